"""What an array can do at a place: how finely it resolves, and how well it sees skin."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.resolution import focal_area, resolution
from pacinian.checks import FAR
from pacinian.errors import PointOnTransducer

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import Floats

COARSER = math.sqrt(2.0)  # step of the spacing from one level to the next
MAX_SUBSET = 8  # transducers that stand for all
HARDLY, WELL = 0.02, 0.1  # of the power: cosines of 0.14 and 0.32
MIN_LENGTH = 1e-30
CELL = 0.02  # [m]; the resolution is asked for once in each
MAX_CELLS = 10_000  # cells


class ArrayResolution:
    """Of one array in one medium."""

    def __init__(self, array: Array, medium: Air) -> None:
        self.array, self.medium = array, medium
        self.centre = array.centre
        self.wavelength = medium.speed_of_sound / array.transducer.frequency  # [m]
        picked = np.unique(np.linspace(0, len(array) - 1, MAX_SUBSET).round().astype(np.intp))
        self.some = np.ascontiguousarray(array.positions[picked])
        """Some of its transducers, from all over it, (V, 3) [m]."""
        low, high = array.positions.min(axis=0), array.positions.max(axis=0)
        ends = np.meshgrid(*zip(low, high, strict=True), indexing="ij")
        self.corners = np.unique(np.stack(ends, axis=-1).reshape(-1, 3), axis=0)
        """Of the box that holds it, (V, 3) [m]."""
        self._spacings: dict[tuple[int, int, int], float] = {}

    def spacing(self, place: tuple[float, float, float]) -> float:
        """How far apart samples should be at `place` [m]: a wavelength, or as much as is resolved there.

        In steps of a factor sqrt 2, so that the samples of what moves stay the same mostly.
        """
        x, y, z = (math.floor(v / CELL) for v in place)
        kept = self._spacings.get((x, y, z))
        if kept is None:
            if len(self._spacings) >= MAX_CELLS:
                self._spacings.clear()
            middle = CELL * (np.array([[x, y, z]]) + 0.5)
            try:
                finest = float(resolution(self.array, middle, self.medium)[0])
            except PointOnTransducer:
                finest = 0.0
            finest = min(max(finest, self.wavelength), FAR)  # infinite where one alone is heard
            steps = math.log(finest / self.wavelength) / math.log(COARSER)
            kept = self._spacings[x, y, z] = self.wavelength * COARSER ** round(steps)
        return kept

    def focal_areas(self, positions: Floats, normals: Floats, *, even: bool) -> Floats:
        """As `focal_area`, (M,) [m^2]; NaN where there is no focus: on a transducer, or before a single one."""
        areas, q = np.full(len(positions), np.nan), positions
        kept = np.arange(len(q))
        try:
            areas[:] = focal_area(self.array, q, normals, self.medium, even=even)
        except PointOnTransducer as error:
            kept = np.delete(kept, list(error.indices))
            areas[kept] = focal_area(self.array, q[kept], normals[kept], self.medium, even=even)
        return np.where(np.isfinite(areas), areas, np.nan)

    def seen(self, positions: Floats, normals: Floats) -> Floats:
        """How well skin at points, (M, 3) [m], is seen: the mean of cos^2 of the incidence, (M,)."""
        d = self.some[:, None] - positions  # (V, M, 3)
        cosine = (d * normals).sum(axis=2) / np.sqrt((d * d).sum(axis=2) + MIN_LENGTH)
        return np.asarray((np.maximum(cosine, 0.0) ** 2).mean(axis=0))


def grazing(seen: Floats) -> Floats:
    """The share of its pressure that skin is asked to feel which the array sees so well, 0..1, (M,).

    seen: the mean of cos^2 of the incidence, (M,), or what of the sound's power presses. Where it is next to
    nothing, full drive would not press: rather than that, nothing is asked.
    """
    x = np.clip((seen - HARDLY) / (WELL - HARDLY), 0.0, 1.0)
    return np.asarray(x * x * (3.0 - 2.0 * x))
