"""The problem passed to a solver: targets, limits and budget."""

from __future__ import annotations

import functools
import math
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np

from pacinian.argument_checks import (
    check_kind,
    check_number,
    check_numbers,
    refuse_masked,
)
from pacinian.errors import ArgumentError
from pacinian.region_numbers import BESIDE, ISOLATED
from pacinian.solving.quiet_zone import Zone

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.types import ArrayLike, Complexes, Flags, Floats, Longs, Reals

Scale = Literal["exact", "max"]


@functools.lru_cache(maxsize=64)
def _make_free_phases(count: int) -> Floats:
    """Return phases that are all free (NaN), shape (count,)."""
    phi = np.full(count, np.nan)
    phi.flags.writeable = False
    return phi


# Range of amplitudes that single precision can handle [Pa].
MIN_AMPLITUDE, MAX_AMPLITUDE = 1e-30, 1e30


@dataclass(frozen=True, eq=False)
class Targets:
    """The targets at M points.

    amplitudes: peak sound pressures [Pa], shape (M,), not negative; values below 1e-30 Pa count as 0.
    phases: [rad], shape (M,), NaN where free.
    scale: "exact" (these pressures) or "max" (as strong as the limits allow, in these proportions).
    regions: region of each point, shape (M,): -1 for an isolated point, -2 for a point beside the regions, whose target
    is 0. None if there are no regions. When a solver receives targets with regions, the phases of each region are
    fixed to those of a single wave (`pacinian.joint_phases`).
    """

    amplitudes: Floats
    phases: Floats
    scale: Scale = "exact"
    regions: Longs | None = None

    @classmethod
    def make_checked(
        cls,
        count: int,
        amplitudes: ArrayLike,
        phases: ArrayLike | None,
        scale: str,
        regions: ArrayLike | None = None,
    ) -> Targets:
        """Make targets for `count` points from a caller's arguments. Raises ArgumentError."""
        if isinstance(amplitudes, (float, int, np.generic)) or (
            isinstance(amplitudes, np.ndarray) and not amplitudes.ndim
        ):
            amplitudes = np.full(count, check_number("amplitudes", cast("float", amplitudes)))
        t = check_numbers("amplitudes", amplitudes, (count,)).copy()
        if count and not (low := t.min()) >= 0.0:
            where = int(np.argmin(t))
            raise ArgumentError(
                "amplitudes", f"must be 0 or more: [{where}] is {low:g}; give a sign as a phase"
            )
        if count and t.max() > MAX_AMPLITUDE:
            raise ArgumentError("amplitudes", f"must be at most {MAX_AMPLITUDE:g} Pa")
        t[t < MIN_AMPLITUDE] = 0.0
        if str(scale) not in ("exact", "max"):
            raise ArgumentError("scale", f'must be "exact" or "max", not {scale!r}')
        phi = _make_free_phases(count)
        if phases is not None:
            phi = phi.copy()
            refuse_masked("phases", phases)
            try:
                given = np.asarray(phases)
                if given.dtype.kind == "c":
                    raise TypeError("complex")
                phi[:] = given.astype(np.float64)
            except (TypeError, ValueError):
                raise ArgumentError(
                    "phases", f"must be None or radians that broadcast to ({count},)"
                ) from None
            if np.isinf(phi).any():
                raise ArgumentError("phases", "must be finite, or NaN where free")
        t.flags.writeable = phi.flags.writeable = False
        number = number_regions(count, regions)
        return cls(t, phi, "exact" if str(scale) == "exact" else "max", number)

    def __post_init__(self) -> None:
        if self.regions is not None and self.amplitudes[self.beside].any():
            raise ArgumentError("amplitudes", "must be 0 at points of `regions` -2, beside regions")

    @functools.cached_property
    def norm(self) -> float:
        """||amplitudes|| [Pa]."""
        return math.sqrt(float(self.amplitudes.dot(self.amplitudes)))

    @functools.cached_property
    def free(self) -> Flags:
        """Whether each phase is free, shape (M,)."""
        return np.isnan(self.phases)

    @functools.cached_property
    def all_free(self) -> bool:
        """Whether every phase is free."""
        return bool(self.free.all())

    @classmethod
    def make_unchecked(cls, amplitudes: Floats, regions: Longs | None = None) -> Targets:
        """Make targets with free phases from checked arguments; copies `amplitudes`."""
        t, phi = amplitudes.copy(), _make_free_phases(len(amplitudes))
        t.flags.writeable = False
        return cls(t, phi, regions=regions)

    def with_phases(self, phases: Floats) -> Targets:
        """Return the same targets with all phases fixed to `phases`, (M,) [rad], unchecked; keeps the array."""
        phases.flags.writeable = False
        made = object.__new__(Targets)
        made.__dict__.update(self.__dict__, phases=phases)
        for name in ("free", "all_free"):
            made.__dict__.pop(name, None)
        return made

    @functools.cached_property
    def beside(self) -> Flags:
        """Whether each point is beside the regions, shape (M,)."""
        if self.regions is None:
            return np.zeros(len(self.amplitudes), np.bool_)
        return np.asarray(self.regions == BESIDE)

    def multiple(self, other: Targets) -> float:
        """Return the c for which these targets equal c times `other`, with equal phases; NaN if there is none."""
        t, before = self.amplitudes, other.amplitudes
        if not len(t):
            return math.nan
        if self.scale != other.scale or len(t) != len(before):
            return math.nan
        if not (self.all_free and other.all_free) and not np.array_equal(
            self.phases, other.phases, equal_nan=True
        ):
            return math.nan
        if not _are_alike(self.regions, other.regions):
            return math.nan
        k = int(before.argmax())
        c = float(t[k] / before[k]) if before[k] else math.nan
        return c if np.abs(t - c * before).max() <= 1e-12 * t[k] else math.nan

    def complex(self, phases: Reals) -> Complexes:
        """Return complex targets [Pa], shape (M,), with `phases` [rad] where the phase is free."""
        angle = phases if self.all_free else np.where(self.free, phases, self.phases)
        return np.asarray(self.amplitudes * np.exp(1j * angle), np.complex128)

    def relative_error(self, p: Complexes | Floats) -> float:
        """Return ||t - p|| / ||t|| for the complex targets t, whose free phases are those of p.

        p: sound pressures, (M,) [Pa]; if all phases are free, amplitudes suffice. Points beside regions do not count.
        """
        from pacinian.native import solving as kernels

        made: Complexes = p.astype(np.complex128, copy=False)
        if self.regions is not None:
            made = np.where(self.beside, 0.0, made)
        return float(kernels.relative_error(made, self.amplitudes, self.phases))


