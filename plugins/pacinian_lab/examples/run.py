"""Run all packages that offer an example, one after the other, and score what they make."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pacinian_lab.examples.score import Score, score
from pacinian_lab.solvers import peers
from pacinian_lab.solvers.worker_process import START, Worker, WorkerError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from pacinian_lab.examples.examples import Example

OURS = "pacinian"
WORKERS = Path(__file__).parent / "workers"
LIMIT = 120.0  # [s] longest wait for a measurement


class Row(NamedTuple):
    """One way of making one example. p50: median time from places to gains [s], with `threads` threads."""

    example: str
    way: str
    threads: int
    p50: float
    score: Score


def start(root: Path, threads: int) -> list[Worker]:
    """Return the workers of Pacinian and of the peers that are installed in `root`."""
    pythons = {OURS: sys.executable}
    pythons |= {peer: str(made) for peer in peers.PEERS if (made := peers.python(root, peer))}
    return [Worker.of(name, python, threads, WORKERS) for name, python in pythons.items()]


def measure(
    workers: Sequence[Worker],
    examples: Sequence[Example],
    seconds: float,
    on_fault: Callable[[str], object],
) -> Iterator[Row]:
    """Make each example in all ways, for about `seconds` [s] each. on_fault: called with what went wrong."""
    for example in examples:
        for worker in workers:
            try:
                ways = [way for way, name in worker.offers() if name == example.name]
                for way in ways:
                    yield run_one(worker, way, example, seconds)
            except WorkerError as error:
                on_fault(f"{worker.name} on {example.name!r} left out: it {error}")
                if worker.name == OURS:
                    raise


def run_one(worker: Worker, way: str, example: Example, seconds: float) -> Row:
    """Return one row. Raises WorkerError."""
    message: dict[str, Any] = {"solver": way, "mode": example.name, "seconds": seconds}
    message["problem"] = example.message()
    worker.ask({**message, "seconds": 0.0}, START)  # loads everything
    told = worker.ask(message, LIMIT)
    try:
        gains = np.array(told["re"], np.float64) + 1j * np.array(told["im"], np.float64)
        p50 = float(told["p50"])
    except (KeyError, TypeError, ValueError) as error:
        raise WorkerError(f"gave an invalid answer: {error!r}") from error
    shape = len(example.points), len(example.positions)
    if gains.shape != shape or not np.isfinite(gains).all():
        raise WorkerError(f"must return {shape} finite gains")
    return Row(example.name, way, worker.threads, p50, score(example, gains))
