"""The force of a focus: the linear model beside what the paper measured."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

import pacinian as pc
from pacinian_lab.paper.focus import KIND, MEDIUM, focus

GRAM_FORCE = 9.80665e-3  # [N]
NONLINEARITY = 1.2  # 1 + B/2A of air
MEASURED = (  # units along a side, distance [m], force [gf]
    (1, 0.2, 1.6),  # the paper does not say this distance
    (3, 0.6, 7.4),
)


@dataclass(frozen=True)
class Force:
    """The force of a focus, in the linear model and as measured.

    radius: of the disc that is the main lobe, 1.22 lambda z / the aperture's shorter side [m].
    peak: sound pressure amplitude [Pa]. level: [dB re 20 uPa RMS]. top: radiation pressure [Pa].
    force, measured: [gf]. shock: how far a plane wave of the peak's strength goes to form a shock [m].
    """

    units: int
    distance: float
    radius: float
    peak: float
    level: float
    top: float
    force: float
    measured: float
    shock: float


def force(side: int, distance: float, measured: float) -> Force:
    """The force of `side` x `side` units focused at `distance` [m]; measured: [gf]."""
    spot = focus(side, distance)
    radius = max(spot.zero(0), spot.zero(1))
    step = radius / 50.0
    x = np.arange(-50.0, 51.0) * step
    X, Y = np.meshgrid(x, x)
    P = np.where(np.hypot(X, Y) <= radius, spot.radiation_pressure(X, Y), 0.0)  # [Pa]
    peak = float(np.abs(spot.sound_pressure(np.zeros(1), np.zeros(1)))[0])
    return Force(
        units=side * side,
        distance=distance,
        radius=radius,
        peak=peak,
        level=float(pc.sound_pressure_level(peak)),
        top=float(P.max()),
        force=float(P.sum()) * step**2 / GRAM_FORCE,
        measured=measured,
        shock=shock_distance(peak),
    )


def shock_distance(p: float) -> float:
    """How far a plane wave of amplitude `p` [Pa] goes to form a shock, rho c^3 / ((1 + B/2A) omega p) [m]."""
    omega = 2.0 * math.pi * KIND.frequency  # [rad/s]
    return MEDIUM.density * MEDIUM.speed_of_sound**3 / (NONLINEARITY * omega * p)


def forces() -> list[Force]:
    """The forces of the paper's two devices, beside the measured ones."""
    return [force(*row) for row in MEASURED]
