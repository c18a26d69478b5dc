"""What several commands do alike with their results: print tables, make a folder."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from rich.table import Table


def print_tables(tables: Iterable[Table]) -> None:
    """Print tables, with an empty line after each."""
    from rich.console import Console

    console = Console()
    for table in tables:
        console.print(table)
        console.print()


def make_folder(folder: Path, option: str) -> None:
    """Make a folder if it does not exist. Raises BadParameter, which names the option."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise click.BadParameter(str(error), param_hint=option) from error
