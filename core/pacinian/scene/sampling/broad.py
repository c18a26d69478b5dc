"""The broad phase: which of many objects may be touched at all."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    from pacinian.types import Flags, Floats, Indices

LATEST = 0.1  # [s], as `motion.LATEST`: what is compiled would not follow that


@compiled("i8(f8[:, ::1], f8, f8[:, ::1], i8[::1])", finite=False)
def _near(bounds: Floats, t: float, boxes: Floats, found: Indices) -> int:
    count = 0
    for i in range(bounds.shape[0]):
        age = min(max(t - bounds[i, 6], 0.0), LATEST)
        radius = bounds[i, 7]
        for b in range(boxes.shape[0]):
            away = 0.0
            for k in range(3):
                x = bounds[i, k] + age * bounds[i, 3 + k]
                outside = max(boxes[b, k] - x, x - boxes[b, 3 + k])
                if outside > 0.0:
                    away += outside * outside
            if away <= radius * radius:
                found[count] = i
                count += 1
                break
    return count


def near(bounds: Floats, t: float, boxes: Floats) -> Indices:
    """Indices of the objects whose bounding spheres touch any of the boxes at time t [s], in order.

    bounds: as `Scene.bounds`, (objects, 8). boxes: lower and upper corners, (boxes, 6) [m].
    """
    found = np.empty(len(bounds), dtype=np.int64)
    return found[: _near(bounds, t, boxes, found)]


@compiled("i8(f8[:, ::1], f8[::1], f8[::1], i8[::1], i8[::1], f8[::1], f8[::1], f8[::1], b1[::1])")
def merge(
    points: Floats, P: Floats, area: Floats, source: Indices, voice: Indices, radius: Floats,
    pressed: Floats, stands: Floats, kept: Flags,
) -> int:  # fmt: skip
    """Merge samples of different sources and one voice, nearer than both their `radius` [m], into the first of them.

    points: (M, 3) [m], in order of importance. P: (M,) [Pa]. area: (M,) [m^2]. source, voice: (M,). Writes
    pressures, areas (a sample that takes another has both areas and the sum of the forces), and which
    are kept; returns how many are not.
    """
    gone = 0
    M = points.shape[0]
    for i in range(M):
        pressed[i], stands[i], kept[i] = P[i], area[i], True
    for j in range(1, M):
        for i in range(j):
            if kept[i] and source[i] != source[j] and voice[i] == voice[j]:
                dx = points[i, 0] - points[j, 0]
                dy = points[i, 1] - points[j, 1]
                dz = points[i, 2] - points[j, 2]
                near = min(radius[i], radius[j])
                if dx * dx + dy * dy + dz * dz < near * near:
                    force = pressed[i] * stands[i] + P[j] * area[j]
                    stands[i] += area[j]
                    pressed[i] = force / stands[i]
                    kept[j] = False
                    gone += 1
                    break
    return gone
