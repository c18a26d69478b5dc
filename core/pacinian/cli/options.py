"""Types of options and arguments, and the option `--connection`.

No value may be empty: scripts pass "" for a variable that is not set.
"""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from typing import Any

EMPTY = "must not be empty."


class FiniteRange(click.FloatRange):
    """Like `click.FloatRange`, which accepts NaN, because NaN is neither below the minimum nor above the maximum."""

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Return the number. Raises BadParameter."""
        number = float(super().convert(value, param, ctx))
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number.", param, ctx)
        return number


class NonEmptyText(click.types.StringParamType):
    """Like click's type of texts, but refuses an empty text."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the text. Raises BadParameter."""
        text: str = super().convert(value, param, ctx)
        if not text:
            self.fail(EMPTY, param, ctx)
        return text


class NonEmptyPath(click.Path):
    """Like `click.Path`, but refuses an empty path, which pathlib takes for the current folder."""

    def convert(
        self,
        value: str | os.PathLike[str],
        param: click.Parameter | None,
        ctx: click.Context | None,
    ) -> str | bytes | os.PathLike[str]:
        """Return the path. Raises BadParameter."""
        if not os.fspath(value):
            self.fail(EMPTY, param, ctx)
        return super().convert(value, param, ctx)


TEXT = NonEmptyText()
PATH = NonEmptyPath()
CONNECTION = click.option(
    "--connection",
    default=None,
    type=PATH,
    metavar="FILE",
    help="The server's connection file.  [default: $PACINIAN_CONNECTION, or the server's default]",
)
