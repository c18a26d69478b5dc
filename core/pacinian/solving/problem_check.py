"""Check the points and targets that a user gives; arrays take a fast path."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from pacinian.argument_checks import MAX_LENGTH, check_near, check_numbers, refuse_masked
from pacinian.native import solving as kernels
from pacinian.solving.targets import Targets, number_regions

if TYPE_CHECKING:
    from pacinian.types import ArrayLike, Floats


def check_problem(
    points: ArrayLike, amplitudes: ArrayLike, phases: ArrayLike | None, scale: str,
    regions: ArrayLike | None, origin: Floats,
) -> tuple[Floats, Targets]:  # fmt: skip
    """Check the arguments of `Session.solve`; return the points, (M, 3) [m], and their targets.

    origin: the array's centre, (3,) [m]. Raises ArgumentError. Arrays of free phases take a fast path.
    """
    simple = phases is None and type(scale) is str and scale == "exact"
    if simple and isinstance(points, np.ndarray) and isinstance(amplitudes, np.ndarray):
        q, t = cast("Floats", points), cast("Floats", amplitudes)
        if (
            q.dtype == t.dtype == np.float64
            and t.ndim == 1
            and q.shape == (len(t), 3)
            and q.flags.c_contiguous
            and t.flags.c_contiguous
            and kernels.furthest(q, origin, t) <= MAX_LENGTH * MAX_LENGTH
        ):
            return q, Targets.make_unchecked(t, number_regions(len(t), regions))
    q = check_numbers("points", _as_rows(points), (None, 3))
    check_near("points", q, origin)
    return q, Targets.make_checked(len(q), amplitudes, phases, scale, regions)


def _as_rows(points: ArrayLike) -> ArrayLike:
    """Return one point of shape (3,) as an array of shape (1, 3), and anything else as it is."""
    refuse_masked("points", points)
    try:
        given = np.asarray(points)
    except ValueError:  # ragged, which the caller refuses
        return points
    return given[None] if given.shape == (3,) else points
