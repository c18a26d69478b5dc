"""What two workers save in a batch, as ratios within one run, for the table of docs/solvers.md.

`extra_info` holds `seconds` (of one worker), `first` (that time over the time of two workers, of which one must start),
`next` (the same with a worker that waits) and `free_cores` (share of a core that each of two idle processes could use
just before: if it is less than 0.95, other programs were running, and the ratios are too small).
"""

import time
from typing import Any

import numpy as np
import pytest
from psutil import cpu_percent

import pacinian as pc
from pacinian.batch.processes import waiting
from pacinian_lab.solvers.batches import AIR, Batch

FIRST, NEXT = 3, 5  # numbers of measured batches


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

    def measure(workers: int, *, start: bool = False) -> float:
        if start:
            waiting.close()
        begin = time.perf_counter()
        pc.solve_many(
            batch.array, batch.points, batch.targets,
            solver=solver, medium=AIR, workers=workers, **options,
        )  # fmt: skip
        return time.perf_counter() - begin

    measure(1)
    first = np.median([measure(2, start=True) for _ in range(FIRST)])
    for _ in range(3):
        measure(2)
    one, two = np.median([[measure(workers) for workers in (1, 2)] for _ in range(NEXT)], axis=0)
    benchmark.extra_info |= {
        "seconds": round(one, 3), "first": round(one / first, 2), "next": round(one / two, 2),
        "free_cores": round(idle, 2),
    }  # fmt: skip
    benchmark.pedantic(lambda: None)
