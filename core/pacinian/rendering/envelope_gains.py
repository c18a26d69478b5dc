"""Apply envelopes to rows of gains, also while the output moves from one solution to the next.

A group is all samples that share one envelope; see `EnvelopeGroups`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.rendering.cached_solution import CachedSolution
    from pacinian.types import Complexes, Floats, Gains, Indices, Singles

MIN_POWER = 1e-30  # smallest power used as a divisor
# Regularisation of the least squares in `mix`, relative to the total power of all parts. Parts that differ by less are
# not separated.
MIN_DIFFERENCE = 1e-6
MAX_COEFFICIENT = 4.0  # largest amplitude of the coefficient of a part; anything more is rounding
MAX_PAST = 8  # largest number of past solutions; beyond it, the two oldest are merged


def group_amplitudes(solved: CachedSolution, t: Floats, switches: bool) -> Singles:
    """Return the factor on the sound pressure of each group at times t, (K,) [s], shape (groups, K).

    The factor is 1 if the gains already contain it. switches: whether square waves have steps.
    """
    groups = solved.groups
    if groups is None or not len(groups):
        return np.ones((1, len(t)), dtype=np.float32)
    return groups.amplitude(t, switches)


def mean_amplitude(solved: CachedSolution, a: Singles) -> Singles:
    """Return the power-weighted root mean square of the groups' amplitudes a, (V, K), shape (K,)."""
    if solved.contributions is None:
        only: Singles = a[0]
        return only
    assert solved.groups is not None
    P = np.abs(solved.solution.sound_pressure) ** 2
    shares = np.bincount(solved.groups.index, P, len(a))
    return np.asarray(np.sqrt(shares @ a**2 / max(shares.sum(), MIN_POWER)), dtype=np.float32)


class Source:
    """One of the solutions of which rows of gains s, (K, N), consist.

    share: the solution's share of each row, (K,). parts: contributions of its groups, (V, N). a: amplitude of each in
    each row, (V, K). mean: their mean, (K,). expected: coefficient of each in each row by its share, (V, K).
    """

    def __init__(
        self, solved: CachedSolution, share: Floats, t: Floats, s: Gains, switches: bool
    ) -> None:
        a = group_amplitudes(solved, t, switches)
        self.mean = mean_amplitude(solved, a)
        if solved.contributions is None:
            self.contributions, self.a = solved.gains[None], a[:1]  # one group, or no sample
        else:
            self.contributions, self.a = solved.contributions, np.vstack([a, self.mean])
        self.share = share
        g = solved.gains
        turn = share * (s @ g.conj()) / max(float(np.vdot(g, g).real), MIN_POWER)
        self.expected: Complexes = np.broadcast_to(turn, self.a.shape)


def mix(sources: Sequence[Source], s: Gains) -> Gains:
    """Return the gains s, (K, N), under the envelopes of the solutions that they consist of.

    sources: the present solution, then past ones. The coefficient of each part in s is found by least squares. Where
    parts of two solutions are too similar to separate, the expected coefficient is used. What no part explains is
    multiplied by the mean amplitude of all solutions, weighted by their shares.
    """
    # similar parts need double precision, or rounding decides
    exact = any(one.share.any() for one in sources[1:])
    parts = np.concatenate([one.contributions for one in sources])
    parts = parts.astype(np.complex128 if exact else np.complex64, copy=False)
    c = np.concatenate([one.expected for one in sources]).astype(parts.dtype)  # (V, K)
    power = parts.conj() @ parts.T
    power += np.eye(len(parts), dtype=parts.dtype) * parts.dtype.type(
        MIN_DIFFERENCE * power.trace().real + MIN_POWER
    )
    c = c + np.linalg.solve(power, parts.conj() @ (s - c.T @ parts).T)
    c /= np.maximum(np.abs(c) / MAX_COEFFICIENT, 1.0)
    a = np.concatenate([one.a for one in sources])
    rest = s - c.T @ parts
    mean = sum((one.share * one.mean for one in sources), np.zeros(len(s))).astype(np.float32)
    return np.asarray((a * c).T @ parts + mean[:, None] * rest, dtype=np.complex64)


