"""The report as tables for a terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from pacinian_lab.paper import experiment, fourier

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian_lab.paper.experiment import Experiment
    from pacinian_lab.paper.focus import Width
    from pacinian_lab.paper.force import Force
    from pacinian_lab.paper.fourier import Comparison


def outcomes(results: Experiment) -> Table:
    """Return a table of pattern by case: correlation, error, maximum."""
    rows: list[list[str]] = []
    for name in experiment.PATTERNS:
        found = [results.outcomes[name, case] for case in experiment.CASES]
        cells = [f"{o.correlation:.2f} {o.error:.2f} {o.maximum:.2f}" for o in found]
        rows.append([name, *cells])
    title = "Experiment, |p| against the target: correlation, relative error, maximum"
    return _make_table(title, ["pattern", *experiment.CASES], rows)


def spectra(results: Experiment) -> Table:
    """Return a table of the cases: size, rank and condition number of B."""
    rows = [
        [
            s.case,
            f"{s.samples} x {s.transducers}",
            str(s.rank),
            _condition(s.condition),
            f"{s.kept:.0f}",
        ]
        for s in results.spectra.values()
    ]
    head = ["case", "B", "rank", "condition", "within the rank"]
    return _make_table("Matrix B", head, rows)


def baseline(comparisons: dict[tuple[str, str], Comparison]) -> Table:
    """Return a table of pattern by place: correlation and maximum of the Fourier method and of the pseudo-inverse."""
    titles = {"1a far": f"{1e3 * fourier.FAR_HEIGHT:.0f} mm"}
    head = [
        f"{titles.get(place, place)}\n{method}"
        for place in fourier.PLACES
        for method in ("Fourier", "ps.-inv.")
    ]
    rows: list[list[str]] = []
    for name in experiment.PATTERNS:
        row = [name]
        for place in fourier.PLACES:
            c = comparisons[name, place]
            row += [f"{o.correlation:.2f} {o.maximum:.2f}" for o in (c, c.pseudo_inverse)]
        rows.append(row)
    title = "Fourier baseline and pseudo-inverse: correlation, maximum"
    return _make_table(title, ["pattern", *head], rows)


def widths(found: Iterable[Width]) -> Table:
    """Return a table of the focus's widths in millimetres."""
    rows = [
        [w.axis, f"{1e3 * w.aperture:.0f}"]
        + [
            f"{1e3 * x:.1f}"
            for x in (w.minimum, w.minimum_integral, w.formula, w.half, w.half_integral)
        ]
        for w in found
    ]
    head = ["axis", "aperture", "minimum", "integral", "1.22 lambda z/a", "half", "integral"]
    return _make_table("Focus of 9 units at 600 mm: main lobe [mm]", head, rows)


def forces(found: Iterable[Force]) -> Table:
    """Return a table of the focus's force, modelled and measured."""
    rows = [
        [
            str(f.units),
            f"{1e3 * f.distance:.0f}",
            f"{f.level:.1f}",
            f"{f.top:.0f}",
            f"{f.force:.1f}",
            f"{f.measured:.1f}",
            f"{1e3 * f.shock:.0f}",
        ]
        for f in found
    ]
    head = ["units", "z [mm]", "SPL [dB]", "peak [Pa]", "model [gf]", "measured [gf]", "shock [mm]"]
    return _make_table("Force of a focus, linear model and measured in the paper", head, rows)


def _condition(value: float) -> str:
    return f"{value:.0f}" if math.isfinite(value) else "infinite"


def _make_table(title: str, head: list[str], rows: list[list[str]]) -> Table:
    """Return a table that takes its texts literally, so that a unit in brackets is not markup."""
    table = Table(title=Text(title), title_justify="left", box=SIMPLE_HEAD, collapse_padding=True)
    for n, name in enumerate(head):
        table.add_column(Text(name), justify="right" if n else "left")
    for row in rows:
        table.add_row(*row)
    return table
