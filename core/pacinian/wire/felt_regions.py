"""Decodes what is felt of each region of a state: `State.felt`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pacinian.solving.felt_figures import FeltRegion
from pacinian.wire.binary_arrays import unpack

if TYPE_CHECKING:
    from collections.abc import Iterable


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
