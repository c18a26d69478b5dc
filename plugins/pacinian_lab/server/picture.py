"""A soak as a picture: memory, ticks and ages over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.plot.page import figure, save

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from pacinian_lab.server.soak import Row


def draw(rows: Sequence[Row], path: Path) -> None:
    """Write it to a file. Raises MissingExtra."""
    page = figure(8.0, 7.0)
    memory, ticks, ages = page.subplots(3, 1, sharex=True)
    minutes = [row.t / 60.0 for row in rows]
    for name in rows[-1].memory:
        memory.plot(minutes, [row.memory.get(name) for row in rows], label=name)
    memory.set_ylabel("memory [MB]")
    for k, name in enumerate(("p50", "p99")):
        ticks.plot(minutes, [row.heard.tick_ms[k] for row in rows], label=f"tick {name} [ms]")
    ticks.plot(minutes, [100.0 * row.heard.late for row in rows], label="late [%]")
    for name in ("p50", "p99"):
        values = [1e3 * getattr(row.heard.age, name) for row in rows]
        ages.plot(minutes, values, label=f"hand's age {name} [ms]")
    ages.set_xlabel("time [min]")
    for axes in (memory, ticks, ages):
        axes.set_ylim(bottom=0.0)
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize="small")
    save(page, path)
