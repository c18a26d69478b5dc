"""The convex heart of `lagrange` against CVXPY with Clarabel, and what it promises."""

import itertools
import math
from dataclasses import replace
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian_plugins.solvers.lagrange.convex import least_squares, maximise_scale
from pacinian_plugins.solvers.lagrange.convex.constraints import Constraints
from pacinian_plugins.solvers.lagrange.convex.dual import Dual

from ..problems import optimum

ARRAY = pc.lattice(0.06, 0.06)  # 49 ideal transducers
N = len(ARRAY)
LIMITS = ("exact", "quiet", "power")
SETS = [set(some) for k in range(4) for some in itertools.combinations(LIMITS, k)]
SETS += [one | {"no gain"} for one in SETS]


def named(limits: set[str]) -> str:
    """By a name that is always the same."""
    return "+".join(sorted(limits)) or "gain"


limits = pytest.mark.parametrize("limits", SETS, ids=named)
LIMITED = [
    some for some in SETS if "exact" not in some and some not in ({"no gain"}, {"no gain", "quiet"})
]
"""Those of `strongest`: all proportions are exact, and something must limit the gains."""


def matrix(count: int, seed: int, single: bool = True) -> Any:
    rng = np.random.default_rng(seed)
    q = np.c_[rng.uniform(-0.06, 0.06, (count, 2)), np.full(count, 0.1)]
    A = pc.matrix(ARRAY, q, pc.Air())
    return np.ascontiguousarray(A, np.complex64 if single else np.complex128)


def asked(B: Any, level: float, seed: int) -> Any:
    """Targets whose 2-norm is `level` times what one focus could reach."""
    rng = np.random.default_rng(seed)
    p = rng.uniform(0.3, 1.0, len(B)) * np.exp(2j * math.pi * rng.uniform(size=len(B)))
    return p / np.linalg.norm(p) * level * np.abs(B).sum(axis=1).mean()


def power_of(B: Any) -> float:
    return float((np.abs(B.astype(complex)) ** 2).sum()) / len(B)


def problem(limits: set[str], level: float, seed: int, single: bool) -> tuple[Any, Any, Any]:
    M, K = 5, 3
    A = matrix(M + K, seed, single)
    p = asked(A[:M], level, seed)
    more: dict[str, Any] = {"mu": 1e-4 * power_of(A[:M]), "gain": "no gain" not in limits}
    if "exact" in limits:
        more["exact"] = np.arange(M) < 2
    if "quiet" in limits:
        more["quiet"] = np.array([0.05, 0.1, 0.4]) * np.abs(p).mean()
    else:
        A = np.ascontiguousarray(A[:M])
    if "power" in limits:
        more["power"] = 0.3 * N * min(level, 1.0) ** 2
    return A, p, more


def reference(A: Any, p: Any, more: Any, c: Any = None) -> float:
    """The least objective, or -s; infinity where no gains keep the limits."""
    A, M = A.astype(complex), len(p)
    g, s = cp.Variable(A.shape[1], complex=True), cp.Variable()
    kept = []
    if c is None:
        exact = more.get("exact", np.zeros(M, bool))
        cost = 0.5 * cp.sum_squares(A[:M][~exact] @ g - p[~exact])
        cost += more["mu"] / 2 * cp.sum_squares(g)
        if exact.any():
            kept.append(A[:M][exact] @ g == p[exact])
    else:
        cost = -s
        kept.append(A[:M] @ g == c * s)
    if more.get("gain", True):
        kept.append(cp.abs(g) <= 1.0)
    if more.get("power") is not None:
        kept.append(cp.norm(g) <= math.sqrt(more["power"]))
    if more.get("quiet") is not None:
        kept.append(cp.abs(A[M:] @ g) <= more["quiet"])
    return optimum(cost, kept)


def check_limits(answer: Any, A: Any, p: Any, more: Any) -> None:
    h = answer.h
    large = np.abs(A).sum() * max(1.0, np.abs(h).max())
    np.testing.assert_allclose(answer.made, A.astype(complex) @ h, atol=1e-12 * large)
    if more.get("gain", True):
        assert np.abs(h).max() <= 1.0 + 1e-12
    if more.get("power") is not None:
        assert np.vdot(h, h).real <= more["power"] * (1 + 1e-12)
    if more.get("quiet") is not None:
        assert (np.abs(answer.made[len(p) :]) <= more["quiet"] * (1 + 1e-12)).all()
    if more.get("exact") is not None:
        hard = more["exact"]
        rest = np.linalg.norm(p[hard] - answer.made[: len(p)][hard])
        assert rest <= 1e-5 * np.linalg.norm(p[hard])


