"""Quiet zones: measured by the reference in double precision, at points that no solver was given."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.plugins.registry import discover_plugins

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats

ARRAY, NINE, AIR = pc.autd(), pc.autd(3, 3), pc.Air()
UNITS = {1: ARRAY, 2: pc.autd(1, 2), 4: pc.autd(2, 2), 9: NINE}
SOLVERS = [offer.name for offer in discover_plugins().list() if offer.kind == "solver"]
POINTS = np.array([[0.0, 0.0, 0.2], [0.03, 0.02, 0.2], [-0.03, 0.03, 0.22]])
EAR = pc.Zone(position=(0.1, 0.0, 0.25), pressure=2.0, radius=0.015)


def inside(zone: pc.Zone, count: int = 600, seed: int = 7) -> Floats:
    """Places in a zone, a third of them on its surface."""
    rng = np.random.default_rng(seed)
    ways = rng.normal(size=(count, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    away = np.where(np.arange(count) % 3 == 0, 1.0, np.cbrt(rng.random(count)))
    return np.array(zone.position) + zone.radius * away[:, None] * ways


def loudest(array: pc.Array, zone: pc.Zone, gains: Complexes) -> float:
    """The highest sound pressure found there [Pa]."""
    return float(np.abs(pc.matrix(array, inside(zone), AIR) @ gains).max())


def climb(array: pc.Array, zone: pc.Zone, gains: Complexes, near: Floats) -> float:
    """Return the highest sound pressure [Pa] in a zone: many places, more of them near `near`, then random climbs.

    Places are picked in single precision; the value is in double precision.
    """
    rng, centre = np.random.default_rng(1), np.array(zone.position)

    def keep_inside(places: Floats) -> Floats:
        away = places - centre
        distance = np.linalg.norm(away, axis=-1, keepdims=True)
        kept = centre + away * np.minimum(1.0, zone.radius / np.maximum(distance, 1e-30))
        return np.asarray(kept, np.float64)

    clouds = [
        f + spread * rng.normal(size=(400, 3)) for f in near for spread in (0.002, 0.006, 0.02)
    ]
    places = keep_inside(np.concatenate([inside(zone, 3000), *clouds]))
    loud = np.abs(pc.field(array, gains, places, AIR))
    first = np.argsort(-loud)[:8]
    at, best, step = places[first], loud[first], 0.002
    for _ in range(12):
        tried = keep_inside(at[:, None] + step * rng.normal(size=(len(at), 24, 3)))
        loud = np.abs(pc.field(array, gains, tried, AIR))
        way = np.arange(len(at)), loud.argmax(axis=1)
        at = np.where((loud[way] > best)[:, None], tried[way], at)
        best, step = np.maximum(best, loud[way]), 0.7 * step
    return float(np.abs(pc.matrix(array, at, AIR) @ gains.astype(complex)).max())


@pytest.mark.parametrize("pressure", [800.0, 4000.0])
@pytest.mark.parametrize("solver", SOLVERS)
def test_every_solver_keeps_the_whole_ball_quiet(solver: str, pressure: float) -> None:
    """A strong focus, and more than the array can do."""
    points = POINTS[:1] if solver == "single-focus" else POINTS
    limits = pc.Limits(zones=(EAR,))
    plain = pc.solve(ARRAY, points, np.full(len(points), pressure), solver=solver)
    quiet = pc.solve(ARRAY, points, np.full(len(points), pressure), solver=solver, limits=limits)
    assert loudest(ARRAY, EAR, plain.gains) > 10.0 * EAR.pressure
    assert loudest(ARRAY, EAR, quiet.gains) < EAR.pressure
    assert np.abs(quiet.gains).max() <= 1.0
    assert quiet.gains.any()
    assert "zones" not in quiet.violations


@pytest.mark.parametrize("pressure", [1e-9, 1e-3, 2.0])
def test_the_excess_is_that_over_the_limit_however_low(pressure: float) -> None:
    """Single precision keeps no limit as low as the first two."""
    ear = pc.Zone(position=EAR.position, pressure=pressure, radius=0.0)
    session = pc.Session(ARRAY, AIR)
    gains = session.solve(POINTS, [800.0] * 3, limits=pc.Limits(zones=(ear,))).gains
    rounded = np.exp(1j * np.round(np.angle(gains) * 128 / np.pi) * np.pi / 128) * np.abs(gains)
    quiet_subspace = session.propagator.quiet_subspace
    assert quiet_subspace is not None
    heard = float(np.abs(pc.matrix(ARRAY, np.array([ear.position]), AIR) @ rounded)[0])
    assert quiet_subspace.measure_excess(rounded) == pytest.approx(heard / pressure, rel=0.01)


def test_a_head_is_quiet_and_the_foci_are_as_strong() -> None:
    """Two units, because the time to prepare a zone grows with the square of their number."""
    array, head = UNITS[2], pc.Zone(position=(0.0, -0.45, 0.5), pressure=2.0, radius=0.12)
    session = pc.Session(array, AIR)
    found = session.solve(POINTS, [2000.0] * 3, limits=pc.Limits(zones=(head,)))
    assert found.status is pc.Status.ok
    assert found.error < 1e-3
    assert np.abs(pc.matrix(array, POINTS, AIR) @ found.gains) == pytest.approx(2000.0, rel=2e-3)
    assert loudest(array, head, found.gains) < head.pressure
    plain = pc.solve(array, POINTS, [2000.0] * 3)
    assert loudest(array, head, plain.gains) > 50.0 * head.pressure


def test_a_surface_stays_even_beside_a_zone() -> None:
    step = 0.0045
    grid = np.stack(np.meshgrid(*[np.arange(-2, 3) * step] * 2), axis=-1).reshape(-1, 2)
    points = np.column_stack([grid, np.full(len(grid), 0.2)])
    pressure = np.full(len(points), pc.sound_pressure(np.array(20.0), AIR))
    zone = pc.Zone(position=(0.15, 0.05, 0.25), pressure=2.0, radius=0.03)
    found = pc.solve(
        UNITS[2], points, pressure, regions=np.zeros(len(points), int),
        limits=pc.Limits(zones=(zone,)),
    )  # fmt: skip
    assert found.status is pc.Status.ok
    assert loudest(UNITS[2], zone, found.gains) < zone.pressure
    among = np.random.default_rng(2).uniform(-0.009, 0.009, (300, 2))
    made = np.abs(
        pc.matrix(UNITS[2], np.column_stack([among, np.full(300, 0.2)]), AIR) @ found.gains
    )
    felt = (made / pressure[0]) ** 2
    assert felt.mean() == pytest.approx(1.0, abs=0.05)
    assert felt.std() < 0.1


def test_a_surface_s_wave_does_not_go_on_to_a_head() -> None:
    """With the wave that it has without a zone, a tenth of the force is missing."""
    array = UNITS[4]
    axis = np.arange(-5, 6) * 0.0028
    disc = np.array([(x, y, 0.2) for x in axis for y in axis if math.hypot(x, y) < 0.0145])
    head = pc.Zone(position=(0.0, -0.45, 0.5), pressure=2.0, radius=0.08)
    found = pc.solve(
        array, disc, np.full(len(disc), pc.sound_pressure(np.array(10.0), AIR)),
        regions=np.zeros(len(disc), int), limits=pc.Limits(zones=(head,)),
    )  # fmt: skip
    (felt,) = found.felt
    assert felt.force == pytest.approx(1.0, abs=0.05)
    assert felt.rms < 0.1
    assert loudest(array, head, found.gains) < head.pressure


@pytest.mark.parametrize("pressure", [1000.0, 2000.0])
def test_what_gains_of_that_kind_can_make_is_made(pressure: float) -> None:
    """The best of all gains without V within the limit, by another solver."""
    phases = np.array([0.0, 1.0, 2.0])
    session = pc.Session(ARRAY, AIR, "lagrange")
    found = session.solve(POINTS, [pressure] * 3, phases, limits=pc.Limits(zones=(EAR,)))
    quiet_subspace = session.propagator.quiet_subspace
    assert quiet_subspace is not None
    V, B = quiet_subspace.V.astype(complex), pc.matrix(ARRAY, POINTS, AIR) / pressure
    assert pytest.approx(np.eye(len(V)), abs=1e-4) == V @ V.conj().T
    g = cp.Variable(len(ARRAY), complex=True)
    missed = cp.norm(B @ g - np.exp(1j * phases)) / math.sqrt(3.0)
    best = cp.Problem(cp.Minimize(missed), [cp.abs(g) <= 1.0, V @ g == 0.0]).solve("CLARABEL")
    assert found.error < best + 0.01


def test_several_zones_and_points_and_a_limit_of_power() -> None:
    zones = (
        EAR,
        pc.Zone((-0.1, 0.0, 0.25), pressure=4.0, radius=0.0),
        pc.Zone((0.0, 0.12, 0.3), pressure=3.0, radius=0.01),
    )
    limits = pc.Limits(gain=None, power=40.0, zones=zones)
    found = pc.solve(ARRAY, POINTS, [500.0] * 3, limits=limits)
    assert found.status is pc.Status.ok
    assert float(np.vdot(found.gains, found.gains).real) <= 40.0
    for zone in zones:
        assert loudest(ARRAY, zone, found.gains) < zone.pressure


def test_what_is_asked_in_a_zone_contradicts_it() -> None:
    points = np.vstack([POINTS[:1], [EAR.position]])
    found = pc.solve(ARRAY, points, [800.0, 300.0], limits=pc.Limits(zones=(EAR,)))
    assert found.status is pc.Status.infeasible
    assert found.violations["zones"] == pytest.approx(300.0 / EAR.pressure - 1.0)
    assert loudest(ARRAY, EAR, found.gains) < EAR.pressure
    assert np.abs(found.sound_pressure[0]) == pytest.approx(800.0, rel=0.01)


def test_gains_that_are_louder_are_certified_as_such() -> None:
    session = pc.Session(ARRAY, AIR)
    found = session.solve(POINTS, [800.0] * 3, limits=pc.Limits(zones=(EAR,)))
    assert session.certify(found.gains).status is pc.Status.ok
    plain = pc.solve(ARRAY, POINTS, [800.0] * 3)
    told = session.certify(plain.gains)
    loud = loudest(ARRAY, EAR, plain.gains) / EAR.pressure - 1.0
    assert told.status is pc.Status.infeasible
    assert told.violations["zones"] == pytest.approx(loud, rel=0.1)


def test_until_zones_are_prepared_there_is_silence() -> None:
    zone = pc.Zone((0.11, 0.013, 0.27), pressure=2.0, radius=0.0151)  # of no other test
    session = pc.Session(ARRAY, AIR)
    first = session.solve(POINTS, [800.0] * 3, limits=pc.Limits(zones=(zone,)), deadline=0.0)
    assert first.status is pc.Status.deadline
    assert not first.gains.any()
    assert "prepared" in first.note
    then = session.solve(POINTS, [800.0] * 3, limits=pc.Limits(zones=(zone,)))
    assert then.status is pc.Status.ok
    assert loudest(ARRAY, zone, then.gains) < zone.pressure


def test_without_zones_all_is_as_before_them() -> None:
    session = pc.Session(ARRAY, AIR)
    before = session.solve(POINTS, [800.0] * 3).gains.copy()
    session.solve(POINTS, [800.0] * 3, limits=pc.Limits(zones=(EAR,)))
    session.last = None
    after = session.solve(POINTS, [800.0] * 3).gains
    np.testing.assert_allclose(after, before, atol=1e-5)


def test_what_is_all_in_a_zone_is_silent() -> None:
    for solver in SOLVERS:
        found = pc.solve(
            ARRAY, [EAR.position], [300.0], solver=solver, limits=pc.Limits(zones=(EAR,))
        )
        assert found.status is pc.Status.infeasible
        assert loudest(ARRAY, EAR, found.gains) < EAR.pressure


@pytest.mark.parametrize("solver", ["lagrange", "pseudo-inverse"])
def test_the_same_ten_thousand_times_as_strong_keeps_the_zone_too(solver: str) -> None:
    session, zone = (
        pc.Session(ARRAY, AIR, solver),
        pc.Zone(EAR.position, pressure=0.05, radius=EAR.radius),
    )
    for pressure in (0.1, 1000.0):
        found = session.solve(POINTS, [pressure] * 3, limits=pc.Limits(zones=(zone,)))
        assert loudest(ARRAY, zone, found.gains) < zone.pressure


def test_one_that_wants_others_does_not_take_them_from_another() -> None:
    """Each waits for its own zones; what has not begun is given up by who no longer wants it."""
    zones = [pc.Zone((0.1, 0.01 * k, 0.3), pressure=2.0, radius=0.0131) for k in range(3)]
    sessions = [pc.Session(ARRAY, AIR) for _ in range(3)]
    for session in sessions:
        for zone in zones:
            session.solve(POINTS, [800.0] * 3, limits=pc.Limits(zones=(zone,)), deadline=0.0)
    for session, zone in zip(sessions, zones, strict=True):
        found = session.solve(POINTS, [800.0] * 3, limits=pc.Limits(zones=(zone,)))
        assert found.status is pc.Status.ok
        assert loudest(ARRAY, zone, found.gains) < zone.pressure


def test_in_double_precision_too() -> None:
    session = pc.Session(ARRAY, AIR, "lagrange", precision="double")
    found = session.solve(POINTS, [800.0] * 3, limits=pc.Limits(zones=(EAR,)))
    assert found.status is pc.Status.ok
    assert loudest(ARRAY, EAR, found.gains) < EAR.pressure


@pytest.mark.parametrize(
    ("bad", "name"),
    [
        ({"position": (0.0, math.nan, 0.3)}, "zone.position"),
        ({"position": (0.0, 0.3)}, "zone.position"),
        ({"radius": -0.1}, "zone.radius"),
        ({"radius": 1e3}, "zone.radius"),
        ({"pressure": 0.0}, "zone.pressure"),
        ({"pressure": math.inf}, "zone.pressure"),
    ],
)
def test_what_is_no_zone_is_refused(bad: dict[str, Any], name: str) -> None:
    whole = {"position": (0.0, 0.0, 0.3), "pressure": 1.0, "radius": 0.01, **bad}
    with pytest.raises(pc.ArgumentError, match=name):
        pc.Zone(**whole)


@pytest.mark.parametrize(
    "zone",
    [
        pc.Zone((0.0, 0.0, 0.0), pressure=1.0, radius=0.5),  # around the array
        pc.Zone(tuple(ARRAY.positions[7].tolist()), pressure=1.0),  # on a transducer
        pc.Zone((300.0, 0.0, 0.0), pressure=1.0, radius=0.1),  # in millimetres
    ],
)
def test_zones_that_cannot_be_meant_are_refused(zone: pc.Zone) -> None:
    for _ in range(2):
        with pytest.raises(pc.ArgumentError, match=r"limits\.zones"):
            pc.solve(ARRAY, POINTS, [800.0] * 3, limits=pc.Limits(zones=(zone,)))


def test_zones_need_zones_and_a_limit() -> None:
    with pytest.raises(pc.ArgumentError, match=r"limits\.zones"):
        pc.Limits(zones=((0.0, 0.0, 0.3),))  # type: ignore[arg-type]
    with pytest.raises(pc.ArgumentError, match="a list of Zones"):
        pc.Limits(zones=EAR)  # type: ignore[arg-type]
    with pytest.raises(pc.ArgumentError, match="gain or power"):
        pc.Limits(gain=None, zones=(EAR,))


@pytest.mark.deep
@settings(max_examples=40)
@given(st.integers(0, 10**6))
def test_any_zone_stays_quiet(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x, y, z = rng.uniform([-0.25, -0.25, 0.1], [0.25, 0.25, 0.5]).tolist()
    pressure, radius = 10.0 ** rng.uniform(-0.5, 1.5), rng.uniform(0.0, 0.03)
    zone = pc.Zone((x, y, z), pressure=pressure, radius=radius)
    points = rng.uniform([-0.05, -0.05, 0.12], [0.05, 0.05, 0.25], (rng.integers(1, 9), 3))
    asked = np.full(len(points), 10.0 ** rng.uniform(1.0, 4.0))
    try:
        found = pc.solve(ARRAY, points, asked, limits=pc.Limits(zones=(zone,)))
    except pc.ArgumentError as error:  # a large zone close to the array
        if "nothing to sound with" not in str(error):
            raise
        reject()
    assert loudest(ARRAY, zone, found.gains) <= zone.pressure
    assert np.abs(found.gains).max() <= 1.0


LIMITS: tuple[dict[str, float | None], ...] = (
    {},
    {"gain": None, "power": 30.0},
    {"gain": 0.7, "power": 90.0},
)


def check_beside(units: int, seed: int) -> None:
    """Check that a zone is quiet, or known not to be, with foci or a region 0 to 60 mm beside it."""
    rng, array = np.random.default_rng(seed), UNITS[units]
    x, y, z = rng.uniform([-0.15, -0.15, 0.12], [0.15, 0.15, 0.5]).tolist()
    radius = float(rng.choice([0.0, 0.005, 0.015, 0.03, 0.06]))
    zone = pc.Zone((x, y, z), pressure=float(10.0 ** rng.uniform(-1.0, 2.5)), radius=radius)
    limits = pc.Limits(zones=(zone,), **LIMITS[rng.integers(3)])  # type: ignore[arg-type]
    way = rng.normal(size=3)
    way *= np.sign(-way[2]) / np.linalg.norm(way)  # towards the array
    gap = float(rng.choice([1e-5, 0.001, 0.004, 0.012, 0.03, 0.06]))
    points = np.array(zone.position) + (radius + gap) * way
    count = int(rng.choice([1, 1, 4, 9]))
    points = points + (rng.uniform(-0.01, 0.01, (count, 3)) if count > 1 else 0.0)
    points = points.reshape(count, 3)
    region = np.zeros(count, int) if count == 9 else None
    fitting = [name for name in SOLVERS if count == 1 or name != "single-focus"]
    session = pc.Session(array, AIR, str(rng.choice(fitting)))
    scale = str(rng.choice(["exact", "max"]))
    asked = np.full(count, 10.0 ** rng.uniform(2.0, 4.0))
    try:
        found = session.solve(points, asked, regions=region, limits=limits, scale=scale)
    except pc.ArgumentError as error:
        if "nothing to sound with" not in str(error) and "contain a transducer" not in str(error):
            raise
        return
    assert "gain" not in found.violations
    assert "power" not in found.violations
    if limits.gain is not None:
        assert np.abs(found.gains).max() <= limits.gain
    if limits.power is not None:
        assert float(np.linalg.norm(found.gains.astype(complex)) ** 2) <= 1.00001 * limits.power
    if zone.holds(points).any():
        assert found.status is pc.Status.infeasible or not asked.any()
    peak = climb(array, zone, found.gains, points)
    assert peak <= 1.001 * zone.pressure or found.violations["zones"] > 0.0
    certified = session.certify(found.gains)
    if peak > 1.002 * zone.pressure:
        assert certified.violations["zones"] == pytest.approx(peak / zone.pressure - 1.0, rel=0.2)


@settings(max_examples=40)
@given(st.integers(0, 10**6))
def test_a_zone_is_quiet_whatever_is_beside_it(seed: int) -> None:
    check_beside(1, seed)


@pytest.mark.deep
@settings(max_examples=40)
@given(st.sampled_from([2, 4]), st.integers(0, 10**6))
def test_larger_arrays_keep_it_too(units: int, seed: int) -> None:
    check_beside(units, seed)


@pytest.mark.deep
@pytest.mark.timeout(300)
@settings(max_examples=16)
@given(st.integers(0, 10**6))
def test_nine_units_keep_it_too(seed: int) -> None:
    check_beside(9, seed)


@pytest.mark.deep
@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    ("zone", "focus"),
    [
        (pc.Zone((0.0, 0.0, 0.4), pressure=30.0, radius=0.1), (-0.0532, -0.0878, 0.3835)),
        (pc.Zone((0.0, -0.45, 0.5), pressure=2.0, radius=0.12), (0.0055, -0.3198, 0.4072)),
        (pc.Zone((0.0, -0.25, 0.35), pressure=20.0, radius=0.12), (0.0065, -0.1123, 0.3255)),
    ],
)
def test_a_focus_at_the_edge_of_a_zone_is_not_heard_in_it(
    zone: pc.Zone, focus: tuple[float, float, float]
) -> None:
    """They were up to 2.7 times as loud as their limit."""
    session, limits, points = pc.Session(NINE, AIR), pc.Limits(zones=(zone,)), np.array([focus])
    for scale in ("exact", "max"):
        found = session.solve(points, [4000.0], limits=limits, scale=scale)
        assert climb(NINE, zone, found.gains, points) <= zone.pressure
        assert not session.certify(found.gains).violations


def test_a_zone_of_many_wavelengths_beside_two_units() -> None:
    """The same with fewer transducers, so that it is prepared in a second."""
    zone, array = pc.Zone((0.0, 0.0, 0.4), pressure=10.0, radius=0.08), UNITS[2]
    focus = np.array([[0.0, -0.06, 0.343]])
    session = pc.Session(array, AIR)
    for scale in ("exact", "max"):
        found = session.solve(focus, [4000.0], limits=pc.Limits(zones=(zone,)), scale=scale)
        assert climb(array, zone, found.gains, focus) <= zone.pressure
        assert not session.certify(found.gains).violations


def test_gains_that_are_loud_in_a_few_millimetres_only_are_found() -> None:
    """Of a zone of 0.1 m, a focus takes a millionth. Its place is known to `certify`, but not that of other gains."""
    zone, array = pc.Zone((0.0, 0.0, 0.35), pressure=50.0, radius=0.1), UNITS[2]
    session = pc.Session(array, AIR)
    session.solve([[0.0, 0.0, 0.15]], [500.0], limits=pc.Limits(zones=(zone,)))
    rng = np.random.default_rng(4)
    for _ in range(5):
        way = rng.normal(size=3)
        at = np.array(zone.position) + 0.0999 * way / np.linalg.norm(way)
        gains = 0.3 * np.exp(-1j * np.angle(pc.matrix(array, at[None], AIR)[0]))
        peak = climb(array, zone, gains, at[None])
        certified = session.certify(gains)
        assert certified.violations["zones"] == pytest.approx(peak / zone.pressure - 1.0, rel=1e-2)


def test_a_zone_that_no_sound_reaches_is_quiet() -> None:
    behind = pc.Zone((0.0, 0.0, -0.5), pressure=2.0)
    for zones in ((behind,), (behind, EAR)):
        found = pc.solve(ARRAY, POINTS, [500.0] * 3, limits=pc.Limits(zones=zones))
        assert found.status is pc.Status.ok
        assert not found.violations
    plain = pc.solve(ARRAY, POINTS, [500.0] * 3)
    alone = pc.solve(ARRAY, POINTS, [500.0] * 3, limits=pc.Limits(zones=(behind,)))
    np.testing.assert_allclose(alone.gains, plain.gains, atol=1e-5)


@pytest.mark.parametrize("solver", ["auto", "lagrange"])
@pytest.mark.parametrize("scale", ["exact", "max"])
def test_quiet_points_gain_and_power_hold_beside_a_zone(solver: str, scale: str) -> None:
    where = np.array([[0.03, 0.03, 0.2], [-0.02, 0.05, 0.18]])
    limits = pc.Limits(gain=0.9, power=100.0, quiet=(where, 5.0), zones=(EAR,))
    found = pc.solve(ARRAY, POINTS, [1000.0] * 3, solver=solver, scale=scale, limits=limits)
    assert not found.violations
    assert found.status is not pc.Status.infeasible
    assert np.abs(pc.matrix(ARRAY, where, AIR) @ found.gains).max() <= 5.1
    assert np.abs(found.gains).max() <= 0.9
    assert float(np.linalg.norm(found.gains.astype(complex)) ** 2) <= 100.001
    assert climb(ARRAY, EAR, found.gains, POINTS) <= EAR.pressure
    assert np.abs(found.sound_pressure).max() > 300.0


class HeedlessFocus(pc.Solver):
    """Makes a focus, although it should keep quiet points."""

    name: ClassVar[str] = "heedless-focus"
    keeps: ClassVar[frozenset[str]] = frozenset({"quiet"})

    def solve(
        self, propagator: pc.Propagator, targets: pc.Targets, limits: pc.Limits,
        warm: pc.Solution | None, budget: pc.Budget, out: pc.Gains,
    ) -> pc.Result:  # fmt: skip
        """Write the gains of a focus at the first point."""
        b = propagator.B[0]
        out[:] = targets.amplitudes[0] * b.conj() / np.vdot(b, b).real
        return pc.Result()


def test_gains_that_are_scaled_down_for_quiet_points_are_limited() -> None:
    # more points than are corrected one by one
    where = POINTS[0] + np.random.default_rng(2).uniform(-0.002, 0.002, (600, 3))
    limits = pc.Limits(quiet=(where, 100.0), zones=(EAR,))
    session = pc.Session(ARRAY, AIR, HeedlessFocus())
    weak = session.solve(POINTS[0], 90.0, limits=limits)
    assert weak.status is pc.Status.ok
    scaled = session.solve(POINTS[0], 200.0, limits=limits)
    assert not scaled.violations
    assert scaled.error == pytest.approx(0.5, abs=0.02)
    assert scaled.status is pc.Status.limited


def test_a_quiet_point_in_a_zone_keeps_its_own_limit() -> None:
    zone = pc.Zone(EAR.position, pressure=60.0, radius=EAR.radius)
    where = np.array([[0.09, 0.0, 0.25]])
    limits = pc.Limits(quiet=(where, 0.5), zones=(zone,))
    found = pc.solve(ARRAY, POINTS, [700.0] * 3, limits=limits)
    made = float(np.abs(pc.matrix(ARRAY, where, AIR) @ found.gains)[0])
    assert made <= 0.6 or found.violations["quiet"] > 0.0


def test_a_target_in_a_zone_is_infeasible_however_weak_and_measured_nevertheless() -> None:
    zone = pc.Zone(EAR.position, pressure=20.0, radius=EAR.radius)
    points = np.vstack([POINTS[:1], [EAR.position]])
    session = pc.Session(ARRAY, AIR)
    found = session.solve(points, [800.0, 5.0], limits=pc.Limits(zones=(zone,)))
    assert found.status is pc.Status.infeasible
    assert session.certify(found.gains).status is pc.Status.infeasible
    made = pc.matrix(ARRAY, points, AIR) @ found.gains
    np.testing.assert_allclose(found.sound_pressure, made, atol=0.02)
    assert abs(made[1]) > 0.0
    silent = session.solve(points, [800.0, 0.0], limits=pc.Limits(zones=(zone,)))
    assert silent.status is not pc.Status.infeasible


def test_pressures_on_skin_in_a_zone_are_weighed_without_the_slow_reference(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With nine units and a hand, the reference takes ten seconds for each solve."""
    zone = pc.Zone(EAR.position, pressure=20.0, radius=EAR.radius)
    points = np.vstack([POINTS[:1], [EAR.position]])
    capsules = np.array([[0.05, -0.02, 0.22, 0.05, 0.02, 0.22, 0.006, 0.007]])
    facing = pc.SkinFacing.of(np.array([[0.0, 0.0, -1.0], [-0.3, 0.0, -0.95]]), capsules)
    weights = facing.weights(points, ARRAY.positions)

    def refuse(*_: object) -> Any:
        raise AssertionError

    monkeypatch.setattr(pc.SkinFacing, "weights", refuse)
    session = pc.Session(ARRAY, AIR)
    found = session.solve(points, [800.0, 5.0], facing=facing, limits=pc.Limits(zones=(zone,)))
    made = (weights * pc.matrix(ARRAY, points, AIR)) @ found.gains
    np.testing.assert_allclose(found.sound_pressure, made, atol=0.02)
    assert abs(made[1]) > 0.0


