"""The pressure limit holds on skin, also at points that the renderer did not evaluate."""

from copy import deepcopy
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.gallery import HAND
from pacinian.rendering.deviation_log import SKIN_LIMITED
from pacinian.rendering.envelope_groups import EnvelopeGroups
from pacinian.rendering.frame_cycle import Cycle
from pacinian.rendering.skin_limit import SkinLimit, spread, sum_up
from pacinian.scene.hands.capsules import distance_to_skin, make_capsules
from pacinian.scene.sampling.posed_skin import PosedSkin
from pacinian.scene.sampling.samples import no_samples
from pacinian.solving.solution_status import Status
from pacinian.testing import ManualClock

ONE = pc.autd()
CENTRE = ONE.centre
AIR = pc.Air()
TOLERANCE = 0.03
HIGH = pc.Pose((CENTRE[0], CENTRE[1], 0.0))  # the gallery's hand is above the origin
NEAR = 8  # number of points around which to look closer

Array = np.ndarray[Any, Any]


def press(gains: Array, q: Array, weights: Array) -> Array:
    """Return the radiation pressure along the normals of skin, by the equations, (M,) [Pa]. weights: (M, N)."""
    return square(hear(q, weights), gains)


def hear(q: Array, weights: Array) -> Array:
    """Return B at points of skin, (M, N), times the weights."""
    kind = ONE.transducer
    B, heard = np.zeros(weights.shape, complex), weights.any(axis=1)
    d = q[heard, None] - ONE.positions
    r = np.sqrt((d * d).sum(axis=2))
    D = kind.directivity(np.maximum((d * ONE.normals).sum(axis=2) / r, 0.0))
    k, beta = AIR.wavenumber(kind.frequency), AIR.beta(kind.frequency)
    wave = kind.pressure * D * np.exp((-1j * k - beta) * r) * r**-AIR.exponent
    B[heard] = weights[heard] * wave
    return B


def square(B: Array, gains: Array) -> Array:
    """Return the radiation pressure, (M,) [Pa], of B, (M, N), and gains."""
    return np.asarray(pc.radiation_pressure(np.abs(B @ gains.astype(complex)), AIR))


def find_normals(capsules: Array, q: Array) -> Array:
    """Return the outward normals of the skin at points, (M, 3), by differences of the distance to it."""
    step = 1e-6 * np.eye(3)
    n = np.column_stack(
        [distance_to_skin(capsules, q + e) - distance_to_skin(capsules, q - e) for e in step]
    )
    return np.asarray(n / np.linalg.norm(n, axis=1)[:, None])


def on_skin(capsules: Array, own: Array, q: Array) -> tuple[Array, Array, Array]:
    """Move points, (M, 3), onto the outside of their capsules `own`. Return points, normals and `own`."""
    a, e = own[:, :3], own[:, 3:6] - own[:, :3]
    s = np.clip(((q - a) * e).sum(axis=1) / np.maximum((e * e).sum(axis=1), 1e-12), 0.0, 1.0)
    axis = a + s[:, None] * e
    n = (q - axis) / np.linalg.norm(q - axis, axis=1)[:, None]
    q = axis + (own[:, 6] + s * (own[:, 7] - own[:, 6]))[:, None] * n
    deep = distance_to_skin(capsules, q)
    out = deep > -5e-4
    q = (q - deep[:, None] * n)[out]
    return q, find_normals(capsules, q), own[out]


def weigh(q: Array, n: Array, capsules: Array) -> Array:
    """Return the weights of sound at points of skin, as `SkinFacing` does, (M, N)."""
    return pc.SkinFacing(n, capsules).weights(q, ONE.positions)


