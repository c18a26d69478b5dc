"""Regions have the phases of one wave inside, free phases between them, and measured quality."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.solving.felt_places import FeltPlaces
from pacinian.solving.propagator import Propagator
from pacinian.solving.region_phases import settle_phases
from pacinian.solving.targets import Targets

ARRAY = pc.autd()
AIR = pc.Air(speed_of_sound=340.0, density=1.2)
K = 2.0 * math.pi * 40e3 / 340.0  # [rad/m]


def patch(x=0.0, y=0.0, z=0.15, count=4, spacing=0.0034):
    """Return a square of points."""
    side = spacing * (np.arange(count) - (count - 1) / 2.0)
    X, Y = np.meshgrid(x + side, y + side)
    return np.c_[X.ravel(), Y.ravel(), np.full(count * count, z)]


def settled(q, regions, amplitudes=None, phases=None, warm=None, array=ARRAY):
    t = np.ones(len(q)) if amplitudes is None else amplitudes
    propagator = Propagator(array, AIR)
    propagator.set_points(q)
    return settle_phases(
        propagator, Targets.make_checked(len(q), t, phases, "exact", regions), warm
    )


def off(a, b):
    """Return the difference of angles [rad]."""
    return np.abs(np.angle(np.exp(1j * (np.asarray(a) - b))))


def test_joint_phases_are_those_of_a_wave_that_converges_beyond():
    q = np.array([[0.01, -0.02, 0.1], [0.0, 0.0, 0.3]])
    focus = np.array([0.01, -0.02, 0.4]) - ARRAY.positions.mean(axis=0)
    away = np.sqrt(((q - focus) ** 2).sum(axis=1))
    assert pc.joint_phases(ARRAY, q, pc.Air(speed_of_sound=340.0)) == pytest.approx(K * away)
    assert pc.joint_phases(ARRAY, q, pc.Air(speed_of_sound=170.0)) == pytest.approx(2 * K * away)
    assert pc.joint_phases(ARRAY, np.empty((0, 3)), medium=AIR).shape == (0,)


def face(axis, angle, *position):
    """Return a unit that is turned about an axis and moved."""
    turn = pc.Pose().rotate(axis, angle)
    return pc.autd().transform(pc.Pose(position, turn.rotation))


LEFT = face("y", math.pi / 2, -0.2, 0.0, 0.2)


@pytest.mark.parametrize(
    "array",
    [
        pc.autd() + face("x", math.pi, 0.0, 0.0, 0.4),
        LEFT + face("y", -math.pi / 2, 0.2, 0.0, 0.2),
        pc.autd() + LEFT,
        LEFT + face("y", -math.pi / 2, 0.2, 0.0, 0.2)
        + face("x", -math.pi / 2, 0.0, -0.2, 0.2) + face("x", math.pi / 2, 0.0, 0.2, 0.2),
    ],
    ids=["floor and ceiling", "two walls", "floor and wall", "four walls"],
)  # fmt: skip
@pytest.mark.parametrize("z", [0.17, 0.2])
def test_units_that_face_one_another_press_evenly_in_their_middle(array, z):
    q, rng = patch(z=z, count=7, spacing=0.003), np.random.default_rng(3)
    t = pc.sound_pressure(np.ones(len(q)), AIR)
    solution = pc.solve(array, q, t, medium=AIR, regions=np.zeros(len(q), int))
    places = np.column_stack([rng.uniform(-0.009, 0.009, (500, 2)), np.full(500, z)])
    felt = pc.radiation_pressure(np.abs(pc.field(array, solution.gains, places, medium=AIR)), AIR)
    assert felt.mean() == pytest.approx(1.0, abs=0.02)
    assert np.sqrt(((felt - 1.0) ** 2).mean()) < 0.07


@pytest.mark.parametrize("half", [50.0, 70.0, 85.0, 110.0])
def test_of_a_bowl_however_deep_all_transducers_count(half):
    i = np.arange(600)
    z, angle = 1.0 - (i + 0.5) / 600 * (1.0 - math.cos(math.radians(half))), 2.4 * i
    across = np.sqrt(1.0 - z * z)
    away = np.column_stack([across * np.cos(angle), across * np.sin(angle), -z])
    array, q = pc.Array(0.2 * away, normals=-away), patch(z=0.03)
    waves = [pc.joint_phases(one, q, AIR) for one in (array, pc.Array(0.2 * away))]
    assert waves[0] == pytest.approx(waves[1])  # the latter face in one direction


def test_on_skin_the_wave_comes_from_the_transducers_that_see_it():
    q, array = patch(count=3), pc.autd(3, 3)
    normals = np.tile([math.sqrt(0.75), 0.0, -0.5], (9, 1))  # towards the array's right side
    propagator = Propagator(array, AIR)
    propagator.set_points(q, SkinFacing(normals, np.empty((0, 8))))
    t = np.linspace(0.2, 1.0, 9)
    targets = Targets.make_checked(
        9, t, None, "max", np.zeros(9, int)
    )  # this solver relaxes no phases
    found = settle_phases(propagator, targets, None).phases
    # independent of amplitudes, so that all frames of a cycle have the same source
    power = (np.abs(propagator.B) ** 2).sum(axis=0, dtype=float)
    source = power @ array.positions / power.sum()
    assert source[0] > 0.05
    middle = np.average(q, axis=0, weights=t * t)
    wave = K * np.linalg.norm(q - middle - 0.8 * (middle - source), axis=1)
    # the source is that of 256 transducers
    assert (off(found - wave, (found - wave)[0]) < 0.1).all()


@pytest.mark.parametrize(("gap", "own"), [(0.02, False), (0.2, True)])
def test_on_skin_regions_far_apart_have_sources_of_their_own(gap, own):
    """The wave of one of two patches is that of the patch alone if the other one is as far away as another hand."""
    array = pc.autd(3, 3)
    one = patch(count=3) + np.array([0.05, 0.02, 0.0])
    q = np.concatenate([one, one - np.array([gap, 0.0, 0.0])])

    def settle(q, regions):
        propagator = Propagator(array, AIR)
        facing = SkinFacing(np.tile([0.0, 0.0, -1.0], (len(q), 1)), np.empty((0, 8)))
        propagator.set_points(q, facing)
        # this solver relaxes no phases
        targets = Targets.make_checked(len(q), np.full(len(q), 0.7), None, "max", regions)
        return settle_phases(propagator, targets, None).phases

    both = settle(q, np.repeat([0, 1], 9))[:9]
    alone = settle(one, np.zeros(9, int))
    same = bool(off(both - alone, (both - alone)[0]).max() < 1e-9)
    assert same is own


@pytest.mark.parametrize("bad", [[0.0], [[0, 0]], [0], [0, 1, 2], ["a", "b"], [1, [2]], 0])
def test_regions_are_whole_numbers_one_for_each_point(bad):
    with pytest.raises(pc.ArgumentError, match="regions"):
        pc.solve(ARRAY, patch(count=2)[:2], [100.0, 100.0], regions=bad, medium=AIR)


def test_points_of_no_region_are_solved_as_before():
    q, t = patch(count=3, spacing=0.02), np.full(9, 200.0)
    apart = pc.solve(ARRAY, q, t, regions=np.full(9, -1), medium=AIR)
    assert apart.targets.regions is None
    assert np.array_equal(apart.gains, pc.solve(ARRAY, q, t, medium=AIR).gains)


@given(st.lists(st.integers(-1, 3), min_size=6, max_size=6), st.integers(0, 2**31))
def test_the_phases_of_a_region_are_the_waves_turned_as_a_whole(regions, seed):
    rng = np.random.default_rng(seed)
    q = rng.uniform([-0.05, -0.05, 0.1], [0.05, 0.05, 0.2], (6, 3))
    phases = np.where(rng.random(6) < 0.3, rng.uniform(-3.0, 3.0, 6), np.nan)
    if not (np.array(regions) >= 0).any():
        return
    t = rng.uniform(0.0, 2.0, 6)
    found = settled(q, regions, t, phases).phases
    assert np.isfinite(found).all()
    given_ = ~np.isnan(phases)
    assert np.array_equal(found[given_], phases[given_])
    for number in set(regions) - {-1, -2}:
        own = np.array(regions) == number
        turn = found[own] - pc.joint_phases(ARRAY, q[own], AIR, radiation_pressure=t[own] ** 2)
        assert (off(turn[~given_[own]], turn[~given_[own]][:1]) < 1e-9).all()


def test_regions_are_turned_to_where_they_take_the_least_power():
    q = np.concatenate([patch(-0.02), patch(0.02, z=0.1537)])
    regions = np.repeat([3, 8], 16)
    found = settled(q, regions).phases
    B = pc.matrix(ARRAY, q, AIR)
    wave = np.concatenate([pc.joint_phases(ARRAY, part, AIR) for part in (q[:16], q[16:])])

    def strength(turn):
        """Return the strength of each transducer for the back-propagated field."""
        return np.linalg.norm(B.conj().T @ np.exp(1j * (wave + turn * (regions == 8))))

    best = max(strength(turn) for turn in np.linspace(0.0, 2.0 * np.pi, 361))
    assert strength((found - wave)[16] - (found - wave)[0]) >= 0.995 * best


def test_a_region_that_moves_keeps_its_phase():
    q = np.concatenate([patch(-0.02), patch(0.02), [[0.0, 0.04, 0.2]]])
    regions = np.append(np.repeat([0, 1], 16), -1)
    session, t = pc.Session(ARRAY, medium=AIR), np.full(33, 300.0)
    last = session.solve(q, t, regions=regions)
    for step in range(1, 6):
        moved = q + 0.0004 * step * np.array([1.0, 0.0, 1.0])
        now = session.solve(moved, t, regions=regions)
        turned = np.exp(1j * (now.phases - last.phases))
        for part in (slice(0, 16), slice(16, 32), slice(32, 33)):
            assert abs(np.angle(turned[part].mean())) < 0.1
        last = now


def test_the_strength_of_a_region_only_scales_the_last_solution():
    session, q, regions = pc.Session(ARRAY, medium=AIR), patch(), np.zeros(16, int)
    first = session.solve(q, np.full(16, 100.0), regions=regions)
    second = session.solve(q, np.full(16, 50.0), regions=regions)
    assert session.propagator.work.solutions_scaled == 1
    assert second.gains == pytest.approx(0.5 * first.gains, rel=1e-5)
    solved = session.propagator.work.solved
    session.solve(q, np.full(16, 50.0), regions=np.repeat([0, 1], 8))
    assert session.propagator.work.solved > solved


# ---------------------------------------------------------------------- what is felt


def test_what_is_felt_is_looked_at_between_the_samples_and_beside():
    q, targets = (
        patch(),
        Targets.make_checked(16, np.full(16, 3.0), None, "exact", np.zeros(16, int)),
    )
    places = FeltPlaces.between_samples(q, targets, None)
    away = np.sqrt(((places.points[:, None] - q) ** 2).sum(axis=2)).min(axis=1)
    inside, beside = ~places.beside, places.beside
    assert (np.abs(places.points[inside, :2]) <= 1.5 * 0.0034 + 1e-12).all()
    assert (away[inside] > 0.0016).all()
    assert (away[beside] > 0.00297).all()
    assert (away[beside] < 0.00501).all()
    assert places.points[:, 2] == pytest.approx(0.15)
    assert len(np.unique(np.sign(places.points[beside, :2]), axis=0)) == 4  # on all sides
    assert (places.asked[inside] == 9.0).all()
    assert not places.asked[beside].any()


def test_the_figures_of_what_is_felt():
    q = np.concatenate([patch(), patch(0.05)])
    targets = Targets.make_checked(
        32, np.repeat([3.0, 0.0], 16), None, "exact", np.repeat([0, 1], 16)
    )
    places = FeltPlaces.between_samples(q, targets, None)
    own = places.region == 0
    p = np.where(places.beside, 1.5, 3.0) + 0j
    assert places.measure_felt(p) == (pc.FeltRegion(1.0, 0.0, 0.0, 0.25), pc.FeltRegion())
    inside = np.flatnonzero(own & ~places.beside)
    p[inside[::2]] = 0.0
    gone = places.weight[inside[::2]].sum() / places.weight[inside].sum()
    first = places.measure_felt(p)[0]
    assert first == pytest.approx((1.0 - gone, math.sqrt(gone), gone, 0.25))
    assert not first.even
    assert places.measure_felt(2.0 * p, multiple=2.0)[0] == pytest.approx(first)


@pytest.mark.parametrize("way", ["half way", "random"])
@pytest.mark.parametrize(
    ("shape", "force", "rms", "holes"),
    [  # integrals of 1 - r^2 / (2 a^2) over a square of side 2 a, and of 1 - r^2 / a^2 over a disc of radius a
        (pc.Rectangle(0.02, 0.02), 2.0 / 3.0, math.sqrt(28.0 / 45.0) / 2.0, 1.0 - math.pi / 4.0),
        (pc.Disc(0.01), 0.5, math.sqrt(1.0 / 3.0), 0.5),
    ],
)
def test_each_part_of_a_region_counts_by_its_area(way, shape, force, rms, holes):
    """The pressure falls towards the rim, on whose samples a fifth of the places would be too many."""
    local = shape.sample_surface(0.00167)
    M = len(local.points)
    targets = Targets.make_checked(M, np.ones(M), None, "exact", np.zeros(M, int))
    if way == "random":
        rng = np.random.default_rng(1)
        places = FeltPlaces.random_places(local.points, targets, None, 20_000, rng, local.area)
    else:
        places = FeltPlaces.between_samples(local.points, targets, None)
    square = (places.points**2).sum(axis=1) / (1e-4 if isinstance(shape, pc.Disc) else 2e-4)
    felt = places.measure_felt(np.sqrt(np.maximum(1.0 - square, 0.0)))[0]
    assert felt[:3] == pytest.approx((force, rms, holes), abs=0.025)


def test_a_place_on_an_outline_has_half_the_weight_of_one_inside():
    q = patch()
    targets = Targets.make_checked(16, np.full(16, 3.0), None, "exact", np.zeros(16, int))
    places = FeltPlaces.between_samples(q, targets, None)
    inside = ~places.beside
    outermost = np.abs(q[:, :2] - q[:, :2].mean(axis=0)).max()
    from_middle = np.abs(places.points[:, :2] - q[:, :2].mean(axis=0)).max(axis=1)
    outline = inside & (from_middle > outermost - 1e-9)
    assert outline.sum() == 12
    assert places.weight[outline] == pytest.approx(0.5)
    assert places.weight[inside & ~outline] == pytest.approx(1.0)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_region_of_few_samples_is_felt_too(count):
    q = patch()[:count]
    solution = pc.solve(ARRAY, q, np.full(count, 300.0), regions=np.zeros(count, int), medium=AIR)
    assert solution.felt[0].force == pytest.approx(
        1.0, abs=0.15
    )  # higher between samples than at them


def test_free_phases_are_met_at_the_samples_and_not_between():
    q = patch(count=5, spacing=0.0085)
    t = np.full(25, 150.0)
    free = pc.Session(ARRAY, medium=AIR)
    assert free.solve(q, t).error < 1e-3
    free.last = pc.Session(ARRAY, medium=AIR).solve(q, t, regions=np.zeros(25, int))
    coarse = pc.solve(ARRAY, q, t, regions=np.zeros(25, int), medium=AIR)
    fine = patch(count=11, spacing=0.0034)
    dense = pc.solve(ARRAY, fine, np.full(121, 150.0), regions=np.zeros(121, int), medium=AIR)
    assert dense.felt[0].rms < 0.05 < coarse.felt[0].rms
    assert dense.status is pc.Status.ok


def test_a_status_of_ok_holds_between_the_samples():
    q = patch(count=4, spacing=0.012)  # too far apart for measurements between them
    solution = pc.solve(ARRAY, q, np.full(16, 150.0), regions=np.zeros(16, int), medium=AIR)
    assert solution.error < 0.03
    assert not solution.felt[0].even
    assert solution.status is pc.Status.approximate


def test_a_certificate_tells_what_is_felt_of_the_gains_as_emitted():
    session, q = pc.Session(ARRAY, medium=AIR), patch()
    solution = session.solve(q, np.full(16, 300.0), regions=np.zeros(16, int))
    assert solution.felt == ()
    whole, half = session.certify(solution.gains), session.certify(solution.gains / 2.0)
    assert whole.felt[0].even
    assert half.felt[0].force == pytest.approx(whole.felt[0].force / 4.0, rel=1e-4)
    assert "felt of region 0" in whole._repr_html_()