@limits
@pytest.mark.parametrize("level", [0.2, 0.7, 1.2])
@pytest.mark.parametrize("single", [True, False])
def test_it_is_the_optimum(limits: set[str], level: float, single: bool) -> None:
    A, p, more = problem(limits, level, 7, single)
    answer = least_squares(A, p, **more)
    best = reference(A, p, more)
    if math.isinf(best):
        assert answer.impossible
        assert not answer.kept
        return
    assert answer.kept
    assert not answer.late
    check_limits(answer, A, p, more)
    assert answer.objective == pytest.approx(best, rel=3e-5)
    assert answer.bound <= answer.objective
    assert answer.bound == pytest.approx(best, rel=3e-5)
    assert answer.gap <= 1e-5
    assert answer.steps <= 30


@pytest.mark.parametrize("limits", LIMITED, ids=named)
@pytest.mark.parametrize("seed", [1, 2, 63, 82, 116])
def test_it_is_the_strongest(limits: set[str], seed: int) -> None:
    A, c, more = problem(limits, 1.0, seed, True)
    del more["mu"]
    answer = maximise_scale(A, c, **more)
    best = reference(A, c, more, c)
    assert answer.kept
    check_limits(answer, A, answer.strength * c, {**more, "exact": np.ones(len(c), bool)})
    assert answer.strength == pytest.approx(-best, rel=2e-4)
    assert answer.strength <= -answer.bound
    assert answer.bound <= best * (1 - 1e-7) + 1e-12 or answer.bound == pytest.approx(
        best, rel=1e-6
    )
    assert answer.gap <= 1e-4


@given(
    seed=st.integers(0, 10_000),
    M=st.integers(1, 12),
    K=st.integers(0, 4),
    columns=st.integers(1, 30),
    rank=st.integers(1, 12),
    level=st.sampled_from([1e-20, 1e-3, 0.1, 0.5, 1.0, 2.0, 1e4, 1e20]),
    power=st.sampled_from([None, 0.5, 5.0]),
    exact=st.floats(0.0, 1.0),
    gain=st.booleans(),
    single=st.booleans(),
)
@settings(max_examples=80)
def test_promises_are_kept_whatever_is_asked(
    seed: int, M: int, K: int, columns: int, rank: int, level: float, power: float | None,
    exact: float, gain: bool, single: bool,
) -> None:  # fmt: skip
    rng = np.random.default_rng(seed)

    def normal(*shape: int) -> Any:
        return rng.normal(size=shape) + 1j * rng.normal(size=shape)

    A = normal(M + K, min(rank, M + K)) @ normal(min(rank, M + K), columns)
    A[rng.uniform(size=M + K) < 0.1] = 0.0
    A = np.ascontiguousarray(A, np.complex64 if single else np.complex128)
    p = level * normal(M) * np.abs(A).sum() / (M + K)
    hard = rng.uniform(size=M) < exact
    quiet = rng.choice([0.0, 1e-3, 0.1, 10.0], K) * np.abs(A).sum(axis=1)[M:] if K else None
    mu = 1e-4 * max(power_of(A), 1e-3)
    more = {"quiet": quiet, "gain": gain, "power": power}
    answer = least_squares(A, p, mu=mu, exact=hard, **more)
    assert np.isfinite(answer.h).all()
    assert np.isfinite(answer.y).all()
    assert np.isfinite(answer.objective)
    assert not answer.late
    assert answer.kept or hard.any()
    if level < 1e10 and answer.kept:
        assert answer.gap <= 1e-3
    assert not gain or np.abs(answer.h).max() <= 1 + 1e-12
    assert power is None or np.vdot(answer.h, answer.h).real <= power * (1 + 1e-12)
    if answer.kept:
        assert answer.bound <= answer.objective
        check_limits(answer, A, p, {**more, "quiet": None, "exact": hard if hard.any() else None})
        for _ in range(20):  # nothing else that keeps the limits is below the bound
            if hard.any() or K:
                break
            h = normal(columns) * rng.choice([1e-3, 0.1, 1.0])
            h /= max(1.0, np.abs(h).max()) if gain else 1.0
            h *= min(1.0, math.sqrt(power / np.vdot(h, h).real)) if power else 1.0
            cost = 0.5 * np.linalg.norm(p - A.astype(complex) @ h) ** 2
            cost += mu / 2 * np.linalg.norm(h) ** 2
            assert cost >= answer.bound * (1 - 1e-9)


