"""Directivities D(theta) of a transducer, as functions of cos(theta). All except `omni` are zero behind it."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.argument_checks import check_integer, check_length, check_number, check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable

    from scipy.interpolate import PchipInterpolator

    from pacinian.types import Floats

MAX_TABLE_ROWS = 10_000  # largest number of rows of a table
MAX_DIRECTIVITY = 10.0  # largest |D|: P0 is the strength on the axis
END_TOLERANCE = 0.01  # by which a table may miss pi / 2 [rad]
AXIS_TOLERANCE = 1e-3  # by which a table may miss 1 on the axis

# Nicera T4010A1, as measured for the AUTD3 software: D = A + B x + C x^2 + D x^3 on ten-degree
# segments of theta, x = theta - 10 i [deg]; -15 dB at 90 degrees.
T4010A1_CUBICS = np.array(
    [
        [1.0, 0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0, 0.0],
        [1.0, -0.00459648054721, -0.000787968093807, 1.60125528528e-05],
        [0.891250938, -0.0155520765675, -0.000307591508224, 2.9747624976e-06],
        [0.707945784, -0.0208114779827, -0.000218348633296, 2.31910931569e-05],
        [0.501187234, -0.0182211227016, 0.00047738416141, -1.1901034125e-05],
        [0.354813389, -0.0122437497109, 0.000120353137658, 6.77743734332e-06],
        [0.251188643, -0.00780345575475, 0.000323676257958, -5.99548024824e-06],
        [0.199526231, -0.00312857467007, 0.000143850511, -4.79372835035e-06],
    ]
)


def omni(cos_theta: Floats) -> Floats:
    """Return 1 for every direction, also behind (the paper's experiment). cos_theta: shape (M, N), or any."""
    return np.ones_like(cos_theta)


def t4010a1(cos_theta: Floats) -> Floats:
    """Return the directivity of the AUTD units' T4010A1; zero behind it. cos_theta: shape (M, N), or any."""
    theta = np.degrees(np.arccos(np.clip(cos_theta, 0.0, 1.0)))  # [deg]
    segment = np.clip(np.ceil(theta / 10.0).astype(np.intp) - 1, 0, 8)
    x = theta - 10.0 * segment
    A, B, C, D = np.moveaxis(T4010A1_CUBICS[segment], -1, 0)
    return np.where(cos_theta > 0.0, A + x * (B + x * (C + x * D)), 0.0)


DIRECTIVITIES = {"omni": omni, "t4010a1": t4010a1}
"""The directivities that have a name in files and on the wire."""


@dataclass(frozen=True)
class Piston:
    """A circular piston in a baffle, D = 2 J1(ka sin t) / (ka sin t); zero behind it.

    radius: a [m]. wavenumber: k [rad/m].
    """

    radius: float
    wavenumber: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", check_length("radius", self.radius))
        object.__setattr__(self, "wavenumber", check_number("wavenumber", self.wavenumber, low=0.0))

    def __call__(self, cos_theta: Floats) -> Floats:
        """Return D, with the shape of `cos_theta`."""
        from scipy.special import j1

        sine = np.sqrt(np.clip(1.0 - cos_theta**2, 0.0, 1.0))
        x = self.wavenumber * self.radius * sine
        safe = np.where(x < 1e-6, 1.0, x)
        return np.where(cos_theta > 0.0, np.where(x < 1e-6, 1.0, 2.0 * j1(safe) / safe), 0.0)


class DirectivityTable(Struct, frozen=True, forbid_unknown_fields=True):
    """A measured directivity, as a table; zero behind the transducer.

    angles: from the axis [rad], ascending from 0 to pi/2, shape (K,), K from 2 to 10,000. values: sound pressure
    relative to that on the axis, (K,): 1 first, negative in antiphase. Between the rows, D follows monotone cubics
    (F. N. Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5, 300, 1984), which do not overshoot.
    Raises ArgumentError.
    """

    angles: tuple[float, ...]
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        a = check_numbers("angles", self.angles, (None,))
        v = check_numbers("values", self.values, (None,))
        if not 2 <= len(a) <= MAX_TABLE_ROWS:
            raise ArgumentError("angles", f"must be 2 to {MAX_TABLE_ROWS}, not {len(a)}")
        if len(v) != len(a):
            raise ArgumentError("values", f"must be {len(a)}, one for each angle, not {len(v)}")
        if (np.diff(a) <= 0.0).any():
            k = int(np.argmax(np.diff(a) <= 0.0))
            raise ArgumentError("angles", f"must ascend: {a[k]:g} comes before {a[k + 1]:g}")
        if abs(a[0]) > 1e-9 or abs(a[-1] - math.pi / 2.0) > END_TOLERANCE:
            degrees = "; they are in radians: were degrees given?" if a[-1] > 2.0 else ""
            raise ArgumentError(
                "angles", f"must go from 0 to pi/2 [rad], not from {a[0]:g} to {a[-1]:g}{degrees}"
            )
        if abs(v[0] - 1.0) > AXIS_TOLERANCE:
            raise ArgumentError(
                "values",
                f"must begin with 1, on the axis, not {v[0]:g}: divide the sound pressures by that on the axis "
                "(are they in decibels? D = 10^(dB / 20))",
            )
        if (np.abs(v) > MAX_DIRECTIVITY).any():
            raise ArgumentError("values", f"must be -{MAX_DIRECTIVITY:g} to {MAX_DIRECTIVITY:g}")
        force_setattr(self, "angles", tuple(a.tolist()))
        force_setattr(self, "values", tuple(v.tolist()))

    @classmethod
    def sample(cls, directivity: Callable[[Floats], Floats], count: int = 181) -> DirectivityTable:
        """Return a table of any directivity, which unlike a Python function can be saved.

        directivity: D(cos(theta)), such as `Transducer.directivity`. count: number of angles, by default one in half
        a degree. The last value is that just before pi/2. Raises ArgumentError.
        """
        angles = np.linspace(0.0, math.pi / 2.0, check_integer("count", count, low=2))
        cosine = np.maximum(np.cos(angles), 1e-9)
        values = np.asarray(directivity(cosine), dtype=np.float64)
        return cls(tuple(angles.tolist()), tuple(values.tolist()))

    def __call__(self, cos_theta: Floats) -> Floats:
        """Return D, with the shape of `cos_theta`."""
        theta = np.arccos(np.clip(cos_theta, 0.0, 1.0))
        D = _interpolate(self)(np.minimum(theta, self.angles[-1]))
        return np.where(cos_theta > 0.0, D, 0.0)


@functools.lru_cache(maxsize=16)
def _interpolate(table: DirectivityTable) -> PchipInterpolator:
    """Return the cubics of a table, which is even in theta: its slope on the axis is 0."""
    from scipy.interpolate import PchipInterpolator

    a, v = np.array(table.angles), np.array(table.values)
    return PchipInterpolator(np.r_[-a[:0:-1], a], np.r_[v[:0:-1], v])
