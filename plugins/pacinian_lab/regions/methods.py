"""A shape made in one way, and the names of the ways."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pacinian.types import Complexes

SPACINGS = {"8.5 mm": 0.0085, "4.25 mm": 0.00425}  # [m] between foci
FREE = {f"foci, {name} apart": spacing for name, spacing in SPACINGS.items()}
OURS, SWEPT = "regions", "one focus, swept"


@dataclass(frozen=True, eq=False)
class MethodResult:
    """A shape made in one way.

    gains: (N,), or (F, N) for frames whose mean counts. samples: number of points that the solver was given. status:
    of a solution by Pacinian. cold_ms: time of one cold solve, NaN if not measured.
    """

    gains: Complexes
    samples: int
    status: str = ""
    cold_ms: float = math.nan
