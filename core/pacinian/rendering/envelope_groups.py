"""Voices: samples that share one amplitude over time, and what each contributes to the gains."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from pacinian.scene.modulation.envelope import resolve
from pacinian.scene.modulation.technique import Simultaneous
from pacinian.scene.modulation.waves import Constant, Square

if TYPE_CHECKING:
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.samples import Samples
    from pacinian.solving.propagator import Propagator
    from pacinian.solving.solution import Solution
    from pacinian.types import Floats, Gains, Indices

MU = 1e-6  # of the mean square pressure at full drive: the regularisation of the contributions


class EnvelopeGroups:
    """The distinct amplitudes of `samples`.

    items: one object for each. index: which voice each sample has, (M,).
    """

    def __init__(self, samples: Samples) -> None:
        self.items: list[Object] = []
        self.index: Indices = np.zeros(len(samples), dtype=np.intp)
        for i in np.unique(samples.objects).tolist():
            voice = self._voice(samples.items[i])
            if voice:
                self.index[samples.objects == i] = voice

    def _voice(self, item: Object) -> int:
        for v, other in enumerate(self.items):
            if _alike(item, other):
                return v
        self.items.append(item)
        return len(self.items) - 1

    def alike(self, other: EnvelopeGroups) -> bool:
        """Whether both are one and the same voice."""
        return len(self) == len(other) == 1 and _alike(self.items[0], other.items[0])

    def __len__(self) -> int:
        return len(self.items)

    @property
    def steady(self) -> bool:
        """Whether no strength ever changes."""
        return all(
            isinstance(item.envelope, Constant) and isinstance(item.technique, Simultaneous)
            for item in self.items
        )

    def strength(self, t: Floats, switches: bool = False) -> Floats:
        """Factor on the radiation pressure of each voice at times t [s], (voices, K), in 0..1.

        switches: whether squares have steps.
        """
        factors = np.empty((len(self.items), len(t)))
        for row, item in zip(factors, self.items, strict=True):
            envelope = resolve(item.envelope)
            square = envelope if switches and isinstance(envelope, Square) else None
            factor = envelope.at(t) if square is None else square.switched(t)
            row[:] = factor * item.technique.factor(t)
        return np.asarray(np.fmin(np.fmax(factors, 0.0), 1.0))  # NaN is 0


def _alike(item: Object, other: Object) -> bool:
    return item.envelope == other.envelope and item.technique == other.technique


def split_contributions(
    solution: Solution, propagator: Propagator, index: Indices, count: int
) -> Gains:
    """What each voice adds to the gains of a solution, (voices + 1, N), so that their sum is the solution.

    The least-squares gains for the pressures that were achieved at the samples of that voice, and zero at
    all others; the last row is what is left of the solution. index: voice of each sample, (M,).
    """
    p = solution.sound_pressure
    mu = solution.mu if solution.mu > 0.0 else MU * propagator.power
    P = np.zeros((len(p), count), dtype=np.complex128)
    P[np.arange(len(p)), index] = p
    factor = propagator.factor(mu)
    y = factor.solve(P) if factor.definite else P / max(propagator.power, 1e-300)
    parts = np.empty((count + 1, len(solution.gains)), dtype=np.complex64)
    for v in range(count):
        parts[v] = propagator.adjoint(np.ascontiguousarray(y[:, v]))
    parts[count] = solution.gains - parts[:count].sum(axis=0)
    return cast("Gains", parts)
