"""Present the samples of an object as its technique requires: all of them, a focus on a path, or a lateral movement."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.scene.modulation import stm_paths
from pacinian.scene.modulation.tangent_plane import find_tangents
from pacinian.scene.modulation.technique import LM, PLACES, STM, SWING

if TYPE_CHECKING:
    from pacinian.scene.modulation.technique import Technique
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Floats

MAX_CACHED = 128  # largest number of cached motions of sets of samples
WORLD = np.eye(3)

SamplesAtStep = Callable[[int], "Samples"]
"""Returns the samples that sound at a step."""

_cache: dict[tuple[int, int, bytes], tuple[Samples, Technique, SamplesAtStep]] = {}


def present(technique: Technique, samples: Samples, t: float, frame: Floats = WORLD) -> Samples:
    """Return the samples of one object that sound at t [s]: the same object for the same step.

    frame: the object's axes as columns, (3, 3). Directions in tangent planes are measured from its x-axis.
    """
    step = technique.step(t)
    if step is None or not len(samples) or not isinstance(technique, (STM, LM)):
        return samples
    key = id(samples), id(technique), frame.tobytes()
    cached = _cache.get(key)
    if cached is None:
        while len(_cache) >= MAX_CACHED:
            del _cache[next(iter(_cache))]
        move = (
            _move_focus(technique, samples, frame)
            if isinstance(technique, STM)
            else _swing(technique, samples, frame)
        )
        motion = functools.lru_cache(PLACES)(move)
        # holds all, so that their ids stay unique
        cached = _cache[key] = (samples, technique, motion)
    return cached[2](step)


def _move_focus(technique: STM, samples: Samples, frame: Floats) -> SamplesAtStep:
    if technique.along == "samples":
        route = stm_paths.visit_one_by_one(samples)
    elif technique.along == "outline":
        route = stm_paths.visit_around(samples, frame)
    else:
        route = stm_paths.visit_along(samples, technique.along, frame)
    n = technique.places
    return lambda i: route(i, n)


def _swing(technique: LM, samples: Samples, frame: Floats) -> SamplesAtStep:
    d = technique.amplitude * find_tangents(samples.normals, technique.angle, frame)
    return lambda i: replace(samples, positions=samples.positions + i / SWING * d)
