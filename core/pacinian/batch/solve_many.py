"""Solve many problems in one call, on all cores."""

from __future__ import annotations

import itertools
import os
import threading
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import TYPE_CHECKING, overload

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import Array
from pacinian.argument_checks import check_integer, check_kind, check_near, check_numbers
from pacinian.batch.processes import pack_task, waiting
from pacinian.batch.task import Task
from pacinian.errors import ArgumentError
from pacinian.plugins import registry
from pacinian.plugins.solver import Solver
from pacinian.solving.blas import limit_blas_threads
from pacinian.solving.limits import Limits
from pacinian.solving.targets import number_regions

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from pacinian.acoustics.propagation import Precision
    from pacinian.batch.processes import WorkerProcess
    from pacinian.solving.solution import Solution
    from pacinian.types import ArrayLike, Complexes, Floats, Longs

MAX_PROBLEMS = 1_000_000  # problems in one call
MAX_GAINS = 1 << 31  # gains of all solutions together: 16 GiB in single precision
MAX_TRIED = 0.005  # time after which problems are no longer solved one by one [s]
MIN_FOR_WAITING = 0.01  # smallest duration of a batch for which idle worker processes are used [s]
MIN_FOR_NEW = 0.15  # time of the batches so far for each process that is started: a start takes 0.1 to 0.4 s [s]
MIN_IN_PROCESSES = 2e-5  # time of a problem from which the transfer of its solution pays [s]
MIN_IN_THREADS = 1e-3  # time of a problem below which threads mostly wait for each other [s]
MAX_PART = 0.02  # time of the problems that a process gets at once [s]
PARTS = 16  # parts for each process, so that none waits long for the last
POLL = 0.005  # time between two checks whether a process has started [s]


class Solutions(Sequence["Solution"]):
    """The solutions of K problems, in the order of the problems: a sequence, and arrays over all of them.

    Indexing by a number returns a `Solution`, by a slice `Solutions`.
    """

    def __init__(self, solutions: Iterable[Solution], sizes: tuple[int, int] = (0, 0)) -> None:
        """Take the solutions. sizes: N and M, in case there is no solution."""
        self._all, self._sizes = tuple(solutions), sizes

    @overload
    def __getitem__(self, k: int) -> Solution: ...
    @overload
    def __getitem__(self, k: slice) -> Solutions: ...
    def __getitem__(self, k: int | slice) -> Solution | Solutions:
        return Solutions(self._all[k], self._sizes) if isinstance(k, slice) else self._all[k]

    def __len__(self) -> int:
        return len(self._all)

    @property
    def gains(self) -> Complexes:
        """All gains, (K, N); a copy. Raises ArgumentError if the arrays have different sizes."""
        if len({len(one.gains) for one in self}) > 1:
            raise ArgumentError("gains", "of arrays of different sizes: use those of each solution")
        if not self._all:
            return np.empty((0, self._sizes[0]), np.complex64)
        return np.array([one.gains for one in self])

    @property
    def sound_pressure(self) -> Complexes:
        """Achieved sound pressures, complex, (K, M) [Pa]."""
        if not self._all:
            return np.empty((0, self._sizes[1]), np.complex128)
        return np.array([one.sound_pressure for one in self])

    @property
    def errors(self) -> Floats:
        """`Solution.error` of each, (K,)."""
        return np.array([one.error for one in self])

    def __repr__(self) -> str:
        kinds = dict.fromkeys(one.status.name for one in self)
        counts = {name: sum(one.status.name == name for one in self) for name in kinds}
        text = ", ".join(f"{count} {name}" for name, count in counts.items())
        scaled = any(one.targets.scale == "max" for one in self)
        errors = [one.shape_error if scaled else one.error for one in self]
        kind = "largest error of the proportions" if scaled else "largest error"
        return f"<{len(self)} Solutions: {text or 'none'}, {kind} {max(errors, default=0.0):.2g}>"


