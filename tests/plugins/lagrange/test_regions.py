"""`lagrange` at regions: optimal by CVXPY, even between the samples, warm as cold."""

import dataclasses
import itertools
import math

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.solving.solution_status import REGION_TOLERANCE
from pacinian_plugins.native.lagrange import RegionWorkspace
from pacinian_plugins.solvers.lagrange import regions

from ..problems import ARRAY, optimum

AIR = pc.Air(speed_of_sound=340.0, density=1.2)
ONE, NINE = pc.autd(), pc.autd(3, 3)
MU = 5e-3
SPACING = 0.0034  # [m], 0.4 wavelengths


def edged(extent, spacing=SPACING):
    """Points along an edge, both ends among them."""
    return np.linspace(-extent / 2, extent / 2, math.ceil(extent / spacing - 1e-9) + 1)


def rectangle(width, height, spacing=SPACING):
    X, Y = np.meshgrid(edged(width, spacing), edged(height, spacing))
    return np.c_[X.ravel(), Y.ravel()]


def ringed(outer, inner=0.0, spacing=SPACING):
    """Rings of points, the outline among them."""
    count = max(1, math.ceil((outer - inner) / spacing - 1e-9))
    made = []
    for r in np.linspace(inner, outer, count + 1):
        around = max(1, math.ceil(2 * math.pi * r / spacing))
        turn = 2 * math.pi * (np.arange(around) + 0.5 * (len(made) % 2)) / around
        made.append(np.c_[r * np.cos(turn), r * np.sin(turn)])
    return np.concatenate(made)


SHAPES = {
    "disc": (ringed(0.015), lambda x, y: np.hypot(x, y) <= 0.015),
    "small disc": (ringed(0.005), lambda x, y: np.hypot(x, y) <= 0.005),
    "ring": (
        ringed(0.02, 0.012),
        lambda x, y: (np.hypot(x, y) <= 0.02) & (np.hypot(x, y) >= 0.012),
    ),
    "strip": (rectangle(0.008, 0.03), lambda x, y: (abs(x) <= 0.004) & (abs(y) <= 0.015)),
    "square": (rectangle(0.04, 0.04), lambda x, y: (abs(x) <= 0.02) & (abs(y) <= 0.02)),
}


def at(points, height=0.2):
    return np.c_[points, np.full(len(points), height)]


def grid(inside, height=0.2):
    """A grid of 1 mm over a shape, and of what lies 3 to 10 mm beside it."""
    side = np.arange(-0.035, 0.035, 0.001) + 0.00037
    X, Y = (a.ravel() for a in np.meshgrid(side, side))
    own = inside(X, Y)
    away = np.sqrt((X[:, None] - X[own]) ** 2 + (Y[:, None] - Y[own]) ** 2).min(axis=1)
    every = at(np.c_[X, Y], height)
    return every[own], every[(away > 0.003) & (away < 0.01)]


def pressure(array, gains, points):
    """Radiation pressure, by B in double precision."""
    p = pc.matrix(array, points, AIR) @ gains.astype(complex)
    return pc.radiation_pressure(p, AIR)


def whole(points):
    return np.zeros(len(points), int)


def solve(array, points, P, **options):
    t = pc.sound_pressure(np.full(len(points), P), AIR)
    return pc.solve(
        array, points, t, regions=whole(points), solver="lagrange", medium=AIR, **options
    )


@pytest.mark.parametrize(
    ("array", "P", "most"), [(ONE, 0.5, 1.45), (NINE, 1.5, 1.15)], ids=["one unit", "nine"]
)
@pytest.mark.parametrize("shape", SHAPES)
def test_pressure_is_even_between_the_samples_and_little_beside(shape, array, P, most):
    points, inside = SHAPES[shape]
    solution = solve(array, at(points), P)
    within, beside = grid(inside)
    made = pressure(array, solution.gains, within)
    assert solution.status is pc.Status.ok
    assert made.sum() / (P * len(made)) == pytest.approx(1.0, abs=0.025)
    assert np.sqrt(((made - P) ** 2).mean()) / P < 0.04
    assert made.min() > 0.8 * P
    assert pressure(array, solution.gains, beside).max() < most * P  # one unit resolves 10 mm
    # and what a solution tells of itself is that
    assert solution.felt[0].rms == pytest.approx(np.sqrt(((made - P) ** 2).mean()) / P, abs=0.012)
    assert solution.felt[0].force == pytest.approx(made.sum() / (P * len(made)), abs=0.012)


