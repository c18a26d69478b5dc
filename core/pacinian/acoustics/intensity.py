"""Acoustic intensity, and radiation pressure along the skin's normal, in double precision.

    I = Re(p v*) / 2,    v = j grad(p) / (rho omega)

p: complex sound pressure, with time dependence exp(j omega t). v: particle velocity, by Euler's equation.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.gradients import compute_slope
from pacinian.acoustics.pressure import radiation_pressure
from pacinian.acoustics.propagation import field, matrix
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.argument_checks import check_kind, check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike, Complexes, Floats

CHUNK = 1 << 16  # elements of B in one chunk


def intensity(
    array: Array,
    gains: ArrayLike,
    points: ArrayLike,
    medium: Air,
    facing: SkinFacing | None = None,
) -> Floats:
    """Return the active intensity I at M points, (M, 3) [W/m^2]: the direction and density of the energy flow.

    array: N transducers. gains: (N,). points: (M, 3) [m]. medium: the air. facing: of the points, if they
    are on skin; then only sound counts that arrives on the skin's outward side and that the hand does not block.
    Raises ArgumentError, PointOnTransducer.
    """
    g, q = _check_arguments(array, gains, points, medium, facing)
    omega = 2.0 * math.pi * array.transducer.frequency  # [rad/s]
    flow = np.empty((len(q), 3))
    for part in _parts(len(q), len(g)):
        B, slope = compute_slope(array, q[part], medium)
        if facing is not None:
            s = facing.only(part).compute_arrival(q[part], array.positions)
            B, slope = s * B, s[:, None] * slope
        v = 1j * (slope @ g) / (medium.density * omega)  # (M, 3) [m/s]
        flow[part] = ((B @ g)[:, None] * v.conj()).real / 2.0
    return flow


def normal_pressure(
    array: Array,
    gains: ArrayLike,
    points: ArrayLike,
    facing: SkinFacing,
    medium: Air,
) -> Floats:
    """Return the radiation pressure along the normals of skin, (M,) [Pa]; 2 E cos^2(theta) for a plane wave.

    array: N transducers. gains: (N,). points: (M, 3) [m]. facing: of the points. medium: the air.
    Raises ArgumentError, PointOnTransducer.
    """
    g, q = _check_arguments(array, gains, points, medium, facing)
    p = np.empty(len(q), dtype=np.complex128)
    for part in _parts(len(q), len(g)):
        w = facing.only(part).weights(q[part], array.positions)
        p[part] = (w * matrix(array, q[part], medium)) @ g
    return radiation_pressure(p, medium)


def _check_arguments(
    array: Array, gains: ArrayLike, points: ArrayLike, medium: Air, facing: SkinFacing | None
) -> tuple[Complexes, Floats]:
    """Check and return gains, (N,), and points, (M, 3)."""
    q = check_numbers("points", points, (None, 3))
    field(array, gains, q, medium)  # raises for invalid arguments
    if facing is not None:
        check_kind("facing", facing, SkinFacing)
        if len(facing) != len(q):
            raise ArgumentError("facing", f"must have {len(q)} normals, as many as points")
    return np.asarray(gains, dtype=np.complex128), q


def _parts(M: int, N: int) -> Iterator[slice]:
    rows = max(1, CHUNK // N)
    return (slice(first, first + rows) for first in range(0, M, rows))
