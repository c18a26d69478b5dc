"""Gerchberg-Saxton on the Gram matrix (GS-PAT): quick, approximate, for phase-free targets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

import pacinian as pc
from pacinian.checks import integer
from pacinian.solving.phases import gerchberg_saxton

if TYPE_CHECKING:
    from collections.abc import Iterable


@dataclass(frozen=True)
class GsPat(pc.Solver):
    """GS-PAT (Plasencia et al., ACM Trans. Graph. 39(4), 2020): backpropagation with chosen phases.

    steps: Gerchberg-Saxton steps.

    Gains are B^H z with |z_m| = t_m^2 / |(G p)_m| at the chosen phases, scaled to the asked strength. No
    equations are solved, so neighbouring points disturb each other by some percent. Fixed phases are kept as
    targets and met as roughly as the amplitudes.
    """

    name: ClassVar[str] = "gs-pat"

    steps: int = 50

    def __post_init__(self) -> None:
        object.__setattr__(self, "steps", integer("steps", self.steps, low=1))

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
        G = propagator.gram
        start = None if warm is None else np.angle(warm.sound_pressure)
        scale = float(targets.amplitudes.max())
        p = gerchberg_saxton(G, targets, start, self.steps) / scale
        reached = np.abs(G @ p)
        z = p * (np.abs(p) / np.where(reached > 0.0, reached, 1.0))
        made = G @ z
        power = float(np.vdot(made, made).real)
        if not power:
            return pc.Result(note="no transducer reaches the points")
        z *= np.abs(np.vdot(made, p)) / power * scale  # the best multiple
        out[:] = propagator.adjoint(z)
        return pc.Result(iterations=self.steps)


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """This plug-in's solver."""
    return [GsPat]
