"""The figures of a region: force, rms, holes, and the pressure beside it. The places: shapes.py."""

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

HOLE = 0.5  # fraction of the request below which a place is a hole


class Score(NamedTuple):
    """How close a pressure is to the request, over all places of a shape.

    force: sum of the result over sum of the request. rms: root mean square of the difference, over that of the
    request. scaled_rms: smallest rms after scaling the pressure by a common factor, whether or not the array could
    emit it. holes: fraction of the places with a request that get less than half of it. beside: highest pressure
    beside the shape, over the mean request; NaN if not measured.
    """

    force: float
    rms: float
    scaled_rms: float
    holes: float
    beside: float


def score(made: Floats, asked: Floats, beside: Floats) -> Score:
    """Compare pressures made, (K,), with those requested, (K,), and with those beside the shape, (J,) [Pa]."""
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
    """Compute the radiation pressure at places (..., 3) [m]; returns (...) [Pa].

    gains: (N,), or (F, N) for the mean over F frames.
    """
    frames = [radiation_pressure(field(array, g, places, AIR), AIR) for g in np.atleast_2d(gains)]
    return np.asarray(np.mean(frames, axis=0))
