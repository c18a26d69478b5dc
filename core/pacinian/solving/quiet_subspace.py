"""Quiet zones: the subspace to exclude from gains, so that the sound pressure in a ball stays below its limit.

`quiet_basis` finds its basis V. For all gains g without it, the sound pressure in the zones is at most
`QuietSubspace.residual` ||g||, relative to the limit, wherever the foci are. Rounding leaves a little of V in g;
`QuietSubspace.bound_excess` counts both.
"""

from __future__ import annotations

import functools
import math
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, replace
from threading import Lock
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from pacinian.acoustics.propagation import KernelData
from pacinian.native import solving as kernels
from pacinian.solving.blas import limit_blas_threads
from pacinian.solving.loudest_places import find_peak_nearby
from pacinian.solving.quiet_basis import leave_out, make_basis, make_limits, make_rows
from pacinian.solving.quiet_zone import check_zone_place

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.solving.budget import Budget
    from pacinian.solving.quiet_basis import ZoneLimit
    from pacinian.solving.quiet_zone import Zone
    from pacinian.types import Complexes, Flags, Floats, Gains

WATCHED_PLACES = 256  # number of places of a zone from whose loudest ones `measure_excess` climbs
# Number of random mixtures of V's rows. They estimate ||V g|| within a factor of SKETCH_FACTOR.
SKETCH_ROWS, SKETCH_FACTOR = 16, 2.0
# Largest ratio of the highest pressure of speckle to what `measure_excess` finds.
UNSEEN_FACTOR = 1.5
MAX_PREPARED = 4  # largest number of prepared sets of zones that are kept


@dataclass(frozen=True, eq=False)
class QuietSubspace:
    """The subspace that gains must not contain, so that zones stay quiet.

    array, medium, zones: those that it was made for; for quiet points, there are no zones. V: its basis, orthonormal
    rows, (R, N), complex64. sketch: random mixtures of V's rows, (S, N), so that ||sketch g|| is about ||V g||. limits:
    of the zones that any sound reaches. residual: largest ||c(x)|| / q, where q is the limit, or the lowest one that
    single precision keeps. watched: b(x) / q of some places of each of `limits`, (W, N).
    """

    array: Array
    medium: Air
    zones: tuple[Zone, ...]
    V: Gains
    sketch: Gains
    limits: tuple[ZoneLimit, ...]
    residual: float
    watched: tuple[Gains, ...]

    @classmethod
    def of(cls, array: Array, medium: Air, zones: tuple[Zone, ...], rms: float) -> QuietSubspace:
        """Compute the subspace of these zones, which takes 0.5 to 1 s for one unit, 4 to 15 s for nine.

        rms: largest root mean square of gains. Raises ArgumentError if a zone is far from the array or contains a
        transducer, or if the zones leave too few dimensions for gains.
        """
        wave, full = KernelData.prepare(array, medium), math.sqrt(len(array)) * rms
        for zone in zones:
            check_zone_place(zone, array, "limits.zones")
        limits = make_limits(wave, zones, full)
        V, residual = make_basis(wave, limits, full)
        watched = tuple(make_rows(wave, _watch(zone), q) for zone, q, _ in limits)
        return cls(array, medium, zones, V, _sketch(V), tuple(limits), residual, watched)

    @functools.cached_property
    def loudest(self) -> float:
        """Largest ||b(x)|| / q."""
        return max((limit.loudest for limit in self.limits), default=0.0)

    @functools.cached_property
    def raised(self) -> bool:
        """Whether a limit is lower than single precision keeps."""
        return any(q > zone.pressure for zone, q, _ in self.limits)

    @functools.cached_property
    def of_quiet_points(self) -> QuietSubspace:
        """The same subspace for rows of quiet points, which have limits of their own in a zone, too."""
        return replace(self, zones=())

    def holds(self, points: Floats) -> Flags:
        """Return whether each of `points`, (M, 3) [m], is in a zone, (M,)."""
        found = np.zeros(len(points), np.bool_)
        for zone in self.zones:
            found |= zone.holds(points)
        return found

    def leave_out(self, B: Complexes, points: Floats) -> None:
        """Remove V from the rows of B, (M, N), in place; set the rows of points in a zone to 0."""
        leave_out(self.V, B)
        B[self.holds(points)] = 0.0

    def remove(self, g: Complexes) -> None:
        """Remove V from gains, (N,), in place."""
        if len(self.V):
            g -= ((self.V @ g.astype(np.complex64)).conj() @ self.V).conj()

    def estimate_leak(self, g: Complexes) -> float:
        """Return about ||V g|| of gains, (N,), within a factor of SKETCH_FACTOR."""
        return float(np.linalg.norm(self.sketch @ g.astype(np.complex64))) if len(self.V) else 0.0

    def bound_excess(self, g: Complexes) -> float:
        """Return an upper bound of the ratio of sound pressure to q anywhere in the zones, for gains (N,)."""
        leak = SKETCH_FACTOR * self.estimate_leak(g)
        return self.residual * math.sqrt(kernels.power(g)) + self.loudest * leak

    def find_violation(self, g: Complexes) -> float:
        """Return by how much gains g, (N,), may exceed limits of zones that are too low for single precision.

        The excess is relative to the limit; 0 if there is none. Other limits are always kept, once the bound is at
        most 1.
        """
        if not self.raised:
            return 0.0
        raised = max(q / zone.pressure for zone, q, _ in self.limits)
        if raised * self.bound_excess(g) <= 1.0:
            return 0.0
        return max(0.0, UNSEEN_FACTOR * self.measure_excess(g) - 1.0)

    def measure_excess(self, g: Complexes) -> float:
        """Return the highest ratio of sound pressure to limit that is found in the zones.

        g: gains, (N,), or several, (S, N). It climbs from the loudest of WATCHED_PLACES places, for the loudest of
        several gains, which takes about a millisecond. Rounding makes speckle, whose highest peak may exceed the result
        by UNSEEN_FACTOR.
        """
        several = np.atleast_2d(np.asarray(g, np.complex64))
        found = [0.0]
        for (zone, _, _), rows in zip(self.limits, self.watched, strict=True):
            loud = np.abs(rows @ several.T)  # (K, S)
            loudest = int(loud.max(axis=0, initial=0.0).argmax())
            peak = find_peak_nearby(
                self.array, self.medium, several[loudest], zone, _watch(zone), loud[:, loudest]
            )
            found.append(peak / zone.pressure)
        return max(found)


