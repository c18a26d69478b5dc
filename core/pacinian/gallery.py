"""Built-in scenes of typical game content, for benchmarks, pictures and first steps. Each maps time to a scene."""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from pacinian.acoustics.pose import Pose
from pacinian.scene.hands.capsules import distance_to_skin, make_capsules
from pacinian.scene.hands.hand import Hand
from pacinian.scene.modulation.technique import STM
from pacinian.scene.modulation.waves import Sine
from pacinian.scene.motion import Motion
from pacinian.scene.objects import Particles, Point, Surface, Volume
from pacinian.scene.scene import Scene
from pacinian.scene.shapes import Rectangle, Sphere
from pacinian.scene.shapes.curves import Circle
from pacinian.scene.shapes.texture import grating

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.scene.shapes.mesh import Mesh
    from pacinian.types import Floats

HEIGHT = 0.2  # height of the palm above the array [m]
TRACKED = 120.0  # rate of updates of hands and objects, as sent by trackers and games [Hz]
HUM = Sine(150.0)
PALM = 0.015  # distance from the palm joint to the skin below it [m]
HAND = Hand.open("right", Pose((0.0, 0.0, HEIGHT + PALM)))
TILTED = Hand.open("right", Pose((0.0, -0.08, HEIGHT + 0.03)).rotate("x", math.radians(-12.0)))
STONE = 0.045  # mean radius of the stone [m]
BUMPS = 0.08  # amplitude of the bumps on the stone, relative to its radius
NEAR = (0.0, 0.0, HEIGHT - 0.007), (-0.026, 0.06, HEIGHT), (0.024, 0.06, HEIGHT)  # [m]
AWAY = 0.2  # distance in x or y beyond the reach of the hand [m]
DROPS, BOTTOM, FALL, SPLASH = 40, 0.03, 0.3, 0.05  # count, start height [m], rise and stay [s]
INTO = 1e-4  # depth to which a drop enters the skin [m]


def _hold_updates(scene: Callable[[float], Scene]) -> Callable[[float], Scene]:
    """Return the scene of the last update, so that motion between updates must be extrapolated."""
    seen = functools.lru_cache(maxsize=4)(scene)

    @functools.wraps(scene)
    def at(t: float) -> Scene:
        return seen(math.floor(t * TRACKED) / TRACKED)

    return at


def static_focus(t: float) -> Scene:
    """A vibrating focus at a fixed position."""
    return _static()


@_hold_updates
def sliding_ball(t: float) -> Scene:
    """A 3 cm ball that rolls back and forth below a still hand."""
    x, v = _oscillate(t, 0.03)
    pose, motion = Pose((x, -0.01, HEIGHT - 0.012)), Motion((v, 0.0, 0.0), time=t)
    return Scene((replace(_ball(), pose=pose, motion=motion),), hands=(HAND,))


@_hold_updates
def textured_plane(t: float) -> Scene:
    """Fingertips that stroke a plate with ridges 12 mm apart."""
    return _plate().with_hands(_oscillate_hand(TILTED, t, 0.02))


@_hold_updates
def mesh(t: float) -> Scene:
    """A hand on a bumpy stone of 10,000 triangles."""
    return _stone().with_hands(_oscillate_hand(HAND, t, 0.015))


@_hold_updates
def crowd(t: float) -> Scene:
    """A hundred balls, three of which the hand can touch."""
    return balls(100).with_hands(_oscillate_hand(HAND, t, 0.01))


@_hold_updates
def palm(t: float) -> Scene:
    """A plate on which the whole palm lies and moves slightly."""
    return _board().with_hands(_oscillate_hand(HAND, t, 0.005))


def stm_circle(t: float) -> Scene:
    """A focus that runs around a circle of 15 mm radius 100 times a second."""
    return _circle()


def rain(t: float) -> Scene:
    """Forty drops that rise to the palm one after the other: rain upside down, as the array is below."""
    return _drops(math.floor(t * TRACKED) % int(TRACKED))


def empty(t: float) -> Scene:
    """An empty scene."""
    return NOTHING


SCENES: dict[str, Callable[[float], Scene]] = {
    "static-focus": static_focus,
    "sliding-ball": sliding_ball,
    "textured-plane": textured_plane,
    "mesh": mesh,
    "crowd": crowd,
    "palm": palm,
    "stm-circle": stm_circle,
    "rain": rain,
    "empty": empty,
}
"""The scenes by name."""

NOTHING = Scene()


def _oscillate(t: float, swing: float) -> tuple[float, float]:
    """Return position [m] and velocity [m/s] of an oscillation with amplitude `swing` [m] at 1 Hz, at time t [s]."""
    s = 2.0 * math.pi * t
    return swing * math.sin(s), 2.0 * math.pi * swing * math.cos(s)


