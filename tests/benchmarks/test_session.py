"""What warm starts and skips save, as ratios within one run.

`extra_info` holds, for level 0.5: `cold_over_roofline` (B, its Gram matrix, one product each way),
`warm_over_parts` (every sample moved by 1 mm, over B, the Gram matrix and two Newton steps),
`stronger_over_cold` and `same_over_cold` (only the strength of all targets changed, or nothing),
`one_moved_over_cold` (one sample of M).
"""

from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.solving.propagator import gram_matrix

from .medians import measure_medians

SOLVER = pc.solver("lagrange")


@pytest.mark.parametrize(("units", "M"), [(1, 4), (1, 16), (1, 64), (3, 16), (3, 64), (3, 256)])
def test_what_a_session_saves(benchmark: Any, units: int, M: int) -> None:
    array = pc.autd(units, units, pc.Transducer(pressure=4.386))
    rng = np.random.default_rng(1)
    q = np.c_[rng.uniform(-0.1, 0.1, (M, 2)), np.full(M, 0.2)]
    t = rng.uniform(0.3, 1.0, M)
    t *= 0.5 * np.abs(pc.matrix(array, q, pc.Air())).sum(axis=1).mean() / np.linalg.norm(t)
    out = np.empty(len(array), np.complex64)
    directions = rng.normal(size=(32, M, 3))
    moves = q + 0.5e-3 * directions / np.linalg.norm(directions, axis=2, keepdims=True)
    warm, one, same = (pc.Session(array, solver=SOLVER) for _ in range(3))
    parts = pc.Propagator(array, pc.Air())
    count, single = iter(range(10**9)), q.copy()
    factors = {False: 1.0, True: 0.99}
    weak = 0.4 * t  # nothing is at its limit

    def every_moved() -> None:
        warm.solve(moves[next(count) % 32], t, out=out)

    def one_moved() -> None:
        single[0, 0] += 1e-6
        one.solve(single, t, out=out)

    def stronger() -> None:
        factors[True], factors[False] = factors[False], factors[True]
        same.solve(q, factors[True] * weak, out=out)

    def unchanged() -> None:
        same.solve(q, factors[True] * weak, out=out)

    g, z = np.ones(len(array), np.complex64), np.ones(M, complex)

    def rows() -> None:
        parts.forget()
        parts.set_points(q)

    def products() -> None:
        gram_matrix(parts.single)

    def there_and_back() -> None:
        parts.apply(g)
        parts.adjoint(z)

    benchmark(lambda: pc.solve(array, q, t, solver=SOLVER))
    repeats = 200 if M < 256 else 20
    cold, moved, row, stronger_, same_, build, product, pair = measure_medians(
        lambda: pc.solve(array, q, t, solver=SOLVER), every_moved, one_moved, stronger, unchanged,
        rows, products, there_and_back, repeats=repeats,
    )  # fmt: skip
    room = _Steps(array, q, t)
    (step,) = measure_medians(room.two_steps, repeats=repeats)
    roofline = build + product + pair
    benchmark.extra_info["cold_over_roofline"] = round(cold / roofline, 2)
    benchmark.extra_info["warm_over_parts"] = round(moved / (build + product + step), 2)
    benchmark.extra_info["stronger_over_cold"] = round(stronger_ / cold, 3)
    benchmark.extra_info["same_over_cold"] = round(same_ / cold, 3)
    benchmark.extra_info["one_moved_over_cold"] = round(row / cold, 2)
    assert same.propagator.work.solutions_scaled > 0
    assert one.propagator.work.rows_built < M + 2 * repeats


class _Steps:
    """Two Newton steps of `lagrange` alone, with what they start from."""

    def __init__(self, array: pc.Array, q: Any, t: Any) -> None:
        from pacinian_plugins.native.lagrange import Workspace

        self.propagator = pc.Propagator(array, pc.Air())
        self.propagator.set_points(q)
        p = pc.solve(array, q, t, solver=SOLVER).asked
        self.mu = 1e-6 * self.propagator.power
        self.y = self.mu * self.propagator.factor(self.mu).solve(p)
        self.w, self.out = Workspace(len(q), len(array)), np.empty(len(array), np.complex64)
        self.w.p[:], self.w.free[:] = p, True

    def _attempt(self, steps: int) -> None:
        from pacinian_plugins.native.lagrange import solve_dual

        self.w.y[:] = self.y
        self.w.restart_dual()
        B, G = self.propagator.single, self.propagator.gram
        solve_dual(B, G, self.mu, steps, 0.0, self.w, 1.0, self.out)

    def two_steps(self) -> None:
        self._attempt(2)
