"""Voices: groups of samples that share one envelope, and the contribution of each to the gains."""

from __future__ import annotations

from functools import cached_property
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

MU = 1e-6  # regularisation of the contributions, relative to the mean square pressure at full drive


class EnvelopeGroups:
    """The voices of `samples`: groups with equal envelope and technique.

    items: one object of each voice. index: voice of each sample, (M,).
    """

    def __init__(self, samples: Samples) -> None:
        self.items: list[Object] = []
        self.index: Indices = np.zeros(len(samples), dtype=np.intp)
        for i in sorted(set(samples.objects.tolist())):
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
        """Return whether both consist of one voice, and it is the same."""
        return len(self) == len(other) == 1 and _alike(self.items[0], other.items[0])

    def __len__(self) -> int:
        return len(self.items)

    @cached_property
    def steady(self) -> bool:
        """Whether all strengths are constant."""
        return all(
            isinstance(item.envelope, Constant) and isinstance(item.technique, Simultaneous)
            for item in self.items
        )

    def strength(self, t: Floats, switches: bool = False) -> Floats:
        """Return the factor on the radiation pressure of each voice at times t, (K,) [s]: 0..1, (voices, K).

        switches: whether square waves have steps.
        """
        if self.steady:
            return np.repeat(self._constant, len(t), axis=1)
        return self._compute_strength(t, switches)

    @cached_property
    def _constant(self) -> Floats:
        """Strength of each voice at all times, if it is `steady`, (voices, 1)."""
        return self._compute_strength(np.zeros(1), switches=False)

    def _compute_strength(self, t: Floats, switches: bool) -> Floats:
        factors = np.empty((len(self.items), len(t)))
        for row, item in zip(factors, self.items, strict=True):
            envelope = resolve(item.envelope)
            square = envelope if switches and isinstance(envelope, Square) else None
            factor = envelope.at(t) if square is None else square.compute_steps(t)
            row[:] = factor * item.technique.factor(t)
        return np.asarray(np.fmin(np.fmax(factors, 0.0), 1.0))  # NaN is 0


def _alike(item: Object, other: Object) -> bool:
    a, b = (item.envelope, item.technique), (other.envelope, other.technique)
    return all(x is y or x == y for x, y in zip(a, b, strict=True))


def split_contributions(
    solution: Solution, propagator: Propagator, index: Indices, count: int
) -> Gains:
    """Return the contribution of each voice to the gains of a solution, (voices + 1, N); their sum is the solution.

    The contribution of a voice is the least-squares gains for the achieved pressures at its samples, and zero at all
    others. The last row is the remainder. index: voice of each sample, (M,). count: number of voices.
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
