"""The shell of a solid that is made of solids, by the samples of its parts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.scene.shapes.local_samples import LocalSamples
from pacinian.scene.shapes.poisson_disk import APART, thin_out
from pacinian.scene.shapes.sdf import scale_shell

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.scene.shapes.sdf import Solid
    from pacinian.types import Flags, Indices

    Sides = Sequence[tuple[Solid, float]]

FINE = 4096  # samples of its parts, about, by which an area is measured
ON = 1e-9  # [m] from a shell: on it
ACROSS = 1e-3  # share of the spacing: how far from a sample the solid is looked for


def measure_shell(whole: Solid, sides: Sides) -> float:
    """The area of its shell [m^2]: an estimate. Arguments as for `sample_shell`."""
    return float(_shell(whole, sides, _fine(sides)).area.sum())


def sample_shell(whole: Solid, sides: Sides, spacing: float) -> LocalSamples:
    """Those samples of its parts that lie on its shell, with its area shared out among them.

    sides: the parts, each with 1 where the shell of the part faces outward, -1 where it faces inward.
    spacing: about how far apart [m]; thinner walls than a thousandth of it are not seen.
    """
    samples = _shell(whole, sides, spacing)
    if not len(samples.points):  # what there is of it is smaller than the spacing
        samples = _shell(whole, sides, _fine(sides))
        samples = _only(samples, thin_out(samples.points, APART * spacing))
    return samples._replace(area=scale_shell(samples.area, whole.area))


def _fine(sides: Sides) -> float:
    return math.sqrt(sum(part.area for part, _ in sides) / FINE) or 1.0  # of nothing, any


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
        for other, _ in sides[:i]:  # where shells coincide, one is enough
            on &= np.abs(other.distance(points)) > ON
        kept.append(_only(samples, on))
    return LocalSamples(*(np.concatenate(values) for values in zip(*kept, strict=True)))
