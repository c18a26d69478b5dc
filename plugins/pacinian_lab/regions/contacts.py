"""Contacts: what a hand feels where it touches, made by the rendering loop and by foci."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

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
from pacinian_lab.regions.run import FREE, OURS
from pacinian_lab.regions.skin import felt_on_skin
from pacinian_lab.solvers.problems import AIR

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from pacinian.acoustics.array import Array
    from pacinian.acoustics.pose import Vector
    from pacinian.scene.shapes.shape_types import SolidShape
    from pacinian.types import Gains

PRESSURE = 6.0  # [Pa]
TICKS, PERIOD = (
    16,
    1e-3,
)  # of a loop whose clock stands still, so that it has all the time it needs, [s]
BUDGET = 2000  # foci at most
PALM, FINGERTIP = (0.0, 0.0, 0.195), (0.001, 0.0845, 0.2045)  # [m] skin below an open hand


class Contact(NamedTuple):
    """One contact, made in one way.

    pressure: asked [Pa] where it is full. samples: how many the solver was given. force, rms, holes, beside: over the
    whole touched skin, and the skin 3 to 10 mm beside it (`regions.skin`). saturation: share of the transducers at
    their limit.
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
    """An open hand, and a shape pressed into it from below. top: of the shape, above its middle [m]."""
    x, y, z = place
    item = Volume(
        shape=shape, pose=Pose((x, y, z - top + depth)), radiation_pressure=PRESSURE, name="object"
    )
    return Scene((item,), hands=(Hand.open("right", Pose((0.0, 0.0, 0.21))),))


CONTACTS: dict[str, Callable[[], Scene]] = {
    "ball of 30 mm radius at the palm": lambda: _press(Sphere(0.03), PALM, 0.03, 0.004),
    "ball of 20 mm radius at the palm": lambda: _press(Sphere(0.02), PALM, 0.02, 0.003),
    "ball of 10 mm radius at the palm": lambda: _press(Sphere(0.01), PALM, 0.01, 0.003),
    "ball of 12 mm radius at a fingertip": lambda: _press(Sphere(0.012), FINGERTIP, 0.012, 0.003),
    "edge of a box at a fingertip": lambda: _press(
        Box((0.04, 0.03, 0.01)), (FINGERTIP[0], FINGERTIP[1] - 0.015, FINGERTIP[2]), 0.005, 0.003
    ),
}
"""By name, in the order of the table."""


def measure_contacts(array: Array) -> Iterator[Contact]:
    """Make each contact by the rendering loop with regions, and by free foci on the skin."""
    for name, make in CONTACTS.items():
        scene = make()
        for way in (OURS, *FREE):
            gains, samples, saturation = (
                _rendered(array, scene) if way == OURS else _focused(array, scene, FREE[way])
            )
            felt = felt_on_skin(array, AIR, scene, TICKS * PERIOD, gains)
            assert felt is not None, name
            yield Contact(name, way, PRESSURE, samples, *felt, saturation)


def _rendered(array: Array, scene: Scene) -> tuple[Gains, int, float]:
    """What the device plays in turn, (K, N); samples; saturation."""
    with Renderer(array, scene, medium=AIR, clock=ManualClock()) as renderer:
        for k in range(TICKS):
            renderer.tick(k * PERIOD)
        assert renderer.samples is not None
        assert renderer.solution is not None
        return renderer.sounding, len(renderer.samples), renderer.solution.saturation


def _focused(array: Array, scene: Scene, spacing: float) -> tuple[Gains, int, float]:
    """Foci of free phase on the touched skin, `spacing` [m] apart."""
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
