"""`pacinian paper`: reproduce the paper's experiment, figures and forces."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pacinian_lab.commands.shared import make_folder

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian_lab.paper.report import Report


@click.command()
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("paper"),
    show_default=True,
    help="Folder for the figures.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object, in SI units.")
@click.option("--no-figures", is_flag=True, help="Draw nothing.")
def paper(out: Path, as_json: bool, no_figures: bool) -> None:
    """Reproduce the paper that Pacinian grew from.

    Repeats the experiment, baseline, focus and forces of Hasegawa and Shinoda.
    """
    import json

    from pacinian_lab.paper.report import plain

    draw = None if no_figures else _prepare_drawing(out)
    report = _compute()
    files = draw(report, out) if draw else []
    if as_json:
        click.echo(json.dumps({**plain(report), "figures": [str(file) for file in files]}))
        return
    _print(report)
    for file in files:
        click.echo(f"wrote {file}")


def _compute() -> Report:
    from rich.console import Console
    from rich.progress import Progress

    from pacinian_lab.paper import report

    with Progress(console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("solving", total=report.STEPS)
        return report.make(lambda: progress.advance(task))


def _prepare_drawing(folder: Path) -> Callable[[Report, Path], list[Path]]:
    """Return the drawing function. Fails before the work if a library is missing or the folder cannot be made."""
    from pacinian_lab.paper.figures import draw

    make_folder(folder, "--out")
    return draw


def _print(report: Report) -> None:
    from rich.console import Console

    from pacinian_lab.paper import tables
    from pacinian_lab.paper.report import EXPERIMENT_NOTES, FOCUS_NOTES, FOURIER_NOTES

    results, console = report.experiment, Console()
    for found, notes in (
        ([tables.outcomes(results), tables.spectra(results)], EXPERIMENT_NOTES),
        ([tables.baseline(report.fourier)], FOURIER_NOTES),
        ([tables.widths(report.widths), tables.forces(report.forces)], FOCUS_NOTES),
    ):
        for table in found:
            console.print(table)
        for note in notes:
            console.print(f"- {note}", highlight=False, markup=False)
        console.print()
