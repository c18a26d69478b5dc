"""Words for the figures of a state; `read_felt` decodes the felt ones."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pacinian.solving.felt_figures import FeltRegion
from pacinian.wire.binary_arrays import unpack

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping


def count(number: int, what: str) -> str:
    """Return a number and what it counts, in the plural if it is not 1."""
    return f"{number:,} {what}{'' if number == 1 else 's'}"


def share(part: int, whole: int) -> str:
    """Return part / whole in percent; "0 %" only if there are none."""
    if not part:
        return "0 %"
    percent = 100.0 * part / max(1, whole)
    return f"{percent:.0f} %" if percent >= 1.0 else f"{max(percent, 0.01):.2f} %"


def list_counts(counts: Mapping[str, int]) -> str:
    """Return the counts that are not 0, each with its name."""
    return ", ".join(f"{n} {name}" for name, n in counts.items() if n)


def read_felt(objects: Iterable[str], felt: bytes) -> dict[str, FeltRegion]:
    """Return what is felt of each object that has a region, by name.

    felt: as in `State`, which says where it is measured.
    """
    regions = (FeltRegion(*four) for four in unpack(felt, 4).tolist())
    return {
        name: region
        for name, region in zip(objects, regions, strict=False)
        if not math.isnan(region.force)
    }