@pytest.mark.parametrize("power", [None, 3.0])
@pytest.mark.parametrize("along", [False, True])
def test_the_slope_is_that_of_the_dual(power: float | None, along: bool) -> None:
    A, p, more = problem({"exact", "quiet"}, 0.7, 3, False)
    rows = Constraints.of(p, more["exact"], more["quiet"]).smooth(1.0)
    dual = Dual.of(A, rows, more["mu"], True, power)
    rng = np.random.default_rng(0)
    y, d = rng.normal(size=(2, len(A), 2)) @ [1, 1j]
    for size in (1e-3, 1.0, 1e3):  # none, some, all at their limit
        point = dual.at(size * y * np.abs(p).mean())
        if along:
            dual = replace(dual, along=np.ones(len(A), complex))
        F = dual.slope(point, dual.make(point.h), 0.0)
        step = 1e-5 * np.linalg.norm(point.y) * d / np.linalg.norm(d)
        rise = dual.at(point.y + step).value - dual.at(point.y - step).value
        assert rise == pytest.approx(2 * np.vdot(step, F).real, rel=1e-4)
        assert power is None or np.vdot(point.h, point.h).real <= power * (1 + 1e-12)


@given(
    seed=st.integers(0, 999),
    size=st.floats(-3.0, 3.0),
    smooth=st.floats(-3.0, 1.0),
    power=st.sampled_from([None, 3.0]),
)
def test_what_smoothing_adds_to_the_dual_is_spared_and_no_more(
    seed: int, size: float, smooth: float, power: float | None
) -> None:
    """Against the dual of the strongest without smoothing: -P^(1/2) ||x||, or -sum |x_n|, less q |y|."""
    A, c, more = problem({"quiet"}, 1.0, seed, False)
    rows = replace(
        Constraints.of(c, np.ones(len(c), bool), more["quiet"]), p=np.zeros(len(A), complex)
    )
    dual = Dual.of(A, rows, 1e-15, True, power)
    along = np.concatenate([c, np.zeros(len(A) - len(c))])
    rng = np.random.default_rng(seed)
    y = rng.normal(size=(len(A), 2)) @ [1, 1j]
    y *= 10.0**size / np.linalg.norm(A.conj().T @ y)
    x = np.abs(A.conj().T @ y)
    if power is None:
        gains = float(x.sum())
    else:  # the strongest within both limits: those held at theirs, the others by what power is left
        scale = np.sort(x)[::-1]
        gains = max(
            float(x[x > s].sum() + math.sqrt(power - held) * np.linalg.norm(x[x <= s]))
            for s in [math.inf, *scale]
            if (held := int((x > s).sum())) < power
            and (x[x <= s] * math.sqrt(power - held) <= np.linalg.norm(x[x <= s]) + 1e-12).all()
        )
    quiet = np.abs(y[len(c) :])
    limit, slack = rows.limit[len(c) :], rows.slack[len(c) :]
    plain = -gains - float((limit + slack) @ quiet)
    dual = replace(dual, along=along).smooth(10.0**smooth, 10.0**smooth)
    point = dual.at(y)
    bound = point.value - dual.spare(y)
    near = 1e-9 * abs(plain)
    assert bound <= plain + near
    far = (np.abs(point.h) >= 1.0 - 1e-12).all() or (power is not None and point.nu > 0.0)
    # then the smoothing costs it all
    if far and (quiet >= dual.rows.weight[len(c) :] * limit).all():
        assert bound >= plain - near


@pytest.mark.parametrize("limits", [set(), {"exact"}, {"quiet", "power"}], ids=named)
def test_more_samples_than_transducers(limits: set[str]) -> None:
    rng = np.random.default_rng(1)
    M, K, columns = 30, 2, 12
    A = np.ascontiguousarray(rng.normal(size=(M + K, columns, 2)) @ [1, 1j])
    p = 4.0 * rng.normal(size=(M, 2)) @ [1, 1j]
    more: dict[str, Any] = {"mu": 1e-2}
    if "quiet" in limits:
        more["quiet"] = np.full(K, 0.5)
    else:
        A = A[:M].copy()
    if "exact" in limits:
        more["exact"] = np.arange(M) == 7
        p[7] = 1.0 + 1.0j
    if "power" in limits:
        more["power"] = 0.2
    answer = least_squares(A, p, **more)
    best = reference(A, p, more)
    check_limits(answer, A, p, more)
    assert answer.objective == pytest.approx(best, rel=2e-5)
    assert answer.bound <= answer.objective
    again = least_squares(A, p, **more, start=answer.y)
    assert again.steps <= 2
    assert again.objective == pytest.approx(best, rel=2e-5)