def number_regions(count: int, regions: ArrayLike | None) -> Longs | None:
    """Return the region of each of `count` points, (count,), renumbered from 0; None if all points are isolated.

    Raises ArgumentError.
    """
    if regions is None:
        return None
    refuse_masked("regions", regions)
    if isinstance(regions, np.ndarray) and _fits(regions, count):
        from pacinian.native import solving as kernels

        number = np.empty(count, np.int64)
        if (found := kernels.number(regions, number)) >= 0:
            number.flags.writeable = False
            return number if found else None
    try:
        given = np.asarray(regions)
    except ValueError:
        given = np.empty(0)
    if given.shape != (count,) or (count and given.dtype.kind not in "iu"):
        raise ArgumentError(
            "regions", f"must be {count} whole numbers, one for each point; -1 for an isolated one"
        )
    if count and given.dtype.kind == "i" and given.min() < BESIDE:
        where = int(given.argmin())
        raise ArgumentError(
            "regions", f"must be -2 (beside), -1 (isolated) or more: [{where}] is {given[where]}"
        )
    own = given >= 0
    if not (given != ISOLATED).any():
        return None
    number = np.where(given == BESIDE, BESIDE, ISOLATED).astype(np.int64)
    number[own] = np.unique(given[own], return_inverse=True)[1]
    number.flags.writeable = False
    return number


