from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.errors import ArgumentError, WireError
from pacinian.scene.modulation.envelope import (
    Function,
    Sine,
    Wave,
)
from pacinian.scene.modulation.technique import AM
from pacinian.scene.objects import Point, Surface, Volume
from pacinian.scene.shapes import sphere_capsule as rounds
from pacinian.scene.shapes.csg import Difference, Placed, Union
from pacinian.scene.shapes.mesh import Mesh
from pacinian.wire import modulation, objects, shapes
from pacinian.wire.convert import (
    to_scene,
    to_wire,
)
from pacinian.wire.decode_errors import locate_errors

CORNERS = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
SIDES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))

BALL = shapes.Sphere(0.1)
WRONG = [
    (objects.Point(position=(0.0, 0.0, 0.2)), ".radiation_pressure"),
    (objects.Volume(shape=shapes.Sphere(-1.0), force=1.0), ".shape.radius"),
    (
        objects.Volume(shape=shapes.Union((BALL, shapes.Sphere(-1.0))), force=1.0),
        ".shape.parts[1].radius",
    ),
    (
        objects.Volume(shape=shapes.Difference(BALL, (shapes.Sphere(-1.0),)), force=1.0),
        ".shape.less[0].radius",
    ),
    (
        objects.Volume(
            shape=shapes.Placed(BALL, shapes.Pose(rotation=(1.0, 1.0, 0.0, 0.0))), force=1.0
        ),
        ".shape.pose.rotation",
    ),
    (
        objects.Surface(shape=BALL, force=1.0, pose=shapes.Pose(rotation=(0.0, 0.0, 0.0, 0.5))),
        ".pose.rotation",
    ),
    (
        objects.Surface(shape=BALL, force=1.0, envelope=modulation.Sine(1.0, 0.9, 0.1)),
        ".envelope.high",
    ),
    (
        objects.Surface(shape=BALL, force=1.0, technique=modulation.STM(10.0, shapes.Circle(-1.0))),
        ".technique.along.radius",
    ),
    (
        objects.Surface(shape=BALL, force=1.0, technique=modulation.STM(10.0, dwell=9.0)),
        ".technique.dwell",
    ),
    (
        objects.Surface(
            shape=shapes.HeightMap(heights=bytes(8), grid=(1, 2), width=0.1, height=0.1), force=1.0
        ),
        ".shape.heights",
    ),
    (objects.Path(shape=shapes.Polyline(bytes(24)), force=1.0), ".shape.points"),
    (objects.Volume(shape=BALL, force=1.0, felt="interior"), ".force"),
]


@pytest.mark.parametrize(("item", "path"), WRONG, ids=[path for _, path in WRONG])
def test_what_cannot_be_meant_is_told_with_its_path(item: objects.Object, path: str) -> None:
    with pytest.raises(WireError) as caught:
        to_scene("ball", item)
    assert caught.value.path == "$.objects[ball]" + path


def test_an_open_mesh_is_no_volume() -> None:
    made = to_wire(Surface(shape=Mesh(vertices=CORNERS, faces=SIDES[:3]), force=1.0))
    assert isinstance(made, objects.Surface)
    assert isinstance(made.shape, shapes.Mesh)
    with pytest.raises(WireError, match="no volume") as caught:
        to_scene("a", objects.Volume(shape=made.shape, force=1.0))
    assert caught.value.path == "$.objects[a].shape"


def deep(item: Any) -> Any:
    return Volume(shape=item, radiation_pressure=1.0)


BALLS = Union((rounds.Sphere(0.1), rounds.Sphere(0.2)))
SENT = [
    (deep(pc.SDF(lambda p: p[:, 0], (1.0, 1.0, 1.0))), "$.shape", "Voxels"),
    (deep(Union((BALLS,))), "$.shape.parts[0]", "one level deep"),
    (deep(Placed(BALLS)), "$.shape.shape", "one level deep"),
    (deep(Placed(Placed(rounds.Sphere(0.1)))), "$.shape.shape", "one level deep"),
    (deep(Difference(BALLS, (rounds.Sphere(0.1),))), "$.shape.of", "one level deep"),
    (deep(Union((rounds.Sphere(0.1),) * 17)), "$.shape.parts", "16"),
    (Point(position=(0.0, 0.0, 0.2), force=1.0, envelope=Function(np.sin)), "$.envelope", "Wave"),
    (Point(position=(20.0, 0.0, 0.2), force=1.0), "$.position[0]", "10"),
    (Point(position=(0.0, 0.0, 0.2), force=1e9), "$.force", "1000"),
    (
        Point(position=(0.0, 0.0, 0.2), force=1.0, envelope=Sine(50_000.0)),
        "$.envelope.frequency",
        "20000",
    ),
    (
        Point(position=(0.0, 0.0, 0.2), force=1.0, name="a", technique=AM(50_000.0)),
        "$.technique.frequency",
        "20000",
    ),
    (
        Point(position=(0, 0, 0.2), force=1.0, envelope=Wave("", (0.0,) * 200_001, 8e3)),
        "$.envelope.samples",
        "lower rate",
    ),
]


@pytest.mark.parametrize(("item", "path", "said"), SENT)
def test_what_cannot_be_sent_is_refused_with_advice(item: Any, path: str, said: str) -> None:
    with pytest.raises(WireError, match=said) as caught:
        to_wire(item)
    assert caught.value.path == path


def test_what_is_no_object_is_refused() -> None:
    with pytest.raises(ArgumentError, match="item"):
        to_wire("ball")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (ValueError("the grid is too fine"), "the grid is too fine"),
        (ZeroDivisionError("division by zero"), "division by zero"),
        (MemoryError(), "MemoryError"),  # it has no text
        (ArgumentError("radius", "must be above 0"), "`radius` must be above 0"),
        (WireError("is no volume", ".shape"), "is no volume"),
    ],
)
def test_what_is_wrong_is_told_in_its_own_words(error: Exception, told: str) -> None:
    def convert(_: object) -> object:
        raise error

    with pytest.raises(WireError) as caught:
        locate_errors("$.objects[a]", convert, objects.Point(position=(0.0, 0.0, 0.2)))
    assert caught.value.problem == told
    below = ".shape" if isinstance(error, WireError) else ""
    assert caught.value.path == "$.objects[a]" + below
