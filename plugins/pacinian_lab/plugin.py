"""What the laboratory adds to Pacinian: its commands."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.plugins.hookspecs import hookimpl
from pacinian_lab.commands.bench import bench
from pacinian_lab.commands.paper import paper
from pacinian_lab.commands.soak import soak
from pacinian_lab.commands.stress import stress
from pacinian_lab.commands.study import study

if TYPE_CHECKING:
    from collections.abc import Iterable

    import click


@hookimpl
def register_commands() -> Iterable[click.Command]:
    """`pacinian bench`, `soak`, `stress`, `study` and `paper`."""
    return bench, soak, stress, study, paper
