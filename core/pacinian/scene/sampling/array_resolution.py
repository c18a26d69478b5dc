"""The spatial resolution of an array, and how well it sees skin."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.resolution import find_lobe, focal_area
from pacinian.argument_checks import MAX_LENGTH
from pacinian.errors import PointOnTransducer

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.scene.objects import Object
    from pacinian.types import Floats

SPACING_RATIO = math.sqrt(2.0)  # ratio of a spacing to the next finer one
MAX_SUBSET = 32  # number of transducers that represent the array for visibility
# Mean cos^2 of the angle of incidence at which skin gets no pressure, or its full pressure (cosines 0.14 and 0.32).
BLOCKED_COS2, FULL_PRESSURE_COS2 = 0.02, 0.1
MIN_AREA = 1e-30  # smallest squared distance used as a divisor [m^2]
CELL = 0.02  # size of the grid cells for each of which the resolution is computed once [m]
MAX_CELLS = 10_000  # largest number of cached cells


class ArrayResolution:
    """Resolution and visibility for one array in one medium."""

    def __init__(self, array: Array, medium: Air) -> None:
        self.array, self.medium = array, medium
        self.centre = array.centre
        self.wavelength = medium.speed_of_sound / array.transducer.frequency  # [m]
        picked = np.unique(np.linspace(0, len(array) - 1, MAX_SUBSET).round().astype(np.intp))
        self.viewpoints = np.ascontiguousarray(array.positions[picked])
        """Positions of up to 32 transducers spread over the array, (V, 3) [m]."""
        low, high = array.positions.min(axis=0), array.positions.max(axis=0)
        ends = np.meshgrid(*zip(low, high, strict=True), indexing="ij")
        self.corners = np.unique(np.stack(ends, axis=-1).reshape(-1, 3), axis=0)
        """Corners of the array's bounding box, (V, 3) [m]."""
        self._cells: dict[tuple[int, int, int], tuple[float, float, float]] = {}

    def compute_isolated_spacing(self, place: tuple[float, float, float]) -> float:
        """Return the spacing of isolated samples at `place` [m]: a wavelength, or the resolution there if coarser.

        The spacing changes in steps of sqrt(2), so that a moving object mostly keeps its samples.
        """
        return self._compute(place)[0]

    def compute_period(self, place: tuple[float, float, float]) -> float:
        """Return the shortest period that the array resolves at `place` [m]: twice the resolution there.

        A ridge and the gap beside it each need one distance from a focus to its first null.
        """
        return 2.0 * self._compute(place)[1]

    def compute_elongation(self, place: tuple[float, float, float]) -> float:
        """Return how much wider a focus at `place` [m] is across the direction in which it is narrowest, 1 or more."""
        return self._compute(place)[2]

    def find_blurring_period(self, item: Object, place: tuple[float, float, float]) -> float:
        """Return `compute_period` at `place` [m] if the object's texture is finer and therefore blurs; otherwise 0.

        Raises ArgumentError if the texture's file cannot be read.
        """
        texture = getattr(item, "texture", None)
        if texture is None:
            return 0.0
        resolved = self.compute_period(place)
        return resolved if texture.period < resolved else 0.0

    def _compute(self, place: tuple[float, float, float]) -> tuple[float, float, float]:
        """Return the sample spacing [m], the resolution [m] and the elongation of a focus at `place` [m]."""
        x, y, z = (math.floor(v / CELL) for v in place)
        kept = self._cells.get((x, y, z))
        if kept is None:
            if len(self._cells) >= MAX_CELLS:
                self._cells.clear()
            middle = CELL * (np.array([[x, y, z]]) + 0.5)
            try:
                resolved, across = find_lobe(self.array, middle, self.medium)[0].tolist()
            except PointOnTransducer:
                resolved = across = 0.0
            # the resolution is infinite where only one transducer is heard
            finest = min(max(resolved, self.wavelength), MAX_LENGTH)
            steps = math.log(finest / self.wavelength) / math.log(SPACING_RATIO)
            spacing = self.wavelength * SPACING_RATIO ** round(steps)
            elongation = across / resolved if 0.0 < resolved < math.inf else 1.0
            kept = self._cells[x, y, z] = spacing, resolved, elongation
        return kept

    def focal_areas(self, positions: Floats, normals: Floats, *, uniform: bool) -> Floats:
        """Return `focal_area`, (M,) [m^2], with NaN where no focus exists: on a transducer, or before a single one."""
        areas, q = np.full(len(positions), np.nan), positions
        kept = np.arange(len(q))
        try:
            areas[:] = focal_area(self.array, q, self.medium, normals, uniform=uniform)
        except PointOnTransducer as error:
            kept = np.delete(kept, list(error.indices))
            areas[kept] = focal_area(
                self.array, q[kept], self.medium, normals[kept], uniform=uniform
            )
        return np.where(np.isfinite(areas), areas, np.nan)

    def compute_incidence(self, positions: Floats, normals: Floats) -> Floats:
        """Return the mean cos^2 of the angle of incidence on skin at points (M, 3) [m], over the transducers: (M,).

        The weights are 1 / distance^2, because near transducers are louder.
        """
        d = self.viewpoints[:, None] - positions  # (V, M, 3)
        weights = 1.0 / np.maximum((d * d).sum(axis=2), MIN_AREA)
        along = np.maximum((d * normals).sum(axis=2), 0.0)
        return np.asarray((along**2 * weights**2).sum(axis=0) / weights.sum(axis=0))


def weigh_incidence(seen: Floats) -> Floats:
    """Return the fraction of the requested pressure, 0..1, (M,), given how well the array sees the skin.

    seen: mean cos^2 of the angle of incidence, which is the fraction of the sound power that presses, (M,). The
    fraction falls to 0 where the array hardly sees the skin, because even full drive would not press there.
    """
    x = np.clip((seen - BLOCKED_COS2) / (FULL_PRESSURE_COS2 - BLOCKED_COS2), 0.0, 1.0)
    return np.asarray(x * x * (3.0 - 2.0 * x))
