"""Check that a server that has run for long has not drifted: memory, files, ticks, ages."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING

import numpy as np

from pacinian_lab.scenes.report import Verdict

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from pacinian_lab.server.soak import Row

MAX_MEMORY_GROWTH = 4.0  # growth of each process after the first quarter [MB]
# Duration below which a run is still filling memory [s], and how many times as much its processes may grow.
SHORT_RUN, SHORT_RUN_GROWTH_FACTOR = 60.0, 10.0
MAX_MORE_FILES = 2  # more open files at the end
MAX_TICK_RATIO = 1.25  # ratio of the last median tick time to that of the second quarter
MAX_LATE_INCREASE = 0.02  # increase of the share of late ticks
# Ratio of the last median age to that of the second quarter; or increase [s]. The larger of the two limits holds.
MAX_AGE_RATIO, MAX_AGE_INCREASE = 1.25, 0.5e-3


def growth(rows: Sequence[Row], name: str) -> float:
    """Return the growth of a process after the first quarter [MB], from a least-squares line."""
    kept = [row for row in rows[len(rows) // 4 :] if name in row.memory]
    if len(kept) < 2:
        return 0.0
    t = np.array([row.t for row in kept])
    slope = np.polyfit(t - t.mean(), [row.memory[name] for row in kept], 1)[0]
    return float(slope * (t[-1] - t[0]))


def quarters(rows: Sequence[Row], of: Callable[[Row], float]) -> tuple[float, float]:
    """Return the medians of the second and the last quarter. The first quarter includes slow start-up."""
    n = max(1, len(rows) // 4)
    return median(map(of, rows[n : 2 * n])), median(map(of, rows[-n:]))


def verdicts(rows: Sequence[Row]) -> list[Verdict]:
    """Return a verdict for each target."""
    most = MAX_MEMORY_GROWTH * (SHORT_RUN_GROWTH_FACTOR if rows[-1].t < SHORT_RUN else 1.0)
    hours = (rows[-1].t - rows[len(rows) // 4].t) / 3600.0
    grown = {name: growth(rows, name) for name in rows[-1].memory}
    shown = ", ".join(f"{k} {v:+.2f} MB ({v / max(hours, 1e-9):+.1f}/h)" for k, v in grown.items())
    files = quarters(rows, lambda row: sum(row.files.values()))
    tick = quarters(rows, lambda row: row.heard.tick_ms[0])
    late = quarters(rows, lambda row: row.heard.late)
    age = quarters(rows, lambda row: row.heard.age.p50)
    faults, restarts = rows[-1].heard.faults, rows[-1].heard.restarts
    happened = [event for row in rows for event in row.heard.events.items()]
    lost = sum(count for name, count in happened if name.startswith("lost"))
    return [
        Verdict(f"each process grows by at most {most:g} MB", max(grown.values()) <= most, shown),
        Verdict(
            f"at most {MAX_MORE_FILES} more files are open",
            files[1] <= files[0] + MAX_MORE_FILES,
            f"{files[0]:g}, then {files[1]:g}",
        ),
        Verdict(
            f"median tick at most {MAX_TICK_RATIO:g} times the first",
            tick[1] <= MAX_TICK_RATIO * tick[0],
            f"{tick[0]:.3f} ms, then {tick[1]:.3f} ms",
        ),
        Verdict(
            f"late ticks at most {100 * MAX_LATE_INCREASE:g} points more",
            late[1] <= late[0] + MAX_LATE_INCREASE,
            f"{late[0]:.2%}, then {late[1]:.2%}",
        ),
        Verdict(
            f"age of hands at most {MAX_AGE_RATIO:g} times the first",
            age[1] <= max(MAX_AGE_RATIO * age[0], age[0] + MAX_AGE_INCREASE),
            f"{1e3 * age[0]:.2f} ms, then {1e3 * age[1]:.2f} ms",
        ),
        Verdict(
            "no fault, no restart, no connection lost",
            not (faults or restarts or lost),
            f"{faults}, {restarts}, {lost}",
        ),
    ]
