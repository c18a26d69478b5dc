"""All results of a run as one object for JSON, and parts of such objects that other benchmarks also have."""

from __future__ import annotations

import math
import platform
from dataclasses import asdict
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from pacinian_lab.solvers.run import cores
from pacinian_lab.solvers.summary import cells, growth
from pacinian_lab.solvers.targets import verdicts

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from pacinian_lab.solvers.rows import Row
    from pacinian_lab.solvers.targets import Verdict
    from pacinian_lab.solvers.worker_process import Worker


def plain(rows: Sequence[Row], workers: Iterable[Worker], **said: Any) -> dict[str, Any]:
    """Return rows, cells (medians), targets, exponents, machine and versions in SI units, with null for unknowns."""
    found = cells(rows)
    return {
        **said,
        **about(),
        "versions": {worker.name: worker.versions for worker in workers},
        "targets": [_verdict(verdict) for verdict in verdicts(rows)],
        "growth": [{**asdict(line), "exponent": line.exponent} for line in growth(found)],
        "cells": [replace_non_finite(asdict(cell)) for cell in found],
        "rows": [replace_non_finite(asdict(row)) for row in rows],
    }


def _verdict(verdict: Verdict) -> dict[str, Any]:
    return replace_non_finite(
        {
            "target": verdict.target.name,
            "limit": verdict.target.limit,
            "solver": verdict.solver,
            "met": verdict.met,
            "of": verdict.of,
            "worst": verdict.worst,
            "where": verdict.where,
        }
    )


def about() -> dict[str, Any]:
    """Return the date and the machine."""
    return {
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": {
            "system": platform.platform(),
            "cores": cores(),
            "python": platform.python_version(),
        },
    }


def replace_non_finite(values: dict[str, Any]) -> dict[str, Any]:
    """Return values for JSON, with null for numbers that are not finite."""
    return {
        k: None if isinstance(v, float) and not math.isfinite(v) else v for k, v in values.items()
    }
