"""Scale each group in a row of gains, also while one solution fades into the next.

A group is all samples that share one envelope; see `EnvelopeGroups`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.rendering.cached_solution import CachedSolution
    from pacinian.types import Floats, Gains, Singles

MIN_POWER = 1e-30  # smallest power used as a divisor
# regularisation, relative to total power; parts that differ by less are not separated
MIN_DIFFERENCE = 1e-6
MAX_SHARE = 4.0  # largest coefficient of a part while it fades; more is rounding


def group_amplitudes(solved: CachedSolution, t: Floats, switches: bool) -> Singles:
    """Return the factor on the sound pressure of each group at times t, (K,) [s], shape (groups, K).

    The factor is 1 if the gains already contain it. switches: whether square waves have steps.
    """
    groups = solved.groups
    if groups is None or not len(groups):
        return np.ones((1, len(t)), dtype=np.float32)
    return np.sqrt(groups.strength(t, switches)).astype(np.float32)


def mean_amplitude(solved: CachedSolution, a: Singles) -> Singles:
    """Return the power-weighted root mean square of the groups' amplitudes a, (V, K), shape (K,)."""
    if solved.parts is None:
        only: Singles = a[0]
        return only
    assert solved.groups is not None
    P = np.abs(solved.solution.sound_pressure) ** 2
    shares = np.bincount(solved.groups.index, P, len(a))
    return np.asarray(np.sqrt(shares @ a**2 / max(shares.sum(), MIN_POWER)), dtype=np.float32)


def split_by_group(solved: CachedSolution, a: Singles, s: Gains) -> tuple[Gains, Gains]:
    """Split gains s, (K, N), into the part due to the groups, scaled by their amplitudes, and the rest; both (K, N).

    a: present amplitudes of the groups, (V, K). While one solution fades into another, the coefficient of each group in
    s is found by least squares.
    """
    if solved.parts is None:
        parts, a = solved.gains[None], a[:1]  # one group, or no sample
    else:
        parts, a = solved.parts, np.vstack([a, mean_amplitude(solved, a)])
    power = parts.conj() @ parts.T
    power += np.eye(len(parts), dtype=np.complex64) * np.float32(
        MIN_DIFFERENCE * power.trace().real + MIN_POWER
    )
    c = np.linalg.solve(power, parts.conj() @ s.T)  # (V, K)
    c = (c / np.maximum(np.abs(c) / MAX_SHARE, 1.0)).astype(np.complex64)
    sound, whole = (a * c).T @ parts, c.T @ parts
    return np.asarray(sound, dtype=np.complex64), np.asarray(s - whole, dtype=np.complex64)


def find_fading(last: list[CachedSolution], now: list[CachedSolution]) -> CachedSolution | None:
    """Return the last solution if its envelope differs from that of the present one, so that it must fade out.

    None if there are several solutions for a tick, because these jump anyway.
    """
    if len(last) != 1 or len(now) != 1 or not len(last[0].samples):
        return None
    before, then = last[0].groups, now[0].groups
    if before is None or not len(before) or (then is not None and before.alike(then)):
        return None
    return last[0]
