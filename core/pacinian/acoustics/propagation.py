"""Equations (3) to (7): the sound pressure that an array produces at points.

    p = B g,    B_mn = s_n P0 D(theta_mn) a(|q_m - r_n|) exp(-j k |q_m - r_n|)

B: shape (M, N) [Pa], the pressure at point m per unit gain of transducer n. s_n: `Array.response`, the measured
differences between real transducers, which are compensated only here.
"""

from __future__ import annotations

import functools
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import Array
from pacinian.acoustics.directivity import omni
from pacinian.argument_checks import MAX_LENGTH, check_kind, check_numbers
from pacinian.errors import ArgumentError, PointOnTransducer

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.types import ArrayLike, Complexes, Floats, Gains, Indices, Singles

Precision = Literal["single", "double"]

# steps of cos(theta) in the kernels' directivity table; error at most 1.5e-5 for the T4010A1
DIRECTIVITY_STEPS = 1 << 16
MAX_GAIN = 1e30  # largest gain; single precision ends at 3e38
TOUCHING_DISTANCE = 1e-6  # distance within which a point is on the transducer [m]
# Distance up to which a sample, or a place between samples, counts as on a transducer and is left out [m]. The margin
# over TOUCHING_DISTANCE allows for rounding: no sample that is kept raises PointOnTransducer.
SAMPLE_TOUCHING_DISTANCE = 1e-5
CHUNK = 1 << 18  # elements of B in one chunk of the double-precision field


@dataclass(frozen=True, eq=False)
class KernelData:
    """An array and a medium in the form that the kernels need, prepared once.

    origin: the array's centre [m]. It is subtracted in double precision, so that an array a kilometre from the world's
    origin loses no precision. r, n, law, table: as in the kernels. response: of the array, (N,).
    """

    array: Array
    medium: Air
    origin: Floats
    r: Singles
    n: Singles
    law: Singles
    table: Singles
    response: Gains | None

    @classmethod
    @functools.lru_cache(maxsize=16)
    def prepare(cls, array: Array, medium: Air) -> KernelData:
        """Prepare the data for `array` in `medium`; the last 16 are cached."""
        kind = array.transducer
        origin = array.centre
        turns = medium.wavenumber(kind.frequency) / (2.0 * np.pi)
        law = [turns, medium.exponent, medium.beta(kind.frequency), kind.pressure]
        origin.flags.writeable = False
        return cls(
            array,
            medium,
            origin,
            np.ascontiguousarray((array.positions - origin).T, dtype=np.float32),
            np.ascontiguousarray(array.normals.T, dtype=np.float32),
            np.array(law, dtype=np.float32),
            _tabulate_directivity(kind.directivity),
            None if array.response is None else array.response.astype(np.complex64),
        )

    def matrix(self, points: Floats, out: Complexes, rows: Indices | None = None) -> None:
        """Write B for `points` [m], shape (M, 3), to `out`, shape (M, N), or only some of its rows.

        Uses the kernel if `out` is complex64, else the reference in double precision.
        rows: indices of the rows to write, (K,), for points of shape (K, 3). Raises PointOnTransducer if a point is on
        a transducer and the attenuation is singular.
        """
        rows = np.arange(len(points)) if rows is None else rows
        if out.dtype == np.complex64:
            from pacinian.native import acoustics as kernels

            touches = np.empty(len(points), dtype=np.float32)
            q = (points - self.origin).astype(np.float32, order="C")
            if kernels.matrix(q, self.r, self.n, self.law, self.table, rows, out, touches):
                self.refuse(touches)
            if self.response is not None:
                for row in rows:
                    out[row] *= self.response
        else:
            out[rows] = matrix(self.array, points, self.medium)

    def refuse(self, touches: Singles) -> None:
        """Raise PointOnTransducer if any point touches a transducer, (M,), and the attenuation is singular."""
        if self.medium.singular and touches.any():
            raise PointOnTransducer(np.flatnonzero(touches).tolist())


@functools.lru_cache(maxsize=16)
def _tabulate_directivity(directivity: Callable[[Floats], Floats]) -> Singles:
    """Return a directivity as the kernels' table. Raises ArgumentError."""
    if directivity is omni:
        return np.ones(1, dtype=np.float32)
    D = np.asarray(
        directivity((np.arange(DIRECTIVITY_STEPS) + 0.5) / DIRECTIVITY_STEPS), dtype=np.float64
    )
    if D.shape != (DIRECTIVITY_STEPS,) or not np.isfinite(D).all():
        raise ArgumentError("directivity", "must give one finite number for each cos(theta)")
    return np.concatenate([[0.0], D]).astype(np.float32)


