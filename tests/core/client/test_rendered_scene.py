"""The rendered scene is what the replies of `show` add up to, wherever each object was sent."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pacinian as pc
from pacinian.client.rendered_scene import RenderedScene
from pacinian.wire.binary_arrays import pack
from pacinian.wire.convert import to_wire
from pacinian.wire.replies import Shown

if TYPE_CHECKING:
    from pacinian.scene.objects import Object

BALL = pc.Volume(shape=pc.Sphere(0.02), radiation_pressure=5.0, name="ball")
SPARK = pc.Point(position=(0.0, 0.0, 0.1), radiation_pressure=5.0, name="spark")
QUARTER = 0.5**0.5


def make_shown(version: int, poses: dict[str, Any], *new: Object, scene: str = "hall") -> Shown:
    return Shown(
        scene=scene,
        version=version,
        names=tuple(poses),
        poses=pack(list(poses.values())) if poses else b"",
        objects={item.name: to_wire(item) for item in new},
    )


def at(x: float) -> tuple[float, ...]:
    """A quarter turn about z, beside the middle."""
    return x, 0.0, 0.25, 0.0, 0.0, QUARTER, QUARTER


def test_objects_are_kept_and_their_poses_are_the_newest() -> None:
    seen = RenderedScene()
    seen.update(make_shown(3, {"ball": at(0.25), "spark": at(0.5)}, BALL, SPARK))
    assert (seen.scene, seen.version) == ("hall", 3)
    first = {item.name: item for item in seen.objects}
    assert first["spark"].pose.position == (0.5, 0.0, 0.25)
    seen.update(make_shown(3, {"ball": at(-0.25), "spark": at(0.5)}))
    ball = next(item for item in seen.objects if item.name == "ball")
    assert ball.pose.position == (-0.25, 0.0, 0.25)
    assert abs(ball.pose.rotation[2] - QUARTER) < 1e-6
    assert ball.bounding_radius == first["ball"].bounding_radius
    seen.update(make_shown(4, {"spark": at(0.5)}))
    assert [item.name for item in seen.objects] == ["spark"]


def test_an_object_that_is_put_again_replaces_the_one_before() -> None:
    seen = RenderedScene()
    seen.update(make_shown(1, {"ball": at(0.0)}, BALL))
    assert [item.bounding_radius for item in seen.objects] == [BALL.bounding_radius]
    larger = pc.Volume(shape=pc.Sphere(0.04), radiation_pressure=5.0, name="ball")
    seen.update(make_shown(2, {"ball": at(0.0)}, larger))
    assert [item.bounding_radius for item in seen.objects] == [larger.bounding_radius]


def test_another_scene_has_other_objects_even_of_the_same_name() -> None:
    seen = RenderedScene()
    seen.update(make_shown(7, {"ball": at(0.0)}, BALL))
    assert seen.objects
    seen.update(make_shown(1, {"ball": at(0.0)}, scene="garden"))
    assert not seen.objects
