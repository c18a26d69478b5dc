"""Quiet zones: what gains may not contain, so that nowhere in a ball the sound pressure exceeds its limit.

Let b(x) be the row of B for a point x, and V orthonormal rows that are left out of gains g: V g = 0. What is left of
b(x) is c(x) = b(x) (1 - V^H V). Gains that are made for points elsewhere know nothing of c(x): |b(x) g| is then about
||c(x)|| times their root mean square, and hardly ever LIKELY times as much. V is enlarged until that is at most the
limit q at thousands of places of the zone, and at thousands of fresh ones after that. It has not many more rows than
waves that the array can tell apart in the zone. Each solution is checked at some places, and turned down if need be.
"""

from __future__ import annotations

import math
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from dataclasses import dataclass
from threading import Lock
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from pacinian.acoustics.propagation import KernelData
from pacinian.checks import check_near
from pacinian.errors import ArgumentError, PointOnTransducer
from pacinian.native import solving as kernels

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.solving.problem import Budget
    from pacinian.solving.propagator import Propagator
    from pacinian.solving.quiet_zone import Zone
    from pacinian.types import Complexes, Floats, Gains

BLOCK = 64  # rows that V gets at a time, at most
LIKELY = 4.0  # times the root mean square of pressures at random: hardly any is more
WATCHED = 256  # places of a zone at which each solution is checked
SPARE = 1.25  # times as much as there, it may be at others
ENOUGH = 0.5  # of the limit, where V is enlarged: so that fresh points keep the limit itself
FAINT = 0.15  # of the limit: V gets no row for what is fainter
DISTINCT = 1e-4  # of a block's strongest row: fainter ones wait for the next block
ROUNDS = 16  # of fresh points, at most
LARGEST_SHARE = 0.8  # of all dimensions that zones may take
MIN_LIMIT = 1e-5  # of what full drive makes in a zone: single precision keeps no lower limit
REPAIRS = 32  # times that gains are shortened, and freed of V again
SOFT = 0.1  # of the mean power of rows: with what regularisation pressures are corrected
LEFT = 0.02  # of a limit: what gains may still make of V
ROUNDING = 2e-6  # of ||g||: what single precision leaves of V
SKETCHED = 16  # random mixtures of V's rows, which tell within a factor of 2 what gains hold of V
MAX_PREPARED = 4  # sets of zones that stay prepared
UNUSABLE = "leave the array nothing to sound with: make them smaller, less quiet, or farther away"


@dataclass(frozen=True, eq=False)
class QuietSubspace:
    """What gains may not contain for zones to be quiet.

    V: (R, N), orthonormal rows, complex64. sketch: mixtures of them, (S, N), by which ||sketch g|| is about ||V g||.
    watched: b(x) / q of some places, (W, N). loudest: ||b(x)|| / q of all places.
    """

    zones: tuple[Zone, ...]
    V: Gains
    sketch: Gains
    watched: Gains
    loudest: float

    @classmethod
    def of(cls, array: Array, medium: Air, zones: tuple[Zone, ...], rms: float) -> QuietSubspace:
        """Those of an array's zones; rms: of gains, at most. They take a second, large ones several.

        Raises ArgumentError for zones that hold a transducer, or leave the array nothing to sound with.
        """
        wave, N = KernelData.prepare(array, medium), len(array)
        check_near("limits.zones", np.array([zone.position for zone in zones]), wave.origin)
        V, loudest = np.zeros((0, N), np.complex64), 0.0
        watched: list[Gains] = []
        for zone in zones:
            if zone.holds(array.positions).any():
                raise ArgumentError("limits.zones", UNUSABLE)
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
                    break
                V = _enlarged(V, rest, 1.0 / (LIKELY * rms))
                if len(V) > LARGEST_SHARE * N or k == ROUNDS:
                    raise ArgumentError("limits.zones", UNUSABLE)
        return cls(zones, V, _sketch(V), np.concatenate(watched), loudest)

    def heard(self, g: Complexes) -> float:
        """The highest sound pressure that gains, (N,), make at the places that are watched, over its limit."""
        return float(np.abs(self.watched @ g.astype(np.complex64)).max())

    def leave_out(self, B: Complexes, points: Floats) -> None:
        """Make of rows B, (M, N), in place, what they are of gains without V; nothing where points are in a zone."""
        _leave_out(self.V, B)
        for zone in self.zones:
            B[zone.holds(points)] = 0.0

    def keep(
        self, g: Complexes, gain: float | None, propagator: Propagator, budget: Budget
    ) -> None:
        """Free gains, (N,), in place, of V, and turn them down until zones are quiet; none is longer than `gain` then.

        They are shortened, and moved to the nearest that have no V and make the same pressures, by turns (projections
        onto convex sets), then scaled down as a whole. propagator: of the samples.
        """
        made = propagator.apply(g)
        top = math.inf if gain is None else gain * (1.0 - 2.0**-21)
        for turn in range(REPAIRS):
            left = float(np.linalg.norm(self.sketch @ g.astype(np.complex64)))
            most = LEFT / self.loudest + ROUNDING * math.sqrt(kernels.power(g))
            if (left <= most and math.sqrt(kernels.peak(g)) <= top) or (turn and budget.spent):
                break
            kernels.restrain(g, 1.0, top)
            self._free(g)
            factor = propagator.factor(SOFT * propagator.power)
            if factor.definite:
                g += propagator.adjoint(factor.solve(made - propagator.apply(g)))
        if not math.isfinite(kernels.peak(g)):
            g[:] = 0.0
        over = max(1.0, SPARE * self.heard(g), math.sqrt(kernels.peak(g)) / top)
        if over > 1.0:
            g /= over
            kernels.restrain(g, 1.0, top)

    def _free(self, g: Complexes) -> None:
        g -= ((self.V @ g.astype(np.complex64)).conj() @ self.V).conj()

    def over(self, array: Array, medium: Air, g: Complexes) -> float:
        """The highest sound pressure that gains, (N,), make at fresh places of the zones, over its limit, less 1."""
        wave, most = KernelData.prepare(array, medium), 0.0
        for zone in self.zones:
            places = zone.places()
            for _ in range(ROUNDS + 1):
                next(places)
            p = _rows(wave, next(places)) @ g.astype(np.complex64)
            most = max(most, float(np.abs(p).max()) / zone.pressure)
        return most - 1.0


