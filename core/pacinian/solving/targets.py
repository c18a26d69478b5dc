"""The targets of a solve: amplitudes and phases at points, and the regions of the points."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np

from pacinian.argument_checks import check_number, check_numbers, refuse_masked
from pacinian.errors import ArgumentError
from pacinian.region_numbers import BESIDE, ISOLATED

if TYPE_CHECKING:
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
