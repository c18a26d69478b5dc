"""Evaluate gains: the error of the sound pressures that they produce. Used for all packages of the benchmark."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian_lab.solvers.problems import matrix

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats

LEVELS = 256  # phase and amplitude levels of an AUTD3


@dataclass(frozen=True)
class Score:
    """The quality of gains, after clipping to |g| <= 1.

    error: ||(|p| - s t)|| / ||s t||, where s t is the multiple of the targets t that is nearest to |p|; NaN for
    silence. best_multiple: s. mean_pressure: mean of |p| over the points [Pa].
    """

    error: float
    best_multiple: float
    mean_pressure: float


def score(positions: Floats, points: Floats, targets: Floats, gains: Complexes) -> Score:
    """Evaluate gains (N,) in double precision: positions (N, 3) and points (M, 3) [m], targets (M,) [Pa]."""
    g = np.asarray(gains, dtype=np.complex128)
    g = g / np.maximum(1.0, np.abs(g))
    p = np.abs(matrix(positions, points) @ g)
    best_multiple = float(p @ targets / (targets @ targets))
    if not best_multiple > 0.0:
        return Score(math.nan, 0.0, 0.0)
    scaled_targets = best_multiple * targets
    error = float(np.linalg.norm(p - scaled_targets) / np.linalg.norm(scaled_targets))
    return Score(error, best_multiple, float(p.mean()))


def eight_bit(gains: Complexes) -> Complexes:
    """Gains (N,) rounded as AUTD3 software rounds them: to 1/256 of a turn and 1/255 of full drive."""
    phase = np.rint(np.angle(gains) * (LEVELS / (2.0 * np.pi))) % LEVELS
    amplitude = np.clip(np.rint(np.abs(gains) * (LEVELS - 1)), 0, LEVELS - 1)
    return np.asarray(amplitude / (LEVELS - 1) * np.exp(2j * np.pi / LEVELS * phase), np.complex128)
