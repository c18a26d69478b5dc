"""Changes from the bus, applied to the rendered scene."""

import math
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.acoustics.pose import Pose
from pacinian.scene.modulation.technique import AM, SIMULTANEOUS, STM
from pacinian.scene.motion import Motion
from pacinian.scene.objects import Object
from pacinian.scene.shapes.mesh import Mesh
from pacinian.serving.ipc.messages import (
    AnyChange,
    HandInfo,
    MoveObject,
    PutObject,
    RemoveObject,
    ResetScene,
    SetEnvelope,
    SetHands,
    SetQuiet,
)
from pacinian.serving.render import background_loader
from pacinian.serving.render.background_loader import BackgroundLoader
from pacinian.serving.render.frame_output import Input
from pacinian.serving.render.scene_replica import SceneReplica

START = 100.0
BALL = pc.Volume(shape=pc.Sphere(0.03), force=0.01)
POINT = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0)


class Manual:
    """A loader that works when the test says so."""

    def __init__(self) -> None:
        self.loader = BackgroundLoader(thread=lambda _: None)

    def work(self) -> None:
        while len(self.loader):
            self.loader._load_next()


def felt(**given: Any) -> SceneReplica:
    made = SceneReplica(None, given.pop("loader", BackgroundLoader(thread=lambda _: None)), **given)
    made.start = START
    return made


def put(name: str, item: Object, default: bool = False) -> PutObject:
    return PutObject(name, msgspec.msgpack.encode(item), default)


def move(name: str, x: float, **given: Any) -> MoveObject:
    values: dict[str, Any] = {
        "rotation": (0.0, 0.0, 0.0, 1.0), "velocity": None, "angular_velocity": None, "time": 101.0,
    }  # fmt: skip
    return MoveObject(name, (x, 0.0, 0.15), **{**values, **given})


def hands(*infos: HandInfo, is_felt: bool = True, sequence: int = 7) -> SetHands:
    return SetHands(infos, is_felt, sequence, 0.25, 100.5)


def hand(name: str = "a/right", x: float = 0.0) -> HandInfo:
    joints = pc.Hand.open(pose=Pose((x, 0.0, 0.15))).joints
    assert joints is not None
    return HandInfo("right", name, joints.astype("<f4").tobytes(), b"", b"", 101.0)


def names(scene: pc.Scene) -> list[str]:
    return [item.name for item in scene.objects]


