"""Draw a soak: memory, ticks and ages over time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pacinian.plot.page import figure, save
from pacinian.plot.style import GREY

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from pacinian_lab.server.soak import Row


def draw(rows: Sequence[Row], path: Path) -> None:
    """Draw the picture into a file. Raises MissingExtra."""
    page = figure(8.0, 8.0)
    memory, ticks, late, ages = page.subplots(4, 1, sharex=True)
    minutes = [row.t / 60.0 for row in rows]
    for name in rows[-1].memory:
        first = next(row.memory[name] for row in rows if name in row.memory)
        grown = [row.memory.get(name, math.nan) - first for row in rows]
        memory.plot(minutes, grown, label=f"{name}, from {first:.0f} MB")
    memory.set_ylabel("memory grown [MB]")
    for k, name in enumerate(("median", "99 %")):
        ticks.plot(minutes, [row.heard.tick_ms[k] for row in rows], label=name)
        values = [1e3 * (row.heard.age.p50, row.heard.age.p99)[k] for row in rows]
        ages.plot(minutes, values, label=name)
    ticks.set_ylabel("tick [ms]")
    ages.set_ylabel("age of hands [ms]")
    late.plot(minutes, [100.0 * row.heard.late for row in rows], color=GREY, label="of all ticks")
    late.set(ylabel="late [%]", ylim=(0.0, 102.0))
    ages.set_xlabel("time [min]")
    for axes in (ticks, ages):
        axes.set_ylim(bottom=0.0)
    for axes in (memory, ticks, late, ages):
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize="small", frameon=False)
        axes.grid(color="0.93", linewidth=0.5)
    save(page, path)
