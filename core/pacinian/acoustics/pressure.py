"""Equation (1): convert sound pressure to radiation pressure and back. No other module does this conversion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.argument_checks import check_kind, check_number
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.types import ArrayLike, Floats

ALPHA_SKIN = 2.0  # alpha for skin, or any liquid or solid, which reflect nearly all of the sound
REFERENCE_PRESSURE = 20e-6  # RMS sound pressure at a sound pressure level of 0 dB [Pa]


def radiation_pressure(p: ArrayLike, medium: Air, alpha: float = ALPHA_SKIN) -> Floats:
    """Return the radiation pressure P = alpha p_rms^2 / (rho c^2) [Pa], the paper's equation (1).

    p: sound pressure, complex or peak amplitude [Pa], any shape; p_rms = |p| / sqrt(2).
    medium: provides rho and c. alpha: about 2 on skin. Returns the shape of `p`.
    Raises ArgumentError.
    """
    check_kind("medium", medium, Air)
    alpha = check_number("alpha", alpha, low=0.0, above=True)
    rms2 = _amplitude(p) ** 2 / 2.0  # [Pa^2]
    return np.asarray(alpha * rms2 / (medium.density * medium.speed_of_sound**2))


def sound_pressure(radiation_pressure: ArrayLike, medium: Air, alpha: float = ALPHA_SKIN) -> Floats:
    """Return the peak sound pressure amplitude |p| [Pa] for a radiation pressure; the inverse of equation (1).

    radiation_pressure: [Pa], not negative, any shape. medium: provides rho and c. alpha: about 2 on skin.
    Returns the shape of `radiation_pressure`. Raises ArgumentError.
    """
    check_kind("medium", medium, Air)
    alpha = check_number("alpha", alpha, low=0.0, above=True)
    try:
        P = np.asarray(radiation_pressure, dtype=np.float64)
    except (TypeError, ValueError):
        raise ArgumentError("radiation_pressure", "must be numbers") from None
    if not (P >= 0.0).all():
        raise ArgumentError("radiation_pressure", "must be 0 or more: sound only pushes")
    return np.asarray(np.sqrt(2.0 * P * medium.density * medium.speed_of_sound**2 / alpha))


def sound_pressure_level(p: ArrayLike) -> Floats:
    """Return the sound pressure level [dB re 20 uPa RMS]; -inf for silence. p: complex or peak amplitude [Pa]."""
    with np.errstate(divide="ignore"):
        return np.asarray(20.0 * np.log10(_amplitude(p) / np.sqrt(2.0) / REFERENCE_PRESSURE))


def _amplitude(p: ArrayLike) -> Floats:
    amplitude = np.asarray(p)
    if amplitude.dtype.kind not in "biufc":
        raise ArgumentError("p", f"must be numbers, not {amplitude.dtype}")
    return np.asarray(np.abs(amplitude), dtype=np.float64)
