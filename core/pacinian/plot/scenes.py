"""Plots a scene, its samples and its field on one page."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.plot.fields import check_medium, cut_both, draw_both
from pacinian.plot.page import figure
from pacinian.plot.planes import middle_of
from pacinian.plot.space import Discs, View, array_of, make_object, skin, towards
from pacinian.scene.hands import capsules as flesh
from pacinian.scene.objects import Body
from pacinian.scene.shapes import Disc, Rectangle
from pacinian.scene.shapes.height_map import HeightMap
from pacinian.scene.shapes.shape_types import distance

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.acoustics.pose import Pose
    from pacinian.plot.planes import Plane
    from pacinian.plot.style import Panel
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.samples import Samples
    from pacinian.scene.scene import Scene
    from pacinian.types import Floats, Gains

ABOVE, BELOW = (22.0, -58.0), (-30.0, -58.0)  # [deg] elevation and azimuth
SAMPLE_MARGIN = 0.13  # margin around the samples in the view from below [m]
DOT = 0.006  # diameter of a sample [m]
ZOOMS = 1.3, 1.45
NARROWEST = 9.0  # [inch]
MAP = "inferno"
SHEETS, THIN = (Rectangle, Disc, HeightMap), 0.002  # open shapes; how thick they are drawn [m]
WHITE, BLUE = "white", "#8cc0ff"


def scene(
    array: Array,
    scene: Scene,
    samples: Samples,
    gains: Gains,
    *,
    t: float = 0.0,
    medium: Air | None = None,
    title: str = "",
) -> Figure:
    """Plot a scene at time t [s] from above and, close up, from below, and its field in two planes.

    samples: the targets. gains: (N,), or (K, N) for the mean field over K moments. The field is that of free air.
    Lines show the outlines of hands, and where objects cross the planes. Raises MissingExtra.
    """
    medium = check_medium(array, medium)
    both = cut_both(array, gains, samples.positions, medium)
    narrow = both[1][0].ratio
    page = figure(max(NARROWEST, 1.6 + 4.2 * (1.0 + narrow)), 8.4)
    parts: Any = page.subfigures(2, 1, height_ratios=[3.7, 4.7])
    upper, lower = parts
    views = _views(upper, array, scene, samples, t)
    panels = lower.subplots(1, 2, width_ratios=[1.0, narrow])
    draw_both(lower, array, gains, panels, both, samples.positions, medium)
    for panel, (plane, _) in zip(panels, both, strict=True):
        _outlines(panel, plane, scene, t)
    if title:
        page.suptitle(title)
    page.draw_without_rendering()
    for view in views:
        view.fit(page.dpi)
    return page


def _views(part: Any, array: Array, scene: Scene, samples: Samples, t: float) -> list[View]:
    """Draw the array with everything above it, and a close-up of the samples."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    q, middle = samples.positions, middle_of(array, samples.positions)
    low, high = array.positions.min(axis=0) - 0.02, array.positions.max(axis=0) + 0.02
    high[2] = max(high[2], middle[2] + 0.08)
    boxes = np.array([low, high]), np.array([middle - SAMPLE_MARGIN, middle + SAMPLE_MARGIN])
    P = samples.radiation_pressure
    scale = ScalarMappable(Normalize(0.0, float(P.max(initial=1e-9))), MAP)
    felt = Discs(q, np.asarray(scale.to_rgba(P)).reshape(-1, 4), np.full(len(q), DOT))
    views: list[View] = []
    for k, (angle, box, zoom) in enumerate(zip((ABOVE, BELOW), boxes, ZOOMS, strict=True)):
        panel = part.add_subplot(1, 2, k + 1, projection="3d")
        eye, view = towards(*angle), View(panel, angle, box, zoom)
        things = [skin(hand, eye) for hand in scene.hands if not hand.lost]
        for item in scene.objects:
            pose = _pose(item, t)
            if k or ((pose.position >= box[0]) & (pose.position <= box[1])).all():
                things.append(make_object(item, pose, eye))
        if k == 0:
            view.draw([array_of(array), *things, felt])
        else:
            view.draw([made.within(box) for made in [array_of(array), *things]])
            view.draw([felt])  # drawn over everything, because the skin lies behind objects
        views.append(view)
    if len(P):
        part.colorbar(scale, ax=views[-1].panel, label="asked [Pa]", shrink=0.7)
    return views


def _outlines(panel: Panel, plane: Plane, scene: Scene, t: float) -> None:
    points = np.ascontiguousarray(plane.points.reshape(-1, 3))
    for hand in scene.hands:
        if not hand.lost and hand.joints is not None:
            _line(panel, plane, _outline(hand, plane, points), WHITE, "-")
    for item in scene.objects:
        if isinstance(item, Body):
            pose = _pose(item, t)
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
    """Draw the contour where d, (GRID * GRID,) [m], is 0."""
    if (d < 0.0).any() and (d > 0.0).any():
        panel.contour(
            1e3 * plane.u, 1e3 * plane.v, d.reshape(len(plane.v), len(plane.u)), [0.0],
            colors=colour, linestyles=style, linewidths=0.9,
        )  # fmt: skip


def _pose(item: Object, t: float) -> Pose:
    return item.pose if item.motion is None else item.motion.pose(item.pose, t)
