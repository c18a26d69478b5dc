"""Quantities of a field that can be drawn: radiation pressure, sound pressure, level and phase."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure, sound_pressure_level
from pacinian.acoustics.propagation import field
from pacinian.errors import ArgumentError, PointOnTransducer
from pacinian.plot.style import CYCLIC, MAP

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike, Complexes, Flags, Floats

Show = Literal["radiation", "pressure", "level", "phase"]

LEVEL_RANGE = 40.0  # range of levels drawn below the loudest [dB]


@dataclass(frozen=True)
class Quantity:
    """Style of a quantity. label: with unit. colours: name of a colour map. marks: colour of marks on it."""

    label: str
    colours: str = MAP
    marks: str = "white"


QUANTITIES: dict[str, Quantity] = {
    "radiation": Quantity("radiation pressure on skin [Pa]"),
    "pressure": Quantity("sound pressure, peak [Pa]"),
    "level": Quantity("sound pressure level [dB re 20 µPa]"),
    "phase": Quantity("phase [rad]", CYCLIC, "#f0e442"),
}


def compute_quantity(
    array: Array, gains: ArrayLike, points: Floats, medium: Air, show: str
) -> Floats:
    """Return a quantity at points (..., 3) [m], (...); NaN on transducers.

    gains: (N,), or (K, N) for the mean power over K moments. Raises ArgumentError.
    """
    if show not in (*QUANTITIES,):
        raise ArgumentError("show", f"must be one of {', '.join(QUANTITIES)}, not {show!r}")
    moments = np.atleast_2d(gains)
    if not len(moments):
        raise ArgumentError("gains", "must be of one moment at least")
    if show == "phase" and len(moments) != 1:
        raise ArgumentError("show", "must not be the phase of several moments: it has no mean")
    p = np.stack([compute_field(array, g, points, medium) for g in moments])
    if show == "phase":
        return np.asarray(np.angle(p[0]))
    power = np.asarray((p.real.astype(np.float64) ** 2 + p.imag**2).mean(axis=0))
    if show == "radiation":
        return radiation_pressure(np.sqrt(power), medium)
    return np.sqrt(power) if show == "pressure" else sound_pressure_level(np.sqrt(power))


def compute_field(array: Array, gains: ArrayLike, points: Floats, medium: Air) -> Complexes:
    """Return the complex sound pressure [Pa] at points (..., 3) [m], (...); NaN on transducers."""
    try:
        return field(array, gains, points, medium)
    except PointOnTransducer as error:
        kept = np.ones(points.shape[:-1], dtype=np.bool_)
        kept.ravel()[list(error.indices)] = False
        p = np.full(kept.shape, np.nan, dtype=np.complex64)
        p[kept] = field(array, gains, points[kept], medium)
        return p


def compute_colour_limits(found: Floats, counted: Flags, show: str) -> tuple[float, float]:
    """Return the ends of the colour scale. counted: which values count, of the shape of `found`."""
    if show == "phase":
        return -np.pi, np.pi
    known = found[counted & np.isfinite(found)]
    most = float(known.max(initial=-np.inf))
    if show == "level":
        return (most - LEVEL_RANGE, most) if np.isfinite(most) else (0.0, LEVEL_RANGE)
    return 0.0, most if most > 0.0 else 1.0


def find_distant_points(array: Array, points: Floats, medium: Air) -> Flags:
    """Return which points (..., 3) [m] are more than a wavelength away from all transducers, (...).

    Closer to a point source, the field diverges and would dim everything else.
    """
    from scipy.spatial import KDTree

    wavelength = medium.wavelength(array.transducer.frequency)
    near = KDTree(array.positions).query(points, distance_upper_bound=wavelength)[0]
    return np.isinf(near)
