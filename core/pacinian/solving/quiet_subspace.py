"""Quiet zones: the subspace to exclude from gains, so that the sound pressure in a ball stays below its limit.

Let b(x) be the row of B for a point x, and V orthonormal rows that are excluded from gains g: V g = 0. Of b(x), this
leaves c(x) = b(x) (1 - V^H V). Gains computed for points elsewhere are unrelated to c(x). Therefore |b(x) g| is about
||c(x)|| times the root mean square of g, rms(g), and hardly ever exceeds LIKELY times that. V is enlarged until
LIKELY ||c(x)|| rms(g) is at most the limit q at thousands of places in the zone, and then at thousands of new ones. V
has few more rows than the number of waves that the array can resolve in the zone. `enforce_zones` checks each solution
at some places and scales it down if necessary.
"""

from __future__ import annotations

import math
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from threading import Lock
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from pacinian.acoustics.propagation import KernelData
from pacinian.argument_checks import check_near
from pacinian.errors import ArgumentError, PointOnTransducer
from pacinian.native import solving as kernels
from pacinian.solving.blas import limit_blas_threads

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.solving.problem import Budget
    from pacinian.solving.quiet_zone import Zone
    from pacinian.types import Complexes, Floats, Gains

MAX_ROWS_AT_ONCE = 64  # largest number of rows added to V at a time
LIKELY = 4.0  # ratio of peak to root mean square that random pressures hardly ever exceed
WATCHED = 256  # number of places of a zone at which each solution is checked
# V is enlarged until pressures are at most this share of the limit, so that new places keep the limit.
LIMIT_SHARE = 0.5
MIN_PRESSURE_SHARE = 0.15  # V gets no rows for pressures below this share of the limit
# Rows that are weaker than this, relative to the strongest row of a block, are left to the next block.
DISTINCT = 1e-4
MAX_ROUNDS = 16  # largest number of rounds of new places
MAX_DIMENSION_SHARE = 0.8  # largest share of the N dimensions that V may take
MIN_LIMIT = 1e-5  # lowest limit that single precision keeps, relative to full drive in the zone
# Number of random mixtures of V's rows. They estimate ||V g|| within a factor of 2.
SKETCH_ROWS = 16
MAX_PREPARED = 4  # largest number of prepared sets of zones that are kept
INSIDE = "contain a transducer: make them smaller, or move them away from the array"
UNUSABLE = "leave the array nothing to sound with: make them smaller, less quiet, or farther away"


@dataclass(frozen=True, eq=False)
class QuietSubspace:
    """The subspace that gains must not contain, so that zones stay quiet.

    V: its basis, orthonormal rows, (R, N), complex64. sketch: random mixtures of V's rows, (S, N), so that ||sketch g||
    is about ||V g||. watched: b(x) / q of the places that are checked, (W, N), where q is the limit, or the lowest one
    that single precision keeps. raised: q over the limit at these places, (W,). loudest: largest ||b(x)|| / q.
    """

    zones: tuple[Zone, ...]
    V: Gains
    sketch: Gains
    watched: Gains
    raised: Floats
    loudest: float

    @classmethod
    def of(cls, array: Array, medium: Air, zones: tuple[Zone, ...], rms: float) -> QuietSubspace:
        """Compute the subspace of these zones, which takes a second, or several for large zones.

        rms: largest root mean square of gains. Raises ArgumentError if a zone contains a transducer, or if the zones
        leave too few dimensions for gains.
        """
        wave, N = KernelData.prepare(array, medium), len(array)
        check_near("limits.zones", np.array([zone.position for zone in zones]), wave.origin)
        V, loudest = np.zeros((0, N), np.complex64), 0.0
        watched: list[Gains] = []
        raised: list[Floats] = []
        for zone in zones:
            if zone.holds(array.positions).any():
                raise ArgumentError("limits.zones", INSIDE)
            for k, places in enumerate(zone.places()):
                rest = _rows(wave, places)
                strongest = float(_norms(rest).max())
                limit = max(zone.pressure, MIN_LIMIT * math.sqrt(N) * rms * strongest)
                loudest = max(loudest, strongest / limit)
                rest *= np.float32(1.0 / limit)
                some = rest[:WATCHED].copy()
                _leave_out(V, rest)
                if LIKELY * rms * _norms(rest).max() <= 1.0:
                    watched.append(some)
                    raised.append(np.full(len(some), limit / zone.pressure))
                    break
                V = _enlarge_basis(V, rest, 1.0 / (LIKELY * rms))
                if len(V) > MAX_DIMENSION_SHARE * N or k == MAX_ROUNDS:
                    raise ArgumentError("limits.zones", UNUSABLE)
        return cls(zones, V, _sketch(V), np.concatenate(watched), np.concatenate(raised), loudest)

    def heard(self, g: Complexes) -> float:
        """Return the highest ratio of sound pressure to q at the watched places, for gains (N,)."""
        return float(np.abs(self.watched @ g.astype(np.complex64)).max())

    def compute_excess(self, g: Complexes) -> float:
        """Return the highest ratio of sound pressure to limit at the watched places, for gains (N,)."""
        return float((self.raised * np.abs(self.watched @ g.astype(np.complex64))).max())

    def leave_out(self, B: Complexes, points: Floats) -> None:
        """Remove V from the rows of B, (M, N), in place; set the rows of points in a zone to 0."""
        _leave_out(self.V, B)
        for zone in self.zones:
            B[zone.holds(points)] = 0.0

    def remove(self, g: Complexes) -> None:
        """Remove V from gains, (N,), in place."""
        g -= ((self.V @ g.astype(np.complex64)).conj() @ self.V).conj()

    def over(self, array: Array, medium: Air, g: Complexes) -> float:
        """Return the highest ratio of sound pressure to limit at new places of the zones, minus 1, for gains (N,)."""
        wave, most = KernelData.prepare(array, medium), 0.0
        for zone in self.zones:
            places = zone.places()
            for _ in range(MAX_ROUNDS + 1):
                next(places)
            p = _rows(wave, next(places)) @ g.astype(np.complex64)
            most = max(most, float(np.abs(p).max()) / zone.pressure)
        return most - 1.0