def weigh_near(q: Array, n: Array, capsules: Array, places: Array) -> Array:
    """Return the same weights, of points that are near one of K places, (K, 3), but faster.

    A capsule is left out where it is in no point's way: where paths from the place to the transducers miss it even if
    it is as much thicker as points are away from the place.
    """
    of = np.linalg.norm(q[:, None] - places, axis=2).argmin(axis=1)
    thick = capsules.copy()
    thick[:, 6:] += np.linalg.norm(q - places[of], axis=1).max()
    free = [weigh(places, np.zeros_like(places), one[None]).min(axis=1) == 1.0 for one in thick]
    out = [distance_to_skin(one[None], places) > 0.0 for one in thick]
    w = np.empty((len(q), len(ONE)))
    for k, counts in enumerate(~(np.array(free) & np.array(out)).T):
        some = of == k
        w[some] = weigh(q[some], n[some], capsules[counts])
    return w


@lru_cache(maxsize=1)  # several gains are heard at the same skin, one after the other
def look_everywhere(hand: pc.Hand, seed: int) -> tuple[Array, Array, Array, np.random.Generator]:
    """Return random points of the skin, their capsules, B as if nothing were in the way, and what made them."""
    rng, capsules = np.random.default_rng(seed), make_capsules(hand)
    own = np.repeat(capsules, 300, axis=0)
    middle = own[:, :3] + rng.uniform(0, 1, (len(own), 1)) * (own[:, 3:6] - own[:, :3])
    q, n, own = on_skin(capsules, own, middle + 0.1 * rng.normal(size=middle.shape))
    return q, own, hear(q, weigh(q, n, np.empty((0, 8)))), rng


def highest(gains: Array, hand: pc.Hand, seed: int, others: tuple[pc.Hand, ...] = ()) -> float:
    """Return the highest pressure at random points of the skin [Pa]. others: hands that also cast a shadow."""
    q, own, B, rng = look_everywhere(hand, seed)
    capsules, rng = make_capsules(hand), deepcopy(rng)
    shadow = np.concatenate([capsules, *(make_capsules(other) for other in others)])
    P = square(B, gains)  # where it is high if nothing is in the way
    for width in (2e-3, 7e-4):
        best = np.argsort(P)[-NEAR:]
        places, around = q[best], np.repeat(q[best], 25, axis=0)
        around += rng.normal(0.0, width, around.shape)
        q, n, own = on_skin(capsules, np.repeat(own[best], 25, axis=0), around)
        P = press(gains, q, weigh_near(q, n, shadow, places))
    return float(P.max())


def render(scene: pc.Scene, ticks: int = 4, array: pc.Array = ONE, **settings: Any) -> pc.Renderer:
    renderer = pc.Renderer(
        array, scene, clock=ManualClock(), medium=AIR, adaptive=False, **settings
    )
    with renderer:
        for k in range(ticks):
            renderer.clock.time = k * renderer.period  # type: ignore[attr-defined]
            renderer.tick(k * renderer.period)
        assert not renderer.report.faults
    return renderer


offsets = st.floats(-0.04, 0.04)


@st.composite
def scenes(draw: st.DrawFn) -> pc.Scene:
    """Draw a scene: a hand on a ball, a plate, or foci."""
    hand = HAND.transform(HIGH)
    palm = np.array([*CENTRE[:2], 0.2])
    kind = draw(st.sampled_from(["ball", "plate", "foci"]))
    pressure = draw(st.floats(5.0, 60.0))
    x, y, z = draw(offsets), draw(offsets), draw(st.floats(-0.012, 0.004))
    here = pc.Pose((palm[0] + x, palm[1] + y, palm[2] + z))
    if kind == "ball":
        items: tuple[Any, ...] = (
            pc.Volume(shape=pc.Sphere(0.02), pose=here, radiation_pressure=pressure),
        )
    elif kind == "plate":
        items = (
            pc.Surface(shape=pc.Rectangle(0.06, 0.04), pose=here, radiation_pressure=pressure),
        )
    else:
        count = draw(st.integers(1, 5))
        items = tuple(
            pc.Point(
                position=(palm[0] + draw(offsets), palm[1] + draw(offsets), palm[2] + z),
                radiation_pressure=pressure,
            )
            for _ in range(count)
        )
    return pc.Scene(items, hands=(hand,))


