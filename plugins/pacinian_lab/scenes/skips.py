"""The measured skips, and how to disable each of them."""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from pacinian import gallery
from pacinian.acoustics.pose import Pose
from pacinian.gallery import HUM
from pacinian.rendering.renderer import Renderer
from pacinian.scene.hands.hand import Hand
from pacinian.scene.modulation.waves import Constant
from pacinian.scene.objects import Particles, Point
from pacinian.scene.sampling.distance_cache import DistanceCache
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.scene import Scene
from pacinian.scene.shapes.mesh import Mesh
from pacinian_lab.scenes.savings import At, Skip

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.scene.modulation.envelope import Envelope
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Floats

STILL = {"static-focus": "one focus", "mesh": "a hand on a mesh", "palm": "a whole palm"}
CROWD = 1000  # objects
OUT_OF_REACH = 1.0  # [m]; out of reach
ANYWHERE = np.empty((0, 3))


def skips() -> list[Skip]:
    """Return all skips."""
    return [
        *(_known(f"{words}: nothing changed", name, Constant(), 0.02) for name, words in STILL.items()),
        *(_known(f"{words}: only the envelope changed", name, HUM, 0.1) for name, words in STILL.items()),
        Skip(
            "STM: reuse solutions of known steps",
            *_same(gallery.stm_circle), lambda renderer: renderer.sample_solver.reset(),
        ),
        Skip(
            "1 of 41 samples moved: update one row",
            *_same(move_one), lambda renderer: renderer.session.propagator.forget(),
        ),
        Skip("1000 balls, 3 near: skip distant balls", _crowd, _crowd_all_near),
        Skip("skip a hand that is out of reach", _away, gallery.palm),
        Skip("a mesh: bounded and cached distances", gallery.mesh, exact_mesh, sampler=Forgetful),
        Skip("a mesh: cached distances", *_same(gallery.mesh), sampler=Forgetful),
        Skip("skip skin that faces away", *_same(gallery.textured_plane), sampler=AllSides),
        Skip(
            "skip samples that are too faint to feel",
            *_same(gallery.textured_plane), sampler=lambda: Sampler(perception=False),
        ),
    ]  # fmt: skip


def _same(scene: At) -> tuple[At, At]:
    return scene, scene


def _known(what: str, name: str, envelope: Envelope, limit: float) -> Skip:
    """Return a skip for a scene in which nothing moves, compared with a cold tick of the scene."""
    scene = gallery.SCENES[name](0.0)
    objects = tuple(replace(item, motion=None, envelope=envelope) for item in scene.objects)
    still = Scene(objects, hands=tuple(Hand(hand.joints) for hand in scene.hands))
    return Skip(what, *_same(lambda t: still), Renderer.reset, limit=limit)


def move_one(t: float) -> Scene:
    """Forty samples that stay, and one beside them that moves."""
    at = 0.03 * math.sin(2.0 * math.pi * t), 0.05, gallery.HEIGHT
    return Scene((_grid(), Point(position=at, radiation_pressure=2.0)))


@functools.cache
def _grid() -> Particles:
    X, Y = np.meshgrid(0.012 * np.arange(8) - 0.042, 0.012 * np.arange(5) - 0.024)
    at = np.column_stack([X.ravel(), Y.ravel(), np.full(X.size, gallery.HEIGHT)])
    return Particles(positions=at, radiation_pressure=2.0)  # type: ignore[arg-type]


def _crowd(t: float) -> Scene:
    return gallery.balls(CROWD).with_hands(*gallery.crowd(t).hands)


def _crowd_all_near(t: float) -> Scene:
    return _all_near().with_hands(*gallery.crowd(t).hands)


@functools.cache
def _all_near() -> Scene:
    """Return a crowd whose bounding spheres let every ball pass the broad phase."""
    scene = Scene(gallery.balls(CROWD).objects)
    scene.bounds[:, -1] = np.inf
    return scene


def _away(t: float) -> Scene:
    """The palm, out of reach."""
    scene = gallery.palm(t)
    return scene.with_hands(
        *(hand.transform(Pose((0.0, 0.0, OUT_OF_REACH))) for hand in scene.hands)
    )


class ExactMesh(Mesh, frozen=True, tag="exact mesh", dict=True):
    """A mesh whose distances are exact everywhere."""

    def distance(self, points: Floats, beyond: float = math.inf, deep: float = math.inf) -> Floats:
        """Return the exact distances, ignoring the bounds."""
        return super().distance(points)


def exact_mesh(t: float) -> Scene:
    """The gallery's mesh scene with exact distances everywhere."""
    return _exact_stone().with_hands(*gallery.mesh(t).hands)


@functools.cache
def _exact_stone() -> Scene:
    stone = gallery.stone_mesh()
    exact = ExactMesh(vertices=stone.vertices, faces=stone.faces)
    return Scene(tuple(replace(item, shape=exact) for item in gallery.mesh(0.0).objects))


class Forgetful(Sampler):
    """A sampler that caches no distances."""

    def sample(self, scene: Scene, t: float = 0.0, ahead: float = 0.0) -> Samples:
        """Sample with an empty distance cache."""
        self._distances = DistanceCache()
        return super().sample(scene, t, ahead)


class AllSides(Sampler):
    """A sampler that includes all touched skin, whether or not it faces the array."""

    def prepare(self, array: Array, medium: Air) -> None:
        """Prepare without the positions that skin must face."""
        super().prepare(array, medium)
        assert self._resolving is not None
        self._resolving.corners = ANYWHERE