@given(st.integers(0, 10**6), st.floats(0.05, 3.0), st.sampled_from([1.0, None, 0.3]))
def test_the_answer_is_the_optimum_under_the_gain_limit(seed, level, gain):
    rng = np.random.default_rng(seed)
    q = at(rng.uniform(-0.015, 0.015, (12, 2)), 0.15)
    t = (
        rng.uniform(0.3, 1.0, 12)
        * level
        * np.abs(pc.matrix(ARRAY, q, medium=AIR)).sum(axis=1).mean()
        / 4.0
    )
    phases = pc.joint_phases(ARRAY, q, medium=AIR)
    session = pc.Session(ARRAY, solver="lagrange", medium=AIR)
    session.corrections = 0
    session.solve(q, t, phases, regions=whole(q), limits=pc.Limits(gain=gain))
    assert session.last is not None
    solution = session.certify(session.last.gains)
    B, p = pc.matrix(ARRAY, q, medium=AIR), t * np.exp(1j * phases)
    assert solution.mu == pytest.approx(MU * (np.abs(B) ** 2).sum() / 12, rel=1e-4)
    g = cp.Variable(len(ARRAY), complex=True)
    unit = np.linalg.norm(p)
    cost = cp.sum_squares((p - B @ g) / unit) / 2 + solution.mu / unit**2 / 2 * cp.sum_squares(g)
    best = optimum(cost, [] if gain is None else [cp.abs(g) <= gain]) * unit**2
    size = unit**2 / 2
    assert solution.bound <= best + 1e-5 * size
    assert solution.objective >= best - 1e-5 * size
    assert solution.objective - best < 1e-3 * size
    assert best - solution.bound < 1e-3 * size
    if gain is not None:
        assert np.abs(solution.gains).max() <= gain


@pytest.mark.parametrize("precision", ["single", "double"])
def test_a_warm_solve_ends_where_a_cold_one_does_in_fewer_steps(precision):
    q, P = at(SHAPES["square"][0]), 2.5  # a part is at its limit
    t = pc.sound_pressure(np.full(len(q), P), AIR)
    session = pc.Session(NINE, solver="lagrange", precision=precision, medium=AIR)
    cold = session.solve(q, t, regions=whole(q))
    steps = []
    for step in range(1, 4):
        moved = q + 0.0004 * step * np.array([1.0, 0.5, 0.0])
        warm = session.solve(moved, t, regions=whole(q))
        again = pc.solve(
            NINE, moved, t, regions=whole(q), solver="lagrange", precision=precision, medium=AIR
        )
        a, b = (pressure(NINE, s.gains, moved) for s in (warm, again))
        assert np.abs(a - b).max() < 0.03 * P
        steps.append(warm.iterations)
    assert max(steps) < cold.iterations


def test_the_strongest_region_is_even_and_no_stronger_one_is():
    q = at(SHAPES["disc"][0])
    solution = pc.solve(ONE, q, np.ones(len(q)), regions=whole(q), scale="max", medium=AIR)
    assert solution.felt[0].even
    assert np.abs(solution.gains).max() == pytest.approx(1.0, abs=1e-3)
    P = pressure(ONE, solution.gains, q).mean()
    assert solve(ONE, q, P).error < 1.2 * REGION_TOLERANCE
    assert solve(ONE, q, 1.5 * P).error > 1.2 * REGION_TOLERANCE
    assert solve(ONE, q, 1.5 * P).status is pc.Status.limited


def test_without_a_limit_none_is_felt():
    q = at(SHAPES["disc"][0])
    t = pc.sound_pressure(np.full(len(q), 100.0), AIR)
    free = pc.solve(
        ONE, q, t, regions=whole(q), limits=pc.Limits(gain=None), solver="lagrange", medium=AIR
    )
    weak = pc.solve(ONE, q, 1e-3 * t, regions=whole(q), solver="lagrange", medium=AIR)
    assert free.felt[0].even
    assert np.abs(free.gains).max() > 1.0
    assert np.abs(free.gains - 1e3 * weak.gains).max() < 0.02 * np.abs(free.gains).max()


@pytest.mark.parametrize("size", [1e-30, 1e-12, 1e-3, 1e12, 1e30])
@pytest.mark.parametrize("precision", ["single", "double"])
def test_targets_of_any_size(size, precision):
    q = at(ringed(0.006))
    t = np.full(len(q), size)
    solution = pc.solve(
        ONE, q, t, regions=whole(q), solver="lagrange", precision=precision, medium=AIR
    )
    assert np.isfinite(solution.gains).all()
    assert np.abs(solution.gains).max() <= 1.0
    if size < 1.0:
        assert solution.felt[0].even