@given(scenes(), st.floats(1.0, 30.0))
@settings(deadline=None, max_examples=40)
def test_no_place_of_the_skin_gets_more_than_the_limit(scene: pc.Scene, limit: float) -> None:
    renderer = render(scene, peak=limit)
    for number, one in enumerate(renderer.played.rows):
        got = highest(one.gains, scene.hands[0], number)
        assert got <= limit * (1.0 + TOLERANCE)
        if one.limited:
            assert one.solution.status is Status.scaled


def test_a_peak_beside_the_samples_is_limited_and_named() -> None:
    """A plate of 8 Pa makes more than 8 Pa beside its samples."""
    hand = HAND.transform(HIGH)
    plate = pc.Surface(
        shape=pc.Rectangle(0.06, 0.05),
        pose=pc.Pose((*CENTRE[:2], 0.197)),
        radiation_pressure=8.0,
        name="plate",
    )
    scene = pc.Scene((plate,), hands=(hand,))
    free = render(scene)
    asked = free.samples.radiation_pressure.max()  # type: ignore[union-attr]
    peak = highest(free.played.rows[-1].gains, hand, 0)
    assert peak > 1.15 * asked
    assert SKIN_LIMITED not in free.report.deviations.totals.get("plate", {})
    held = render(scene, peak=asked)
    one = held.played.rows[-1]
    assert 0.8 * asked < highest(one.gains, hand, 0) <= asked * (1.0 + TOLERANCE)
    assert SKIN_LIMITED in held.report.deviations.totals["plate"]
    assert f"limit of {asked:.3g} Pa" in one.solution.note
    loose = render(scene, peak=200.0)
    np.testing.assert_array_equal(loose.played.rows[-1].gains, free.played.rows[-1].gains)


def bones(hand: pc.Hand) -> tuple[Array, Array]:
    """Return a hand's joints, (26, 3), and their radii, (26,) [m]."""
    assert hand.joints is not None
    assert hand.radii is not None
    return hand.joints, hand.radii


def bend(hand: pc.Hand, finger: int, degrees: tuple[float, float, float]) -> pc.Hand:
    """Bend a finger (1: index) of a hand in the pose of rest at its three joints."""
    joints = bones(hand)[0].copy()
    chain = range(6 + 5 * (finger - 1), 6 + 5 * finger)
    for joint, angle in zip(chain[1:], np.radians(degrees), strict=False):
        turn = np.array(
            [[1, 0, 0], [0, np.cos(angle), np.sin(angle)], [0, -np.sin(angle), np.cos(angle)]]
        )
        beyond = [k for k in chain if k > joint]
        joints[beyond] = joints[joint] + (joints[beyond] - joints[joint]) @ turn.T
    return pc.Hand(joints, hand.radii, side=hand.side)


def test_skin_that_bending_uncovers_is_limited() -> None:
    """The back of a joint is inside the flesh of a straight finger. Here it points at the array."""
    straight = pc.Hand.open("right")
    hand = bend(straight, 2, (60.0, 100.0, 30.0))
    down = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    joints, radii = bones(hand)
    joints = joints @ down.T
    joints += np.array([*CENTRE[:2], 0.15]) - joints[13]
    hand = pc.Hand(joints, radii, side="right")
    low = 0.15 - float(radii[13])
    ball = pc.Volume(
        shape=pc.Sphere(0.003), pose=pc.Pose((*CENTRE[:2], low)), radiation_pressure=60.0
    )
    gains = render(pc.Scene((ball,), hands=(hand,)), peak=3.0).played.rows[-1].gains
    assert 0.5 * 3.0 < highest(gains, hand, 0) <= 3.0 * (1.0 + TOLERANCE)


