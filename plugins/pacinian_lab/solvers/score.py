"""The one evaluator of all contestants: from gains to the error of the sound pressures they make."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian_lab.solvers.problems import matrix

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats

LEVELS = 256  # phases and amplitudes of an AUTD3


@dataclass(frozen=True)
class Score:
    """What gains achieve, after clipping to |g| <= 1.

    error: ||(|p| - s t)|| / ||s t||, s being the best multiple of the targets; NaN for silence.
    scale: s. mean_pressure: of |p| over the points [Pa].
    """

    error: float
    scale: float
    mean_pressure: float


def score(positions: Floats, points: Floats, targets: Floats, gains: Complexes) -> Score:
    """Evaluate gains (N,) in double precision: positions (N, 3) and points (M, 3) [m], targets (M,) [Pa]."""
    g = np.asarray(gains, dtype=np.complex128)
    g = g / np.maximum(1.0, np.abs(g))
    p = np.abs(matrix(positions, points) @ g)
    scale = float(p @ targets / (targets @ targets))
    if not scale > 0.0:
        return Score(math.nan, 0.0, 0.0)
    wanted = scale * targets
    error = float(np.linalg.norm(p - wanted) / np.linalg.norm(wanted))
    return Score(error, scale, float(p.mean()))


def eight_bit(gains: Complexes) -> Complexes:
    """Gains (N,) rounded as AUTD3 software rounds them: to 1/256 of a turn and 1/255 of full drive."""
    phase = np.rint(np.angle(gains) * (LEVELS / (2.0 * np.pi))) % LEVELS
    amplitude = np.clip(np.rint(np.abs(gains) * (LEVELS - 1)), 0, LEVELS - 1)
    return np.asarray(amplitude / (LEVELS - 1) * np.exp(2j * np.pi / LEVELS * phase), np.complex128)
