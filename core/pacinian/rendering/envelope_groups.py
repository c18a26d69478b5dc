"""Groups of samples that share one envelope, and the contribution of each to the gains (voices in decision 16)."""

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
    from pacinian.types import Floats, Gains, Indices, Singles

MU = 1e-6  # regularisation of the contributions, relative to the mean square pressure at full drive


class EnvelopeGroups:
    """Groups of `samples` that have equal envelopes and techniques.

    items: one object of each group. index: group of each sample, (M,).
    """

    def __init__(self, samples: Samples) -> None:
        self.items: list[Object] = []
        self.index: Indices = np.zeros(len(samples), dtype=np.intp)
        for i in sorted(set(samples.objects.tolist())):
            group = self._group(samples.items[i])
            if group:
                self.index[samples.objects == i] = group

    def _group(self, item: Object) -> int:
        for v, other in enumerate(self.items):
            if _alike(item, other):
                return v
        self.items.append(item)
        return len(self.items) - 1

    def alike(self, other: EnvelopeGroups) -> bool:
        """Return whether both consist of the same groups in the same order."""
        return len(self) == len(other) and all(map(_alike, self.items, other.items))

    def __len__(self) -> int:
        return len(self.items)

    @cached_property
    def steady(self) -> bool:
        """Whether all strengths are constant."""
        return all(
            isinstance(item.envelope, Constant) and isinstance(item.technique, Simultaneous)
            for item in self.items
        )

    def amplitude(self, t: Floats, switches: bool = False) -> Singles:
        """Return the factor on the sound pressure of each group at times t, (K,) [s]: 0..1, (groups, K).

        switches: whether square waves have steps.
        """
        if self.steady:
            return self._constant_amplitude.repeat(len(t), axis=1)
        return np.sqrt(self._compute_strength(t, switches)).astype(np.float32)

    @cached_property
    def _constant_amplitude(self) -> Singles:
        """Amplitude of each group at all times, if it is `steady`, (groups, 1)."""
        return np.sqrt(self._constant).astype(np.float32)

    def strength(self, t: Floats, switches: bool = False) -> Floats:
        """Return the factor on the radiation pressure of each group at times t, (K,) [s]: 0..1, (groups, K).

        switches: whether square waves have steps.
        """
        if self.steady:
            return np.repeat(self._constant, len(t), axis=1)
        return self._compute_strength(t, switches)

    @cached_property
    def _constant(self) -> Floats:
        """Strength of each group at all times, if it is `steady`, (groups, 1)."""
        return self._compute_strength(np.zeros(1), switches=False)

    def _compute_strength(self, t: Floats, switches: bool) -> Floats:
        factors = np.empty((len(self.items), len(t)))
        for row, item in zip(factors, self.items, strict=True):
            envelope = resolve(item.envelope)
            square = envelope if switches and isinstance(envelope, Square) else None
            # a copy, because an envelope of the user may change it
            row[:] = envelope.at(t.copy()) if square is None else square.compute_steps(t)
            if not isinstance(item.technique, Simultaneous):
                np.multiply(row, item.technique.factor(t), out=row)
        np.fmax(factors, 0.0, out=factors)  # NaN is 0
        return np.fmin(factors, 1.0, out=factors)


def _alike(item: Object, other: Object) -> bool:
    a, b = (item.envelope, item.technique), (other.envelope, other.technique)
    return all(x is y or x == y for x, y in zip(a, b, strict=True))


def split_contributions(
    solution: Solution, propagator: Propagator, index: Indices, count: int
) -> Gains:
    """Return the contribution of each group to the gains of a solution, (groups + 1, N); their sum is the solution.

    The contribution of a group is the least-squares gains for the achieved pressures at its samples, and zero at all
    others. The last row is the remainder. index: group of each sample, (M,). count: number of groups.
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
