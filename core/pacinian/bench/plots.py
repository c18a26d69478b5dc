"""The pictures: run time against error, and run time against size. Needs Matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pacinian.bench.labels import SMALL, label
from pacinian.bench.run import OURS, REFERENCE
from pacinian.bench.summary import growth
from pacinian.plot import figure, save

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from pacinian.bench.labels import Text
    from pacinian.bench.summary import Cell, Growth

Panel = Any  # Matplotlib's axes: its stubs leave too much open

# Okabe and Ito's colours, told apart by every eye; and a shape each.
STYLES = {
    OURS: ("#0072b2", "o"),
    "autd3": ("#d55e00", "s"),
    "acoustools": ("#009e73", "^"),
    "levitate": ("#a8508a", "D"),
    REFERENCE: ("0.4", "x"),
}
WEAK = 0.9  # scale; what makes less of what was asked is pale, and not on the front
FLOOR = 1e-5  # [%]; smaller errors are drawn here
SHOWN = ("cold", "warm", REFERENCE)
MOST = 4  # panels along a side


def draw(cells: Sequence[Cell], folder: Path) -> list[Path]:
    """Draw all pictures as PNG files in `folder`; return the files. Raises MissingExtra.

    What failed, or is wrong by more than 100 %, is left out.
    """
    files: list[Path] = []
    cells = [c for c in cells if c.mode in SHOWN and c.solver != "gemm"]
    shown = [c for c in cells if not (c.note or c.error > 1.0)]
    for level in sorted({c.level for c in shown if c.mode != REFERENCE}):
        path = folder / f"pareto-{level:g}.png"
        pareto([c for c in shown if c.level == level], level, path)
        files.append(path)
    if lines := growth(cells):
        path = folder / "growth.png"
        grow(lines, path)
        files.append(path)
    return files


def pareto(cells: Sequence[Cell], level: float, path: Path) -> None:
    """Run time against error: a panel for each N and M."""
    sizes, counts = (_some(sorted({getattr(c, k) for c in cells})) for k in "NM")
    page = figure(1.0 + 4.4 * len(sizes), 1.0 + 3.3 * len(counts))
    grid = page.subplots(len(counts), len(sizes), sharex=True, sharey=True, squeeze=False)
    times = [1e3 * c.p50 for c in cells]
    grid[0, 0].set(xscale="log", yscale="log", ylim=(0.4 * FLOOR, 200.0))
    grid[0, 0].set_xlim(0.6 * min(times), 8.0 * max(times))
    for axis in (grid[0, 0].xaxis, grid[0, 0].yaxis):
        axis.set_major_formatter(_plainly)
    for panel in grid[-1]:
        panel.set_xlabel("run time, p50 [ms]")
    for i, M in enumerate(counts):
        grid[i, 0].set_ylabel("error [%]")
        for j, N in enumerate(sizes):
            grid[i, j].set_title(f"N = {N} transducers, M = {M} points", fontsize=9)
    page.suptitle(
        f"Run time, points to gains, against error, at level {level:g}. "
        f"Filled: cold; hollow: warm. x: scale where it is not 1; pale: under {WEAK:g}. "
        f"Errors under {FLOOR:g} % are drawn there.",
        fontsize=9,
    )
    page.draw_without_rendering()  # lays the panels out, so that labels can be placed
    for i, M in enumerate(counts):
        for j, N in enumerate(sizes):
            _pareto(grid[i, j], [c for c in cells if (c.N, c.M) == (N, M)])
    save(page, path)


def _pareto(panel: Panel, cells: list[Cell]) -> None:
    at = {(c.solver, c.mode): (1e3 * c.p50, max(100.0 * c.error, FLOOR)) for c in cells}
    texts: list[Text] = []
    for c in cells:
        x, y = at[c.solver, c.mode]
        colour, marker = STYLES.get(c.family, STYLES[REFERENCE])
        alpha = 0.4 if c.scale < WEAK else 1.0
        if c.mode == REFERENCE:
            panel.axvline(x, color=colour, linestyle=":", linewidth=1)
            panel.text(x, 150.0, f" {c.solver}", color=colour, fontsize=SMALL, va="top")
        elif c.mode == "warm":
            panel.plot(x, y, marker, color=colour, ms=4, mfc="none", mew=0.8, alpha=alpha)
            if cold := at.get((c.solver, "cold")):
                panel.plot(*zip((x, y), cold, strict=True), color=colour, linewidth=0.5)
        else:
            panel.plot(x, y, marker, color=colour, ms=5, zorder=6, alpha=alpha)
            scale = "" if abs(c.scale - 1.0) < 0.01 else f" x{c.scale:.2f}"
            texts.append((c.solver + scale, x, y, colour))
    front = _front([at[c.solver, "cold"] for c in cells if c.mode == "cold" and c.scale >= WEAK])
    if front:
        front = [(front[0][0], 200.0), *front, (panel.get_xlim()[1], front[-1][1])]
        panel.step(*zip(*front, strict=True), where="post", color="0.87", linewidth=3, zorder=0)
    panel.grid(color="0.94", linewidth=0.5)
    label(panel, texts, [at[c.solver, c.mode] for c in cells if c.mode == "warm"])


def _front(points: Iterable[tuple[float, float]]) -> list[tuple[float, float]]:
    """The points that none beats in both time and error."""
    front: list[tuple[float, float]] = []
    for at in sorted(points):
        if not front or at[1] < front[-1][1]:
            front.append(at)
    return front


def grow(lines: Sequence[Growth], path: Path) -> None:
    """Run time against N and against M."""
    alongs = sorted({line.along for line in lines}, reverse=True)
    page = figure(1.0 + 5.5 * len(alongs), 8.0)
    panels = page.subplots(1, len(alongs), sharey=True, squeeze=False)[0]
    for panel, along in zip(panels, alongs, strict=True):
        panel.set(xscale="log", yscale="log")
        shown = [line for line in lines if line.along == along]
        for line in shown:
            colour, marker = STYLES.get(line.family, STYLES[REFERENCE])
            style = "--" if line.family == REFERENCE else "-"
            panel.plot(line.sizes, [1e3 * t for t in line.times], style, marker=marker, ms=4,
                       color=colour, linewidth=1)  # fmt: skip
        sizes = sorted({size for line in shown for size in line.sizes})
        panel.set_xlim(0.8 * sizes[0], sizes[-1] * (sizes[-1] / sizes[0]) ** 0.55)
        panel.set_xticks(sizes, [str(size) for size in sizes])
        panel.set_xticks([], minor=True)
        panel.yaxis.set_major_formatter(_plainly)
        other, what = ("M", "transducers N") if along == "N" else ("N", "points M")
        panel.set_xlabel(what)
        panel.set_title(
            f"{other} = {shown[0].fixed}; the power of {along} in each label", fontsize=9
        )
        panel.grid(color="0.93", linewidth=0.5)
    panels[0].set_ylabel("run time, p50, cold [ms]")
    page.suptitle(f"Growth of the run time at level {lines[0].level:g}", fontsize=10)
    page.draw_without_rendering()
    for panel, along in zip(panels, alongs, strict=True):
        label(
            panel,
            [
                (f"{line.solver}  {along}$^{{{line.exponent:.2f}}}$", line.sizes[-1],
                 1e3 * line.times[-1], STYLES.get(line.family, STYLES[REFERENCE])[0])
                for line in lines
                if line.along == along
            ],
            both=False,
        )  # fmt: skip
    save(page, path)


def _plainly(value: float, place: int) -> str:
    """A tick without powers of ten."""
    return f"{value:g}"


def _some(values: list[int]) -> list[int]:
    """At most `MOST` of them, from the first to the last."""
    if len(values) <= MOST:
        return values
    return [values[round(k * (len(values) - 1) / (MOST - 1))] for k in range(MOST)]
