"""Types of options and arguments that must not be empty: scripts pass "" for a variable that is not set."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from typing import Any

EMPTY = "must not be empty."


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