ONE_DISC = at(ringed(0.006))
AWKWARD = {
    "in one place": np.repeat(ONE_DISC[:1], 20, axis=0),
    "in pairs": np.repeat(ONE_DISC, 2, axis=0),
    "on a line": at(np.c_[edged(0.03), np.zeros(len(edged(0.03)))]),
    "behind": ONE_DISC * [1, 1, -1],
    "10 m wide": at(rectangle(10.0, 10.0, 1.0)),
    "upright": ONE_DISC[:, [0, 2, 1]] - np.array([0, 0.2, -0.2]),
    "as many as transducers": at(rectangle(0.05, 0.05, 0.0032)),
    "of 1000": at(rectangle(0.04, 0.04, 0.00128)),
}


@pytest.mark.parametrize("what", AWKWARD)
def test_awkward_regions_have_an_answer(what):
    q = AWKWARD[what]
    t = pc.sound_pressure(np.full(len(q), 0.3), AIR)
    solution = pc.solve(ONE, q, t, regions=whole(q), medium=AIR)
    assert np.isfinite(solution.gains).all()
    assert np.abs(solution.gains).max() <= 1.0
    if what not in ("10 m wide", "behind"):
        assert solution.felt[0].force == pytest.approx(1.0, abs=0.05)
    if what == "10 m wide":
        assert solution.status is not pc.Status.ok


def test_two_regions_and_a_point_each_get_their_own():
    disc = ringed(0.008)
    q = np.concatenate(
        [at(disc - np.array([0.03, 0])), at(disc + np.array([0.03, 0]), 0.22), [[0.0, 0.04, 0.2]]]
    )
    regions = np.append(np.repeat([0, 1], len(disc)), -1)
    asked = np.append(np.repeat([1.0, 3.0], len(disc)), 2.0)
    solution = pc.solve(NINE, q, pc.sound_pressure(asked, AIR), regions=regions, medium=AIR)
    assert solution.status is pc.Status.ok
    assert all(felt.even for felt in solution.felt)
    assert pressure(NINE, solution.gains, q[-1:]) == pytest.approx(2.0, rel=0.03)


@pytest.mark.parametrize("gap", [0.0, 0.0017, 0.0034])
def test_regions_that_touch_or_overlap_have_no_dark_line_between(gap):
    half = np.array([0.006 + gap / 2, 0.0])
    left, right = rectangle(0.012, 0.02) - half, rectangle(0.012, 0.02) + half
    q = at(np.concatenate([left, right]))
    t = pc.sound_pressure(np.full(len(q), 1.5), AIR)
    solution = pc.solve(NINE, q, t, regions=np.repeat([0, 1], len(left)), medium=AIR)
    line = at(np.c_[np.zeros(19), np.linspace(-0.009, 0.009, 19)])
    assert pressure(NINE, solution.gains, line).min() > 0.8 * 1.5


def test_phases_that_are_given_win():
    q = at(ringed(0.01))
    tilt = 150.0 * q[:, 0]
    t = pc.sound_pressure(np.full(len(q), 0.5), AIR)
    solution = pc.solve(ONE, q, t, tilt, regions=whole(q), medium=AIR)
    turned = np.exp(1j * (solution.phases - tilt))
    assert abs(turned.mean()) > 0.98
    assert solution.felt[0].even


def test_a_quiet_point_beside_a_region_is_kept():
    q = at(ringed(0.01))
    ear = np.array([[0.05, 0.0, 0.2]])
    t = pc.sound_pressure(np.full(len(q), 0.5), AIR)
    loud = np.abs(pc.matrix(ONE, ear, medium=AIR) @ solve(ONE, q, 0.5).gains)[0]
    limits = pc.Limits(quiet=(ear, loud / 10.0))
    solution = pc.solve(ONE, q, t, regions=whole(q), limits=limits, medium=AIR)
    assert np.abs(pc.matrix(ONE, ear, medium=AIR) @ solution.gains)[0] < 1.01 * loud / 10.0
    assert solution.felt[0].force == pytest.approx(1.0, abs=0.05)


def test_no_time_is_a_finite_answer_in_time():
    q = at(SHAPES["square"][0])
    solution = solve(NINE, q, 40.0, deadline=0.0)
    assert solution.status is pc.Status.deadline
    assert np.isfinite(solution.gains).all()