def solve_many(
    array: Array | Sequence[Array],
    points: ArrayLike,
    amplitudes: ArrayLike,
    phases: ArrayLike | None = None,
    *,
    solver: str | Solver = "auto",
    regions: ArrayLike | None = None,
    limits: Limits | None = None,
    scale: str = "exact",
    medium: Air | None = None,
    precision: Precision = "single",
    workers: int | None = None,
) -> Solutions:
    """Solve K problems, each as `solve` would from a cold start, on all cores.

    array: one for all problems, or K arrays, for example one array in K poses. points: (K, M, 3) [m], or (M, 3) if all
    problems have the same. amplitudes: [Pa], that broadcast to (K, M). phases: [rad], that broadcast to (K, M), NaN
    where free; None if all are free. regions: that broadcast to (K, M). solver, limits, scale, medium, precision: as
    for `solve`. workers: number of problems solved at the same time; default: the number of cores.

    The gains are those of `solve`, bit for bit; with more than a million elements of B (M N), where BLAS would use all
    cores for one problem, they may differ by rounding. Python code of a solver does not run in two threads at once, so
    problems of more than 0.02 ms are also solved in other processes. One is started for each 0.15 s that batches have
    taken so far. It starts in 0.1 to 0.4 s; meanwhile, the first problems are solved here. Processes stay for a minute,
    and help in batches of 10 ms or more. Solvers and directivities that other processes cannot load run in threads, if
    each problem takes more than 1 ms.
    The solver must keep no state between calls. No solution depends on the time, so there is no deadline.
    Raises what `solve` raises, with a note that gives the number of the problem; and PluginError if a process dies.
    """
    task = _check_task(
        array, points, amplitudes, phases, regions, solver, limits, scale, medium, precision
    )
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    most = check_integer("workers", (usable or 1) if workers is None else workers, low=1)
    with limit_blas_threads():
        return Solutions(_solve_all(task, most), (len(task.arrays[0]), task.points.shape[1]))


