"""Draws objects in space as discs that face the viewer; dense discs look like a surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.plot.style import METAL, SKIN, THING
from pacinian.scene.hands.skin_cache import get_skin
from pacinian.scene.objects import Body, Surface
from pacinian.scene.sampling.sample_cache import estimate_samples

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.acoustics.array import Array
    from pacinian.acoustics.pose import Pose
    from pacinian.plot.style import Panel
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.objects import Object
    from pacinian.types import Flags, Floats

Colour = tuple[float, float, float]

LIGHT = np.array([0.3, -0.4, 0.9])
DARKEST = 0.5  # brightness of a side facing away from the light
# distance between discs on an object [m]; their maximum number
DISC_SPACING, MAX_DISCS = 0.002, 4000
SKIN_DISC_SPACING = 1.75e-3  # distance between discs on a skin [m]
SKIN_DISC_DIAMETER = 4.2e-3  # [m]
TRANSDUCER_DISC_DIAMETER = 0.006  # [m]
POINT_DISC_DIAMETER = 0.004  # of objects without a surface: points, paths and particles [m]
SURFACE_DISC_RATIO = 1.9  # diameter of the discs on a surface, over their distance: they overlap
GLASS = 0.15  # opacity of open surfaces, which would hide the hand


@dataclass(frozen=True, eq=False)
class Discs:
    """K discs: points (K, 3) [m]; red, green, blue and opacity (K, 4); diameters (K,) [m]."""

    points: Floats
    colours: Floats
    sizes: Floats

    @classmethod
    def of(cls, points: Floats, colour: Colour, size: float, opacity: float = 1.0) -> Discs:
        """Return equal discs at `points`, (K, 3) [m], of diameter `size` [m]."""
        K = len(points)
        return cls(points, np.tile([*colour, opacity], (K, 1)), np.full(K, size))

    def within(self, box: Floats) -> Discs:
        """Return the discs between two corners, (2, 3) [m]."""
        return self.only(((self.points >= box[0]) & (self.points <= box[1])).all(axis=1))

    def only(self, kept: Flags) -> Discs:
        """Return the discs for which `kept`, (K,), is True."""
        return Discs(self.points[kept], self.colours[kept], self.sizes[kept])

    def lit(self, normals: Floats, eye: Floats) -> Discs:
        """Return the discs whose normals, (K, 3), face the viewer, lit from over the viewer's shoulder."""
        lamp = LIGHT + 1.2 * eye
        bright = np.clip(normals @ lamp / np.sqrt(lamp @ lamp), 0.0, 1.0)
        colours = self.colours.copy()
        colours[:, :3] *= (DARKEST + (1.0 - DARKEST) * bright)[:, None]
        return Discs(self.points, colours, self.sizes).only(normals @ eye > 0.0)


def towards(elevation: float, azimuth: float) -> Floats:
    """Return the direction to the viewer at these angles [deg], (3,)."""
    e, a = np.radians([elevation, azimuth])
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def array_of(array: Array) -> Discs:
    """Return one disc for each transducer of an array."""
    return Discs.of(array.positions, METAL, TRANSDUCER_DISC_DIAMETER)


def skin(hand: Hand, eye: Floats) -> Discs:
    """Return the part of a hand's skin that faces the viewer in direction `eye`, (3,). The hand must not be lost."""
    skin = get_skin(hand)
    placed, nodes = skin.place(hand), skin.counts[skin.level(SKIN_DISC_SPACING)]
    return Discs.of(placed.points[:nodes], SKIN, SKIN_DISC_DIAMETER).lit(
        placed.normals[:nodes], eye
    )


def make_object(item: Object, pose: Pose, eye: Floats) -> Discs:
    """Return the surface of an object at a pose, with its texture as brightness; points, if it has no surface."""
    spacing = DISC_SPACING * max(
        1.0, float(np.sqrt(estimate_samples(item, DISC_SPACING) / MAX_DISCS))
    )
    local = item.sample_surface(spacing)
    points = pose.points(local.points)
    if not isinstance(item, Body):
        return Discs.of(points, THING, POINT_DISC_DIAMETER)
    flat = isinstance(item, Surface)
    made = Discs.of(points, THING, SURFACE_DISC_RATIO * spacing, GLASS if flat else 1.0)
    if item.texture is not None:
        made.colours[:, :3] *= 0.4 + 0.6 * item.texture.at(local.points)[:, None]
    normals = pose.directions(local.normals)
    return made.lit(np.where(flat & (normals @ eye < 0.0)[:, None], -normals, normals), eye)


class View:
    """A 3-D panel without axes, seen from an angle (elevation, azimuth) [deg].

    box: lower and upper corner of the visible space, (2, 3) [m]. zoom: share of the panel that it fills.
    """

    def __init__(self, panel: Panel, angle: tuple[float, float], box: Floats, zoom: float) -> None:
        self.panel, self.box = panel, box
        self._drawn: list[tuple[Any, Floats]] = []
        panel.set_proj_type("ortho")
        panel.view_init(*angle)
        panel.set(xlim=box[:, 0], ylim=box[:, 1], zlim=box[:, 2])
        panel.set_box_aspect(box[1] - box[0], zoom=zoom)
        panel.set_axis_off()
        panel.computed_zorder = False

    def draw(self, groups: Sequence[Discs]) -> None:
        """Draw these discs over earlier ones, the nearest disc last."""
        found = [(g.points, g.colours, g.sizes) for g in groups]
        made = Discs(*(np.concatenate(parts) for parts in zip(*found, strict=True)))
        marks = self.panel.scatter(
            *made.points.T, c=made.colours, s=1.0, depthshade=False, linewidths=0, clip_on=False,
            zorder=len(self._drawn),
        )  # fmt: skip
        self._drawn.append((marks, made.sizes))

    def fit(self, dpi: float) -> None:
        """Set the sizes of the discs after the page is laid out at `dpi` [1/inch]."""
        across = np.cross(towards(self.panel.elev, self.panel.azim), [0.0, 0.0, 1.0])
        ends = np.ones((2, 4))
        ends[:, :3] = self.box.mean(axis=0)
        ends[1, :3] += 0.1 / np.sqrt(across @ across) * across
        flat = ends @ self.panel.get_proj().T
        a, b = self.panel.transData.transform(flat[:, :2] / flat[:, 3:])
        scale = 10.0 * float(np.hypot(*(b - a))) * 72.0 / dpi  # [pt/m]
        for marks, sizes in self._drawn:
            marks.set_sizes((scale * sizes) ** 2)