def test_what_cannot_be_exact_is_said_to_be_impossible() -> None:
    A, p, more = problem({"exact", "quiet"}, 4.0, 1, True)
    answer = least_squares(A, p, **more)
    assert answer.impossible
    assert not answer.kept
    assert answer.violation[:2].max() > 0.1 * np.abs(p).max()
    del more["exact"]
    near = least_squares(A, p, **more)
    np.testing.assert_allclose(answer.h, near.h, atol=1e-3)
    check_limits(answer, A, p, more)


@pytest.mark.parametrize("same", [True, False])
@pytest.mark.parametrize("gain", [True, False])
def test_one_place_twice(same: bool, gain: bool) -> None:
    """Exact samples at one place: as one if they ask for the same, else impossible."""
    A = matrix(3, 0)[[0, 1, 1]]
    p = asked(A, 0.3, 0)
    p[2] = p[1] if same else -p[1]
    exact = np.array([False, True, True])
    answer = least_squares(A, p, mu=1e-4 * power_of(A), exact=exact, gain=gain)
    assert answer.kept is same
    assert answer.impossible is not same
    most = maximise_scale(A, p)
    assert (most.strength > 0.5) if same else (most.strength < 1e-6)


def test_rows_of_zeros() -> None:
    A = np.zeros((2, 5), np.complex64)
    p = np.array([1.0, 0.0j])
    silent = least_squares(A, p, mu=1.0)
    assert not silent.h.any()
    assert silent.objective == pytest.approx(0.5)
    assert silent.kept
    assert least_squares(A, p, mu=1.0, exact=np.array([True, False])).impossible
    assert least_squares(A, p, mu=1.0, exact=np.array([False, True])).kept
    assert maximise_scale(A, p).strength == 0.0
    with pytest.raises(pc.ArgumentError):
        maximise_scale(A, p, gain=False)


@pytest.mark.parametrize("ticks", [0, 1, 3])
def test_an_expired_budget_gives_the_best_so_far(ticks: int) -> None:
    A, p, more = problem({"quiet"}, 1.2, 5, True)
    times = iter(range(1000))
    answer = least_squares(A, p, **more, budget=pc.Budget(float(ticks), lambda: float(next(times))))
    assert answer.late
    assert answer.steps == ticks
    assert answer.kept
    assert answer.bound <= least_squares(A, p, **more).objective <= answer.objective * (1 + 1e-5)
    check_limits(answer, A, p, more)


@pytest.mark.parametrize("limits", [set(), {"exact", "quiet", "power"}], ids=named)
def test_a_warm_start_saves_steps(limits: set[str]) -> None:
    A, p, more = problem(limits, 0.6, 9, True)
    cold = least_squares(A, p, **more)
    warm = least_squares(A, 1.001 * p, **more, start=cold.y)
    assert least_squares(A, p, **more, start=cold.y).steps <= 1
    assert warm.steps <= max(2, cold.steps)
    assert warm.gap <= 1e-5


@limits
@given(seed=st.integers(0, 99), unit=st.sampled_from([2.0**-40, 2.0**-20, 2.0**20, 2.0**40]))
@settings(max_examples=4)
def test_the_unit_of_sound_pressure_does_not_matter(
    limits: set[str], seed: int, unit: float
) -> None:
    """By powers of two, in which nothing is rounded differently: the same in as many steps."""
    A, p, more = problem(limits, 0.7, seed, False)
    one = least_squares(A, p, **more)
    more["mu"] *= unit * unit
    if "quiet" in more:
        more["quiet"] = unit * more["quiet"]
    other = least_squares(unit * A, unit * p, **more)
    np.testing.assert_allclose(other.h, one.h, atol=1e-9 * np.abs(one.h).max())
    assert (other.kept, other.impossible) == (one.kept, one.impossible)
    assert other.steps == one.steps


def test_hard_cases_take_few_steps() -> None:
    """Targets at and beyond what can be reached, where steps on the plain dual overshoot."""
    A = matrix(24, 4)
    mu = 1e-5 * power_of(A)
    for level in (0.9, 1.0, 1.1, 1.5, 3.0):
        answer = least_squares(A, asked(A, level, 4), mu=mu)
        assert answer.gap <= 1e-5
        assert answer.steps <= 20