def matrix(array: Array, points: ArrayLike, medium: Air) -> Complexes:
    """Return B [Pa], shape (M, N), complex128, in double precision; the reference for the kernels.

    array: N transducers. points: [m], shape (M, 3). medium: the air. Raises ArgumentError, and PointOnTransducer if the
    attenuation is singular there.
    """
    check_kind("array", array, Array)
    check_medium(medium)
    q = check_numbers("points", points, (None, 3))
    kind = array.transducer
    d = q[:, None, :] - array.positions  # (M, N, 3) [m]
    distance = np.sqrt((d * d).sum(axis=2))  # (M, N) [m]
    if medium.singular and (distance < TOUCHING_DISTANCE).any():
        raise PointOnTransducer(np.flatnonzero((distance < TOUCHING_DISTANCE).any(axis=1)).tolist())
    B: Complexes = kind.pressure * np.exp(-1j * medium.wavenumber(kind.frequency) * distance)
    if medium.exponent:
        B *= distance**-medium.exponent
    if beta := medium.beta(kind.frequency):
        B *= np.exp(-beta * distance)
    if kind.directivity is not omni:
        with np.errstate(invalid="ignore", divide="ignore"):
            cosine = np.nan_to_num(np.einsum("mnk,nk->mn", d, array.normals) / distance)
        B *= np.where(cosine > 0.0, kind.directivity(cosine), 0.0)
    if array.response is not None:
        B *= array.response
    return B


def check_medium(medium: object) -> Air:
    """Return the medium. Refuses a missing one, because another air changes all pressures. Raises ArgumentError."""
    if not isinstance(medium, Air):
        raise ArgumentError(
            "medium",
            f"must be an Air, not {medium!r}: for the gains of a solution, its `medium`; otherwise for example Air()",
        )
    return medium


def field(
    array: Array,
    gains: ArrayLike,
    points: ArrayLike,
    medium: Air,
    precision: Precision = "single",
) -> Complexes:
    """Return the complex sound pressure p = B g [Pa] at any number of points, without storing B.

    array: N transducers. gains: (N,). points: [m], shape (..., 3). medium: the air for which
    the gains were found; a solution has its own `Solution.field`.
    precision: "single" (a fused kernel on all cores, with phase errors of 6e-8 k r rad; points more than 10 m from the
    array use double precision) or "double", which takes 100 times as long.
    Returns shape (...). Raises ArgumentError, PointOnTransducer.
    """
    check_kind("array", array, Array)
    check_medium(medium)
    if precision not in ("single", "double"):
        raise ArgumentError("precision", f'must be "single" or "double", not {precision!r}')
    try:
        g = np.asarray(gains)
        if g.dtype.kind not in "iufc":
            raise TypeError(f"they are {g.dtype}")
        g = g.astype(np.complex128)
    except (TypeError, ValueError) as error:
        raise ArgumentError("gains", f"must be numbers: {error}") from None
    if g.shape != (len(array),):
        raise ArgumentError("gains", f"must have shape ({len(array)},), not {g.shape}")
    if not np.abs(g).max() < MAX_GAIN:
        raise ArgumentError("gains", f"must be finite, and below {MAX_GAIN:g}")
    try:
        given = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ArgumentError("points", f"must be numbers: {error}") from None
    if given.shape == (0,):
        given = given.reshape(0, 3)
    shape = given.shape
    if not shape or shape[-1] != 3:
        raise ArgumentError("points", f"must have shape (..., 3), not {shape}")
    q = check_numbers("points", given.reshape(-1, 3), (None, 3))
    wave = KernelData.prepare(array, medium)
    far = len(q) and np.abs(q - wave.origin).max() > MAX_LENGTH
    evaluate = _double if precision == "double" or far else _single
    return evaluate(wave, g, q).reshape(shape[:-1])


def _single(wave: KernelData, g: Complexes, points: Floats) -> Gains:
    from pacinian.native import acoustics as kernels

    q = np.ascontiguousarray(points - wave.origin, dtype=np.float32)
    g = g if wave.response is None else g * wave.response
    parts = np.ascontiguousarray([g.real, g.imag], dtype=np.float32)
    p = np.empty(len(q), dtype=np.complex64)
    touches = np.empty(len(q), dtype=np.float32)

    def part(rows: slice) -> None:
        kernels.field(q[rows], wave.r, wave.n, wave.law, wave.table, parts, p[rows], touches[rows])

    workers = min(os.cpu_count() or 1, 1 + len(q) * len(g) // CHUNK)
    if workers == 1:
        part(slice(None))
    else:
        edges = np.linspace(0, len(q), 4 * workers + 1).astype(int).tolist()
        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(part, map(slice, edges[:-1], edges[1:])))
    wave.refuse(touches)
    return p


def _double(wave: KernelData, g: Complexes, points: Floats) -> Complexes:
    rows = max(1, CHUNK // len(g))
    p = np.empty(len(points), dtype=np.complex128)
    touching: list[int] = []
    for first in range(0, len(points), rows):
        part = slice(first, first + rows)
        try:
            p[part] = matrix(wave.array, points[part], wave.medium) @ g
        except PointOnTransducer as error:
            touching += [first + index for index in error.indices]
    if touching:
        raise PointOnTransducer(touching)
    return p
