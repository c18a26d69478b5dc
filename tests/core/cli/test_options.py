"""Options that are numbers refuse NaN and infinity, in every command."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click
import pytest
from click.testing import CliRunner

from pacinian.cli.main import cli
from pacinian.cli.options import FiniteRange

if TYPE_CHECKING:
    from collections.abc import Iterator


def list_options(
    command: click.Command, path: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], click.Parameter]]:
    if isinstance(command, click.Group):
        context = click.Context(command)
        for name in command.list_commands(context):
            found = command.get_command(context, name)
            assert found is not None
            yield from list_options(found, (*path, name))
    else:
        yield from ((path, option) for option in command.params)


def test_every_range_is_finite() -> None:
    found = [option for _, option in list_options(cli) if isinstance(option.type, click.FloatRange)]
    assert len(found) > 10
    assert all(isinstance(option.type, FiniteRange) for option in found), found


@pytest.mark.parametrize("text", ["nan", "inf", "-inf", "1e400", "1e308", "-1", "five"])
def test_what_is_no_time_is_refused_before_anything_runs(text: str) -> None:
    done = CliRunner().invoke(cli, ["render", "scene.toml", f"--seconds={text}"])
    assert done.exit_code == 2
    assert "--seconds" in done.output
