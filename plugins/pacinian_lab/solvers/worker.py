"""The process that a contestant runs in: `python -P worker.py workers/autd3.py`, told and telling in JSON lines.

First line out: {"versions": {...}, "offers": [[solver, mode], ...]}. Then for each line in, {"solver", "mode",
"seconds", "problem"}, a line out: {"re", "im", "points", "p50", "p99", "samples", "traced", "resident"}, or
{"error"}. Standard library only: Pacinian is not installed in the peers' environments.

A contestant's file has `versions()` and `offers(threads)`, from (solver, mode) to a function of the problem.
That prepares what may be kept from solve to solve and returns two functions: one from points to the
contestant's own output, which is timed, and one from that to (gains, points), gains in the convention
p = B g, B ~ exp(-jkr), or None where there are none.
"""

from __future__ import annotations

import importlib.util
import json
import math
import os
import sys
from pathlib import Path
from typing import Any


def load(file: Path) -> Any:
    """Import a file by its path, under a name that hides no library."""
    name = f"bench_{file.stem}"
    spec = importlib.util.spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise ImportError(f"cannot load {file}")
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def answer(offers: Any, timing: Any, asked: dict[str, Any]) -> dict[str, Any]:
    """Measure one solver on one problem."""
    solve, read = offers[asked["solver"], asked["mode"]](asked["problem"])
    output, times = timing.measure(solve, asked["seconds"])
    found = read(output)
    told: dict[str, Any] = {**times._asdict(), "resident": timing.resident()}
    if found is not None:
        gains, points = found
        told |= {"re": gains.real.tolist(), "im": gains.imag.tolist(), "points": points.tolist()}
    told["traced"] = (
        timing.traced(solve) if times.p50 <= timing.long(asked["seconds"]) else math.nan
    )
    return told


def main() -> None:
    """Serve until standard input ends. What the contestant prints goes to standard error."""
    lines = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    file, threads = Path(sys.argv[1]), int(os.environ["OMP_NUM_THREADS"])
    sys.argv[1:] = []  # AcousTools reads them
    timing, contestant = load(Path(__file__).with_name("timing.py")), load(file)
    offers = contestant.offers(threads)
    told: dict[str, Any] = {"versions": contestant.versions(), "offers": list(offers)}
    while True:
        print(json.dumps(told), file=lines, flush=True)
        line = sys.stdin.readline()
        if not line:
            return
        try:
            told = answer(offers, timing, json.loads(line))
        except Exception as error:  # a contestant's fault is told, and the next problem is tried
            told = {"error": f"{type(error).__name__}: {error}"}


if __name__ == "__main__":
    main()