def sliding(i, spacing):
    """What a disc of 12 mm radius covers of a grid that moves under it: samples come and go at its rim."""
    x, y = (a.ravel() for a in np.meshgrid(*[np.arange(-0.03, 0.03, spacing)] * 2))
    x = x + 4e-4 * i
    inside = np.hypot(x, y) < 0.012
    return at(np.c_[x, y][inside]), np.flatnonzero(inside)


@pytest.mark.parametrize("deadline", [None, 0.0])
@pytest.mark.parametrize("array", [ONE, NINE], ids=["one", "nine"])
def test_where_samples_come_and_go_a_region_is_as_asked_from_step_to_step(array, deadline):
    session, before = pc.Session(array, medium=AIR), None
    for i in range(40):
        q, names = sliding(i, 0.0021)
        amplitudes = np.full(len(q), pc.sound_pressure(1.0, AIR))
        solution = session.solve(q, amplitudes, regions=whole(q), deadline=deadline)
        felt = session.measure_felt(solution).felt[0]
        assert felt.force == pytest.approx(1.0, abs=0.06)
        assert felt.rms < (0.15 if deadline is None else 0.2)
        assert solution.iterations <= 3
        phases = dict(zip(names.tolist(), solution.asked_phases, strict=True))
        if before:  # nothing jumps: by a tenth of a turn at most
            change = [phases[k] - before[k] for k in phases.keys() & before.keys()]
            assert np.abs(np.angle(np.exp(1j * np.array(change)))).max() < 0.6
        before = phases


@pytest.mark.parametrize("strength", [60.0, 240.0])
def test_at_the_limit_a_moved_region_starts_from_its_multipliers(strength):
    """It needs few steps for the optimum, and is near it without time for any more."""
    disc, t = ringed(0.018), pc.sound_pressure(strength, AIR)
    at_limit, hurried = pc.Session(NINE, AIR), pc.Session(NINE, AIR)
    at_limit.corrections = 0
    for k in range(4):
        q = at(disc + np.array([1e-3 * k, 5e-4 * k]))
        amplitudes = np.full(len(q), t)
        moved = at_limit.solve(q, amplitudes, regions=whole(q), deadline=1e9)
        late = hurried.solve(q, amplitudes, regions=whole(q), deadline=0.0 if k else 1e9)
        cold = pc.Session(NINE, AIR).solve(q, amplitudes, regions=whole(q), deadline=1e9)
        assert moved.saturation > 0.1
        assert moved.objective == pytest.approx(cold.objective, rel=0.01)
        assert late.objective < 1.1 * cold.objective
        if k:
            assert moved.iterations <= cold.iterations / 2


@pytest.mark.parametrize("strength", [16.0, 240.0])
def test_multipliers_that_mislead_are_not_used(strength):
    """Samples that only look as if they had moved, with other multipliers: no more pressure than from nothing."""
    q = at(ringed(0.018))
    amplitudes = pc.sound_pressure(np.full(len(q), strength), AIR)
    session = pc.Session(NINE, AIR)
    session.corrections = 0
    cold = session.solve(q, amplitudes, regions=whole(q), deadline=0.0)
    session.forget()
    good = session.solve(q, amplitudes, regions=whole(q), deadline=1e9)
    rng = np.random.default_rng(3)
    wrong = rng.permutation(good.multipliers) * np.exp(1j * rng.uniform(-3.0, 3.0, len(q)))
    session.last = dataclasses.replace(good, multipliers=wrong)
    session._base = None
    misled = session.solve(q + 1e-3, amplitudes, regions=whole(q), deadline=0.0)
    P = [pc.radiation_pressure(s.field(s.points), AIR) for s in (cold, misled)]
    assert misled.error < 1.05 * cold.error
    assert P[1].max() < 1.1 * P[0].max()


@pytest.mark.parametrize("M", [3, 60, 399, 513])
def test_conjugate_gradients_with_and_without_a_preconditioner_agree(M, monkeypatch):
    side = int(np.ceil(np.sqrt(M)))
    q = at(np.stack(np.meshgrid(*[0.002 * np.arange(side)] * 2), axis=-1).reshape(-1, 2)[:M])
    amplitudes = np.full(M, 20.0)

    def solve() -> pc.Solution:
        session = pc.Session(ONE, AIR)
        session.corrections = 0
        return session.solve(q, amplitudes, regions=whole(q))

    helped = solve()
    without = np.empty(0, np.intp)  # blocks
    monkeypatch.setattr(
        regions,
        "find_workspace",
        lambda propagator, same: RegionWorkspace(*propagator.B.shape, without, 1),
    )
    plain = solve()
    difference = np.abs(helped.sound_pressure - plain.sound_pressure).max()
    assert difference < 0.03 * 20.0
    rounding = 1.0 + 1e-6  # of single precision
    assert max(helped.bound, plain.bound) <= rounding * helped.objective
    assert helped.objective <= 1.03 * plain.objective