def test_objects_come_move_and_go() -> None:
    scene = felt()
    scene.apply([put("a", POINT), put("b", BALL)])
    assert names(scene.scene) == ["a", "b"]
    q = (0.0, 0.0, 0.5, math.sqrt(0.75) * 1.005)
    scene.apply([move("a", 0.02), move("b", 0.03, rotation=q, velocity=(1.0, 0.0, 0.0))])
    a, b = scene.scene.objects
    assert isinstance(a, pc.Point)
    assert a.position == (0.02, 0.0, 0.15)
    assert a.motion is None
    assert isinstance(b, pc.Volume)
    # equal to an object that is made with all checks
    assert b.pose == Pose((0.03, 0.0, 0.15), q)
    assert b.motion == Motion((1.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)
    scene.apply([RemoveObject("a"), RemoveObject("never")])
    assert names(scene.scene) == ["b"]
    scene.apply([ResetScene()])
    assert names(scene.scene) == []


def test_nothing_new_is_the_same_scene() -> None:
    scene = felt()
    scene.apply([put("a", POINT)])
    before = scene.scene
    scene.apply([])
    scene.apply(
        [RemoveObject("b"), move("b", 0.1), SetEnvelope("b", msgspec.msgpack.encode("buzzing"))]
    )
    assert scene.scene is before


STEPS = st.tuples(st.sampled_from("pmr"), st.sampled_from("abc"), st.integers(0, 9))


@settings(max_examples=60)
@given(st.lists(STEPS, max_size=30), st.integers(1, 7))
def test_batches_are_as_one_change_after_the_other(
    steps: list[tuple[str, str, int]], size: int
) -> None:
    scene, model = felt(), dict[str, float]()
    changes: list[AnyChange] = []
    for what, name, x in steps:
        if what == "p":
            model[name] = x
            changes.append(put(name, pc.Point(position=(x, 0, 0.1), radiation_pressure=1.0)))
        elif what == "m":
            model.update({name: x} if name in model else {})
            changes.append(move(name, x))
        else:
            model.pop(name, None)
            changes.append(RemoveObject(name))
    for i in range(0, len(changes), size):
        scene.apply(changes[i : i + size])
    found = {item.name: item.position[0] for item in scene.scene.objects}  # type: ignore[union-attr]
    assert found == model
    assert not scene.refused
    np.testing.assert_allclose(scene.scene.bounds, pc.Scene(scene.scene.objects).bounds)


def test_intensity_and_technique_are_of_now_and_leave_what_was_asked() -> None:
    scene = felt()
    am = AM(frequency=100.0)
    scene.apply([put("a", POINT, default=True), put("b", BALL)])
    scene.present(am, 0.5)
    scene.apply([move("a", 0.01), put("c", POINT, default=True)])
    a, b, c = scene.scene.objects
    assert (a.radiation_pressure, b.force, c.radiation_pressure) == (2.5, 0.005, 2.5)
    assert (a.technique, b.technique, c.technique) == (am, SIMULTANEOUS, am)
    scene.present(STM(frequency=50.0), 0.2)
    scene.present(SIMULTANEOUS, 1.0)
    a, b, c = scene.scene.objects
    assert (a.radiation_pressure, b.force, c.radiation_pressure) == (5.0, 0.01, 5.0)
    assert a.technique == SIMULTANEOUS
    assert isinstance(a, pc.Point)
    assert a.position[0] == 0.01
    before = scene.scene
    scene.present(SIMULTANEOUS, 1.0)
    assert scene.scene is before


def test_with_felt_hands_that_are_gone_nothing_is_whole() -> None:
    scene = felt()
    scene.apply([put("a", BALL), hands(is_felt=False)])
    assert not scene.scene.hands
    scene.apply([hands(hand(), hand("a/left", 0.1))])
    assert [one.name for one in scene.scene.hands] == ["a/right", "a/left"]
    assert scene.scene.hands[0].time == 1.0
    for gone in (hands(), hands(HandInfo("left", "a", b"", b"", b"", 101.0))):
        scene.apply([gone])
        assert scene.scene.hands[0].lost
        assert not len(pc.Sampler().sample(scene.scene))


def test_the_input_belongs_to_its_scene() -> None:
    scene = felt()
    scene.apply([put("a", BALL), hands(hand(), sequence=7)])
    first = scene.scene
    scene.apply([hands(hand(x=0.01), sequence=8)])
    second = scene.scene
    scene.apply([move("a", 0.1)])
    assert scene.find_input(first) == Input(7, 0.25, 100.5)
    assert scene.find_input(second).input == scene.find_input(scene.scene).input == 8
    assert scene.find_input(scene.silenced) == scene.find_input(pc.Scene()) == Input()


def test_silenced_keeps_the_hands_and_is_always_the_same() -> None:
    scene = felt()
    scene.apply([put("a", BALL), hands(hand())])
    silenced = scene.silenced
    assert not silenced.objects
    assert silenced.hands == scene.scene.hands
    scene.apply([])
    assert scene.silenced is silenced


def test_quiet_zones_that_are_invalid_are_unknown_until_others_come() -> None:
    scene = felt(zones=(pc.Zone((0.0, 0.0, 0.4), pressure=1.0),))
    assert scene.zones is not None
    assert len(scene.zones) == 1
    scene.apply([SetQuiet((((0.0, 1.0, 2.0), 5.0, 0.1), ((3.0, 4.0, 5.0), 6.0, 0.0)))])
    assert scene.zones == (
        pc.Zone((0.0, 1.0, 2.0), pressure=5.0, radius=0.1),
        pc.Zone((3.0, 4.0, 5.0), pressure=6.0, radius=0.0),
    )
    scene.apply([SetQuiet((((0.0, 1.0, 2.0), -5.0, 0.1),))])
    assert "" in scene.refused
    assert scene.zones is None
    scene.apply([SetQuiet()])
    assert scene.zones == ()


@pytest.mark.parametrize("data", [b"", b"\xc1", msgspec.msgpack.encode({"type": "cube"}), b"\x80"])
def test_what_is_no_object_is_refused_and_the_rest_is_there(data: bytes) -> None:
    scene = felt()
    scene.apply(
        [put("a", POINT), PutObject("bad", data, False), SetEnvelope("a", data), put("b", POINT)]
    )
    assert names(scene.scene) == ["a", "b"]
    assert set(scene.refused) == {"bad", "a"}
    scene.apply([put("bad", POINT), RemoveObject("a")])
    assert not scene.refused


def test_refusals_are_bounded() -> None:
    scene = felt()
    scene.apply([PutObject(f"n{i}", b"", False) for i in range(1000)])
    assert len(scene.refused) == 256


def tetrahedron(size: float) -> pc.Volume:
    a, b = size, -size
    corners = (a, a, a), (a, b, b), (b, a, b), (b, b, a)
    mesh = Mesh(vertices=corners, faces=((0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)))
    return pc.Volume(shape=mesh, radiation_pressure=3.0)


def test_a_mesh_is_felt_once_it_is_loaded_until_then_the_one_before() -> None:
    manual = Manual()
    scene = felt(loader=manual.loader)
    scene.apply([put("a", BALL)])
    scene.apply([put("a", tetrahedron(0.03)), move("a", 0.01), move("a", 0.02)])
    assert not scene.find_awaited()  # the one before is felt
    (item,) = scene.scene.objects
    assert isinstance(item, pc.Volume)
    assert isinstance(item.shape, pc.Sphere)
    assert item.pose.position[0] == 0.02  # and moves
    manual.work()
    scene.apply()
    (item,) = scene.scene.objects
    assert isinstance(item, pc.Volume)
    assert isinstance(item.shape, Mesh)
    assert item.pose.position[0] == 0.02


@pytest.mark.parametrize("then", [RemoveObject("a"), ResetScene(), put("a", POINT)])
def test_what_came_since_wins_over_what_has_been_loaded(then: AnyChange) -> None:
    manual = Manual()
    scene = felt(loader=manual.loader)
    scene.apply([put("a", tetrahedron(0.03))])
    assert scene.find_awaited() == ["a"]
    scene.apply([then])
    assert not scene.find_awaited()
    before = names(scene.scene)
    manual.work()
    scene.apply()
    assert names(scene.scene) == before
    assert not any(hasattr(item, "shape") for item in scene.scene.objects)


def test_an_object_that_is_put_outside_the_workspace_is_logged(logged: Any) -> None:
    room = pc.Workspace((-0.1, -0.1, 0.1), (0.1, 0.1, 0.3))
    scene = SceneReplica(room, Manual().loader)
    sphere = pc.Sphere(0.05)
    for name, z in (("inside", 0.2), ("across", 0.33), ("beside", 0.36)):
        ball = pc.Volume(shape=sphere, pose=pc.Pose((0.0, 0.0, z)), radiation_pressure=1.0)
        scene.apply([put(name, ball)])
    assert names(scene.scene) == ["inside", "across", "beside"]
    text = logged.wait("outside the workspace")
    assert "beside" in text
    assert "across" not in text
    assert "inside" not in text


def test_a_mesh_that_cannot_be_loaded_is_refused(logged: Any) -> None:
    manual = Manual()
    scene = felt(loader=manual.loader)
    flat = Mesh(vertices=((0, 0, 0), (1, 0, 0), (0, 1, 0)), faces=((0, 1, 2),))
    open_one = msgspec.msgpack.encode(pc.Surface(shape=flat, radiation_pressure=1.0))
    as_volume = open_one.replace(b"\xa7surface", b"\xa6volume")
    scene.apply([PutObject("a", as_volume + b"", False), put("b", tetrahedron(0.03))])
    manual.work()
    scene.apply()
    assert names(scene.scene) == ["b"]
    assert "a" in scene.refused
    logged.wait("change refused", "object=a")


def test_envelopes_are_wrapped_and_slow_ones_once_they_are_made() -> None:
    manual = Manual()
    scene = felt(loader=manual.loader)
    noise = pc.Noise(low_frequency=10.0, high_frequency=100.0)
    scene.apply([put("a", POINT), SetEnvelope("a", msgspec.msgpack.encode("buzzing"))])
    assert scene.scene.objects[0].envelope == pc.Preset("buzzing")
    scene.apply([SetEnvelope("a", msgspec.msgpack.encode(noise))])
    assert scene.scene.objects[0].envelope == pc.Preset("buzzing")
    manual.work()
    scene.apply()
    assert scene.scene.objects[0].envelope == noise


@pytest.mark.parametrize("item", [POINT, BALL, tetrahedron(0.01)])
def test_a_slow_envelope_follows_an_object_that_is_being_loaded(item: pc.Volume | pc.Point) -> None:
    manual = Manual()
    scene = felt(loader=manual.loader)
    noise = pc.Noise(low_frequency=10.0, high_frequency=100.0)
    scene.apply([put("a", item)])
    scene.apply(
        [
            put("a", tetrahedron(0.03)),
            SetEnvelope("a", msgspec.msgpack.encode(noise)),
            move("a", 0.02),
        ]
    )
    for _ in range(2):
        manual.work()
        scene.apply()
    (made,) = scene.scene.objects
    assert isinstance(made, pc.Volume)
    assert made.shape == tetrahedron(0.03).shape
    assert made.envelope == noise
    assert made.pose.position[0] == 0.02
    assert not scene.loading


def test_particles_that_move_need_not_be_measured_again() -> None:
    scene = felt()
    crowd = pc.Particles(positions=tuple((i * 1e-5, 0.0, 0.0) for i in range(300)), radiation_pressure=1.0)  # fmt: skip
    scene.apply([put("a", crowd)])
    reach = scene.scene.objects[0].bounding_radius
    scene.apply([move("a", 0.1)])
    assert vars(scene.scene.objects[0]) == {"bounding_radius": reach}


def test_what_is_light_is_what_is_quick() -> None:
    assert background_loader.is_light(POINT)
    assert background_loader.is_light(BALL)
    assert not background_loader.is_light(tetrahedron(0.01))


def test_the_loader_makes_one_after_the_other_and_goes_on_after_errors() -> None:
    jobs: list[Any] = []
    loader = BackgroundLoader(thread=jobs.append)

    def bad() -> Object:
        raise RuntimeError("torn")

    loader.queue("a", 1, bad)
    loader.queue("b", 2, lambda: POINT)
    assert len(jobs) == 1  # one thread for all objects
    loader._load_next()
    loader._load_next()
    a, b = loader.take_results()
    assert (a.name, a.turn, a.made, a.problem) == ("a", 1, None, "RuntimeError: torn")
    assert b.made is POINT
    assert not loader.take_results()


def test_of_each_name_only_the_newest_is_loaded() -> None:
    manual = Manual()
    scene = felt(loader=manual.loader)
    for k in range(1, 50):
        scene.apply([put("a", tetrahedron(0.001 * k)), put(f"b{k}", tetrahedron(0.01))])
        scene.apply([RemoveObject(f"b{k}")])
        assert len(manual.loader) == 1
    manual.work()
    scene.apply([])
    [a] = scene.scene.objects
    assert isinstance(a, pc.Surface | pc.Volume)
    assert a.shape == tetrahedron(0.049).shape
    scene.apply([put("c", tetrahedron(0.01)), ResetScene()])
    assert len(manual.loader) == 0
