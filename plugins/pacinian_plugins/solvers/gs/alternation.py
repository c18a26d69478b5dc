"""Alternating projections between points and transducers: one run of Gerchberg-Saxton steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

import pacinian as pc
from pacinian.solving.target_scaling import scale_targets
from pacinian_plugins.native.gs import iterate

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats, Singles

MIN_ABS = 1e-18  # least |x| whose square does not underflow in single precision
# limits between two checks of the clock: number of steps; steps times elements of B
MAX_UNCHECKED_STEPS, MAX_UNCHECKED_WORK = 10, 1_000_000
MAX_TARGET = 1000.0  # largest targets, as a multiple of a focus
# Share of the limit from which a transducer counts as at its limit: less than `AT_LIMIT` of other solvers, because
# the last scaling lowers gains that the steps have clipped.
NEAR_LIMIT = 0.999
CONVERGED_ERROR = 1e-4  # relative error of the amplitudes at which the weights have converged


@dataclass(frozen=True, eq=False)
class Alternation:
    """One call of `gs` or `weighted-gs`."""

    propagator: pc.Propagator
    targets: pc.Targets
    limits: pc.Limits
    warm: pc.Solution | None
    budget: pc.Budget
    out: pc.Gains

    def run(self, steps: int, floor: float, exponent: float = 0.0, hold: int = 0) -> pc.Result:
        """Take up to `steps` steps and write the gains.

        floor: least |x| in g = x / max(|x|, floor). exponent, hold: as of `WeightedGs`; hold 0 means never.
        """
        B, free = self.propagator.B, self.targets.free
        M, N = B.shape
        planes = np.empty((2, M, N), np.float32)
        planes[0], planes[1] = B.real, B.imag
        d = np.einsum("pmn,pmn->m", planes, planes).astype(np.float64)  # diagonal of B B^H [Pa^2]
        asked = (d > 0.0) & (self.targets.amplitudes > 0.0)
        if not asked.any():
            return pc.Result(note="no transducer reaches the points")
        t = np.where(asked, self.targets.amplitudes, 0.0)
        reach = float(np.sqrt(N * d[asked]).mean())  # [Pa] of a focus at full drive
        t, unit = scale_targets(t, reach, self.targets.scale, self.limits.gain, MAX_TARGET)
        m = np.arange(M)
        start = np.pi * m * m / M if self.warm is None else np.angle(self.warm.sound_pressure)
        u = np.exp(1j * np.where(free, start, self.targets.phases))
        w = np.where(asked, 1.0 / np.where(asked, d, 1.0), 0.0)
        h, p = np.zeros((2, N), np.float32), np.zeros(M, np.complex128)
        block = min(MAX_UNCHECKED_STEPS, max(1, MAX_UNCHECKED_WORK // B.size))
        done, late = 0, False
        while done < steps and not late:
            if done == hold > 0:
                free = np.zeros(M, np.bool_)
            count = min(block, (hold if done < hold else steps) - done, steps - done)
            floor = iterate(planes, t, free, exponent, floor, count, w, u, h, p)
            done += count
            if exponent and _measure_shape_error(np.abs(p[asked]), t[asked]) <= CONVERGED_ERROR:
                break
            late = done < steps and self.budget.spent
        return self._write(h, p, t, unit, done, late)

    def _write(
        self, h: Singles, p: Complexes, t: Floats, unit: float, done: int, late: bool
    ) -> pc.Result:
        """Write the gains: the multiple of h within the limit whose p is nearest to t."""
        angle = np.where(self.targets.free, np.angle(p), self.targets.phases)
        best = complex(np.vdot(p, t * np.exp(1j * angle)) / (np.vdot(p, p).real or 1.0))
        top = np.inf if self.limits.gain is None else self.limits.gain
        size = unit if self.targets.scale == "max" else min(unit * abs(best), top)
        self.out[:] = (h[0] + 1j * h[1]) * (best / (abs(best) or 1.0) * size)
        at_limit = size * float(np.hypot(h[0], h[1]).max()) >= NEAR_LIMIT * top
        return pc.Result(iterations=done, limited=at_limit, late=late)


def _measure_shape_error(p: Floats, t: Floats) -> float:
    """Return ||p - s t|| / ||s t|| for the best multiple s."""
    along = float(p @ t) / float(t @ t)
    return float(np.linalg.norm(p - along * t) / np.linalg.norm(along * t))
