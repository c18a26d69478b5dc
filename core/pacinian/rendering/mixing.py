"""How strong each voice sounds in a row of gains, also while one solution fades into the next."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.rendering.player import Solved
    from pacinian.types import Floats, Gains, Singles

TINY = 1e-30
ALIKE = 1e-6  # of their power: parts that differ by less are not told apart
MORE = 4.0  # times a part may sound as strong as it is asked: it fades


def amplitudes(solved: Solved, t: Floats, switches: bool) -> Singles:
    """Factor on the sound pressure of each voice at times t, (K,) [s]: (voices, K); 1 where it is in the gains."""
    voices = solved.voices
    if voices is None or not len(voices):
        return np.ones((1, len(t)), dtype=np.float32)
    return np.sqrt(voices.strength(t, switches)).astype(np.float32)


def mean(solved: Solved, a: Singles) -> Singles:
    """Of the amplitudes of voices, (V,) or (V, K), by how strong each is: () or (K,)."""
    if solved.parts is None:
        return np.asarray(a[0])
    assert solved.voices is not None
    P = np.abs(solved.solution.sound_pressure) ** 2
    shares = np.bincount(solved.voices.index, P, len(a))
    return np.asarray(np.sqrt(shares @ a**2 / max(shares.sum(), TINY)), dtype=np.float32)


def voiced(solved: Solved, a: Singles, s: Gains) -> tuple[Gains, Gains]:
    """What of gains s, (N,), each voice makes, as strong as it is now; and what none of them makes.

    a: of the voices, (V,). While all fades, that is a part of what is solved: by least squares.
    """
    if solved.parts is None:
        parts, a = solved.gains[None], a[:1]  # of one voice, or of no sample
    else:
        parts, a = solved.parts, np.append(a, mean(solved, a))
    power = parts.conj() @ parts.T
    power += np.eye(len(parts), dtype=np.complex64) * np.float32(ALIKE * power.trace().real + TINY)
    c = np.linalg.solve(power, parts.conj() @ s)
    c = (c / np.maximum(np.abs(c) / MORE, 1.0)).astype(np.complex64)
    sound, all_of_it = (a * c) @ parts, c @ parts
    return np.asarray(sound, dtype=np.complex64), np.asarray(s - all_of_it, dtype=np.complex64)


def other(last: list[Solved], now: list[Solved]) -> Solved | None:
    """What sounded last, if it was with other envelopes than what sounds now; None where either jumps."""
    if len(last) != 1 or len(now) != 1 or not len(last[0].samples):
        return None
    before, then = last[0].voices, now[0].voices
    if before is None or not len(before) or (then is not None and before.alike(then)):
        return None
    return last[0]