# ---------------------------------------------------------------------- without time


@pytest.mark.parametrize("deadline", [0.0, 1.0, 2.0])
@pytest.mark.parametrize("strength", [4.0, 16.0, 60.0])
@pytest.mark.parametrize("seed", range(3))
def test_without_time_it_is_never_worse_than_silence_nor_louder_than_asked(
    deadline: float, strength: float, seed: int
) -> None:
    """Targets change at every sample from solve to solve, as those of frames do that make what others lack."""
    readings = iter(range(1_000_000))
    session, rng = (
        pc.Session(NINE, AIR, clock=lambda: float(next(readings))),
        np.random.default_rng(seed),
    )
    session.tilt = 0.15
    disc = ringed(0.012)
    q = np.concatenate([at(disc - np.array([0.03, 0])), at(disc + np.array([0.03, 0]), 0.22)])
    regions, B = np.repeat([0, 1], len(disc)), pc.matrix(NINE, q, AIR)
    ended = 0
    for _ in range(12):
        t = pc.sound_pressure(strength * rng.uniform(0.15, 2.5, len(q)), AIR)
        solution = session.solve(q, t, regions=regions, deadline=deadline)
        g = solution.gains.astype(complex)
        p, silence = B @ g, float(t @ t) / 2.0
        rest = t * np.exp(1j * solution.asked_phases) - p
        objective = (np.vdot(rest, rest).real + solution.mu * np.vdot(g, g).real) / 2.0
        assert objective <= 1.001 * silence
        assert np.linalg.norm(p) <= 1.001 * np.linalg.norm(t)
        assert solution.objective == pytest.approx(objective, rel=1e-3, abs=1e-3 * silence)
        assert solution.bound <= objective * (1.0 + 1e-6)
        ended += solution.late
    assert ended


def test_solves_without_time_for_the_same_targets_come_to_an_end() -> None:
    readings = iter(range(1_000_000))
    session = pc.Session(NINE, AIR, clock=lambda: float(next(readings)))
    q = at(ringed(0.015))
    t, errors = pc.sound_pressure(np.full(len(q), 16.0), AIR), list[float]()
    for k in range(16):
        solution = session.solve(q, t * (1.0 + 1e-6 * k), regions=whole(q), deadline=0.0)
        errors.append(solution.error)
    assert errors[-1] < REGION_TOLERANCE < errors[0]
    assert all(after <= 1.02 * before for before, after in itertools.pairwise(errors))


def test_solves_without_time_converge_from_one_to_the_next_while_a_region_moves():
    """Each has time for one step. From nothing, each would end as far from the optimum as the first ones."""
    disc, t = ringed(0.018), pc.sound_pressure(40.0, AIR)
    session, whole_time = pc.Session(NINE, AIR), pc.Session(NINE, AIR)
    whole_time.corrections = 0
    objectives = []
    for k in range(30):
        q = at(disc + np.array([2e-4 * k, 0.0]))
        amplitudes = np.full(len(q), t)
        late = session.solve(q, amplitudes, regions=whole(q), deadline=0.0)
        objectives.append(late.objective)
    best = whole_time.solve(q, amplitudes, regions=whole(q), deadline=1e9)
    assert best.saturation > 0.1
    assert min(objectives[:4]) > 2.0 * best.objective
    assert max(objectives[-4:]) < 1.2 * best.objective


@pytest.mark.parametrize("turns", [False, True])
def test_the_preconditioner_of_the_last_solve_serves_samples_that_moved_as_one(turns):
    disc, t = ringed(0.018), pc.sound_pressure(20.0, AIR)
    session = pc.Session(NINE, AIR)
    session.corrections = 0
    session.solve(at(disc), np.full(len(disc), t), regions=whole(disc))
    before = session.propagator.workspace.factor.copy()
    angle = 0.3 if turns else 0.0
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    q = at(disc @ turn + np.array([1e-3, 0.0]))
    moved = session.solve(q, np.full(len(q), t), regions=whole(q))
    assert np.array_equal(session.propagator.workspace.factor, before) != turns
    cold = pc.Session(NINE, AIR)
    cold.corrections = 0
    cold = cold.solve(q, np.full(len(q), t), regions=whole(q))
    assert moved.objective == pytest.approx(cold.objective, rel=0.02)
    session.forget()
    assert session.propagator.workspace is None