def _fits(regions: np.ndarray[Any, Any], count: int) -> bool:
    """Return whether the kernel can number these regions of `count` points."""
    return regions.shape == (count,) and regions.dtype == np.int64 and regions.flags.c_contiguous


def _are_alike(a: Longs | None, b: Longs | None) -> bool:
    """Return whether both arrays assign the points to the same regions."""
    return a is b or (a is not None and b is not None and np.array_equal(a, b))


@dataclass(frozen=True, kw_only=True, eq=False)
class Limits:
    """The limits that a solution must keep.

    gain: |g_n| <= gain for every transducer, 1e-6..1e6; 1 is full drive; None for no limit.
    power: sum |g_n|^2 <= power; None for no limit.
    quiet: a pair of points, (K, 3) [m], and limits [Pa], one or (K,): |p| <= limit at these points. The shadow of the
    hand is not taken into account.
    exact: the samples to meet exactly, as indices or as one flag for each sample.
    zones: `Zone`s, balls that stay quiet with any solver. They require a limit of gain or power. Each set of zones is
    prepared once, which takes 0.5 to 1 s for one unit, 4 to 15 s for nine.
    If a solver cannot keep a limit, the solve raises UnsupportedLimit; limits are never ignored. Limits that
    contradict each other or the targets result in `Status.infeasible`. Raises ArgumentError.

    Properties group the limits:

        limit   solver_limits   couples_gains   forbids_steering
        gain    no              no              no
        power   no              yes             yes
        quiet   yes             yes             yes
        exact   yes             yes             yes
        zones   no              no              yes
    """

    gain: float | None = 1.0
    power: float | None = None
    quiet: tuple[ArrayLike, ArrayLike] | None = None
    exact: ArrayLike | None = None
    zones: tuple[Zone, ...] = ()

    def __post_init__(self) -> None:
        try:
            object.__setattr__(self, "zones", tuple(self.zones))
        except TypeError:
            raise ArgumentError(
                "limits.zones", f"must be a list of Zones, not {self.zones!r}"
            ) from None
        for zone in self.zones:
            check_kind("limits.zones", zone, Zone)
        if self.zones and self.gain is None and self.power is None:
            raise ArgumentError("limits.zones", "need a limit of gain or power")
        for name, low, high in (("gain", 1e-6, 1e6), ("power", 1e-12, 1e12)):
            if (value := getattr(self, name)) is not None:
                object.__setattr__(
                    self, name, check_number(f"limits.{name}", value, low=low, high=high)
                )
        if self.quiet is not None:
            object.__setattr__(self, "quiet", _check_quiet(self.quiet))
        if self.exact is not None:
            object.__setattr__(self, "exact", _check_exact(self.exact))

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        if not isinstance(other, Limits):
            return NotImplemented
        return (
            (self.gain, self.power, self.zones) == (other.gain, other.power, other.zones)
            and _are_equal(self.quiet, other.quiet)
            and _are_equal(self.exact, other.exact)
        )

    def __hash__(self) -> int:
        return hash((self.gain, self.power, self.zones))

    @functools.cached_property
    def solver_limits(self) -> frozenset[str]:
        """Names of the limits that the solver itself must keep; the session keeps the others."""
        return frozenset(name for name in ("quiet", "exact") if getattr(self, name) is not None)

    @functools.cached_property
    def couples_gains(self) -> bool:
        """Whether a limit makes the gains for each sample depend on those for all others.

        Then gains cannot be scaled, nor combined from solutions for some of the samples each.
        """
        return self.power is not None or bool(self.solver_limits)

    @functools.cached_property
    def forbids_steering(self) -> bool:
        """Whether a solution's field must stay where it is, because the limits would not hold elsewhere."""
        return self.couples_gains or bool(self.zones)

    @property
    def top_gain(self) -> float:
        """`gain`, or infinity for no limit."""
        return math.inf if self.gain is None else self.gain

    def compute_max_rms(self, count: int) -> float:
        """Return the largest root mean square that `count` gains can have under these limits."""
        power = math.inf if self.power is None else math.sqrt(self.power / count)
        return min(self.top_gain, power)

    def make_exact_mask(self, count: int) -> Flags:
        """Return a flag for each of `count` samples: whether to meet it exactly, (count,). Raises ArgumentError."""
        flags = np.zeros(count, dtype=np.bool_)
        if self.exact is None:
            return flags
        given = np.asarray(self.exact)
        if given.dtype.kind == "b" and given.shape == (count,):
            return given.astype(np.bool_)
        within = given.dtype.kind in "iu" and given.ndim == 1
        if given.size and not (within and given.min() >= -count and given.max() < count):
            raise ArgumentError("limits.exact", f"must be indices below {count}, or {count} flags")
        flags[given.astype(np.intp)] = True
        return flags


