"""Draw the loop at the top of the README.

    python docs/building/hand_on_ball.py docs/pictures/hand-on-ball.webp

The renderer runs at 1 kHz on the simulated array. A hand comes down on a ball, closes, strokes the ball and leaves. All
colours are computed: the array shows the emitted phases and amplitudes, the skin shows the radiation pressure along its
normal, and a plane behind the hand shows the radiation pressure in free air. The camera casts a ray for each pixel.

If times [s] follow the name of the file, the script draws only these moments, as PNG files beside that file.
"""

from __future__ import annotations

import functools
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps, font_manager
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

import pacinian as pc
from pacinian.plot.style import CYCLIC
from pacinian.scene.hands.capsules import distance_to_skin
from pacinian.scene.hands.skin_cache import get_skin
from pacinian.testing import ManualClock

Floats = NDArray[np.float64]

SECONDS, FPS = 6.0, 15
FIRST = 2.5  # [s] time of the first picture: where films do not play, it shows the touch
SETTLED = 20  # ticks until the start of a moment has no effect any more
SIZE, FINER = (800, 480), 2  # pixels; rays per side of a pixel
SAVED, QUALITY = (640, 384), 38  # pixels of the loop; quality of the WebP
EYE, TARGET = np.array([0.0, -0.48, 0.115]), np.array([0.005, 0.0, 0.122])  # [m]
ANGLE = 52.0  # horizontal angle of view [deg]
BALL, RADIUS, PRESSURE = np.array([0.0, 0.0, 0.168]), 0.032, 6.0  # [m], [m], [Pa]
TOP = 9.0  # end of the colour scale [Pa]
PLANE = 0.0  # [m] y of the plane that shows the field in the air
HALF, UPPER, STEP = 0.12, 0.26, 1.8e-3  # [m] half its width, its upper edge, its grid spacing
DOT = 0.0042  # radius of a transducer as drawn [m]
NIGHT, FLESH, GLASS = (np.array(c) for c in ((13.0, 17, 23), (168.0, 142, 130), (120.0, 175, 255)))
PALE, DIM = (230, 237, 243), (139, 148, 158)  # text
LAMP = np.array([-0.45, -0.70, 0.50]) / math.sqrt(0.9425)
FINGERS = {2: (22, 12), 6: (28, 38, 26), 11: (28, 38, 26), 16: (28, 38, 26), 21: (30, 36, 22)}
"""Bend of each finger's joints around the ball [deg], by the first joint of its metacarpal."""
MAP = colormaps["inferno"]


# ---------------------------------------------------------------------------- the scene


def ease(t: float, start: float, end: float) -> float:
    """Return 0 before `start`, 1 after `end`, and a smooth transition in between [s]."""
    x = min(max((t - start) / (end - start), 0.0), 1.0)
    return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)


def bent(joints: Floats, closing: float) -> Floats:
    """Bend the fingers of a flat right hand, (26, 3) [m]. closing: 0 leaves them flat, 1 bends them around the ball."""
    made = joints.copy()
    for first, angles in FINGERS.items():
        last = first + (3 if first == 2 else 4)
        for joint, angle in enumerate(angles, first + 1):
            along = made[joint + 1] - made[joint]
            axis = np.array([0.0, -1.0, 0.3]) if first == 2 else np.cross([0.0, 0.0, 1.0], along)
            turn = closing * math.radians(angle) * axis / np.sqrt(axis @ axis)
            rest = slice(joint + 1, last + 1)
            made[rest] = made[joint] + about(turn).directions(made[rest] - made[joint])
    return made


def about(turn: Floats) -> pc.Pose:
    """Return the rotation about a vector by its length [rad]."""
    angle = math.sqrt(turn @ turn)
    x, y, z = (turn * np.sinc(angle / math.tau) / 2.0).tolist()  # sinc(a) = sin(pi a) / (pi a)
    return pc.Pose(rotation=(x, y, z, math.cos(angle / 2.0)))


