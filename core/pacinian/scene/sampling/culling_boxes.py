"""Culling boxes: where anything can be felt. Objects outside them are culled, and samples outside the workspace cut."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.argument_checks import MAX_LENGTH
from pacinian.native import scene as kernels

if TYPE_CHECKING:
    from pacinian.scene.config_sections import Workspace
    from pacinian.scene.sampling.posed_skin import PosedSkin
    from pacinian.scene.sampling.samples import Samples
    from pacinian.scene.scene import Scene
    from pacinian.types import Floats, Indices

EVERYWHERE = np.array([-np.inf] * 3 + [np.inf] * 3)
EVERYWHERE.flags.writeable = False


class CullingBoxes:
    """Finds the culling boxes of scenes, and keeps what depends only on the array and the last workspace.

    centre: of the array, (3,) [m]; None if no array is known yet.
    """

    def __init__(self, centre: Floats | None = None) -> None:
        self._reach = EVERYWHERE
        if centre is not None:
            self._reach = np.concatenate([centre - MAX_LENGTH, centre + MAX_LENGTH])
        self._last: tuple[Workspace | None, Floats] = None, self._reach

    def find(self, scene: Scene, hands: list[PosedSkin]) -> Floats:
        """Return the boxes in which objects can be felt, as lower and upper corners, (boxes, 6) [m].

        Each box lies within the workspace and within MAX_LENGTH of the array's centre along each axis. If the scene
        has hands, there is one for each of `hands`, the hands that are present, except those outside the workspace.
        Otherwise there is one in all.
        """
        box = self._find_box(scene.workspace)
        if not scene.hands:
            return box[None]
        boxes = np.empty((len(hands), 6))
        for one, hand in zip(boxes, hands, strict=True):
            np.maximum(hand.box[:3], box[:3], out=one[:3])
            np.minimum(hand.box[3:], box[3:], out=one[3:])
        return (
            boxes if scene.workspace is None else boxes[(boxes[:, :3] <= boxes[:, 3:]).all(axis=1)]
        )

    def _find_box(self, workspace: Workspace | None) -> Floats:
        """Return the box in which anything can be felt at all, (6,) [m]."""
        last, box = self._last
        if last is not workspace:
            box = self._reach
            if workspace is not None:
                low, high = workspace.lower, workspace.upper
                box = np.concatenate([np.maximum(box[:3], low), np.minimum(box[3:], high)])
            self._last = workspace, box
        return box


def cull(bounds: Floats, t: float, boxes: Floats) -> Indices:
    """Return the indices, in order, of the objects whose bounding spheres touch any of the boxes at time t [s].

    The broad phase discards the others. bounds: as `Scene.bounds`, (objects, 8). boxes: lower and upper corners,
    (boxes, 6) [m].
    """
    found = np.empty(len(bounds), dtype=np.int64)
    return found[: kernels.near(bounds, t, boxes, found)]


def cut(workspace: Workspace | None, samples: Samples) -> Samples:
    """Return the samples without those outside the workspace."""
    if workspace is None:
        return samples
    if len(samples) == 1:  # fast path, mostly for points
        x, y, z = samples.positions[0].tolist()
        (a, b, c), (u, v, w) = workspace.lower, workspace.upper
        if a <= x <= u and b <= y <= v and c <= z <= w:
            return samples
    kept = workspace.holds(samples.positions)
    return samples if kept.all() else samples.only(kept)
