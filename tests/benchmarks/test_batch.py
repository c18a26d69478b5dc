"""What two workers save in a batch, as ratios within one run; start-up of processes included.

`extra_info` holds `one_over_two` (wall time of one worker over that of two), `loop_over_two` (a loop of `pc.solve` over
two workers) and `free_cores` (share of a core that each of two idle processes could use just before: if it is less than
0.95, other programs were running, and the ratios are too small).
"""

import time
from typing import Any

import numpy as np
import pytest
from psutil import cpu_percent

import pacinian as pc


@pytest.mark.parametrize(
    ("solver", "units", "M", "seconds"),
    [
        ("lagrange", 3, 64, 2.0),  # in threads
        ("lagrange", 3, 64, 12.0),  # in processes
        ("auto", 1, 4, 12.0),
        ("lbfgs", 1, 16, 12.0),
    ],
)
def test_two_workers(benchmark: Any, solver: str, units: int, M: int, seconds: float) -> None:
    array = pc.autd(units, units)
    rng = np.random.default_rng(1)
    most = np.abs(pc.matrix(array, [[0.0, 0.0, 0.2]], pc.Air())).sum()

    def problems(count: int) -> tuple[Any, Any]:
        q = rng.uniform((-0.08, -0.08, 0.15), (0.08, 0.08, 0.25), (count, M, 3))
        t = rng.uniform(0.3, 1.0, (count, M))
        return q, 0.7 * most * t / np.linalg.norm(t, axis=1, keepdims=True)

    q, t = problems(100)
    pc.solve_many(array, q, t, solver=solver, workers=1)
    begin = time.perf_counter()
    pc.solve_many(array, q, t, solver=solver, workers=1)
    q, t = problems(int(100 * seconds / (time.perf_counter() - begin)))
    idle = 1.0 - cpu_percent(1.0) / 100.0

    def loop() -> None:
        for points, amplitudes in zip(q, t, strict=True):
            pc.solve(array, points, amplitudes, solver=solver)

    times = []
    for run in (
        lambda: pc.solve_many(array, q, t, solver=solver, workers=1),
        lambda: pc.solve_many(array, q, t, solver=solver, workers=2),
        loop,
    ):
        begin = time.perf_counter()
        run()
        times.append(time.perf_counter() - begin)
    one, two, by_loop = times
    benchmark.extra_info |= {
        "one_over_two": round(one / two, 2), "loop_over_two": round(by_loop / two, 2), "free_cores": round(idle, 2),
    }  # fmt: skip

    benchmark.pedantic(lambda: None)