@functools.cache
def ball() -> pc.Volume:
    """Return the ball. It is not modulated, so that each picture shows the full pressure."""
    x, y, z = BALL.tolist()
    return pc.Volume(
        shape=pc.Sphere(RADIUS), pose=pc.Pose((x, y, z)), radiation_pressure=PRESSURE, name="ball"
    )


def scene(t: float) -> pc.Scene:
    """Return the ball and the hand at time t [s]."""
    here = ease(t, 0.1, 1.3) - ease(t, 4.9, 6.0)
    closing = ease(t, 0.9, 1.9) - ease(t, 4.2, 5.2)
    stroke = ease(t, 1.7, 2.3) * (1.0 - ease(t, 3.9, 4.5))
    sway = stroke * math.sin(math.tau * (t - 2.0) / 1.25)
    yaw, tilt = (
        pc.Pose().rotate("z", math.radians(9.0 * sway - 75.0)),
        pc.Pose().rotate("x", math.radians(-26.0)),
    )
    joints = pc.Hand.open("right").joints
    assert joints is not None
    held = np.array([[-0.006, 0.010, 0.0]])  # [m] the part of the palm that lies on the ball
    made = tilt.points(yaw.points(bent(joints, closing) - held))
    up = tilt.directions(np.array([[0.0, 0.0, 1.0]]))[0]
    along = tilt.directions(yaw.directions(np.array([[0.0, 1.0, 0.0]])))[0]
    return pc.Scene((ball(),), hands=(pc.Hand(
        made + BALL + (RADIUS + 0.0045 + 0.075 * (1.0 - here)) * up - 0.005 * sway * along, time=t
    ),))  # fmt: skip


# ---------------------------------------------------------------------------- the camera


@functools.cache
def rays(width: int, height: int) -> Floats:
    """Return the directions of the camera's rays, row by row, (height * width, 3)."""
    ahead = TARGET - EYE
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    ahead, right = ahead / np.sqrt(ahead @ ahead), right / np.sqrt(right @ right)
    half = math.tan(math.radians(ANGLE) / 2.0)
    u = half * (2.0 * (np.arange(width) + 0.5) / width - 1.0)
    v = half * (height - 2.0 * (np.arange(height) + 0.5)) / width
    d = ahead + u[None, :, None] * right + v[:, None, None] * np.cross(right, ahead)
    return (d / np.sqrt((d * d).sum(axis=-1, keepdims=True))).reshape(-1, 3)


def cast(flesh: Floats, d: Floats) -> Floats:
    """Return the distance of the hand along each ray, (K, 3) [m], or infinity, by sphere tracing."""
    far = np.full(len(d), np.inf)
    ends = np.concatenate([flesh[:, :3], flesh[:, 3:6]])
    middle = (ends.min(axis=0) + ends.max(axis=0)) / 2.0
    reach = float(np.sqrt(((ends - middle) ** 2).sum(axis=1)).max()) + 0.03
    along, to = d @ (middle - EYE), middle - EYE
    live = np.flatnonzero(to @ to - along * along < reach * reach)
    s, end = np.maximum(along[live] - reach, 0.0), along[live] + reach
    for _ in range(80):
        gap = distance_to_skin(flesh, EYE + s[:, None] * d[live])
        met = gap < 1e-4
        far[live[met]] = s[met]
        kept = ~met & (s < end)
        live, s, end = live[kept], (s + gap)[kept], end[kept]
    return far


def slopes(flesh: Floats, points: Floats) -> Floats:
    """Return the outward normals of the skin at points, (K, 3)."""
    steps = 2.5e-3 * np.eye(3)  # wide enough to smooth the creases between bones
    n = np.stack(
        [distance_to_skin(flesh, points + e) - distance_to_skin(flesh, points - e) for e in steps],
        axis=-1,
    )
    return np.asarray(n / np.sqrt((n * n).sum(axis=1, keepdims=True)))


# ---------------------------------------------------------------------------- the picture


def fire(P: Floats) -> Floats:
    """Return the colours of pressures [Pa], 0..255."""
    return 255.0 * np.asarray(MAP(np.clip(P / TOP, 0.0, 1.0)))[..., :3]


