"""Run all packages that offer an example, in turn."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from pacinian_lab.solvers.worker_process import WorkerError, read_gains

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from pacinian.types import Complexes
    from pacinian_lab.examples.examples import Example
    from pacinian_lab.solvers.worker_process import Worker

WORKERS = Path(__file__).parent / "workers"
LIMIT = 300.0  # [s] longest wait for a measurement
TURNS = 5  # measurements of each way


class Row(NamedTuple):
    """One way of making one example, with `threads` threads.

    p50: time from places to gains [s], the least of the medians of some turns. gains: (K, N).
    """

    example: str
    way: str
    threads: int
    p50: float
    gains: Complexes


def measure(
    workers: Sequence[Worker],
    examples: Sequence[Example],
    seconds: float,
    on_fault: Callable[[str], object],
) -> Iterator[Row]:
    """Make each example in all ways, for about `seconds` [s] each. on_fault: called with what went wrong.

    All ways take turns, so that other programs on the machine disturb all of them alike.
    """
    for example in examples:
        made: dict[tuple[Worker, str], list[Row]] = {}
        for turn in range(1 + TURNS):
            for worker in workers:
                ways = [way for way, name in _offers(worker, on_fault) if name == example.name]
                for way in ways:
                    if turn and (worker, way) not in made:
                        continue  # it has failed
                    try:
                        row = run_one(worker, way, example, seconds / TURNS if turn else 0.0)
                    except WorkerError as error:
                        on_fault(f"{way} on {example.name!r} left out: it {error}")
                        made.pop((worker, way), None)
                    else:
                        made.setdefault((worker, way), []).append(row)
        for _, *rows in made.values():  # the first one has loaded everything
            yield min(rows, key=lambda row: row.p50)


def _offers(worker: Worker, on_fault: Callable[[str], object]) -> list[tuple[str, str]]:
    try:
        return worker.offers()
    except WorkerError as error:
        on_fault(f"{worker.name} left out: it {error}")
        return []


def run_one(worker: Worker, way: str, example: Example, seconds: float) -> Row:
    """Return one row. Raises WorkerError."""
    message = {"solver": way, "mode": example.name, "seconds": seconds}
    reply = worker.ask({**message, "problem": example.message()}, LIMIT)
    gains = read_gains(reply, (len(example.points), len(example.positions)))
    try:
        p50 = float(reply["p50"])
    except (KeyError, TypeError, ValueError) as error:
        raise WorkerError(f"gave an invalid answer: {error!r}") from error
    return Row(example.name, way, worker.threads, p50, gains)
