"""Contacts: what a hand feels where it touches objects, made by the rendering loop and by foci."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import msgspec
import numpy as np

from pacinian.acoustics.pose import Pose
from pacinian.acoustics.pressure import sound_pressure
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.rendering.renderer import Renderer
from pacinian.scene.hands.hand import Hand
from pacinian.scene.objects import Volume
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.scene import Scene
from pacinian.scene.shapes import Box, Sphere
from pacinian.session import Session
from pacinian.testing import ManualClock
from pacinian_lab.regions.methods import FREE, OURS
from pacinian_lab.regions.shapes import SHAPES
from pacinian_lab.regions.skin import measure_felt
from pacinian_lab.solvers.problems import AIR

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from pacinian.acoustics.array import Array
    from pacinian.acoustics.pose import Vector
    from pacinian.scene.shapes.shape_types import SolidShape
    from pacinian.types import Gains

PRESSURE = 6.0  # [Pa]
# of a loop whose clock is set by hand, so that it has all the time it needs; [s]
TICKS, PERIOD = 16, 1e-3
BUDGET = 2000  # maximum number of foci
# shapes of `shapes.SHAPES`
FLAT = (
    "disc, 30 mm",
    "ring, 24 to 40 mm",
    "strip, 8 x 30 mm",
    "letter H",
    "letter S",
    "rectangle, 43 x 31 mm",
)
PALM, FINGERTIP = (0.0, 0.0, 0.195), (0.001, 0.0845, 0.2045)  # [m] skin under an open hand


class Contact(NamedTuple):
    """One contact, made in one way.

    pressure: requested where it is full [Pa]. samples: number of points that the solver was given. force, rms, holes,
    beside: over the whole touched skin, and the skin 3 to 30 mm beside it (`regions.skin`). saturation: fraction of
    the transducers at their limit.
    """

    contact: str
    way: str
    pressure: float
    samples: int
    force: float
    rms: float
    holes: float
    beside: float
    saturation: float


def _press(shape: SolidShape, place: Vector, top: float, depth: float) -> Scene:
    """Return an open hand with a shape pressed into it from below. top: height of the shape above its centre [m]."""
    x, y, z = place
    item = Volume(
        shape=shape, pose=Pose((x, y, z - top + depth)), radiation_pressure=PRESSURE, name="object"
    )
    return Scene((item,), hands=(Hand.open("right", Pose((0.0, 0.0, 0.21))),))


def _touch(name: str) -> Scene:
    """Return an open hand whose palm has sunk 3 mm into a flat shape of the other benchmark."""
    (item,) = SHAPES[name]().items
    x, y, z = PALM
    flat = msgspec.structs.replace(
        item, pose=Pose((x, y, z + 0.003)), radiation_pressure=PRESSURE, name="object"
    )
    return Scene((flat,), hands=(Hand.open("right", Pose((0.0, 0.0, 0.21))),))


CONTACTS: dict[str, Callable[[], Scene]] = {
    "ball of 30 mm radius at the palm": lambda: _press(Sphere(0.03), PALM, 0.03, 0.004),
    "ball of 20 mm radius at the palm": lambda: _press(Sphere(0.02), PALM, 0.02, 0.003),
    "ball of 10 mm radius at the palm": lambda: _press(Sphere(0.01), PALM, 0.01, 0.003),
    "ball of 12 mm radius at a fingertip": lambda: _press(Sphere(0.012), FINGERTIP, 0.012, 0.003),
    "edge of a box at a fingertip": lambda: _press(
        Box((0.04, 0.03, 0.01)), (FINGERTIP[0], FINGERTIP[1] - 0.015, FINGERTIP[2]), 0.005, 0.003
    ),
    **{f"{name}, at the palm": partial(_touch, name) for name in FLAT},
}
"""Scenes by name, in the order of the table."""


def measure_contacts(array: Array) -> Iterator[Contact]:
    """Make each contact by the rendering loop with regions, and by free-phase foci on the skin."""
    for name, make in CONTACTS.items():
        scene = make()
        for way in (OURS, *FREE):
            gains, samples, saturation = (
                _render_frames(array, scene) if way == OURS else _make_foci(array, scene, FREE[way])
            )
            felt = measure_felt(array, AIR, scene, TICKS * PERIOD, gains)
            assert felt is not None, name
            yield Contact(name, way, PRESSURE, samples, *felt, saturation)


def _render_frames(array: Array, scene: Scene) -> tuple[Gains, int, float]:
    """Return the frames that the device plays in turn, (K, N), the number of samples, and the saturation."""
    with Renderer(array, scene, medium=AIR, clock=ManualClock(), adaptive=False) as renderer:
        for k in range(TICKS):
            renderer.tick(k * PERIOD)
        assert renderer.samples is not None
        assert renderer.solution is not None
        return renderer.cycle_gains, len(renderer.samples), renderer.solution.saturation


def _make_foci(array: Array, scene: Scene, spacing: float) -> tuple[Gains, int, float]:
    """Make free-phase foci on the touched skin, `spacing` [m] apart."""
    sampler = Sampler(BUDGET, spacing)
    sampler.prepare(array, AIR)
    samples = sampler.sample(scene)
    solution = Session(array, AIR).solve(
        samples.positions,
        sound_pressure(samples.radiation_pressure, AIR),
        facing=SkinFacing.of(samples.normals, samples.capsules)
        if samples.capsules is not None
        else None,
    )
    return np.atleast_2d(solution.gains), len(samples), solution.saturation