def evaluate(function: Callable[[], float]) -> float:
    """Return what a function returns."""
    return function()


class Preparation:
    """Prepares the zones of a session in a background thread. All sessions share a cache of prepared zones."""

    _pool = ThreadPoolExecutor(1, "quiet zones")
    _kept: ClassVar[dict[object, Future[QuietSubspace]]] = {}
    _lock = Lock()

    def __init__(self) -> None:
        self._key: object = None
        self._made: Future[QuietSubspace] | None = None

    def nulls(
        self, array: Array, medium: Air, zones: tuple[Zone, ...], rms: float, budget: Budget,
        note: Callable[[Callable[[], float]], float] = evaluate,
    ) -> QuietSubspace | None:  # fmt: skip
        """Return the quiet subspace; None if the budget runs out first. Raises as `QuietSubspace.of`.

        note: records whether it was ready in time, or repeats what was recorded, see `RecordingClock.note`.
        """
        key = array, medium, zones, rms
        if key != self._key and self._made is not None:
            self._made.cancel()  # has an effect only if it has not begun
            self._made = None
        self._key = key
        if self._made is None or self._made.cancelled():
            self._made = self._submit(key)
        if not budget.endless:
            made, left = self._made, max(0.0, budget.due - budget.clock())
            if not note(lambda: float(made in wait([made], left).done)):
                return None
        while True:
            try:
                return self._made.result()
            except CancelledError:  # another session cancelled it
                self._made = self._submit(key)

    @classmethod
    def _submit(cls, key: tuple[Array, Air, tuple[Zone, ...], float]) -> Future[QuietSubspace]:
        with cls._lock:
            made = cls._kept.pop(key, None)
            if made is None or made.cancelled():
                made = cls._pool.submit(_make, *key)
            cls._kept[key] = made
            for old in list(cls._kept)[:-MAX_PREPARED]:
                del cls._kept[old]
            return made


def _make(array: Array, medium: Air, zones: tuple[Zone, ...], rms: float) -> QuietSubspace:
    """Compute the subspace with one BLAS thread, because another number of threads rounds otherwise."""
    with limit_blas_threads():
        return QuietSubspace.of(array, medium, zones, rms)


def _rows(wave: KernelData, places: Floats) -> Gains:
    """Return B for places of a zone. Raises ArgumentError if a place is on a transducer."""
    B = np.empty((len(places), len(wave.array)), dtype=np.complex64)
    try:
        wave.matrix(places, B)
    except PointOnTransducer:
        raise ArgumentError("limits.zones", UNUSABLE) from None
    return B


def _norms(B: Gains) -> Floats:
    """Return the norm of each row."""
    made = np.empty(len(B))
    kernels.powers(B, made)
    return np.sqrt(made)


def _sketch(V: Gains) -> Gains:
    draw = np.random.default_rng(1).normal(
        scale=math.sqrt(0.5 / SKETCH_ROWS), size=(SKETCH_ROWS, len(V), 2)
    )
    return np.asarray(draw.view(np.complex128)[..., 0] @ V, np.complex64)


def _leave_out(V: Gains, B: Complexes) -> None:
    B -= (V @ B.conj().T).conj().T @ V


def _enlarge_basis(V: Gains, rest: Gains, most: float) -> Gains:
    """Return V with rows added until each row of `rest`, (K, N), has a norm of at most LIMIT_SHARE times `most`.

    Removes the new rows from `rest`, in place.
    """
    while True:
        size = _norms(rest)
        block = np.argsort(-size)[:MAX_ROWS_AT_ONCE]
        block = block[size[block] > max(LIMIT_SHARE * most, 0.1 * size[block[0]])]
        if not len(block):
            return V
        X = rest[block].astype(np.complex128)
        for _ in range(2):  # twice, because of rounding
            _leave_out(V, X)
        power, ways = np.linalg.eigh(X @ X.conj().T)
        kept = power > max((MIN_PRESSURE_SHARE * most) ** 2, DISTINCT * DISTINCT * power[-1])
        new = (ways[:, kept].conj().T @ X) / np.sqrt(power[kept])[:, None]
        new = new.astype(np.complex64)
        V = np.concatenate([V, new])
        _leave_out(new, rest)
