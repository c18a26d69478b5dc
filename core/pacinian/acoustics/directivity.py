"""Directivity D(theta) of a transducer, as functions of cos(theta); all but `omni` are zero behind it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.checks import check_length, check_number

if TYPE_CHECKING:
    from pacinian.types import Floats

# Nicera T4010A1, as measured for the AUTD3 software: D = A + B x + C x^2 + D x^3 on ten-degree
# segments of theta, x = theta - 10 i [deg]; -15 dB at 90 degrees.
SEGMENTS = np.array(
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
    """1 in every direction, also behind (the paper's experiment). cos_theta: any shape (M, N)."""
    return np.ones_like(cos_theta)


def t4010a1(cos_theta: Floats) -> Floats:
    """The T4010A1 of the AUTD units; zero behind it. cos_theta: any shape (M, N)."""
    theta = np.degrees(np.arccos(np.clip(cos_theta, 0.0, 1.0)))  # [deg]
    segment = np.clip(np.ceil(theta / 10.0).astype(np.intp) - 1, 0, 8)
    x = theta - 10.0 * segment
    A, B, C, D = np.moveaxis(SEGMENTS[segment], -1, 0)
    return np.where(cos_theta > 0.0, A + x * (B + x * (C + x * D)), 0.0)


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
        """D, same shape as `cos_theta`."""
        from scipy.special import j1

        sine = np.sqrt(np.clip(1.0 - cos_theta**2, 0.0, 1.0))
        x = self.wavenumber * self.radius * sine
        safe = np.where(x < 1e-6, 1.0, x)
        return np.where(cos_theta > 0.0, np.where(x < 1e-6, 1.0, 2.0 * j1(safe) / safe), 0.0)