@given(st.integers(0, 10**6), st.sampled_from([0.5, 1.0, 2.0, 4.0]))
@settings(deadline=None, max_examples=120)
def test_a_focus_anywhere_on_the_skin_is_found(seed: int, scale: float) -> None:
    """On bent fingers, low beside the array, on large hands: wherever sound reaches the skin."""
    rng = np.random.default_rng(seed)
    hand = pc.Hand.open("right")
    for finger in range(1, 5):
        hand = bend(hand, finger, tuple(rng.uniform(0.0, 100.0, 3)))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    joints, radii = (scale * each for each in bones(hand))
    joints = joints @ turn.T
    low = (joints[:, 2] - radii).min()
    joints += CENTRE + np.array([*rng.uniform(-0.15, 0.15, 2), rng.uniform(0.03, 0.2) - low])
    hand = pc.Hand(joints, radii)
    capsules = make_capsules(hand)
    own = np.repeat(capsules[3:], 4, axis=0)  # not the ball of the thumb
    q, n, _ = on_skin(capsules, own, own[:, :3] + scale * 0.03 * rng.normal(size=(len(own), 3)))
    facing = pc.SkinFacing(n, capsules)
    heard = facing.weights(q, ONE.positions).sum(axis=1)
    if not len(q) or heard.max() < 0.1 * len(ONE):
        return
    reached = np.flatnonzero(heard >= 0.1 * len(ONE))
    towards = ((CENTRE - q) * n).sum(axis=1) / np.linalg.norm(CENTRE - q, axis=1)
    least = reached[np.argmin(towards[reached])]  # turned away from the centre, or nearly
    m = least if seed % 2 else int(rng.choice(reached))
    gains = pc.Session(ONE, AIR, "single-focus").solve(q[m], 1e3).gains
    gains = (gains / np.abs(gains).max()).astype(np.complex64)
    P = float(press(gains, q[m : m + 1], weigh(q[m : m + 1], n[m : m + 1], capsules))[0])
    limit = SkinLimit(pc.Session(ONE, AIR))
    far = no_samples().changed(
        positions=np.ones((1, 3)), normals=np.zeros((1, 3)), regions=np.zeros(1, np.int64)
    )
    samples = far.changed(radiation_pressure=np.zeros(1), capsules=capsules)
    found = limit.find_highest_pressure(gains[None], [PosedSkin(hand)], samples, 0.5 * P)
    assert found is not None
    assert found >= P / (1.0 + TOLERANCE)


@pytest.mark.deep
@pytest.mark.parametrize(
    "speed",
    [0.3, 1.0, 3.0],
)
def test_a_second_hand_without_velocities_is_limited_where_it_was_seen(speed: float) -> None:
    """It crosses the beam to a hand at rest; it is drawn to its new place within 10 ms, but is there at once."""
    right = pc.Hand.open("right", pc.Pose((*CENTRE[:2], 0.25)))
    ball = pc.Volume(
        shape=pc.Sphere(0.02), pose=pc.Pose((*CENTRE[:2], 0.228)), radiation_pressure=40.0
    )
    begin = CENTRE[0] - 0.02 - 0.008 * speed

    def scene(t: float) -> pc.Scene:
        left = pc.Hand.open("left", pc.Pose((begin + speed * t, CENTRE[1], 0.19)))
        return pc.Scene((ball,), hands=(right, left))

    clock = ManualClock()
    renderer = pc.Renderer(
        ONE, scene, clock=clock, medium=AIR, adaptive=False, peak=10.0, rate=1000.0
    )
    reached = 0.0
    with renderer:
        for k in range(16):
            t = k * renderer.period
            clock.time = t
            renderer.tick(t)
            if k % 4 == 3:
                hands = scene(t).hands
                row = renderer.last_frame.gains(renderer.backend.capability)[-1]
                for hand, other in (hands, hands[::-1]):
                    reached = max(reached, highest(row, hand, k, others=(other,)))
    assert reached <= 10.0 * (1.0 + TOLERANCE)


def test_without_a_hand_no_skin_is_seen_and_nothing_is_scaled_down() -> None:
    """Two foci are so close together that the pressure between them exceeds the target."""
    at = [CENTRE + np.array([0.004 * side, 0.0, 0.2]) for side in (-1, 1)]
    scene = pc.Scene(tuple(pc.Point(position=tuple(q), radiation_pressure=6.0) for q in at))
    free, held = render(scene).played.rows[-1], render(scene, peak=6.0).played.rows[-1]
    np.testing.assert_array_equal(held.gains, free.gains)


