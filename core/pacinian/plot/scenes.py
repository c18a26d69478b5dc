"""Plots a scene, its samples and its field on one page."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.argument_checks import check_number
from pacinian.plot.discs import Discs, View, array_of, make_object, skin, towards
from pacinian.plot.fields import check_array_and_medium, cut_both, draw_both
from pacinian.plot.outlines import draw_outlines, find_pose
from pacinian.plot.page import figure, set_title
from pacinian.plot.planes import middle_of
from pacinian.plot.style import SAMPLES_MAP
from pacinian.scene.objects import Body

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.scene.sampling.samples import Samples
    from pacinian.scene.scene import Scene
    from pacinian.types import Floats, Gains

ABOVE, BELOW = (22.0, -58.0), (-30.0, -58.0)  # [deg] elevation and azimuth
SAMPLE_MARGIN = 0.13  # margin around the samples in the view from below [m]
DOT = 0.005  # diameter of a sample [m]
# [m] the same where nothing else is above the array, and its rim's share of that
LONE_DOT, RIM = 0.014, 1.4
ZOOMS, LONE_ZOOM = (1.34, 1.45), 1.3
NARROWEST = 9.0  # [inch]
MAX_SAMPLE_RATIO = 0.65  # largest diameter of a sample, over the distance to the next

INK = 0.12, 0.14, 0.18


def scene(
    array: Array,
    scene: Scene,
    samples: Samples,
    gains: Gains,
    *,
    medium: Air,
    t: float = 0.0,
    title: str = "",
    top: float | None = None,
) -> Figure:
    """Plot a scene at time t [s] from above and, close up, from below, and its field in two planes.

    samples: the targets. gains: (N,), or (K, N) for the mean field over K moments. medium: the air, with nothing in
    it. top: upper end of the field's colour scale [Pa]; by default slightly above the pressure at the samples. Lines
    show the outlines of hands, and where objects cross the planes. Raises ArgumentError, MissingExtra.
    """
    if top is not None:
        check_number("top", top, low=0.0, above=True)
    check_array_and_medium(array, medium)
    both = cut_both(array, gains, samples.positions, medium)
    narrow = both[1][0].ratio
    page = figure(max(NARROWEST, 1.6 + 4.2 * (1.0 + narrow)), 8.4)
    parts: Any = page.subfigures(2, 1, height_ratios=[3.7, 4.7])
    upper, lower = parts
    views = _views(upper, array, scene, samples, t)
    panels = lower.subplots(1, 2, width_ratios=[1.0, narrow])
    draw_both(lower, array, gains, panels, both, samples.positions, medium, top)
    for panel, (plane, _) in zip(panels, both, strict=True):
        draw_outlines(panel, plane, scene, t)
    if title:
        set_title(page, title)
    page.draw_without_rendering()
    for view in views:
        view.fit(page.dpi)
    return page


def _find_dot(q: Floats) -> float:
    """Return the diameter of samples at q, (M, 3) [m], so that those of a curve stay apart [m]."""
    away = np.sqrt(((q[:, None] - q) ** 2).sum(axis=2)) + np.diag(np.full(len(q), np.inf))
    return min(LONE_DOT, MAX_SAMPLE_RATIO * float(away.min(initial=np.inf)))


def _views(part: Any, array: Array, scene: Scene, samples: Samples, t: float) -> list[View]:
    """Draw the array with everything above it, and a close-up of the samples if something touches them."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    q, middle = samples.positions, middle_of(array, samples.positions)
    low, high = array.positions.min(axis=0) - 0.02, array.positions.max(axis=0) + 0.02
    high[2] = max(high[2], middle[2] + 0.08)
    boxes = np.array([low, high]), np.array([middle - SAMPLE_MARGIN, middle + SAMPLE_MARGIN])
    P = samples.radiation_pressure
    scale = ScalarMappable(Normalize(0.0, float(P.max(initial=1e-9))), SAMPLES_MAP)
    lone = not any(isinstance(item, Body) for item in scene.objects) and all(
        hand.lost for hand in scene.hands
    )
    colours = np.asarray(scale.to_rgba(P)).reshape(-1, 4)
    size = _find_dot(q) if lone else DOT
    felt = Discs(q, colours, np.full(len(q), size)).only(P > 0.0)
    cameras = (
        [(ABOVE, boxes[0], LONE_ZOOM)]
        if lone
        else list(zip((ABOVE, BELOW), boxes, ZOOMS, strict=True))
    )
    views: list[View] = []
    for k, (angle, box, zoom) in enumerate(cameras):
        panel = part.add_subplot(1, len(cameras), k + 1, projection="3d")
        eye, view = towards(*angle), View(panel, angle, box, zoom)
        hands = [skin(hand, eye) for hand in scene.hands if not hand.lost]
        things: list[Discs] = []
        for item in scene.objects:
            pose = find_pose(item, t)
            if k or ((pose.position >= box[0]) & (pose.position <= box[1])).all():
                things.append(make_object(item, pose, eye))
        if lone:
            view.draw([array_of(array)])
            view.draw([Discs.of(felt.points, INK, RIM * size)])  # pale colours need a rim
            view.draw([felt])
        elif k == 0:
            view.draw([array_of(array), *hands, *things, felt])
        else:
            view.draw([*hands, *(made.within(box) for made in [array_of(array), *things])])
            view.draw([felt])  # drawn over everything, because the skin lies behind objects
        views.append(view)
    if len(P):
        part.colorbar(
            scale, ax=views[-1].panel, label="asked [Pa]", shrink=0.7, pad=0.12 if lone else 0.05
        )
    return views