def call_unrecorded(function: Callable[[], float]) -> float:
    """Return what a function returns; neither record it nor repeat what was recorded."""
    return function()


class Preparation:
    """Prepares the zones of a session in a background thread. All sessions share a cache of prepared zones."""

    _pool = ThreadPoolExecutor(1, "quiet zones")
    _kept: ClassVar[dict[object, Future[QuietSubspace]]] = {}
    _lock = Lock()

    def __init__(self) -> None:
        self._key: object = None
        self._made: Future[QuietSubspace] | None = None

    def get(
        self, array: Array, medium: Air, zones: tuple[Zone, ...], rms: float, budget: Budget,
        record_decision: Callable[[Callable[[], float]], float] = call_unrecorded,
    ) -> QuietSubspace | None:  # fmt: skip
        """Return the quiet subspace; None if the budget runs out first. Raises as `QuietSubspace.of`.

        record_decision: records whether it was ready in time, or repeats what was recorded: that of a `RecordingClock`.
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
            if not record_decision(lambda: float(made in wait([made], left).done)):
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


def _watch(zone: Zone) -> Floats:
    """Return the watched places of a zone, (W, 3) [m]."""
    return zone.spread(0, WATCHED_PLACES if zone.radius else 1)


def _sketch(V: Gains) -> Gains:
    """Return SKETCH_ROWS random mixtures of V's rows."""
    draw = np.random.default_rng(1).normal(
        scale=math.sqrt(0.5 / SKETCH_ROWS), size=(SKETCH_ROWS, len(V), 2)
    )
    return np.asarray(draw.view(np.complex128)[..., 0] @ V, np.complex64)