class EnvelopeFade:
    """Past solutions whose envelopes still count.

    While gains move from one solution to another, least squares shows how much of each they contain. It cannot show
    this if only the envelope of an object has changed. Therefore each past solution also has an expected share of the
    gains. The share falls from row to row, no faster than gains may change.
    """

    def __init__(self) -> None:
        self._present: Sequence[CachedSolution] = ()
        # each with its share of the last row
        self._past: list[tuple[Sequence[CachedSolution], float]] = []
        self._step = 1.0  # fall of a share from row to row

    def __bool__(self) -> bool:
        """Whether the share of a past solution still falls."""
        return self._step > 0.0 and any(share > 0.0 for _, share in self._past)

    def begin(self, solved: Sequence[CachedSolution], step: float) -> None:
        """Fade to these solutions from the next row on, if they are not the present ones.

        solved: one, or the frames of a cycle. step: fall of a share from row to row.
        """
        if solved == self._present:
            return
        self._past = [(past, share) for past, share in self._past if share > 0.0]
        match _compare_envelopes(self._present, solved):
            case "new_envelopes":
                self._past.append((self._present, 1.0 - sum(share for _, share in self._past)))
            case "same_envelopes":
                # least squares shows how much of the old solution the gains still contain
                self._past.append((self._present, 0.0))
            case "nothing_to_fade":
                pass
        if len(self._past) > MAX_PAST:
            (_, first), (past, share), *later = self._past
            self._past = [(past, first + share), *later]
        self._present = solved
        # silence has no envelope, so a solution that fades out keeps its own
        self._step = step if len(solved[0].samples) else 0.0

    @property
    def cycles(self) -> bool:
        """Whether a past solution had several frames, so that each row has a frame of its own."""
        return any(len(past) > 1 for past, _ in self._past)

    def end(self) -> None:
        """Let only the present solutions count."""
        self._past = []

    def reset(self) -> None:
        """Forget all solutions."""
        self._present, self._past = (), []

    def shares(self, number: int, rows: slice) -> list[tuple[CachedSolution, Floats]]:
        """Return past solutions with their shares of rows of the next tick.

        number: of the first row, which tells the frame of a cycle.
        """
        if not self._past:
            return []
        n = np.arange(rows.start, rows.stop, rows.step) + 1
        return [
            (past[number % len(past)], share)
            for (past, _), share in zip(self._past, self._fall(n), strict=True)
        ]

    def advance(self, rows: int) -> None:
        """Go on by this number of rows."""
        if not self._past:
            return
        last = self._fall(np.array([rows]))
        self._past = [(past, float(s[0])) for (past, _), s in zip(self._past, last, strict=True)]

    def _fall(self, n: Indices) -> list[Floats]:
        """Return the share of each past solution after n rows, (K,): the first ones fall first."""
        shares = np.array([share for _, share in self._past])
        left = shares.cumsum()[:, None] - self._step * n
        return list(np.clip(left, 0.0, shares[:, None]))


def _compare_envelopes(
    last: Sequence[CachedSolution], now: Sequence[CachedSolution]
) -> Literal["new_envelopes", "same_envelopes", "nothing_to_fade"]:
    """Return whether the last solutions still count, and why.

    "new_envelopes": their envelopes fade out. "same_envelopes": several groups have the same envelopes as before, but
    other contributions to the gains. "nothing_to_fade": there is nothing to tell apart, or the solutions are frames of
    a cycle with several groups, which jump anyway.
    """
    if not last or not len(last[0].samples):
        return "nothing_to_fade"
    before, then = last[0].groups, now[0].groups
    single = len(last) == len(now) == 1
    if before is None:  # these gains contain their envelopes
        return "new_envelopes" if then and single else "nothing_to_fade"
    if not len(before):
        return "nothing_to_fade"
    if then is not None and before.alike(then):
        return "same_envelopes" if single and len(before) > 1 else "nothing_to_fade"
    one_each = len(before) == 1 and then is not None and len(then) <= 1
    return "new_envelopes" if single or one_each else "nothing_to_fade"
