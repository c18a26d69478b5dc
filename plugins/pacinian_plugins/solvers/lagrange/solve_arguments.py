"""The arguments of `pacinian.Solver.solve`, questions about its gains, and the note on their limit.

The solver's options, such as mu, and their defaults are in solver.py.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.solving.solution_check import measure_violations, relative_error
from pacinian.solving.solution_status import TOLERANCE

if TYPE_CHECKING:
    import pacinian as pc
    from pacinian.types import Floats

POWER_TOLERANCE = 1.0 + 1e-6  # factor on the power limit that allows for rounding


class SolveArguments(NamedTuple):
    """The arguments of `pacinian.Solver.solve`."""

    propagator: pc.Propagator
    targets: pc.Targets
    limits: pc.Limits
    warm: pc.Solution | None
    budget: pc.Budget
    out: pc.Gains

    @property
    def strongest(self) -> bool:
        """Whether the largest multiple of the targets is wanted."""
        return self.targets.scale == "max"

    @property
    def coherence(self) -> float:
        """Largest |G_ij| / sqrt(G_ii G_jj) of two points: 1 if they cannot be told apart."""
        G = np.abs(self.propagator.gram)
        scale = np.sqrt(np.maximum(G.diagonal(), np.finfo(G.dtype).tiny))
        np.fill_diagonal(G, 0.0)
        return float((G / np.outer(scale, scale)).max(initial=0.0))

    def compute_reach(self) -> Floats:
        """Return the pressure of a focus at each point, within the limits of gain and power, (M,) [Pa]."""
        B, limits = self.propagator.B, self.limits
        reach = np.full(len(B), np.inf)
        if limits.gain is not None:
            reach = limits.gain * np.abs(B).sum(axis=1, dtype=np.float64)
        if limits.power is not None:
            reach = np.minimum(reach, math.sqrt(limits.power) * np.linalg.norm(B, axis=1))
        return reach

    def has_violation(self) -> bool:
        """Return whether the gains in `out` break a limit other than the gain limit."""
        propagator, targets, limits, _, _, out = self
        full = np.inf if limits.gain is None else len(out) * limits.gain**2
        if limits.power is not None and limits.power < full:
            if self.strongest and targets.regions is None:
                return True  # the strongest under the gain limit is not the strongest under power
            power = float(np.vdot(out, out).real)
            if not power <= POWER_TOLERANCE * limits.power:
                return True
        if not limits.solver_limits:
            return False
        return bool(measure_violations(propagator, limits, targets, propagator.apply(out), out))

    def rank(self, gains: pc.Gains) -> tuple[bool, float]:
        """Return a sort key: whether gains, (N,), keep the proportions, then how strong they are [Pa]."""
        p = self.propagator.apply(gains)
        return relative_error(self.targets, p) <= TOLERANCE, float(np.linalg.norm(p))


def describe_saturation(saturated_count: int, N: int) -> str:
    """Return a note on the number of N transducers that are at their limit, or an empty text if there are none."""
    return f"{saturated_count / N:.0%} of the transducers at their limit" if saturated_count else ""