def test_groups_are_limited_in_whatever_phase_of_their_envelopes() -> None:
    """Every second row that was sent is checked, for two foci with different frequencies."""
    hand = HAND.transform(HIGH)
    at = [CENTRE + np.array([0.009 * side, 0.0, 0.2]) for side in (-1, 1)]
    items = tuple(
        pc.Point(position=tuple(q), radiation_pressure=20.0, envelope=pc.Sine(rate))
        for q, rate in zip(at, (90.0, 170.0), strict=True)
    )
    renderer = pc.Renderer(
        ONE,
        pc.Scene(items, hands=(hand,)),
        clock=ManualClock(),
        medium=AIR,
        adaptive=False,
        peak=5.0,
    )
    reached = 0.0
    with renderer:
        for k in range(18):
            renderer.clock.time = k * renderer.period  # type: ignore[attr-defined]
            renderer.tick(k * renderer.period)
            assert renderer.last_frame is not None
            (row,) = renderer.last_frame.gains(renderer.backend.capability)
            if k % 2:
                reached = max(reached, highest(row, hand, k))
    assert isinstance(renderer.played.rows[-1].groups, EnvelopeGroups)
    assert renderer.played.rows[-1].contributions is not None
    assert 0.5 * 5.0 < reached <= 5.0 * (1.0 + TOLERANCE)


@given(st.integers(0, 1000))
def test_the_largest_sum_of_groups_is_bounded_closely(seed: int) -> None:
    """The largest amplitude is at a corner, so the test tries all groups on and off."""
    rng = np.random.default_rng(seed)
    z = rng.normal(size=(4, 7)) + 1j * rng.normal(size=(4, 7))
    on = np.array(list(np.ndindex(2, 2, 2, 2)), float)
    exact = np.abs(on @ z).max(axis=0)
    found = sum_up(z)
    assert (exact <= found * (1.0 + 1e-12)).all()
    assert (found <= 1.02 * exact).all()


def test_a_patch_is_even_and_flat() -> None:
    normals = np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8]])
    points, of = spread(np.zeros((2, 3)), normals, 2, 1e-3)
    assert points.shape == of.shape == (38, 3)
    for n, q in zip(normals, points.reshape(2, 19, 3), strict=True):
        np.testing.assert_allclose(q @ n, 0.0, atol=1e-15)
        d = np.sqrt(((q[:, None] - q[None]) ** 2).sum(axis=2)) + np.eye(19)
        np.testing.assert_allclose(d.min(axis=1), 1e-3)


