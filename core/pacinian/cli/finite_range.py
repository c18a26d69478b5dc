"""The type of options that are numbers: within a range, and neither NaN nor infinite."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from typing import Any


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
