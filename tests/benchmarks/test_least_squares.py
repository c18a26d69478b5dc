"""Ratios within one run: `pytest -m benchmark -n 0`.

Each result's `extra_info` holds how many times faster than NumPy's least squares, or SciPy's QR
decomposition, on the same B, and how far the answers are apart. Times are processor time, one thread.
"""

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from scipy import linalg
from threadpoolctl import threadpool_limits

import pacinian as pc
from pacinian.solving.least_squares import LeastSquares, Reduced
from pacinian_lab.paper import experiment

pytestmark = pytest.mark.benchmark(timer=time.process_time)


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    with threadpool_limits(1):
        yield


def quickest(function: Callable[[], object], repeats: int) -> float:
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        function()
        times.append(time.process_time() - begin)
    return min(times)


def propagator(case: str, precision: Any) -> pc.Propagator:
    place = experiment.case(case)
    made = pc.Propagator(place.array, experiment.MEDIUM, precision)
    made.set_points(place.points)
    return made


def compare(benchmark: Any, B: Any, p: Any) -> None:
    wide = B.astype(np.complex128)
    rcond = float(max(B.shape) * np.finfo(B.dtype).eps)
    found = []
    reference = quickest(lambda: found.append(np.linalg.lstsq(wide, p, rcond=rcond)[0]), 1)
    g, note = benchmark.pedantic(lambda: LeastSquares.of(B).solve(p), rounds=2)
    kept = LeastSquares.of(B)
    kept.solve(p)
    again = quickest(lambda: kept.solve(p), 2)
    benchmark.extra_info |= {
        "times_faster_than_numpy": round(reference / benchmark.stats.stats.min, 1),
        "and_for_new_targets": round(reference / again),
        "difference": float(f"{np.linalg.norm(g - found[0]) / np.linalg.norm(g):.1e}"),
        "note": note,
    }


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("case", experiment.CASES)
def test_the_papers_cases(benchmark: Any, case: str, precision: Any) -> None:
    p = experiment.pattern("ring").ravel() + 0j
    compare(benchmark, propagator(case, precision).B, p)


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("width", [0.3, 0.1])  # [m]; at 0.1 the rank is far below M
@pytest.mark.parametrize("M", [256, 861])
def test_many_points(benchmark: Any, M: int, width: float, precision: Any) -> None:
    rng = np.random.default_rng(0)
    made = pc.Propagator(pc.autd(3, 3), pc.Air(), precision)
    made.set_points(np.c_[rng.uniform(-width / 2, width / 2, (M, 2)), np.full(M, 0.2)])
    compare(benchmark, made.B, np.exp(1j * rng.uniform(0, 6, M)))


@pytest.mark.parametrize("case", experiment.CASES)
def test_fewer_equations(benchmark: Any, case: str) -> None:
    B = propagator(case, "double").B
    reference = quickest(lambda: linalg.qr(B, mode="economic"), 1)
    benchmark.pedantic(Reduced.of, (B,), rounds=2)
    benchmark.extra_info["times_faster_than_qr"] = round(reference / benchmark.stats.stats.min, 1)
