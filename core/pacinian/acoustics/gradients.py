"""Derivatives of sound pressure and radiation pressure with respect to gains and to the positions of points.

    p_m = sum_n B_mn g_n                        (M,) [Pa]
    dp_m / dg_n = B_mn                          p is holomorphic in g: dp / dconj(g) = 0
    dp_m / dq_m = sum_n grad B_mn g_n           (M, 3) [Pa/m]
    grad B_mn = -B_mn (jk + beta + power / r) u + B_mn D'(cos(theta)) / D (n - cos(theta) u) / r

with r u = q_m - r_n, |u| = 1, n the transducer's normal and D its directivity. For a real function F of p,

    dF / dRe(g) + j dF / dIm(g) = 2 dF / dconj(g),

the direction of steepest ascent in the complex plane of g. For the amplitude |p| it is conj(B) p / |p|, and for the
radiation pressure P = alpha |p|^2 / (2 rho c^2) it is alpha conj(B) p / (rho c^2). With respect to the points,

    d|p| / dq = Re(conj(p) dp/dq) / |p|,    dP / dq = alpha Re(conj(p) dp/dq) / (rho c^2).

Source: the product and chain rules for equations (4) to (7); Wirtinger calculus, for example K. Kreutz-Delgado, The
complex gradient operator and the CR-calculus, arXiv:0906.4835.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np

from pacinian.acoustics.array import Array
from pacinian.acoustics.directivity import omni
from pacinian.acoustics.pressure import ALPHA_SKIN, radiation_pressure
from pacinian.acoustics.propagation import check_medium, field
from pacinian.argument_checks import check_kind, check_near, check_number, check_numbers
from pacinian.errors import ArgumentError
from pacinian.types import Complexes, Floats

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.types import ArrayLike

STEP = 1e-6  # step of cos(theta) for the slope of a directivity
MIN_DIVISOR = 1e-30  # smallest divisor
CHUNK = 1 << 16  # elements of B in one chunk
MAX_ELEMENTS = 1 << 27  # elements of B: 2 GiB

V = TypeVar("V", Floats, Complexes)


@dataclass(frozen=True, eq=False)
class Gradient(Generic[V]):
    """A quantity at M points, with its derivatives.

    value: (M,). by_gains: derivatives of each point's value with respect to the gains, (M, N), in the value's unit per
    unit of gain. by_points: with respect to the point's own position, (M, 3), in the value's unit per metre.
    """

    value: V
    by_gains: Complexes
    by_points: V


def differentiate_field(
    array: Array, gains: ArrayLike, points: ArrayLike, medium: Air
) -> Gradient[Complexes]:
    """Return the complex sound pressure p [Pa] at M points, with its derivatives, in double precision.

    array: N transducers. gains: (N,). points: (M, 3) [m]. medium: the air.
    Returns value: p, complex, (M,) [Pa]; by_gains: dp/dg = B, complex, (M, N) [Pa]; by_points: dp/dq, complex, (M, 3)
    [Pa/m]. p depends on g but not on its conjugate, so that p changes by B dg. Where a directivity has a kink, the
    derivative is the mean of both sides. Raises ArgumentError, PointOnTransducer.
    """
    check_kind("array", array, Array)
    check_medium(medium)
    q = check_numbers("points", points, (None, 3))
    check_near("points", q, array.centre)
    M, N = len(q), len(array)
    if M * N > MAX_ELEMENTS:
        raise ArgumentError(
            "points",
            f"and gains have {M * N} derivatives: ask for {MAX_ELEMENTS // N} points at most",
        )
    field(array, gains, q, medium)  # raises for invalid arguments
    g = np.asarray(gains, dtype=np.complex128)
    B, by_points = np.empty((M, N), np.complex128), np.empty((M, 3), np.complex128)
    rows = max(1, CHUNK // N)
    for first in range(0, M, rows):
        part = slice(first, first + rows)
        B[part], slope = compute_slope(array, q[part], medium)
        by_points[part] = slope @ g
    return Gradient(B @ g, B, by_points)


def differentiate_amplitude(
    array: Array, gains: ArrayLike, points: ArrayLike, medium: Air
) -> Gradient[Floats]:
    """Return the peak sound pressure |p| [Pa] at M points, with its derivatives, in double precision.

    array: N transducers. gains: (N,). points: (M, 3) [m]. medium: the air.
    Returns value: |p|, (M,) [Pa]; by_gains: d|p|/dRe(g) + j d|p|/dIm(g), complex, (M, N) [Pa]; by_points: d|p|/dq,
    (M, 3) [Pa/m]. To first order, a change dg changes |p| by Re(conj(by_gains) dg). Where p is 0, |p| has no
    derivative, and both are 0. Raises ArgumentError, PointOnTransducer.
    """
    found = differentiate_field(array, gains, points, medium)
    size = np.abs(found.value)
    unit = np.where(size > 0.0, found.value / np.maximum(size, MIN_DIVISOR), 0.0)
    return Gradient(size, *_chain(found, unit))


def differentiate_radiation_pressure(
    array: Array,
    gains: ArrayLike,
    points: ArrayLike,
    medium: Air,
    *,
    alpha: float = ALPHA_SKIN,
) -> Gradient[Floats]:
    """Return the radiation pressure P = alpha |p|^2 / (2 rho c^2) at M points, with its derivatives.

    array: N transducers. gains: (N,). points: (M, 3) [m]. medium: the air. alpha: about 2 on skin.
    Returns value: P, (M,) [Pa]; by_gains: dP/dRe(g) + j dP/dIm(g), complex, (M, N) [Pa]; by_points: dP/dq, (M, 3)
    [Pa/m], all in double precision. To first order, a change dg changes P by Re(conj(by_gains) dg).
    Raises ArgumentError, PointOnTransducer.
    """
    alpha = check_number("alpha", alpha, low=0.0, above=True)
    found = differentiate_field(array, gains, points, medium)
    factor = alpha / (medium.density * medium.speed_of_sound**2)  # [1/Pa]
    return Gradient(
        radiation_pressure(found.value, medium, alpha), *_chain(found, factor * found.value)
    )


def _chain(of: Gradient[Complexes], by_p: Complexes) -> tuple[Complexes, Floats]:
    """Return the derivatives of a real function F of p by gains and points. by_p: dF/dRe(p) + j dF/dIm(p), (M,)."""
    return (
        of.by_gains.conj() * by_p[:, None],
        np.asarray((of.by_points.conj() * by_p[:, None]).real),
    )


def compute_slope(array: Array, points: Floats, medium: Air) -> tuple[Complexes, Complexes]:
    """Return B, (M, N) [Pa], and its gradient with respect to the points, (M, 3, N) [Pa/m].

    points: (M, 3) [m], not on transducers. The slope of a directivity is a central difference in cos(theta).
    """
    kind = array.transducer
    d = (points[:, None, :] - array.positions).transpose(0, 2, 1)  # (M, 3, N) [m]
    r = np.maximum(np.sqrt((d * d).sum(axis=1)), MIN_DIVISOR)  # (M, N) [m]
    u = d / r[:, None]
    fading = medium.beta(kind.frequency) + 1j * medium.wavenumber(kind.frequency)  # [1/m]
    B: Complexes = kind.pressure * r**-medium.exponent * np.exp(-fading * r)
    if array.response is not None:
        B = B * array.response
    slope: Complexes = -(B * (fading + medium.exponent / r))[:, None] * u
    if kind.directivity is not omni:
        n = array.normals.T
        cosine = (u * n).sum(axis=1)  # (M, N)
        above, below = np.minimum(cosine + STEP, 1.0), np.maximum(cosine - STEP, MIN_DIVISOR)
        D = np.where(cosine > 0.0, kind.directivity(cosine), 0.0)
        rise = (kind.directivity(above) - kind.directivity(below)) / (above - below)
        rise = np.where(cosine > STEP, rise, 0.0)
        slope = D[:, None] * slope + (B * rise / r)[:, None] * (n - cosine[:, None] * u)
        B = D * B
    return B, slope
