"""Quantiles of many times."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from pacinian_lab.solvers.timing import quantile

if TYPE_CHECKING:
    from collections.abc import Iterable


class Quantiles(Struct, frozen=True):
    """Of `count` values, by nearest rank; zeros of none."""

    p50: float
    p99: float
    p999: float
    most: float
    count: int

    @classmethod
    def of(cls, values: Iterable[float]) -> Quantiles:
        """Of these."""
        ascending = sorted(values)
        if not ascending:
            return cls(0.0, 0.0, 0.0, 0.0, 0)
        p50, p99, p999 = (quantile(ascending, share) for share in (0.5, 0.99, 0.999))
        return cls(p50, p99, p999, ascending[-1], len(ascending))