@pytest.mark.parametrize("limit", [3.0, 1e6])
def test_gains_that_cannot_reach_the_limit_cost_no_look(
    limit: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks: list[int] = []
    evaluate = SkinLimit._evaluate

    def count(limit: SkinLimit, *given: Any) -> Any:
        looks.append(1)
        return evaluate(limit, *given)

    monkeypatch.setattr(SkinLimit, "_evaluate", count)
    hand = HAND.transform(HIGH)
    ball = pc.Volume(
        shape=pc.Sphere(0.02), pose=pc.Pose((*CENTRE[:2], 0.19)), radiation_pressure=3.0
    )
    renderer = render(pc.Scene((ball,), hands=(hand,)), peak=limit)
    assert renderer.solution is not None
    assert bool(looks) is (limit == 3.0)


@pytest.mark.parametrize("cycle", [1, 4])  # one frame, and several in turn
def test_what_stands_still_is_evaluated(cycle: int, monkeypatch: pytest.MonkeyPatch) -> None:
    looks: list[float] = []
    evaluate = SkinLimit._evaluate_skins

    def count(limit: SkinLimit, *given: Any) -> float:
        looks.append(evaluate(limit, *given))
        return looks[-1]

    monkeypatch.setattr(SkinLimit, "_evaluate_skins", count)
    # on skin, frames of a cycle are bands of large regions; two waves of a small one serve as well here
    monkeypatch.setattr(Cycle, "_may_tilt", cycle > 1)
    hand = HAND.transform(HIGH)

    scenes = [
        pc.Scene(
            (
                pc.Volume(
                    shape=pc.Sphere(0.02),
                    pose=pc.Pose((CENTRE[0] + 0.001 * k, CENTRE[1], 0.19)),
                    radiation_pressure=3.0,
                ),
            ),
            hands=(hand,),
        )
        for k in range(6)
    ]
    renderer = pc.Renderer(
        ONE,
        lambda t: scenes[min(round(1000.0 * t), 5)],
        clock=ManualClock(),
        medium=AIR,
        adaptive=False,
        max_cycle_frames=cycle,
        peak=1000.0,
        rate=1000.0,
    )
    evaluated: list[bool] = []
    with renderer:
        for k in range(60):
            renderer.clock.time = k * renderer.period  # type: ignore[attr-defined]
            renderer.tick(k * renderer.period)
            evaluated.append(all(row.evaluated for row in renderer._pipeline.played.solutions.rows))
        assert not renderer.report.faults
    assert (len(renderer._pipeline.played.solutions.rows) > 1) is (cycle > 1)
    assert not all(evaluated[:8])  # while it moves, most are like the last
    assert all(evaluated[-10:])
    assert 2 <= len(looks) < 20
    skipped = renderer.report.skipped
    assert skipped["solve, nothing moved"] + skipped["solve, not due"] > 10


def test_a_hand_that_comes_back_or_moves_is_evaluated_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looks: list[int] = []
    hand = HAND.transform(HIGH)
    ball = pc.Volume(
        shape=pc.Sphere(0.02), pose=pc.Pose((*CENTRE[:2], 0.19)), radiation_pressure=3.0
    )
    made = render(pc.Scene((ball,), hands=(hand,)))._pipeline.played.solutions.rows[0]
    limit = SkinLimit(pc.Session(ONE, AIR))
    monkeypatch.setattr(limit, "_evaluate_skins", lambda *given: float(looks.append(1) or 1.0))
    skin, near, far, other = (
        (PosedSkin(one),)
        for one in (
            hand,
            hand.transform(pc.Pose((0.004, 0.0, 0.0))),
            hand.transform(pc.Pose((0.014, 0.0, 0.0))),
            pc.Hand(hand.joints, name="other"),
        )
    )
    steps = (skin, 1), (skin, 0), ((), 0), (skin, 1), (near, 0), (far, 1), (far, 0), (other, 1)
    for skins, evaluated in steps:
        before = len(looks)
        limit.enforce(made, skins, 100.0)
        assert len(looks) - before == evaluated


def test_far_below_the_limit_only_every_eighth_solution_is_evaluated_and_each_that_may_press_more(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looks = [0]
    found = [50.0]

    def evaluate(*arguments: Any) -> float:
        looks[0] += 1
        return found[0]

    limit = SkinLimit(pc.Session(ONE, AIR))
    monkeypatch.setattr(limit, "_evaluate_skins", evaluate)
    gains, samples = (
        np.full((1, len(ONE)), 0.5, np.complex64),
        no_samples().changed(
            positions=np.array([[0.0, 0.0, 0.2]]), radiation_pressure=np.array([5.0])
        ),
    )

    def count(
        solutions: int,
        drive: float = 1.0,
        pressure: float = 5.0,
        x: float = 0.0,
        most: float = 200.0,
    ) -> int:
        before = looks[0]
        changed = samples.changed(
            positions=samples.positions + np.array([x, 0.0, 0.0]),
            radiation_pressure=np.array([pressure]),
        )
        for _ in range(solutions):
            P = limit.find_highest_pressure(np.complex64(drive) * gains, (), changed, most)
            assert solutions > 1 or (found[0] if looks[0] > before else None) == P
        return looks[0] - before

    assert count(80) == 10
    assert count(1) == 1
    assert count(7, drive=1.1, pressure=5.5, x=0.005) == 0
    assert count(1) == 1
    changes: list[dict[str, float]] = [
        {"drive": 1.3},
        {"pressure": 6.5},
        {"x": 0.01},
        {"most": 190.0},
    ]
    for changed in changes:
        limit.reset()
        assert (count(2), count(1, **changed)) == (1, 1)
    limit.reset()
    assert count(2) == 1
    found[0] = 51.0  # not far below
    limit.reset()
    assert count(20) == 20
