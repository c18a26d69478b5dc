"""A worker, the process of one project's solvers: `python -P worker.py workers/autd3.py`. It speaks JSON lines.

First line out: {"versions": {...}, "offers": [[solver, mode], ...]}. For each line in, {"solver", "mode", "seconds",
"problem"}, a line out: {"re", "im", "points", "p50", "p99", "samples", "traced", "resident"}, or {"error"}. Standard
library only, because Pacinian is not installed in the peers' environments.

A project's file in workers/ defines `LIBRARIES`, the distributions whose versions are told, and `offers(threads)`, a
map from (solver, mode) to a function of the problem. That function prepares what may be kept from solve to solve, and
returns two functions. The first maps points to the solver's own output, and is timed. The second maps the output to
(gains, points), with gains in the convention p = B g, B ~ exp(-jkr), or to None if there are none.
"""

from __future__ import annotations

import importlib.util
import json
import math
import os
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Any


def load(file: Path) -> Any:
    """Import a file by its path, under a name that does not shadow a library."""
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
    reply: dict[str, Any] = {**times._asdict(), "resident": timing.resident()}
    if found is not None:
        gains, points = found
        reply |= {"re": gains.real.tolist(), "im": gains.imag.tolist(), "points": points.tolist()}
    reply["traced"] = (
        timing.measure_memory(solve) if times.p50 <= timing.long(asked["seconds"]) else math.nan
    )
    return reply


def main() -> None:
    """Serve until standard input ends. Redirects what the solvers print to standard error."""
    lines = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    file, threads = Path(sys.argv[1]), int(os.environ["OMP_NUM_THREADS"])
    sys.argv[1:] = []  # AcousTools reads the arguments
    timing, project = load(Path(__file__).with_name("timing.py")), load(file)
    offers = project.offers(threads)
    versions = {name: version(name) for name in project.LIBRARIES}
    reply: dict[str, Any] = {"versions": versions, "offers": list(offers)}
    while True:
        print(json.dumps(reply), file=lines, flush=True)
        line = sys.stdin.readline()
        if not line:
            return
        try:
            reply = answer(offers, timing, json.loads(line))
        except Exception as error:  # report a solver's failure, and go on to the next problem
            reply = {"error": f"{type(error).__name__}: {error}"}


if __name__ == "__main__":
    main()
