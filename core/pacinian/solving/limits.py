"""The limits that a solution must keep: of gain, power, quiet points, exact samples and quiet zones.

limit_enforcement.py keeps them.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.argument_checks import check_kind, check_number, check_numbers
from pacinian.errors import ArgumentError
from pacinian.solving.quiet_zone import Zone

if TYPE_CHECKING:
    from pacinian.types import ArrayLike, Flags, Floats


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
