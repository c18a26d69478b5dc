"""The worker: solves the tasks of one place, and measures. Dask loads this module before any timing."""

from __future__ import annotations

import functools
import math
import signal
import time
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np
from threadpoolctl import threadpool_limits

import pacinian as pc
from pacinian.errors import ArgumentError
from pacinian.rendering.quantiser import Quantiser
from pacinian_lab.study.measures import MEASURES, amplitudes, compute_emitted_power, image
from pacinian_lab.study.target_plane import TargetPlane

if TYPE_CHECKING:
    from distributed import Worker

    from pacinian.devices.description import LevelCounts
    from pacinian.types import Complexes, Floats, Gains
    from pacinian_lab.study.planes import Plane
    from pacinian_lab.study.study_file import Method, Picture

Row = dict[str, Any]

TIMED = 5  # maximum number of timed runs of the reference, and of a fast solver
SLOW = 0.2  # [s] total time after which no further run starts

_warm: set[str] = set()


def dask_setup(worker: Worker) -> None:
    """Let a local Dask process ignore Ctrl-C, because the command ends its workers."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


@dataclass(frozen=True)
class Job:
    """The settings that differ between the tasks of one place."""

    key: str
    method: Method
    level: float


@dataclass(frozen=True, eq=False)
class Batch:
    """The tasks of one place, with all their inputs, for sending to a worker.

    uv, proportions: of the pattern, (M, 2) [m] and (M,). gain: the limit; None for none. emitted: levels of the
    emulated device, if any.
    """

    array: pc.Array
    plane: Plane
    uv: Floats
    proportions: Floats
    medium: pc.Air
    gain: float | None
    emitted: LevelCounts | None
    picture: Picture
    jobs: tuple[Job, ...]

    def target_plane(self) -> TargetPlane:
        """Return the data that the tasks share."""
        return TargetPlane(
            self.array, self.plane, self.uv, self.proportions, self.medium, self.picture
        )


def measure(batch: Batch) -> list[Row]:
    """Return a row for each task. The row of a failed task has the reason."""
    with threadpool_limits(1):
        target_plane = batch.target_plane()
        return [_row(batch, target_plane, job) for job in batch.jobs]


def make_failure(job: Job, reason: str) -> Row:
    """Return the row of a task that failed."""
    return {"key": job.key, "failure": reason}


def _row(batch: Batch, target_plane: TargetPlane, job: Job) -> Row:
    try:
        return _measure_job(batch, target_plane, job)
    except Exception as error:
        return make_failure(job, f"{type(error).__name__}: {error}")


def _measure_job(batch: Batch, target_plane: TargetPlane, job: Job) -> Row:
    exact = job.level != math.inf
    t = targets(batch, target_plane, job.level)
    solution, seconds = _time_solve(batch, target_plane, job)
    g = quantise_gains(batch, solution.gains).astype(np.complex128)
    a = np.abs(target_plane.B @ g)
    power = compute_emitted_power(batch.array, g, batch.medium)
    P = pc.radiation_pressure(a[target_plane.asked], batch.medium)
    rank, condition = target_plane.spectrum
    measured = {
        **amplitudes(a, t, exact=exact),
        **image(a[target_plane.asked], target_plane.field(g), target_plane.lobes),
        **{f"width_{way}": width for way, width in target_plane.widths._asdict().items()},
        "reach": (batch.gain or 1.0) * float(target_plane.reach.max()),
        "yield": float(P.mean()) / power if power > 0.0 else math.nan,
        "condition": condition,
        "saturation": solution.saturation,
        "run_time": seconds / _reference(),
    }
    return {
        "key": job.key,
        "failure": None,
        "status": solution.status.name,
        "used": solution.solver,
        "iterations": solution.iterations,
        "transducers": len(batch.array),
        "points": len(batch.uv),
        "aperture": target_plane.aperture,
        "spacing": target_plane.spacing,
        "rank": rank,
        **{name: measured[name] for name in MEASURES},
        "seconds": seconds,
    }


def targets(batch: Batch, target_plane: TargetPlane, level: float) -> Floats:
    """Return the target sound pressures [Pa], (M,), with ||t|| = level x gain limit x mean reach of a focus.

    Raises ArgumentError if no sound reaches the points.
    """
    level = 1.0 if level == math.inf else level
    size = level * (batch.gain or 1.0) * float(target_plane.reach.mean())
    if not size > 0.0:
        raise ArgumentError("points", "cannot be reached by the sound of any transducer")
    return batch.proportions * (size / float(np.linalg.norm(batch.proportions)))


def solve(batch: Batch, target_plane: TargetPlane, job: Job) -> pc.Solution:
    """Return the solution of one task. Raises the errors of solvers."""
    return pc.solve(
        batch.array,
        target_plane.points,
        targets(batch, target_plane, job.level),
        job.method.phases,
        solver=job.method.make(),
        limits=pc.Limits(gain=batch.gain),
        scale="max" if job.level == math.inf else "exact",
        medium=batch.medium,
        precision=job.method.precision,
    )


def quantise_gains(batch: Batch, gains: Gains | Complexes) -> Complexes:
    """Return the gains as the device emits them, or unchanged if no device is emulated."""
    if batch.emitted is None:
        return gains
    can = pc.Capability(phases=batch.emitted.phases, amplitudes=batch.emitted.amplitudes)
    made = Quantiser(can, 1, len(gains)).quantise_gains(
        gains.astype(np.complex64), batch.gain or 1.0
    )
    return made.copy()


def _time_solve(batch: Batch, target_plane: TargetPlane, job: Job) -> tuple[pc.Solution, float]:
    """Return the solution, and the median of its run times, from points to gains [s]."""
    if job.method.name not in _warm:  # the solver may have to load or compile something
        solve(batch, target_plane, job)
        _warm.add(job.method.name)
    times: list[float] = []
    solution = None
    while solution is None or (len(times) < TIMED and sum(times) < SLOW):
        begin = time.perf_counter()
        solution = solve(batch, target_plane, job)
        times.append(time.perf_counter() - begin)
    return solution, median(times)


@functools.cache
def _factors() -> tuple[Gains, Gains]:
    ones = np.ones((64, 2241), dtype=np.complex64)
    return ones, ones.T.copy()


def _reference() -> float:
    """Return the run time of the product of 64 x 2241 by 2241 x 64 on this machine now [s]."""
    times: list[float] = []
    first, second = _factors()
    for _ in range(TIMED):
        begin = time.perf_counter()
        np.matmul(first, second)
        times.append(time.perf_counter() - begin)
    return median(times)
