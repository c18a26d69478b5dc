"""The shell of a combination of solids, found from the samples of its parts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.scene.shapes.local_samples import LocalSamples
from pacinian.scene.shapes.poisson_disk import MIN_DISTANCE, thin_out
from pacinian.scene.shapes.sdf import scale_shell

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.scene.shapes.sdf import Solid
    from pacinian.types import Flags, Indices

    Sides = Sequence[tuple[Solid, float]]

MEASURE_SAMPLES = 4096  # approximate number of samples of the parts for measuring an area
ON = 1e-9  # a point this near to a shell lies on it [m]
ACROSS = 1e-3  # distance to the two test points on either side of a sample, over the spacing


def measure_shell(whole: Solid, sides: Sides) -> float:
    """Estimate the area of a shell [m^2]. The arguments are those of `sample_shell`."""
    return float(_shell(whole, sides, _fine(sides)).area.sum())


def sample_shell(whole: Solid, sides: Sides, spacing: float) -> LocalSamples:
    """Return the samples of the parts that lie on the shell of the whole, with its area divided among them.

    sides: the parts, each with 1 if the shell of the part faces outward, or -1 if it faces inward. spacing: approximate
    distance of samples [m]; walls thinner than a thousandth of it are missed.
    """
    samples = _shell(whole, sides, spacing)
    if not len(samples.points):  # the shell is smaller than the spacing
        samples = _shell(whole, sides, _fine(sides))
        samples = _only(samples, thin_out(samples.points, MIN_DISTANCE * spacing))
    return samples._replace(area=scale_shell(samples.area, whole.area))


def _fine(sides: Sides) -> float:
    # any, if there is no area
    return math.sqrt(sum(part.area for part, _ in sides) / MEASURE_SAMPLES) or 1.0


def _only(samples: LocalSamples, kept: Flags | Indices) -> LocalSamples:
    return LocalSamples(*(values[kept] for values in samples))


def _shell(whole: Solid, sides: Sides, spacing: float) -> LocalSamples:
    kept: list[LocalSamples] = []
    for i, (part, side) in enumerate(sides):
        samples = part.sample_surface(spacing)
        samples = samples._replace(normals=side * samples.normals)
        points, step = samples.points, ACROSS * spacing * samples.normals
        on = np.abs(whole.distance(points)) <= np.abs(part.distance(points)) + ON
        on &= (whole.distance(points + step) > 0.0) & (whole.distance(points - step) < 0.0)
        for other, _ in sides[:i]:  # where shells coincide, keep the samples of one
            on &= np.abs(other.distance(points)) > ON
        kept.append(_only(samples, on))
    return LocalSamples(*(np.concatenate(values) for values in zip(*kept, strict=True)))
