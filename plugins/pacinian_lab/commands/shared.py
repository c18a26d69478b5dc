"""What several commands share: the option --units, tables, the check for matplotlib, the folder of results."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from rich.table import Table


def side(context: click.Context, parameter: click.Parameter, units: int) -> int:
    """Return the side length [units] of a square of `units` units."""
    root = math.isqrt(max(units, 0))
    if root * root != units or not units:
        raise click.BadParameter(f"must be 1, 4, 9, ..., not {units}")
    return root


units = click.option(
    "--units", "side", callback=side, type=int, default=9, show_default=True,
    help="AUTD units, a square number.",
)  # fmt: skip
"""Option of commands that measure a square array; passes its side length [units]."""


def print_tables(tables: Iterable[Table]) -> None:
    """Print tables, with an empty line after each."""
    from rich.console import Console

    console = Console()
    for table in tables:
        console.print(table)
        console.print()


def require_matplotlib() -> None:
    """Check, before anything is measured, that pictures can be drawn. Raises MissingExtra."""
    from pacinian.plot.page import require

    require()


def make_folder(folder: Path, option: str) -> None:
    """Make a folder if it does not exist. Raises BadParameter, which names the option."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise click.BadParameter(str(error), param_hint=option) from error
