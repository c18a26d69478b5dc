"""Samples of a textured surface: on the outlines of what presses, and silent ones where its texture is 0.

The pressure shall be full up to an outline, and fall outside. Outlines therefore have samples of full pressure, and
samples beyond are silent. Without this, the pressure would rise half inside an outline and half outside: a mask of
30 mm had holes along its edge. The samples on outlines would fill narrow gaps, such as those of a grating. A texture
with many narrow gaps therefore keeps its samples.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.neighbours import find_nearest
from pacinian.scene.shapes.local_samples import LocalSamples
from pacinian.scene.shapes.poisson_disk import thin_out

if TYPE_CHECKING:
    from pacinian.scene.shapes.texture import Texture
    from pacinian.types import Flags, Floats, Indices

# All lengths are relative to the spacing.
# Largest distance, across an outline, of a sample that does not press from one that does.
MAX_EDGE_DISTANCE = 1.5
STEEP = 0.3  # an outline is a step if the factor is full at this distance inside
FULL = 0.9  # share of the factor of a sample that counts as full
MIN_GAP = 5.5  # width of the smallest gap whose outline has samples: twice the resolution
# Smallest share of the outlines of wide gaps among all outlines of a mask. Letters have more, gratings less.
MIN_WIDE_SHARE = 0.55
# Radius around the middle of a wide gap in which nothing presses, relative to half of MIN_GAP.
MIN_FREE_SHARE = 0.5
MIN_OUTLINE_SPACING = 0.5  # smallest distance between two samples on an outline
MIN_SILENT_DISTANCE = 0.7  # smallest distance of a silent sample from one that presses
MAX_SMOOTH = 0.25  # largest factor beside a place with factor 0, over the texture's largest one, that is no step
BISECTIONS = 12  # steps that find where a line crosses an outline
# Directions in which a point is compared with its surroundings, along x and y of the shape.
DIRECTIONS = np.array([(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)])


class TexturedSamples(NamedTuple):
    """Samples in a shape's own frame.

    factor: of the texture on the pressure at each, (K,). silent: whether each lies beyond an outline, (K,).
    """

    local: LocalSamples
    factor: Floats
    silent: Flags


def lay_out(texture: Texture, local: LocalSamples, spacing: float) -> TexturedSamples:
    """Return the samples of a textured shape.

    Samples on an outline share the area of those beside them. local: of the shape without its texture. spacing: of
    these [m].
    """
    plain = TexturedSamples(local, texture.at(local.points), np.zeros(len(local.points), np.bool_))
    factor = _round_steps(texture, local.points, spacing)
    on, off = np.flatnonzero(factor > 0.0), np.flatnonzero(factor <= 0.0)
    if not (len(on) and len(off)):
        return plain
    away, nearest = find_nearest(local.points[on], local.points[off])
    near, nearest = away < MAX_EDGE_DISTANCE * spacing, on[nearest]
    edge, inside = _find_outlines(texture, local.points, nearest[near], off[near], factor, spacing)
    if len(edge) < MIN_WIDE_SHARE * near.sum():
        return plain
    kept = thin_out(edge, MIN_OUTLINE_SPACING * spacing)
    edge, inside = edge[kept], inside[kept]
    pressing = np.concatenate([local.points[on], edge])
    off = off[find_nearest(pressing, local.points[off])[0] > MIN_SILENT_DISTANCE * spacing]
    which = np.concatenate([on, inside, off])
    silent = np.arange(len(which)) >= len(pressing)
    divided = np.bincount(inside, minlength=len(factor)) + 1.0  # samples that share an area
    return TexturedSamples(
        LocalSamples(
            np.concatenate([pressing, local.points[off]]),
            local.normals[which],
            np.where(silent, 0.0, local.area[which] / divided[which]),
        ),
        factor[which],
        silent,
    )


def _round_steps(texture: Texture, points: Floats, spacing: float) -> Floats:
    """Return the factor at points, (K,). On a step, which a picture has between two pixels, it is that of one side."""
    factor = texture.at(points)
    around = [texture.at(points + STEEP * spacing * d) for d in DIRECTIONS]
    low, high = np.minimum.reduce([factor, *around]), np.maximum.reduce([factor, *around])
    step = high - low > 0.5 * high
    return np.where(step, np.where(2.0 * factor < low + high, low, high), factor)


def _find_outlines(
    texture: Texture, points: Floats, inside: Indices, outside: Indices, factor: Floats, spacing: float
) -> tuple[Floats, Indices]:  # fmt: skip
    """Find where lines from samples that press to others cross the outline of a wide gap.

    points: all samples, (M, 3) [m]. factor: at these, (M,). inside, outside: the ends of the lines, (L,). Returns the
    places, (K, 3) [m], and the sample inside of each, (K,).
    """
    begin, end, full = points[inside], points[outside], factor[inside]
    size = np.linalg.norm(end - begin, axis=1, keepdims=True)
    along = (end - begin) / np.maximum(size, 1e-30)
    low, high = np.zeros_like(size), size.copy()
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        presses = texture.at(begin + middle * along)[:, None] >= 0.5 * full[:, None]
        low, high = np.where(presses, middle, low), np.where(presses, high, middle)
    edge = begin + low * along
    step = texture.at(edge - np.minimum(low, STEEP * spacing) * along) >= FULL * full
    half = 0.5 * MIN_GAP * spacing
    free = find_nearest(points[factor > 0.0], edge + half * along)[0] >= MIN_FREE_SHARE * half
    wide = step & free & (full > MAX_SMOOTH * factor.max())
    return edge[wide], inside[wide]