class Preparation:
    """Zones of a session, prepared beside it; and of all sessions, those that were prepared last are kept."""

    _pool = ThreadPoolExecutor(1, "quiet zones")
    _kept: ClassVar[dict[object, Future[QuietSubspace]]] = {}
    _lock = Lock()

    def __init__(self) -> None:
        self._key: object = None
        self._made: Future[QuietSubspace] | None = None

    def nulls(
        self, array: Array, medium: Air, zones: tuple[Zone, ...], rms: float, budget: Budget
    ) -> QuietSubspace | None:
        """The quiet subspace; None if the budget is spent before it is known. Raises as `QuietSubspace.of`."""
        key = array, medium, zones, rms
        if key != self._key or self._made is None:
            if self._made is not None:
                self._made.cancel()  # where it has not begun: it would be late
            self._key, self._made = key, self._begun(key)
        left = None if budget.endless else max(0.0, budget.due - budget.clock())
        try:
            return self._made.result(left)
        except TimeoutError:
            return None
        except CancelledError:  # by another session, which wants others now
            self._made = None
            return self.nulls(array, medium, zones, rms, budget)

    @classmethod
    def _begun(cls, key: tuple[Array, Air, tuple[Zone, ...], float]) -> Future[QuietSubspace]:
        with cls._lock:
            made = cls._kept.pop(key, None)
            if made is None or made.cancelled():
                made = cls._pool.submit(QuietSubspace.of, *key)
            cls._kept[key] = made
            for old in list(cls._kept)[:-MAX_PREPARED]:
                del cls._kept[old]
            return made


def _rows(wave: KernelData, places: Floats) -> Gains:
    """B for places of a zone. Raises ArgumentError where one is on a transducer."""
    B = np.empty((len(places), len(wave.array)), dtype=np.complex64)
    try:
        wave.matrix(places, B)
    except PointOnTransducer:
        raise ArgumentError("limits.zones", UNUSABLE) from None
    return B


def _norms(B: Gains) -> Floats:
    """Of each row."""
    made = np.empty(len(B))
    kernels.powers(B, made)
    return np.sqrt(made)


def _sketch(V: Gains) -> Gains:
    draw = np.random.default_rng(1).normal(
        scale=math.sqrt(0.5 / SKETCHED), size=(SKETCHED, len(V), 2)
    )
    return np.asarray(draw.view(np.complex128)[..., 0] @ V, np.complex64)


def _leave_out(V: Gains, B: Complexes) -> None:
    B -= (V @ B.conj().T).conj().T @ V


def _enlarged(V: Gains, rest: Gains, most: float) -> Gains:
    """V with rows that leave at most ENOUGH of `most` of each row of `rest`, (K, N), which is worked on."""
    while True:
        size = _norms(rest)
        block = np.argsort(-size)[:BLOCK]
        block = block[size[block] > max(ENOUGH * most, 0.1 * size[block[0]])]
        if not len(block):
            return V
        X = rest[block].astype(np.complex128)
        for _ in range(2):  # what rounding has left of V
            _leave_out(V, X)
        power, ways = np.linalg.eigh(X @ X.conj().T)
        kept = power > max((FAINT * most) ** 2, DISTINCT * DISTINCT * power[-1])
        new = (ways[:, kept].conj().T @ X) / np.sqrt(power[kept])[:, None]
        new = new.astype(np.complex64)
        V = np.concatenate([V, new])
        _leave_out(new, rest)
