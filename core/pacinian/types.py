"""Array types used throughout, and their contents."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats: TypeAlias = NDArray[np.float64]
"""Real numbers in SI units."""
Reals: TypeAlias = NDArray[np.floating[Any]]
"""Real numbers of either precision."""
Singles: TypeAlias = NDArray[np.float32]
"""Real numbers for the kernels."""
Gains: TypeAlias = NDArray[np.complex64]
"""Transducer gains, shape (N,), dimensionless; 1 is full drive."""
Complexes: TypeAlias = NDArray[np.complexfloating[Any, Any]]
"""Complex numbers of either precision."""
Levels: TypeAlias = NDArray[np.uint16]
"""Device levels of phase or amplitude."""
Numbers: TypeAlias = NDArray[np.int32]
"""Integers for the kernels."""
Flags: TypeAlias = NDArray[np.bool_]
"""Booleans."""
Indices: TypeAlias = NDArray[np.intp]
"""Indices."""
Longs: TypeAlias = NDArray[np.int64]
"""Integers that serve as identifiers."""

__all__ = [
    "ArrayLike",
    "Complexes",
    "Flags",
    "Floats",
    "Gains",
    "Indices",
    "Levels",
    "Longs",
    "Numbers",
    "Reals",
    "Singles",
]
