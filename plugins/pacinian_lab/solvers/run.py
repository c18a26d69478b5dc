"""Run the benchmark: every entry solves one problem before the next, so that ratios compare adjacent runs."""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian_lab.solvers import peers
from pacinian_lab.solvers.problems import BenchmarkProblem
from pacinian_lab.solvers.rows import Row
from pacinian_lab.solvers.score import eight_bit, score
from pacinian_lab.solvers.worker_process import (
    START,
    WORKERS,
    Worker,
    WorkerError,
    check_array,
    read_gains,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from pathlib import Path

OURS = "pacinian"
REFERENCE = "reference"


@dataclass(frozen=True)
class Entry:
    """One contestant, which is a solver of a worker, in one mode."""

    worker: Worker
    solver: str
    mode: str

    @property
    def family(self) -> str:
        """Whose solver it is: "pacinian", a peer, or "reference"."""
        return REFERENCE if self.mode == REFERENCE else self.worker.name


def cores() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def workers(threads: Iterable[int], root: Path | None, folder: Path = WORKERS) -> list[Worker]:
    """Return Pacinian's workers and, if `root` is given, those of the peers that have an environment there.

    folder: of the files that the workers run.
    """
    pythons = {OURS: sys.executable}
    if root is not None:
        found = {peer: peers.find_python(root, peer) for peer in peers.PEERS}
        pythons |= {peer: str(python) for peer, python in found.items() if python}
    return [Worker.of(name, python, n, folder) for name, python in pythons.items() for n in threads]


def entries(
    workers: Iterable[Worker],
    solvers: Sequence[str] | None,
    on_fault: Callable[[str], object],
) -> list[Entry]:
    """Return all entries that the workers offer; of Pacinian's, only `solvers`, if given.

    on_fault: called with a message if a peer does not start. Raises WorkerError if Pacinian's worker does not start.
    """
    found: list[Entry] = []
    for worker in workers:
        try:
            offers = worker.offers()
        except WorkerError as error:
            if worker.name == OURS:
                raise
            on_fault(f"{worker.name} left out: it {error}")
            continue
        for solver, mode in offers:
            wanted = solvers is None or solver in solvers
            if wanted or worker.name != OURS or mode == REFERENCE:
                found.append(Entry(worker, solver, mode))
    return found


def warm_up(entries: Iterable[Entry]) -> None:
    """Let every entry solve a small problem, so that nothing is loaded or compiled later.

    Ignores failures, because they will recur and be reported in the run.
    """
    problem = BenchmarkProblem.make(1, 4, 0.5, 0)
    for entry in entries:
        try:
            entry.worker.ask(message(entry, problem, 0.0), START)
        except WorkerError:
            continue


def measure(
    entries: Sequence[Entry],
    problems: Iterable[BenchmarkProblem],
    seconds: float,
    limit: float,
) -> Iterator[Row]:
    """Run every entry on every problem for about `seconds` [s] each, giving up after `limit` [s]."""
    for problem in problems:
        for entry in entries:
            yield run_one(entry, problem, seconds, limit)


def run_one(entry: Entry, problem: BenchmarkProblem, seconds: float, limit: float) -> Row:
    """Return one row. Its status describes any failure."""
    M, N = len(problem.points), len(problem.positions)
    place = (problem.units, N, M, problem.level, problem.seed)
    row = Row(entry.family, entry.solver, entry.mode, entry.worker.threads, *place)
    try:
        reply = entry.worker.ask(message(entry, problem, seconds), limit)
        return evaluate_answer(row, problem, reply)
    except WorkerError as error:
        return replace(row, status=str(error))


def evaluate_answer(row: Row, problem: BenchmarkProblem, reply: dict[str, Any]) -> Row:
    """Return the row with a worker's answer, evaluated. Raises WorkerError if the answer is invalid."""
    try:
        p50, p99, traced, most = (float(reply[k]) for k in ("p50", "p99", "traced", "resident"))
        samples = int(reply["samples"])
        row = replace(row, p50=p50, p99=p99, traced=traced, resident=most, samples=samples)
        if row.family == REFERENCE:
            return row
        q = np.array(reply["points"], np.float64)
    except (KeyError, TypeError, ValueError) as error:
        raise WorkerError(f"gave an invalid answer: {error!r}") from error
    g = read_gains(reply, (row.N,))
    check_array("points", q, (row.M, 3))
    found = score(problem.positions, q, problem.targets, g)
    rounded = score(problem.positions, q, problem.targets, eight_bit(g))
    return replace(
        row,
        error=found.error,
        error_8bit=rounded.error,
        scale=found.best_multiple,
        mean_pressure=found.mean_pressure,
        drive=float(np.abs(g).max()),
    )


def message(entry: Entry, problem: BenchmarkProblem, seconds: float) -> dict[str, Any]:
    """Return the message that asks a worker for a measurement."""
    return {
        "solver": entry.solver,
        "mode": entry.mode,
        "seconds": seconds,
        "problem": problem.message(),
    }
