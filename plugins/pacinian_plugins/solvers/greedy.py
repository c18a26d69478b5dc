"""Greedy search: gives one transducer after the other the phase with the least error."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from msgspec import Meta

import pacinian as pc
from pacinian.argument_checks import check_integer
from pacinian.solving.solution_metrics import AT_LIMIT
from pacinian_plugins.native.greedy import choose

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.types import Complexes, Floats, Singles

# Pressures evaluated between two checks of the clock: some milliseconds.
MAX_UNCHECKED_PRESSURES = 2_000_000
TARGET_RATIO = 0.7  # targets relative to a focus at the common drive
STRONGEST_TARGET_RATIO = 0.9  # the same for scale="max", at full drive
# Largest value of that ratio, so that single precision resolves one transducer.
MAX_TARGET_RATIO = 10.0


@dataclass(frozen=True)
class Greedy(pc.Solver):
    """The greedy method with brute-force search (Suzuki et al., IEEE Trans. Haptics 14(4), 2021).

    levels: number of phases tried per transducer. passes: maximum number of passes over the array; 1 as published,
    further passes choose each transducer's phase again, given all others. seed: of the random order of each pass.

    In random order, each transducer takes the one of `levels` phases with the least sum_m (|p_m| - t_m)^2, where
    p includes the pressures of the others, which are silent at first. (AUTD3 sums | |p_m| - t_m |, which performs
    worse.) All transducers have the same drive: a focus as strong as all targets together would need 70 % of it.
    A fixed phase counts as |p_m - t_m exp(j phi_m)|^2. Points with amplitude 0 are silenced.
    """

    name: ClassVar[str] = "greedy"
    linear: ClassVar[bool] = True
    max_uniform_points: ClassVar[float] = np.inf

    levels: Annotated[int, Meta(ge=2, le=256)] = 16
    passes: Annotated[int, Meta(ge=1, le=20)] = 3
    seed: Annotated[int, Meta(ge=0, le=2**32 - 1)] = 0

    def __post_init__(self) -> None:
        import_module("numpy.random")  # so that no solve waits for it
        for name, low in (("levels", 2), ("passes", 1), ("seed", 0)):
            object.__setattr__(self, name, check_integer(name, getattr(self, name), low=low))

    def solve(
        self,
        propagator: pc.Propagator,
        targets: pc.Targets,
        limits: pc.Limits,
        warm: pc.Solution | None,
        budget: pc.Budget,
        out: pc.Gains,
    ) -> pc.Result:
        """Write the gains; see `pacinian.Solver.solve`."""
        B = propagator.B
        M, N = B.shape
        columns = np.empty((N, 2, M), np.float32)
        columns[:, 0], columns[:, 1] = B.real.T, B.imag.T
        reach = np.sqrt(N * np.einsum("npm,npm->m", columns, columns).astype(np.float64))  # [Pa]
        t = np.where(reach > 0.0, targets.amplitudes, 0.0)
        if not t.any():
            return pc.Result(note="no transducer reaches the points")
        t, drive = _choose_drive(t, float(reach[t > 0.0].mean()), targets.scale, limits.gain)
        given = np.exp(1j * np.where(targets.free, 0.0, targets.phases))
        fixed = np.where(targets.free, 0.0, t) * given  # subtracted, so that their target becomes 0
        h = np.zeros(N, np.complex64) if warm is None else _normalise(warm.gains)
        p = B @ h - fixed
        parts = np.array([h.real, h.imag], np.float32), np.array([p.real, p.imag], np.float32)
        done, late = self._pass_over(columns, np.where(targets.free, t, 0.0), *parts, budget)
        h, p = parts[0][0] + 1j * parts[0][1], parts[1][0] + 1j * parts[1][1] + fixed
        asked = np.where(targets.free, t * np.exp(1j * np.angle(p)), fixed)
        best = complex(np.vdot(p, asked) / (np.vdot(p, p).real or 1.0))  # multiple
        top = limits.top_gain
        size = drive if targets.scale == "max" else min(drive * abs(best), top)
        out[:] = h * (best / (abs(best) or 1.0) * size)
        return pc.Result(iterations=done, limited=size >= AT_LIMIT * top, late=late)

    def _pass_over(
        self, B: Singles, t: Floats, h: Singles, p: Singles, budget: pc.Budget
    ) -> tuple[int, bool]:
        """Pass over the array until nothing changes; return the number of passes begun, and whether it is late."""
        N, _, M = B.shape
        angle = 2.0 * np.pi * np.arange(self.levels) / self.levels
        E = np.array([np.cos(angle), np.sin(angle)], np.float32)
        block = max(1, MAX_UNCHECKED_PRESSURES // (M * self.levels))
        random = np.random.default_rng(self.seed)
        for done in range(1, self.passes + 1):
            order, changed = random.permutation(N), 0
            for first in range(0, N, block):
                if first + done > 1 and budget.spent:
                    return done, True
                changed += choose(B, t.astype(np.float32), order[first : first + block], E, h, p)
            if not changed:
                return done, False
        return self.passes, False


def _choose_drive(t: Floats, reach: float, scale: str, limit: float | None) -> tuple[Floats, float]:
    """Return the targets [Pa] at a drive of 1, and the common drive of the transducers.

    reach: pressure of a focus at a drive of 1 [Pa].
    """
    need = float(np.linalg.norm(t)) / reach
    if scale == "max":
        return t * (STRONGEST_TARGET_RATIO / need), limit or 1.0
    drive = need / TARGET_RATIO if limit is None else min(limit, need / TARGET_RATIO)
    return t * (min(1.0, MAX_TARGET_RATIO * drive / need) / drive), drive


def _normalise(g: pc.Gains) -> Complexes:
    """Return g / |g|, 0 where g is 0."""
    size = np.abs(g)
    return np.asarray(g / np.where(size > 0.0, size, 1.0), np.complex64)


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """Return this plug-in's solver."""
    return [Greedy]