def _solve_all(task: Task, workers: int) -> list[Solution]:
    """Solve the first problems here, and from the time they take decide where to solve the others."""
    K = len(task.points)
    found: dict[int, Solution] = {}
    begin = time.perf_counter()
    for k, solution in task.solve(iter(range(K))):
        found[k] = solution
        now = time.perf_counter()
        if len(found) == 1:
            begin = now  # the first one also prepares the array
        elif workers > 1 and now - begin > MAX_TRIED:
            break
    first = len(found)
    if first < K:
        each = (time.perf_counter() - begin) / (first - 1)  # [s]
        rest = K - first
        code, whole = waiting.identify_code(task), each * rest  # [s]
        others = min(workers, rest) - 1
        pays = each > MIN_IN_PROCESSES and whole > MIN_FOR_WAITING
        helpers = min(others, waiting.count_worthwhile(code, whole / MIN_FOR_NEW)) if pays else 0
        packed = pack_task(task) if helpers else None
        if packed is None:
            numbers = iter(range(first, K))  # shared by the threads: each takes the next number
            threads = 1 + others if each >= MIN_IN_THREADS else 1
            _run([lambda: _take(task, numbers, found)] * threads, numbers)
        else:
            size = int(max(1, min(MAX_PART // each, rest // ((1 + helpers) * PARTS))))
            parts = [range(k, min(k + size, K)) for k in range(first, K, size)]
            _solve_in_processes(task, packed, waiting.take(code, helpers), parts, found)
    return [found[k] for k in range(K)]


def _take(task: Task, numbers: Iterator[int], found: dict[int, Solution]) -> None:
    found.update(task.solve(numbers))


def _solve_in_processes(
    task: Task, packed: bytes, processes: Sequence[WorkerProcess], parts: Sequence[range], found: dict[int, Solution]
) -> None:  # fmt: skip
    """Solve the problems of these parts in this process and in others, as soon as these have started."""
    rest = iter(parts)
    done = threading.Event()  # no part is left

    def here() -> None:
        try:
            _take(task, itertools.chain.from_iterable(rest), found)
        finally:
            done.set()

    def drain(process: WorkerProcess) -> None:
        process.begin(task, packed)
        while not process.started.wait(POLL):
            if done.is_set():
                return
        found.update(process.solve(rest))

    try:
        _run([here, *(partial(drain, process) for process in processes)], rest)
    except BaseException:
        for process in processes:
            process.close()
        raise
    waiting.keep(processes)


def _run(jobs: Sequence[Callable[[], None]], rest: Iterator[object]) -> None:
    """Run the first job here and the others in threads; they share the iterator `rest`.

    If one fails, the others stop. Raises its error.
    """
    with ThreadPoolExecutor(len(jobs)) as pool:  # which starts only the threads that it needs
        made = [pool.submit(partial(_run_or_stop, job, rest)) for job in jobs[1:]]
        _run_or_stop(jobs[0], rest)
    for done in made:
        done.result()


def _run_or_stop(job: Callable[[], None], rest: Iterator[object]) -> None:
    """Run a job; if it fails, take all that is left, so that the other jobs end. Raises its error."""
    try:
        job()
    except BaseException:
        for _ in rest:
            pass
        raise


def _check_task(
    array: Array | Sequence[Array], points: ArrayLike, amplitudes: ArrayLike, phases: ArrayLike | None,
    regions: ArrayLike | None, solver: str | Solver, limits: Limits | None, scale: str,
    medium: Air | None, precision: Precision,
) -> Task:  # fmt: skip
    """Check the arguments of `solve_many`."""
    try:
        arrays = (array,) if isinstance(array, Array) else tuple(array)
    except TypeError:
        raise ArgumentError(
            "array", f"must be one array or a list of them, not {array!r}"
        ) from None
    if not arrays:
        raise ArgumentError("array", "must be one at least")
    for one in arrays:
        check_kind("array", one, Array)
    air = Air() if medium is None else medium
    check_kind("medium", air, Air)
    limits = Limits() if limits is None else limits
    check_kind("limits", limits, Limits)
    made = registry.solver(solver) if isinstance(solver, str) else solver
    check_kind("solver", made, Solver)
    if precision not in ("single", "double"):
        raise ArgumentError("precision", f'must be "single" or "double", not {precision!r}')
    given = np.ndim(points)
    q = check_numbers("points", points, (None, None, 3) if given == 3 else (None, 3))
    K = len(q) if given == 3 else max(len(arrays), _count(amplitudes))
    if len(arrays) not in (1, K):
        raise ArgumentError("array", f"must be one array, or {K} of them, as many as problems")
    if K > MAX_PROBLEMS or K * max(map(len, arrays)) > MAX_GAINS:
        raise ArgumentError(
            "points",
            f"ask for {K} problems, whose solutions would fill the memory: solve them in parts",
        )
    q = np.ascontiguousarray(np.broadcast_to(q, (K, *q.shape[-2:])))
    M = q.shape[1]
    for one in dict.fromkeys(arrays):
        check_near("points", q.reshape(-1, 3), one.centre)
    return Task(
        arrays, q, _spread("amplitudes", amplitudes, (K, M)),
        None if phases is None else _spread("phases", phases, (K, M), free=True),
        None if regions is None else _spread_regions(regions, K, M),
        made, limits, scale, air, precision,
    )  # fmt: skip


def _count(amplitudes: ArrayLike) -> int:
    """Return for how many problems there are amplitudes."""
    return len(np.atleast_1d(np.asarray(amplitudes))) if np.ndim(amplitudes) == 2 else 1


def _spread(name: str, given: ArrayLike, shape: tuple[int, int], *, free: bool = False) -> Floats:
    """Return real numbers, broadcast to `shape`; NaN is allowed if they may be free. Raises ArgumentError."""
    try:
        made = np.asarray(given)
        if made.dtype.kind not in "biuf":
            raise TypeError(f"they are {made.dtype}")
        spread = np.array(np.broadcast_to(made, shape), dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ArgumentError(
            name, f"must be numbers that broadcast to {shape}, (K, M): {error}"
        ) from None
    if np.isinf(spread).any() or (not free and np.isnan(spread).any()):
        k = int(np.argwhere(~np.isfinite(spread))[0][0])
        raise ArgumentError(name, f"must be finite: those of problem {k} are not")
    return spread


def _spread_regions(given: ArrayLike, K: int, M: int) -> Longs:
    """Return regions, broadcast to (K, M). Raises ArgumentError."""
    try:
        spread = np.array(np.broadcast_to(np.asarray(given), (K, M)))
    except (TypeError, ValueError):
        raise ArgumentError(
            "regions", f"must be whole numbers that broadcast to {(K, M)}, (K, M)"
        ) from None
    for row in np.unique(spread.reshape(-1, M), axis=0):
        number_regions(M, row)  # raises for what are no regions
    return np.asarray(spread, np.int64)
