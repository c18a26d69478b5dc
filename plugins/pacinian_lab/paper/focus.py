"""The focus of the AUTD units and its width (the paper's Figure 3)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

import pacinian as pc
from pacinian.acoustics.array import UNIT

if TYPE_CHECKING:
    from pacinian.types import Floats

MEDIUM = pc.Air(speed_of_sound=340.0, density=1.2)
KIND = pc.T4010A1
FIRST_ZERO = 1.22  # first zero of a circular aperture's pattern [lambda z / diameter]
STEP = 1e-4  # [m] between samples of a profile


@dataclass(frozen=True, eq=False)
class Focus:
    """All transducers at full drive, in phase on the axis at `distance` [m].

    aperture: the boards' extent in x and y [m]. gains: (N,).
    """

    distance: float
    array: pc.Array
    aperture: tuple[float, float]
    gains: pc.Gains

    def radiation_pressure(self, x: Floats, y: Floats) -> Floats:
        """Return radiation pressure on skin [Pa] in the focal plane, at x, y [m] of the same shape."""
        return pc.radiation_pressure(self.sound_pressure(x, y), MEDIUM)

    def sound_pressure(self, x: Floats, y: Floats) -> pc.Complexes:
        """Return complex sound pressure [Pa] in the focal plane, at x, y [m] of the same shape."""
        points = np.stack([x, y, np.full_like(x, self.distance)], axis=-1)
        return pc.field(self.array, self.gains, points, MEDIUM)

    def zero(self, axis: int) -> float:
        """Return 1.22 lambda z / aperture [m] along x (0) or y (1)."""
        wavelength = MEDIUM.wavelength(KIND.frequency)
        return FIRST_ZERO * wavelength * self.distance / self.aperture[axis]


@dataclass(frozen=True)
class Width:
    """The main lobe of radiation pressure along one axis [m].

    minimum: from the peak to the first minimum. half: full width at half of the peak. *_integral: the same for a
    uniform aperture, integrated directly. formula: 1.22 lambda z / aperture.
    """

    axis: str
    aperture: float
    minimum: float
    minimum_integral: float
    formula: float
    half: float
    half_integral: float


def focus(side: int, distance: float) -> Focus:
    """Return the focus of `side` x `side` units at `distance` [m] on their axis."""
    array = pc.autd(side, side, KIND)
    solution = pc.solve(
        array, [[0.0, 0.0, distance]], [1.0], solver="single-focus", scale="max", medium=MEDIUM
    )
    return Focus(distance, array, (side * UNIT[0], side * UNIT[1]), solution.gains)


def widths(spot: Focus) -> list[Width]:
    """Return the main lobe's widths along x and y."""
    return [_width(spot, axis) for axis in (0, 1)]


def _width(spot: Focus, axis: int) -> Width:
    s = _reach(spot)
    direction = np.eye(2)[axis]
    ours = spot.radiation_pressure(s * direction[0], s * direction[1])
    integral = np.abs(aperture_integral(spot.aperture, spot.distance, s[:, None] * direction)) ** 2
    return Width(
        "xy"[axis],
        spot.aperture[axis],
        first_minimum(s, ours),
        first_minimum(s, integral),
        spot.zero(axis),
        half_width(s, ours),
        half_width(s, integral),
    )


def _reach(spot: Focus) -> Floats:
    return np.arange(0.0, 2.0 * max(spot.zero(0), spot.zero(1)), STEP)


def aperture_integral(aperture: tuple[float, float], distance: float, points: Floats) -> Floats:
    """Return |p| of a uniform rectangle focused on its axis, in any scale, shape (M,).

        p(q) = int D(theta) exp(-j k (|q - r| - |f - r|)) / |q - r| dr,   f = (0, 0, z)

    Computed without transducers or kernels, by the midpoint rule at half a wavelength. aperture: [m]. distance: z
    [m]. points: q in the focal plane, x and y [m], shape (M, 2).
    """
    half = MEDIUM.wavelength(KIND.frequency) / 2.0
    k = MEDIUM.wavenumber(KIND.frequency)
    counts = [math.ceil(side / half) for side in aperture]
    x, y = (
        ((np.arange(n) + 0.5) / n - 0.5) * side for n, side in zip(counts, aperture, strict=True)
    )
    X, Y = np.meshgrid(x, y)
    to_focus = np.sqrt(X * X + Y * Y + distance**2)  # [m]
    p = np.empty(len(points), dtype=np.complex128)
    for m, (u, v) in enumerate(points.tolist()):
        d = np.sqrt((X - u) ** 2 + (Y - v) ** 2 + distance**2)  # [m]
        p[m] = (KIND.directivity(distance / d) * np.exp(-1j * k * (d - to_focus)) / d).sum()
    return np.abs(p)


def first_minimum(s: Floats, P: Floats) -> float:
    """Return where a profile P(s) that falls from s[0] first stops falling, in the unit of s."""
    rises = np.flatnonzero(np.diff(P) >= 0.0)
    return float(s[rises[0]]) if len(rises) else math.nan


def half_width(s: Floats, P: Floats) -> float:
    """Return twice the s at which a profile P(s) that falls from s[0] = 0 first reaches half of P[0]."""
    half = 0.5 * float(P[0])
    below = int(np.argmax(half > P))
    part = slice(below - 1, below + 1)
    return 2.0 * float(np.interp(-half, -P[part], s[part]))