def mix(under: Floats, over: Floats, share: Floats) -> Floats:
    """Blend colours over others, (K, 3), with the opacity `share`, (K,)."""
    return np.asarray(under + (over - under) * share[:, None])


class Picture:
    """The camera's view of a renderer now."""

    def __init__(self, renderer: pc.Renderer) -> None:
        self.renderer, self.array = renderer, renderer.session.array
        self.hand = renderer.rendered_scene.hands[0]
        self.skin = get_skin(self.hand)
        self.placed = self.skin.place(self.hand)
        self.d = rays(FINER * SIZE[0], FINER * SIZE[1])
        self.out = np.tile(NIGHT, (len(self.d), 1))

    def draw(self) -> Image.Image:
        """Draw from the back to the front."""
        self._array()
        self._air()
        far = cast(self.placed.capsules, self.d)
        self._hand(far)
        self._ball(far)
        colours = np.clip(self.out, 0.0, 255.0).astype(np.uint8)
        made = Image.fromarray(colours.reshape(FINER * SIZE[1], FINER * SIZE[0], 3))
        return label(made.resize(SIZE, Image.Resampling.BOX))

    def _compute_felt(self, points: Floats, facing: pc.SkinFacing | None) -> Floats:
        """Return the radiation pressure at points, (M,) [Pa]."""
        p = self.renderer.compute_pressures(points, facing)
        return np.asarray(pc.radiation_pressure(p, self.renderer.session.medium))

    def _array(self) -> None:
        gains = self.renderer.emitted_gains
        hue = 255.0 * colormaps[CYCLIC](np.angle(gains) / math.tau % 1.0)[:, :3]
        light = 0.25 + 0.75 * np.sqrt(np.abs(gains))
        s = -EYE[2] / np.minimum(self.d[:, 2], -1e-9)
        seen = np.flatnonzero(s < 1.0)
        tree = cKDTree(self.array.positions[:, :2])
        gap, which = tree.query(EYE[:2] + s[seen, None] * self.d[seen, :2])
        seen, which = seen[gap < DOT], which[gap < DOT]
        fog = np.exp(-np.maximum(s[seen] - 0.40, 0.0) / 0.35)
        self.out[seen] = mix(self.out[seen], (light[:, None] * hue)[which], fog)

    def _air(self) -> None:
        s = (PLANE - EYE[1]) / np.maximum(self.d[:, 1], 1e-9)
        q = EYE + s[:, None] * self.d
        seen = (np.abs(q[:, 0]) < HALF) & (q[:, 2] > 0.004) & (q[:, 2] < UPPER)
        q = q[seen]
        x, z = np.arange(-HALF, HALF + STEP, STEP), np.arange(0.004, UPPER + STEP, STEP)
        Z, X = np.meshgrid(z, x, indexing="ij")
        P = self._compute_felt(np.stack([X, 0.0 * X + PLANE, Z], axis=-1).reshape(-1, 3), None)
        where = [(q[:, 2] - z[0]) / STEP, (q[:, 0] - x[0]) / STEP]
        P = np.asarray(map_coordinates(P.reshape(X.shape), where, order=1, mode="nearest"))
        edge = np.clip((HALF - np.abs(q[:, 0])) / 0.05, 0.0, 1.0)
        edge *= np.clip(np.minimum(UPPER - q[:, 2], q[:, 2] - 0.01) / 0.05, 0.0, 1.0)
        self.out[seen] = mix(self.out[seen], fire(P), edge * np.clip(P / (0.4 * TOP), 0.0, 0.9))

    def _hand(self, far: Floats) -> None:
        placed = self.placed
        shown = np.flatnonzero(self.skin.find_exposed(placed, np.arange(len(placed.points))))
        points, normals = placed.points[shown], placed.normals[shown]
        P = self._compute_felt(points, pc.SkinFacing(normals, placed.capsules))
        hit = np.flatnonzero(np.isfinite(far))
        q = EYE + far[hit, None] * self.d[hit]
        n = slopes(placed.capsules, q)
        gap, near = cKDTree(np.hstack([points, 0.004 * normals])).query(
            np.hstack([q, 0.004 * n]), 4
        )
        weight = 1.0 / (gap**2 + 1e-7)
        felt = (weight * P[near]).sum(axis=1) / weight.sum(axis=1)
        lit = 0.28 + 0.72 * (0.5 + 0.5 * (n @ LAMP)) ** 1.6
        rim = np.clip(1.0 + (n * self.d[hit]).sum(axis=1), 0.0, 1.0) ** 4
        skin = FLESH * lit[:, None] + 30.0 * rim[:, None]
        self.out[hit] = mix(skin, fire(felt), np.clip(felt / (0.35 * TOP), 0.0, 1.0))

    def _ball(self, far: Floats) -> None:
        to = EYE - BALL
        along = self.d @ to
        square = along * along - (to @ to - RADIUS * RADIUS)
        near = np.where(square > 0.0, -along - np.sqrt(np.maximum(square, 0.0)), np.inf)
        seen = np.flatnonzero((square > 0.0) & (near < far))
        n = (EYE + near[seen, None] * self.d[seen] - BALL) / RADIUS
        rim = np.clip(1.0 + (n * self.d[seen]).sum(axis=1), 0.0, 1.0)
        self.out[seen] = mix(self.out[seen], GLASS, 0.05 + 0.7 * rim**4)
        self.out[seen] += 90.0 * np.clip(n @ LAMP, 0.0, 1.0)[:, None] ** 60


