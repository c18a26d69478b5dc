"""What two workers save in a batch, as ratios within one run, for the table of docs/solvers.md.

`extra_info` holds `seconds` (of one worker), `first` (that time over the time of two workers, of which one must start),
`next` (the same with a worker that waits), `independent` (twice that time over the time in which each of two processes,
which are independent, solves the whole batch: what the machine allows) and `free_cores` (share of a core that
each of two idle processes could use just before: if it is less than 0.95, other programs were running, and the ratios
are too small).
"""

import time
from multiprocessing import get_context
from multiprocessing.synchronize import Barrier
from typing import Any

import numpy as np
import pytest
from psutil import cpu_percent

import pacinian as pc
from pacinian.batch.processes import waiting
from pacinian_lab.solvers.batches import AIR, Batch

FIRST, NEXT = 3, 5  # numbers of measured batches


def solve(batch: Batch, solver: str, options: dict[str, Any], workers: int) -> float:
    """Return the time of a batch [s]."""
    begin = time.perf_counter()
    pc.solve_many(
        batch.array, batch.points, batch.targets,
        solver=solver, medium=AIR, workers=workers, **options,
    )  # fmt: skip
    return time.perf_counter() - begin


def solve_apart(
    barrier: Barrier, made: tuple[int, int, int], solver: str, options: dict[str, Any], to: Any
) -> None:
    """Solve the batch in a process that knows nothing of the other, at the same time as that one."""
    batch = Batch.make(*made)
    solve(batch, solver, options, 1)
    times = []
    for _ in range(NEXT):
        barrier.wait()
        times.append(solve(batch, solver, options, 1))
    to.put(float(np.median(times)))


def measure_apart(made: tuple[int, int, int], solver: str, options: dict[str, Any]) -> float:
    """Return the time of two processes that solve the whole batch each [s]."""
    context = get_context("spawn")
    barrier, told = context.Barrier(2), context.Queue()
    processes = [
        context.Process(target=solve_apart, args=(barrier, made, solver, options, told))
        for _ in range(2)
    ]
    for process in processes:
        process.start()
    found = [told.get() for _ in processes]
    for process in processes:
        process.join()
    return max(found)


@pytest.mark.parametrize(
    ("solver", "units", "M", "K", "options"),
    [
        ("auto", 1, 4, 1000, {}),
        ("auto", 1, 4, 20000, {}),
        ("auto", 1, 16, 10000, {}),
        ("auto", 4, 16, 1000, {}),
        ("auto", 4, 16, 10000, {}),
        ("auto", 9, 16, 500, {}),
        ("auto", 9, 16, 5000, {}),
        ("auto", 9, 64, 100, {}),
        ("auto", 9, 64, 2000, {}),
        ("auto", 9, 16, 200, {"scale": "max"}),
        ("lbfgs", 1, 16, 1000, {}),
        ("pseudo-inverse", 4, 16, 10000, {}),
        ("pseudo-inverse", 9, 64, 1500, {}),
    ],
)
def test_two_workers(
    benchmark: Any, solver: str, units: int, M: int, K: int, options: dict[str, Any]
) -> None:
    batch = Batch.make(units, M, K)
    idle = 1.0 - cpu_percent(1.0) / 100.0

    def begin_anew() -> float:
        waiting.close()
        return solve(batch, solver, options, 2)

    solve(batch, solver, options, 1)
    first = np.median([begin_anew() for _ in range(FIRST)])
    for _ in range(3):
        solve(batch, solver, options, 2)
    one, two = np.median(
        [[solve(batch, solver, options, workers) for workers in (1, 2)] for _ in range(NEXT)],
        axis=0,
    )
    waiting.close()
    apart = measure_apart((units, M, K), solver, options)
    benchmark.extra_info |= {
        "seconds": round(one, 3), "first": round(one / first, 2), "next": round(one / two, 2),
        "independent": round(2.0 * one / apart, 2), "free_cores": round(idle, 2),
    }  # fmt: skip
    benchmark.pedantic(lambda: None)
