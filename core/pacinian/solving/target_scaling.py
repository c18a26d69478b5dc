"""Scales targets for iterative solvers: neither far below full drive, nor too far out of reach."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Floats

MAX_DRIVE = 10.0  # largest gain that a solver may use, as a multiple of what a focus needs


def scale_targets(
    t: Floats, reach: float, scale: str, limit: float | None, max_target: float
) -> tuple[Floats, float]:
    """Return the targets, (M,) [Pa], at gains of one unit, and this unit [gain].

    t: amplitudes, (M,) [Pa], not all 0. reach: pressure of a focus at gain 1 [Pa]. scale: "exact", or "max" for targets
    as strong as a focus at the limit. limit: of the gain; None if there is none. max_target: largest norm of the scaled
    targets, as a multiple of `reach`.
    """
    need = float(np.linalg.norm(t)) / reach
    if scale == "max":
        return t / need, limit or 1.0
    unit = MAX_DRIVE * need if limit is None else min(limit, MAX_DRIVE * need)
    return t * (min(1.0, max_target * unit / need) / unit), unit