def _are_equal(a: ArrayLike | tuple[ArrayLike, ...] | None, b: Any) -> bool:
    """Return whether two limits, or pairs of arrays, are equal."""
    if a is None or b is None:
        return a is b
    if isinstance(a, tuple):
        return all(map(_are_equal, a, b))
    a, b = np.asarray(a), np.asarray(b)
    return a.dtype == b.dtype and np.array_equal(a, b)  # True is not index 1


def _check_exact(given: ArrayLike) -> np.ndarray[Any, Any]:
    """Check and copy the indices or flags of exact samples."""
    try:
        chosen = np.array(given)
    except ValueError:
        chosen = np.array("")
    if chosen.ndim != 1 or (chosen.size and chosen.dtype.kind not in "biu"):
        raise ArgumentError("limits.exact", "must be a list of indices, or a flag for each sample")
    chosen.flags.writeable = False
    return chosen


def _check_quiet(given: tuple[ArrayLike, ArrayLike]) -> tuple[Floats, Floats]:
    """Check and copy quiet points, (K, 3) [m], and their limits, (K,) [Pa]."""
    try:
        where, limit = given
    except (TypeError, ValueError):
        raise ArgumentError("limits.quiet", "must be a pair: points [m] and a limit [Pa]") from None
    points = check_numbers("limits.quiet[0]", where, (None, 3)).copy()
    try:
        pressures = np.broadcast_to(np.asarray(limit, dtype=np.float64), (len(points),)).copy()
    except (TypeError, ValueError):
        raise ArgumentError(
            "limits.quiet[1]", f"must be one limit [Pa] or {len(points)} of them"
        ) from None
    if not (np.isfinite(pressures) & (pressures >= 0.0)).all():
        raise ArgumentError("limits.quiet[1]", "must be 0 or more [Pa]")
    points.flags.writeable = pressures.flags.writeable = False
    return points, pressures


def _never_cancel() -> bool:
    """Return False: nothing cancels the solve."""
    return False


@dataclass(frozen=True)
class Budget:
    """The time budget of a solver, which checks it between iterations.

    due: when to stop, as a reading of `clock` [s]; infinity for no deadline. is_cancelled: returns whether to stop
    at once, because nobody needs the result any more.
    """

    due: float = math.inf
    clock: Callable[[], float] = field(default=time.perf_counter, repr=False)
    is_cancelled: Callable[[], bool] = field(default=_never_cancel, repr=False)

    @classmethod
    def until(
        cls, deadline: float | None, clock: Callable[[], float] = time.perf_counter
    ) -> Budget:
        """Make a budget that ends `deadline` seconds from now; None for no deadline."""
        if deadline is None:
            return cls(math.inf, clock)
        return cls(clock() + check_number("deadline", deadline, low=0.0), clock)

    @property
    def endless(self) -> bool:
        """Whether there is no deadline."""
        return self.due == math.inf

    @property
    def spent(self) -> bool:
        """Whether the time is up, or the solve is cancelled."""
        return (self.due < math.inf and self.clock() >= self.due) or self.is_cancelled()

    def affords(self, seconds: float) -> bool:
        """Return whether a step of `seconds` would end before the deadline."""
        return self.due == math.inf or self.clock() + seconds <= self.due
