"""The basis V of the subspace that gains must not contain, so that zones stay quiet.

Let b(x) be the row of B for a point x, and V orthonormal rows that are excluded from gains g: V g = 0. Of b(x), this
leaves c(x) = b(x) (1 - V^H V), and the sound pressure is at most ||c(x)|| ||g|| (Cauchy-Schwarz). Gains of a focus at
the edge of a zone come near this bound, because they are nearly parallel to c(x). V is made in three steps, so that
||c(x)|| ||g|| is at most KEPT_SHARE of the limit, for the largest ||g||:

1. `_enlarge` adds the strongest directions of the loudest places, until thousands of new places are quiet. This takes
   up to twice as many rows as needed.
2. `_compress` keeps the fewest principal directions within them.
3. New places are looked at, and the loudest are climbed. If any is too loud, its direction is added.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.acoustics.directivity import omni
from pacinian.acoustics.propagation import TOUCHING_DISTANCE, KernelData
from pacinian.errors import ArgumentError
from pacinian.native import solving as kernels
from pacinian.solving.loudest_places import FIRST_STEP, climb, pick_starts

if TYPE_CHECKING:
    from pacinian.solving.quiet_zone import Zone
    from pacinian.types import Complexes, Floats, Gains

MAX_ROWS_AT_ONCE = 64  # largest number of rows added to V at a time
# Share of the limit that c(x) may make; the rest allows for places between those that are checked, and for rounding.
KEPT_SHARE = 0.75
# V is enlarged until pressures are at most this share of what c(x) may make, so that new places are quiet, too.
GROWN_SHARE = 0.4
COMPRESSED_SHARE = 0.7  # the same, for V with the fewest rows
REPAIRED_SHARE = 0.9  # the same, for places that are found later
MIN_PRESSURE_SHARE = 0.15  # V gets no rows for pressures below this share of the limit
# Rows that are weaker than this, relative to the strongest row of a block, are left to the next block.
MIN_ROW_RATIO = 1e-4
MAX_BATCHES = 17  # largest number of batches of new places for which V is enlarged
MAX_DIMENSION_SHARE = 0.8  # largest share of the N dimensions that V may take
MIN_LIMIT = 1e-5  # lowest limit that single precision keeps, relative to full drive in the zone
PLACES_PER_ROW = 3  # least number of places for each row of V before it is compressed
# Largest number of places of each kind from which to climb, and number of steps of each climb.
BASIS_MAX_CLIMBS, BASIS_CLIMB_STEPS = 8, 6
MAX_FACING = 64  # largest number of transducers whose nearest places in a zone are looked at
CHUNK_ROWS = 16  # number of rows of B computed at a time, which fit the second-level cache
UNUSABLE = "leave the array nothing to sound with: make them smaller, less quiet, or farther away"


class ZoneLimit(NamedTuple):
    """A zone, with q [Pa]: its limit, or the lowest one that single precision keeps; and the largest ||b(x)|| / q."""

    zone: Zone
    q: float
    loudest: float


def make_limits(wave: KernelData, zones: tuple[Zone, ...], full: float) -> list[ZoneLimit]:
    """Return the limits of zones that any sound reaches. full: largest ||g||. Raises ArgumentError."""
    made = []
    for zone in zones:
        places = np.concatenate([next(zone.places()), _face(wave, zone)])
        strongest = float(compute_norms(make_rows(wave, places)).max())
        if strongest:
            q = max(zone.pressure, MIN_LIMIT * full * strongest)
            made.append(ZoneLimit(zone, q, strongest / q))
    return made


def make_basis(wave: KernelData, limits: list[ZoneLimit], full: float) -> tuple[Gains, float]:
    """Return V, (R, N), and the largest ||c(x)|| / q that was found.

    full: largest ||g||. Raises ArgumentError if V takes too many dimensions.
    """
    N = len(wave.array)
    V, bound, looked = np.zeros((0, N), np.complex64), KEPT_SHARE / full, 0
    for zone, q, _ in limits:
        for k, places in enumerate(zone.places()):
            rest = make_rows(wave, places, q)
            leave_out(V, rest)
            if compute_norms(rest).max() <= bound or len(V) >= N or k >= MAX_BATCHES:
                break
            V = _enlarge(V, rest, bound, GROWN_SHARE)
            looked = max(looked, k + 1)
    V = _compress(wave, limits, V, bound)
    found = 0.0
    for zone, q, _ in limits:
        batches = zone.places()
        for _ in range(looked):
            next(batches)
        for k, places in enumerate(batches):
            if len(V) > MAX_DIMENSION_SHARE * N or k >= MAX_BATCHES:
                raise ArgumentError("limits.zones", UNUSABLE)
            rest, loud = _find_loud(wave, zone, q, places, V, bound)
            if loud <= bound:
                found = max(found, loud)
                break
            V = _enlarge(V, rest, bound, REPAIRED_SHARE)
    return V, found


def make_rows(wave: KernelData, places: Floats, unit: float = 1.0) -> Gains:
    """Return B / unit for places of a zone, from phases in double precision.

    Those of the kernels have errors of 2e-5 rad, which no basis of few rows would remove. Raises ArgumentError if a
    place is on a transducer.
    """
    B = np.empty((len(places), len(wave.array)), dtype=np.complex64)
    for first in range(0, len(places), CHUNK_ROWS):
        rows = slice(first, first + CHUNK_ROWS)
        _write_rows(wave, places[rows], unit, B[rows])
    return B


def _write_rows(wave: KernelData, places: Floats, unit: float, out: Gains) -> None:
    """Write B / unit for a few places, (K, 3) [m], to `out`, (K, N); see `matrix` for the equation."""
    array, medium, kind = wave.array, wave.medium, wave.array.transducer
    q, r, n = places - wave.origin, array.positions - wave.origin, array.normals
    squares = (q * q).sum(axis=1)[:, None] + (r * r).sum(axis=1) - 2.0 * (q @ r.T)
    distance = np.sqrt(np.maximum(squares, 0.0))  # (K, N) [m]
    if medium.singular and (distance < TOUCHING_DISTANCE).any():
        raise ArgumentError("limits.zones", UNUSABLE)
    size = np.full(distance.shape, kind.pressure / unit)
    if medium.exponent:
        size *= distance**-medium.exponent
    if beta := medium.beta(kind.frequency):
        size *= np.exp(-beta * distance)
    if kind.directivity is not omni:
        cosine = (q @ n.T - (r * n).sum(axis=1)) / np.maximum(distance, TOUCHING_DISTANCE)
        size *= np.where(cosine > 0.0, kind.directivity(cosine), 0.0)
    turns = distance * (medium.wavenumber(kind.frequency) / (2.0 * np.pi))
    turns -= np.rint(turns)
    phase, single = (-2.0 * np.pi * turns).astype(np.float32), size.astype(np.float32)
    out.real, out.imag = single * np.cos(phase), single * np.sin(phase)
    if wave.response is not None:
        out *= wave.response


def compute_norms(B: Gains) -> Floats:
    """Return the norm of each row."""
    made = np.empty(len(B))
    kernels.powers(B, made)
    return np.sqrt(made)


def leave_out(V: Gains, B: Complexes) -> None:
    """Remove V from the rows of B, (M, N), in place."""
    if len(V):
        B -= (V @ B.conj().T).conj().T @ V


def _face(wave: KernelData, zone: Zone) -> Floats:
    """Return the places of a zone that are nearest to some transducers, and those farthest along their normals."""
    array = wave.array
    some = slice(None, None, -(-len(array) // MAX_FACING))
    ahead = np.array(zone.position) + zone.radius * array.normals[some]
    return np.concatenate([zone.move_inside(array.positions[some]), zone.move_inside(ahead)])


def _find_loud(
    wave: KernelData, zone: Zone, q: float, places: Floats, V: Gains, bound: float
) -> tuple[Gains, float]:
    """Return c(x) / q at places of a zone, and its largest norm.

    If all are quiet, those to which climbs from the loudest ones lead are added.
    """

    def make_rest(at: Floats) -> Gains:
        rest = make_rows(wave, at, q)
        leave_out(V, rest)
        return rest

    def measure(at: Floats) -> Floats:
        return compute_norms(make_rest(at))

    rest, beside = make_rest(places), _face(wave, zone)
    size = compute_norms(rest)
    if (loudest := float(size.max())) > bound:
        return rest, loudest
    starts = np.concatenate(
        [
            pick_starts(places, size, BASIS_MAX_CLIMBS),
            pick_starts(beside, measure(beside), BASIS_MAX_CLIMBS),
        ]
    )
    wavelength = wave.medium.wavelength(wave.array.transducer.frequency)
    at, loud = climb(measure, zone, starts, FIRST_STEP * wavelength, BASIS_CLIMB_STEPS)
    return np.concatenate([rest, make_rest(at)]), max(loudest, float(loud.max()))


def _enlarge(V: Gains, rest: Gains, bound: float, share: float) -> Gains:
    """Return V with rows added until each row of `rest`, (K, N), has a norm of at most `share` times `bound`.

    Removes the new rows from `rest`, in place.
    """
    while True:
        size = compute_norms(rest)
        block = np.argsort(-size)[:MAX_ROWS_AT_ONCE]
        block = block[size[block] > max(share * bound, 0.1 * size[block[0]])]
        if not len(block) or len(V) >= V.shape[1]:
            return V
        X = rest[block].astype(np.complex128)
        for _ in range(2):  # twice, because of rounding
            leave_out(V, X)
        power, ways = np.linalg.eigh(X @ X.conj().T)
        least = max((MIN_PRESSURE_SHARE * bound) ** 2, MIN_ROW_RATIO * MIN_ROW_RATIO * power[-1])
        kept = power > least
        kept[: max(0, len(V) + len(block) - V.shape[1])] = False
        new = (ways[:, kept].conj().T @ X) / np.sqrt(power[kept])[:, None]
        new = new.astype(np.complex64)
        V = np.concatenate([V, new])
        leave_out(new, rest)


def _compress(wave: KernelData, limits: list[ZoneLimit], V: Gains, bound: float) -> Gains:
    """Return the fewest principal rows of V with which ||c(x)|| / q is at most COMPRESSED_SHARE times `bound`.

    The places are those for which V was made, at least PLACES_PER_ROW for each row.
    """
    R = len(V)
    if not R:
        return V
    parts, outside = [], []
    for zone, q, _ in limits:
        batches, count = zone.places(), 0
        while count < PLACES_PER_ROW * R // len(limits) + 1:
            rows = make_rows(wave, next(batches), q)
            part = rows @ V.conj().T  # (K, R)
            parts.append(part)
            leave = compute_norms(rows) ** 2 - compute_norms(part) ** 2
            outside.append(np.clip(leave, 0.0, (GROWN_SHARE * bound) ** 2))
            count += len(rows) if zone.radius else PLACES_PER_ROW * R
    A = np.concatenate(parts)
    S = np.zeros((R, R), np.complex128)
    for part in parts:
        wide = part.astype(np.complex128)
        S += wide.conj().T @ wide
    ways = np.linalg.eigh(S)[1][:, ::-1]  # strongest first
    power = np.abs(A @ ways.astype(np.complex64)).astype(np.float64) ** 2  # (K, R)
    left = np.concatenate(
        [np.cumsum(power[:, ::-1], axis=1)[:, ::-1], np.zeros((len(A), 1))], axis=1
    )
    # highest power with the first 0, 1, ... R rows
    highest = (left + np.concatenate(outside)[:, None]).max(axis=0)
    fits = highest <= (COMPRESSED_SHARE * bound) ** 2
    count = int(fits.argmax()) if fits.any() else R
    return np.asarray(ways[:, :count].conj().T @ V.astype(np.complex128), np.complex64)
