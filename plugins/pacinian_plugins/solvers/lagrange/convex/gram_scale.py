"""Size of a matrix."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Complexes


def mean_square(gram: Complexes) -> float:
    """Return ||A||^2 / R, computed from A A^H."""
    return float(np.trace(gram).real) / max(1, len(gram))
