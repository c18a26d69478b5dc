"""The problem that a solver is given: targets, limits, budget."""

from __future__ import annotations

import functools
import math
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

import numpy as np

from pacinian.checks import number, numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.types import ArrayLike, Complexes, Flags, Floats, Reals

Scale = Literal["exact", "max"]

QUIETEST, LOUDEST = 1e-30, 1e30  # [Pa]: what single precision can work with


@dataclass(frozen=True, eq=False)
class Targets:
    """What is asked at M points.

    amplitudes: peak sound pressure [Pa], shape (M,), not negative; below 1e-30 Pa counts as 0.
    phases: [rad], shape (M,), NaN where free.
    scale: "exact" (these pressures) or "max" (as strong as the limits allow in these proportions).
    """

    amplitudes: Floats
    phases: Floats
    scale: Scale = "exact"

    @classmethod
    def checked(
        cls, count: int, amplitudes: ArrayLike, phases: ArrayLike | None, scale: str
    ) -> Targets:
        """Targets for `count` points from a caller's arguments. Raises ArgumentError."""
        t = numbers("amplitudes", amplitudes, (count,)).copy()
        if (t < 0.0).any():
            where = int(np.argmin(t))
            raise ArgumentError(
                "amplitudes", f"must be 0 or more: [{where}] is {t[where]:g}; a sign is a phase"
            )
        if (t > LOUDEST).any():
            raise ArgumentError("amplitudes", f"must be at most {LOUDEST:g} Pa")
        t[t < QUIETEST] = 0.0
        if str(scale) not in ("exact", "max"):
            raise ArgumentError("scale", f'must be "exact" or "max", not {scale!r}')
        phi = np.full(count, np.nan)
        if phases is not None:
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
        return cls(t, phi, "exact" if str(scale) == "exact" else "max")

    @functools.cached_property
    def free(self) -> Flags:
        """Where the phase is free, shape (M,)."""
        return np.isnan(self.phases)

    @functools.cached_property
    def all_free(self) -> bool:
        """Whether every phase is free."""
        return bool(self.free.all())

    def complex(self, phases: Reals) -> Complexes:
        """The targets [Pa] with `phases` [rad], shape (M,), where free."""
        angle = np.where(self.free, phases, self.phases)
        return np.asarray(self.amplitudes * np.exp(1j * angle), np.complex128)

    def miss(self, p: Complexes) -> float:
        """||asked - p|| / ||asked|| for pressures p, (M,) [Pa]; free phases are as p has them."""
        size = float(np.linalg.norm(self.amplitudes))
        if not size:
            return 0.0
        if self.all_free:
            return float(np.linalg.norm(np.abs(p) - self.amplitudes)) / size
        return float(np.linalg.norm(self.complex(np.angle(p)) - p)) / size


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What a solution must keep.

    gain: |g_n| <= gain for every transducer, 1e-6..1e6; 1 is full drive; None lifts the limit.
    power: sum |g_n|^2 <= power, kept by scaling down as a whole; None for no limit.
    quiet: ((K, 3) points [m], limit [Pa]): |p| <= limit there. exact: indices of the samples to meet exactly.
    A solver that cannot keep a limit refuses it (UnsupportedLimit) and never ignores it.
    """

    gain: float | None = 1.0
    power: float | None = None
    quiet: tuple[ArrayLike, float] | None = None
    exact: ArrayLike | None = None

    def __post_init__(self) -> None:
        for name, low, high in (("gain", 1e-6, 1e6), ("power", 1e-12, 1e12)):
            if (value := getattr(self, name)) is not None:
                object.__setattr__(self, name, number(f"limits.{name}", value, low=low, high=high))

    @property
    def asked(self) -> set[str]:
        """Names of the limits that a solver must keep by itself: the session keeps the others."""
        return {name for name in ("quiet", "exact") if getattr(self, name) is not None}


@dataclass(frozen=True)
class Budget:
    """How long a solver may go on; asked between iterations.

    due: when to stop, in seconds of `clock`; infinity for no deadline.
    """

    due: float = math.inf
    clock: Callable[[], float] = field(default=time.perf_counter, repr=False)

    @classmethod
    def until(
        cls, deadline: float | None, clock: Callable[[], float] = time.perf_counter
    ) -> Budget:
        """A budget of `deadline` seconds from now; None for no deadline."""
        if deadline is None:
            return cls(math.inf, clock)
        return cls(clock() + number("deadline", deadline, low=0.0), clock)

    @property
    def spent(self) -> bool:
        """Whether the time is up."""
        return self.due < math.inf and self.clock() >= self.due
