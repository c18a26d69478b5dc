"""The summary as tables for a terminal."""

from __future__ import annotations

import math
from collections import defaultdict
from statistics import median
from typing import TYPE_CHECKING

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from pacinian.plot.pareto_front import SHOWN_MODES
from pacinian_lab.solvers.run import REFERENCE
from pacinian_lab.solvers.targets import TARGETS

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from pacinian_lab.solvers.rows import Row
    from pacinian_lab.solvers.summary import Cell, Growth
    from pacinian_lab.solvers.targets import Verdict


def results(cells: Sequence[Cell]) -> list[Table]:
    """Return a table for each level and N: solver by M, with error, scale, time and ratio to the roofline's time."""
    cells = [c for c in cells if c.mode in SHOWN_MODES and c.solver != "gemm"]
    return [
        _results([c for c in cells if (c.level, c.N) == place], *place)
        for place in sorted({(c.level, c.N) for c in cells})
    ]


def _results(cells: list[Cell], level: float, N: int) -> Table:
    counts = sorted({c.M for c in cells})
    found = {(c.solver, c.mode, c.M): c for c in cells}
    head = [""] + [
        text for M in counts for text in ("error\n[%]", f"M={M}\nx t", "p50\n[ms]", "over\nroof")
    ]
    rows: list[list[str]] = []
    for solver, mode in dict.fromkeys((c.solver, c.mode) for c in cells):
        row = ["  warm" if mode == "warm" else solver]
        for M in counts:
            row += _numbers(found.get((solver, mode, M)), found.get(("roofline", REFERENCE, M)))
        rows.append(row)
    title = f"Level {level:g}, N = {N} transducers, M points; x t: scale of the targets"
    return plain_table(title, head, rows)


def _numbers(cell: Cell | None, roofline: Cell | None) -> list[str]:
    if cell is None or cell.note:
        note = "" if cell is None else "late" if "timed out" in cell.note else "failed"
        return [note, "", "", ""]
    over = "" if roofline is None or roofline.note else short(cell.p50 / roofline.p50)
    quality = [short(100.0 * cell.error), f"{cell.scale:.2f}"]
    return [*(["", ""] if cell.mode == REFERENCE else quality), short(1e3 * cell.p50), over]


def updates(cells: Sequence[Cell]) -> Table:
    """Return a table of a session's update times relative to a cold solve, on the largest problem."""
    places = {(c.solver, c.mode, c.N, c.M, c.level): c.p50 for c in cells if not c.note}
    sizes = [(N, M) for _, _, N, M, _ in places]
    N, M = max(sizes, key=lambda size: size[0] * size[1], default=(0, 0))
    levels = sorted({level for *_, level in places})
    modes = ("warm", "one moved", "rescaled")
    head = ["", *(f"{mode}\nL {level:g}" for level in levels for mode in modes)]
    rows: list[list[str]] = []
    for solver in dict.fromkeys(solver for solver, mode, *_ in places if mode == "warm"):
        times = [
            places.get((solver, mode, N, M, level), math.nan)
            / places.get((solver, "cold", N, M, level), math.nan)
            for level in levels
            for mode in modes
        ]
        rows.append([solver, *map(short, times)])
    return plain_table(f"Run time over cold, N = {N}, M = {M}", head, rows)


def resources(rows: Sequence[Row]) -> Table:
    """Return a table of each solver's memory on its largest problem, and of the effect of threads on two problems."""
    head = [
        "",
        "N M",
        "one solve\nholds [MB]",
        "process\n[MB]",
        "all threads\nover one",
        "on the\nsmallest",
    ]
    table: list[list[str]] = []
    shown = [(r.solver, r.mode) for r in rows if r.mode in SHOWN_MODES and r.solver != "gemm"]
    for solver, mode in dict.fromkeys(shown):
        own = [r for r in rows if (r.solver, r.mode, r.ok) == (solver, mode, True)]
        if not own:
            continue
        groups: defaultdict[int, list[Row]] = defaultdict(list)
        for r in own:
            groups[r.N * r.M].append(r)
        large, small = max(groups), min(groups)
        held = [max(getattr(r, k) for r in groups[large]) for k in ("traced", "resident")]
        numbers = [short(1e-6 * size) for size in held]
        name = "  warm" if mode == "warm" else solver
        table.append([name, str(large), *numbers, _gain(groups[large]), _gain(groups[small])])
    return plain_table("Memory, and run time with all threads over that with one", head, table)


def _gain(rows: list[Row]) -> str:
    """Return the time with the most threads relative to the time with one."""
    threads = max(r.threads for r in rows)
    one, all_ = (median(r.p50 for r in rows if r.threads == n) for n in (1, threads))
    return "" if threads == 1 else short(all_ / one)


def verdicts(found: Iterable[Verdict]) -> Table:
    """Return a table of solver by target: the number of kinds of problems that meet it, and the worst value."""
    places = {(v.solver, v.target): v for v in found}
    head = ["ours", *(target.head for target in TARGETS)]
    rows: list[list[str]] = []
    for solver in dict.fromkeys(solver for solver, _ in places):
        row = [solver]
        for target in TARGETS:
            v = places.get((solver, target))
            worst = 0.0 if v is None else v.worst * (100.0 if target.percent else 1.0)
            row.append("" if v is None else f"{v.met}/{v.of}\n{short(worst)}")
        rows.append(row)
    return plain_table(
        "Targets: kinds of problems in which each is met, and the worst value", head, rows
    )


def exponents(found: Sequence[Growth]) -> Table:
    """Return a table of the fitted exponents of the run times."""
    both = {(g.solver, g.along): g for g in found}
    head = [
        "",
        *(f"{g.along}, at {'M' if g.along == 'N' else 'N'} = {g.fixed}" for g in _first(found)),
    ]
    rows = [
        [solver, *(_exponent(both.get((solver, g.along))) for g in _first(found))]
        for solver in dict.fromkeys(g.solver for g in found)
    ]
    title = f"Run time grows as size to the power of (cold, level {found[0].level:g})"
    return plain_table(title, head, rows)


def _first(found: Sequence[Growth]) -> list[Growth]:
    return list({g.along: g for g in found}.values())


def _exponent(line: Growth | None) -> str:
    return "" if line is None else f"{line.exponent:.2f}"


def short(value: float) -> str:
    """Return a number as text, in at most five characters for the usual range."""
    if not math.isfinite(value):
        return "-"
    for least, digits in ((10.0, 0), (1.0, 1), (0.1, 2), (0.01, 3)):
        if abs(value) >= least:
            return f"{value:.{digits}f}".replace("0.", ".", 1 if abs(value) < 1.0 else 0)
    return f"{value:.0e}".replace("e-0", "e-") if value else "0"


def markdown_table(head: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    rows = head, ["---"] * len(head), *lines
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def plain_table(title: str, head: list[str], rows: list[list[str]]) -> Table:
    """Return a table that takes its texts literally, so that a unit in brackets is not markup."""
    line = Text(title, no_wrap=True, overflow="ignore")
    made = Table(
        title=line,
        title_justify="left",
        box=SIMPLE_HEAD,
        collapse_padding=True,
        padding=0,
        show_edge=False,
    )
    for n, name in enumerate(head):
        made.add_column(Text(name), justify="right" if n else "left", no_wrap=True)
    for row in rows:
        made.add_row(*(Text(cell) for cell in row))
    return made
