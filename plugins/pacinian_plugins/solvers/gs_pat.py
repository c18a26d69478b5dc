"""Gerchberg-Saxton on the Gram matrix (GS-PAT): fast and approximate, for targets of free phase."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from msgspec import Meta

import pacinian as pc
from pacinian.argument_checks import check_integer
from pacinian.native.solving import gerchberg_saxton, limit_gains, peak
from pacinian.solving.back_propagation import NO_GRAM_MATRIX, affords_gram

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.types import Complexes

MAX_UNCHECKED_PRODUCTS = 100_000  # products between two checks of the clock
MIN_REMAINDER = 1e-6  # |R z| / |z| below which only rounding is left


@dataclass(frozen=True)
class GsPat(pc.Solver):
    """GS-PAT (Plasencia, Hirayama, Montano-Murillo & Subramanian, ACM Trans. Graph. 39(4), 2020).

    steps: number of Gerchberg-Saxton steps.

    Back-propagation is B^H D^-1, where D is the diagonal of B B^H: a focus of 1 Pa at each point. With
    R = B B^H D^-1, (M, M), it repeats z <- t exp(j arg(R z)) `steps` times, then sets z <- z t / |R z| and
    g = B^H D^-1 z. The gains are scaled as a whole to the target strength, and each gain above the limit is
    clipped (for `scale="max"`, all gains are scaled). No equations are solved, so neighbouring points disturb
    each other by some percent. Fixed phases are kept as targets and met equally roughly. Points with
    amplitude 0 get no sound, but are not silenced.
    """

    name: ClassVar[str] = "gs-pat"
    linear: ClassVar[bool] = True

    steps: Annotated[int, Meta(ge=1, le=1000)] = 50

    def __post_init__(self) -> None:
        object.__setattr__(self, "steps", check_integer("steps", self.steps, low=1))

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
        M, d = len(targets.amplitudes), propagator.powers  # diagonal of B B^H
        # with fewer transducers than points, or without time for R, multiply through the transducers instead
        hurried = not affords_gram(propagator, budget)
        tall, note = len(out) < M or hurried, NO_GRAM_MATRIX if hurried else ""
        t = np.where(d > 0.0, targets.amplitudes, 0.0)
        if not (scale := float(t.max())):
            return pc.Result(note="no transducer reaches the points")
        t /= scale  # avoids underflow and overflow
        d = np.where(d > 0.0, d, 1.0)
        R = None if tall else propagator.gram / d

        def apply_R(z: Complexes) -> Complexes:
            """Return R z."""
            return propagator.apply(propagator.adjoint(z / d)) if R is None else R @ z

        m = np.arange(M)
        start = np.pi * m * m / M if warm is None else np.angle(warm.sound_pressure)
        z: Complexes = t * np.exp(1j * np.where(targets.free, start, targets.phases))
        done, late, block = 0, False, max(1, MAX_UNCHECKED_PRODUCTS // M**2)
        while done < self.steps and not late:
            count = 1 if R is None else min(block, self.steps - done)
            if R is not None:
                gerchberg_saxton(R, targets.free, count, z)
            else:
                q = apply_R(z)
                turn = targets.free & (q != 0.0)
                z[turn] = t[turn] * np.exp(1j * np.angle(q[turn]))
            done += count
            late = done < self.steps and budget.spent
        reached = np.abs(apply_R(z))
        z *= t / np.where(reached > 0.0, reached, 1.0)
        made = apply_R(z)
        angle = np.where(targets.free, np.angle(made), targets.phases)
        power = float(np.vdot(made, made).real)
        if power <= MIN_REMAINDER**2 * float(np.vdot(z, z).real):
            return pc.Result(iterations=done, late=late, note="the targets cancel each other")
        best = np.vdot(made, t * np.exp(1j * angle)) / power
        out[:] = propagator.adjoint(z / d) * complex(best * scale)
        if limits.gain is None or targets.scale == "max":
            return pc.Result(iterations=done, late=late or hurried, note=note)
        cut = peak(out) > limits.gain**2
        limit_gains(out, 1.0, limits.gain)
        return pc.Result(iterations=done, limited=cut, late=late or hurried, note=note)


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """Return this plug-in's solver."""
    return [GsPat]
