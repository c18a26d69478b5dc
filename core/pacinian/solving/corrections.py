"""Correct the amplitudes that are asked for in regions, where the regularisation leaves pressure missing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats

# Largest number of further solves that make up for the pressure missing after the first solve for regions.
MAX_CORRECTIONS = 2
# A correction is kept if it reduces the error to at most this share.
MAX_ERROR_RATIO = 0.98
MAX_CORRECTION = 2.0  # largest ratio between a corrected amplitude and its target, either way


def correct_amplitudes(asked: Floats, t: Floats, p: Complexes) -> Floats:
    """Return what to ask for instead of `asked` if that gave the pressures p, while t is wanted, (M,) [Pa].

    The regularisation leaves pressure missing in one place, and too much in another. So ask for more or less there:
    asked_m t_m / |p_m|, within [t_m / 2, 2 t_m].
    """
    made = np.maximum(np.abs(p), t / MAX_CORRECTION**2)
    share = np.divide(t, made, out=np.ones_like(t), where=made > 0.0)
    return np.asarray(np.clip(asked * share, t / MAX_CORRECTION, MAX_CORRECTION * t))
