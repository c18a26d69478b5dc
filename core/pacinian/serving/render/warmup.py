"""Warm-up of the render process: loads what the first ticks need."""

from __future__ import annotations

import contextlib
import logging
from itertools import product
from typing import TYPE_CHECKING, Any

from pacinian.acoustics.pose import Pose
from pacinian.rendering.renderer import Renderer
from pacinian.rendering.rerender import CaptureBackend, FixedClock
from pacinian.scene.hands.hand import Hand
from pacinian.scene.modulation.noise import Noise
from pacinian.scene.modulation.technique import AM, STM
from pacinian.scene.objects import Object, Path, Point, Volume
from pacinian.scene.scene import Scene
from pacinian.scene.shapes.curves import Circle
from pacinian.scene.shapes.mesh import Mesh
from pacinian.scene.shapes.sphere_capsule import Sphere
from pacinian.serving.render.background_loader import load_object
from pacinian.solving.blas import limit_blas_threads
from pacinian.solving.limits import Limits
from pacinian.solving.quiet_zone import Zone

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.acoustics.pose import Vector
    from pacinian.plugins.backend import Capability
    from pacinian.plugins.solver import Solver
    from pacinian.types import Floats

WARMUP_HEIGHT = 0.15  # height of the warm-up scenes above the array [m]
WARMUP_TICKS = 4  # number of ticks of each warm-up scene; they load all that later ticks need
ZONE_PRESSURE = 1.0  # limit of the sound pressure in a quiet zone [Pa]
POWER_LIMIT = 1e-3  # power limit, below what the points need, so that the solver must enforce it
PRESSURE: Any = {"radiation_pressure": 1.0}
NOISE = Noise(low_frequency=50.0, high_frequency=200.0)


def warm_up(array: Array, medium: Air, solver: Solver, capability: Capability, rate: float) -> None:
    """Render a few scenes of all kinds without a device, with and without quiet zones and a power limit.

    As in the loop, BLAS has one thread. With more, they wait for each other, and the warm-up takes twice the time.
    """
    away = array.normals.mean(axis=0)
    place: Floats = array.positions.mean(axis=0) + WARMUP_HEIGHT * away
    x, y, z = (place + 0.1).tolist()
    kinds = (
        Limits(),
        Limits(power=POWER_LIMIT, zones=(Zone((x, y, z), pressure=ZONE_PRESSURE, radius=0.0),)),
    )
    with limit_blas_threads(), _suppress_warnings():
        for scene, limits in product(_make_scenes(place), kinds):
            _render(array, medium, solver, capability, rate, scene, limits)


@contextlib.contextmanager
def _suppress_warnings() -> Generator[None]:
    """Log no warnings about the warm-up's objects, which no user has made."""
    logger = logging.getLogger("pacinian")
    before, logger.disabled = logger.disabled, True
    try:
        yield
    finally:
        logger.disabled = before


def _render(
    array: Array, medium: Air, solver: Solver, capability: Capability, rate: float, scene: Scene,
    limits: Limits,
) -> None:  # fmt: skip
    renderer = Renderer(
        array,
        scene,
        medium=medium,
        solver=solver,
        backend=CaptureBackend(capability),
        rate=rate,
        limits=limits,
        clock=FixedClock(),
    )
    with renderer:
        for tick in range(WARMUP_TICKS):
            renderer.tick(tick / rate)


def _make_scenes(place: Floats) -> Iterator[Scene]:
    x, y, z = place.tolist()
    at, hand = Pose((x, y, z)), Hand.open(pose=Pose((x, y, z + 0.01)), time=0.0)
    point = Point(position=(x, y, z), **PRESSURE)
    other = Point(position=(x + 0.03, y, z), technique=AM(), **PRESSURE)
    circle = Path(shape=Circle(0.02), pose=at, technique=STM(frequency=100.0), **PRESSURE)
    ball = Volume(shape=Sphere(0.012), pose=at, envelope=NOISE, **PRESSURE)
    solid = load_object(Volume(shape=_make_tetrahedron(), pose=at, **PRESSURE))
    felt: tuple[Object, ...] = point, ball, solid
    yield Scene((point, other))
    yield Scene((circle,))
    yield Scene(felt)
    yield Scene(felt, hands=(hand,))


def _make_tetrahedron() -> Mesh:
    a, b = 0.012, -0.012
    corners: tuple[Vector, ...] = (a, a, a), (a, b, b), (b, a, b), (b, b, a)
    return Mesh(vertices=corners, faces=((0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)))