@pytest.mark.parametrize("pressure", [1e-9, 1e-4])
def test_a_limit_that_single_precision_cannot_keep_is_reported(pressure: float) -> None:
    zone = pc.Zone(EAR.position, pressure=pressure, radius=EAR.radius)
    found = pc.solve(ARRAY, POINTS, [1500.0] * 3, limits=pc.Limits(zones=(zone,)))
    assert climb(ARRAY, zone, found.gains, POINTS) > pressure
    assert found.violations["zones"] > 0.0
    assert found.status is pc.Status.infeasible
    assert climb(ARRAY, zone, found.gains, POINTS) < 0.05


@pytest.mark.parametrize("solver", ["lagrange", "auto"])
def test_beside_a_zone_foci_are_nearly_as_strong_as_any_that_keep_it(solver: str) -> None:
    """The gains reach the limit. Another solver finds the strongest without V."""
    session = pc.Session(ARRAY, AIR, solver)
    found = session.solve(POINTS[:1], [1e4], limits=pc.Limits(zones=(EAR,)))
    quiet_subspace = session.propagator.quiet_subspace
    assert quiet_subspace is not None
    V, b = quiet_subspace.V.astype(complex), pc.matrix(ARRAY, POINTS[:1], AIR)[0] / 1e3
    g = cp.Variable(len(ARRAY), complex=True)
    strongest = cp.Maximize(cp.real(b @ g))
    best: Any = cp.Problem(strongest, [cp.abs(g) <= 1.0, V @ g == 0.0]).solve("CLARABEL")
    assert np.abs(found.sound_pressure[0]) > 0.95e3 * best
