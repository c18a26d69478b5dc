"""Draws the outlines of hands, and of objects where they cross a plane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.scene.hands import capsules as flesh
from pacinian.scene.objects import Body
from pacinian.scene.shapes import Disc, Rectangle
from pacinian.scene.shapes.height_map import HeightMap
from pacinian.scene.shapes.shape_types import distance

if TYPE_CHECKING:
    from pacinian.acoustics.pose import Pose
    from pacinian.plot.planes import Plane
    from pacinian.plot.style import Panel
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.objects import Object
    from pacinian.scene.scene import Scene
    from pacinian.types import Floats

SHEETS, THIN = (Rectangle, Disc, HeightMap), 0.002  # open shapes; how thick they are drawn [m]
WHITE, BLUE = "white", "#8cc0ff"


def draw_outlines(panel: Panel, plane: Plane, scene: Scene, t: float) -> None:
    """Draw, as contours, the hands of a scene at time t [s], and its objects where they cross the plane."""
    points = np.ascontiguousarray(plane.points.reshape(-1, 3))
    for hand in scene.hands:
        if not hand.lost and hand.joints is not None:
            _line(panel, plane, _outline(hand, plane, points), WHITE, "-")
    for item in scene.objects:
        if isinstance(item, Body):
            pose = find_pose(item, t)
            local = np.ascontiguousarray((points - pose.position) @ pose.matrix)
            if np.sqrt((local * local).sum(axis=1)).min() < item.bounding_radius:
                d = distance(item.shape, local, np.inf, np.inf)
                if isinstance(item.shape, SHEETS):  # everything behind them counts as inside
                    d[
                        distance(item.shape, local + np.array([0.0, 0.0, THIN]), np.inf, np.inf)
                        < 0.0
                    ] = np.nan
                _line(panel, plane, d, BLUE, "--")


def _outline(hand: Hand, plane: Plane, points: Floats) -> Floats:
    """Return the distance to a hand: to its shadow in the horizontal plane, to its cut in the vertical plane."""
    capsules = flesh.make_capsules(hand)
    if plane.axes == (0, 1):
        capsules[:, [2, 5]] = plane.height
    return flesh.distance_to_skin(capsules, points)


def _line(panel: Panel, plane: Plane, d: Floats, colour: str, style: str) -> None:
    """Draw the contour where d, one for each point of the plane [m], is 0."""
    if (d < 0.0).any() and (d > 0.0).any():
        panel.contour(
            1e3 * plane.u, 1e3 * plane.v, d.reshape(len(plane.v), len(plane.u)), [0.0],
            colors=colour, linestyles=style, linewidths=0.9,
        )  # fmt: skip


def find_pose(item: Object, t: float) -> Pose:
    """Return the pose of an object at time t [s]."""
    return item.pose if item.motion is None else item.motion.pose(item.pose, t)