def _oscillate_hand(hand: Hand, t: float, swing: float) -> Hand:
    """Return a hand that oscillates by `swing` [m] at 1 Hz, as a tracker reports it at time t [s]."""
    x, v = _oscillate(t, swing)
    joints = hand.transform(Pose((x, 0.0, 0.0))).joints
    return Hand(joints, hand.radii, velocities=(v, 0.0, 0.0), time=t)


@functools.cache
def _static() -> Scene:
    point = Point(position=(0.0, 0.0, HEIGHT), radiation_pressure=20.0, envelope=HUM)
    return Scene((point,))


@functools.cache
def _ball() -> Volume:
    return Volume(shape=Sphere(0.015), radiation_pressure=12.0, envelope=HUM, name="ball")


@functools.cache
def _plate() -> Scene:
    plate = Surface(
        shape=Rectangle(0.24, 0.16),
        pose=Pose((0.0, 0.0, HEIGHT + 0.004)),
        texture=grating(0.012),
        radiation_pressure=10.0,
        envelope=HUM,
        name="plate",
    )
    return Scene((plate,))


@functools.cache
def _stone() -> Scene:
    stone = Volume(
        shape=stone_mesh(),
        pose=Pose((0.0, 0.02, HEIGHT - 0.038)),
        radiation_pressure=8.0,
        envelope=HUM,
        name="stone",
    )
    return Scene((stone,))


def stone_mesh(count: int = 51) -> Mesh:
    """Make a closed, bumpy sphere of about 2 count^2 triangles."""
    from trimesh.creation import uv_sphere

    from pacinian.scene.shapes.mesh import Mesh

    ball = uv_sphere(radius=1.0, count=[count, count])
    u = np.asarray(ball.vertices)
    r = STONE * (1.0 + BUMPS * np.sin(8.0 * u + np.arange(3.0)).prod(axis=1))
    return Mesh(vertices=r[:, None] * u, faces=np.asarray(ball.faces))  # type: ignore[arg-type]


@functools.cache
def balls(count: int) -> Scene:
    """Make a scene of balls of 1 cm radius. The first three touch the palm and two fingers; the others lie around."""
    rng = np.random.default_rng(0)
    far = rng.uniform([-0.4, -0.4, 0.03], [0.4, 0.4, 0.4], (2 * count, 3))
    far = far[(np.abs(far[:, :2]) > AWAY).any(axis=1)]
    places = [*NEAR, *map(tuple, far.tolist())][:count]
    ball = Volume(shape=Sphere(0.01), radiation_pressure=10.0, envelope=HUM)
    return Scene(
        tuple(replace(ball, pose=Pose(at), name=f"ball {i}") for i, at in enumerate(places))
    )


@functools.cache
def _board() -> Scene:
    board = Surface(
        shape=Rectangle(0.3, 0.3),
        pose=Pose((0.0, 0.0, HEIGHT + 0.007)),
        radiation_pressure=4.0,
        envelope=HUM,
        name="board",
    )
    return Scene((board,))


@functools.cache
def _circle() -> Scene:
    point = Point(
        position=(0.0, 0.0, HEIGHT),
        radiation_pressure=20.0,
        technique=STM(frequency=100.0, along=Circle(0.015)),
    )
    return Scene((point,))


@functools.lru_cache(maxsize=int(TRACKED))
def _drops(update: int) -> Scene:
    """Return the drops at one update of the second: each rises, stays at the skin briefly, and starts again."""
    places, tops, begun = _clouds()
    age = (update / TRACKED - begun) % 1.0  # [s]
    z = np.where(
        age < FALL + SPLASH, BOTTOM + (tops - BOTTOM) * np.minimum(age / FALL, 1.0), BOTTOM
    )
    at = np.column_stack([places, z])
    drops = Particles(positions=at, radiation_pressure=20.0, name="drops")  # type: ignore[arg-type]
    return Scene((drops,), hands=(HAND,))


@functools.cache
def _clouds() -> tuple[Floats, Floats, Floats]:
    """Return for each drop its x and y, (40, 2) [m], its top, (40,) [m], and its start in each second, (40,) [s]."""
    rng, flesh = np.random.default_rng(1), make_capsules(HAND)
    places = rng.uniform([-0.03, -0.03], [0.025, 0.025], (DROPS, 2))
    tops = np.full(DROPS, BOTTOM)
    while (away := distance_to_skin(flesh, np.column_stack([places, tops]))).max() > INTO:
        tops += np.maximum(away, 0.0)
    return places, tops + INTO, np.arange(DROPS) / DROPS
