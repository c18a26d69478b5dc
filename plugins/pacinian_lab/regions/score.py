"""The figures of a region: force, rms, holes, and the pressure beside it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure
from pacinian.acoustics.propagation import field
from pacinian_lab.solvers.problems import AIR

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.types import Complexes, Floats

HOLE = 0.5  # of what was asked: less is a hole


class Score(NamedTuple):
    """How near a pressure is to what was asked, over all places of a shape.

    force: sum made over sum asked. rms: root mean square of the difference, over that of what was asked.
    scaled_rms: the least rms that any common factor on the pressure leaves, whether or not the array could make it.
    holes: share of the places where pressure is asked that get less than half of it. beside: highest pressure beside
    the shape, over the mean asked; NaN where it is not measured.
    """

    force: float
    rms: float
    scaled_rms: float
    holes: float
    beside: float


def score(made: Floats, asked: Floats, beside: Floats) -> Score:
    """Compare pressures made, (K,), with those asked, (K,), and with those beside the shape, (J,) [Pa]."""
    power = float(made @ made) * float(asked @ asked)
    alike = float(made @ asked) ** 2 / power if power else 0.0
    wanted = asked > 0.0
    return Score(
        float(made.sum() / asked.sum()),
        float(np.sqrt(((made - asked) ** 2).mean() / (asked**2).mean())),
        math.sqrt(max(0.0, 1.0 - alike)),
        float((made[wanted] < HOLE * asked[wanted]).mean()),
        float(beside.max() / asked.mean()) if len(beside) else math.nan,
    )


def evaluate_pressure(array: Array, gains: Complexes, places: Floats) -> Floats:
    """Compute radiation pressure at places (..., 3) [m], (...) [Pa].

    gains: (N,), or (F, N) for the mean over F frames.
    """
    frames = [radiation_pressure(field(array, g, places, AIR), AIR) for g in np.atleast_2d(gains)]
    return np.asarray(np.mean(frames, axis=0))