@functools.cache
def font(size: int) -> Any:
    """Return the font that Matplotlib ships, `size` pixels high."""
    return ImageFont.truetype(font_manager.findfont("DejaVu Sans"), size)


def label(page: Image.Image) -> Image.Image:
    """Write what the picture shows, with a colour bar."""
    pen = ImageDraw.Draw(page)
    left, top, wide, high = 20, 40, 170, 8
    for x in range(wide):
        colour = tuple(int(c) for c in fire(np.array(TOP * x / (wide - 1))))
        pen.line([(left + x, top), (left + x, top + high)], fill=colour)
    pen.rectangle([left - 1, top - 1, left + wide, top + high], outline=DIM)
    pen.text((left, top - 8), "radiation pressure [Pa]", PALE, font(13), anchor="ls")
    for value in (0, 3, 6, 9):
        at = (left + wide * value / TOP, top + high + 14)
        pen.text(at, str(value), DIM, font(11), anchor="ms")
    for line, text in enumerate(("simulated: 2241 transducers,", "coloured by phase")):
        pen.text((left, top + 46 + 16 * line), text, DIM, font(12), anchor="ls")
    return page


def main(path: Path, *moments: float) -> None:
    """Write the loop, or only some moments [s] of it."""
    clock, drawn, tick = ManualClock(), list[Image.Image](), 0
    with pc.Renderer(pc.autd(3, 3), scene, adaptive=False, clock=clock) as renderer:
        for t in moments or [frame / FPS for frame in range(round(SECONDS * FPS))]:
            if moments:
                tick = max(tick, round(t / renderer.period) - SETTLED)
            while (due := tick * renderer.period) < t + 1e-9:
                clock.time, tick = due, tick + 1
                renderer.tick(due)
            drawn.append(Picture(renderer).draw())
            if moments:
                drawn[-1].save(path.with_name(f"{path.stem}-{t:.2f}.png"))
    if not moments:
        drawn = [page.resize(SAVED, Image.Resampling.LANCZOS) for page in drawn]
        first = round(FIRST * FPS)
        drawn = drawn[first:] + drawn[:first]
        drawn[0].save(
            path, save_all=True, append_images=drawn[1:], duration=round(1000 / FPS), loop=0,
            quality=QUALITY, method=6,
        )  # fmt: skip


if __name__ == "__main__":
    main(Path(sys.argv[1]), *(float(t) for t in sys.argv[2:]))
