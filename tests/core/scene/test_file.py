from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace
from scipy.io import wavfile

import pacinian as pc
from pacinian.acoustics.pose import Pose
from pacinian.scene.file import (
    Choice,
    HandPose,
    Lattice,
    Medium,
    Sampling,
    SceneFile,
    Units,
    schema,
)
from pacinian.scene.hands.hand import Hand
from pacinian.scene.material import Material
from pacinian.scene.motion import Motion
from pacinian.scene.objects import Particles
from pacinian.scene.objects import Path as Trace
from pacinian.scene.shapes.combine import Difference, Intersection, Placed, Union
from pacinian.scene.shapes.curves import Circle, Line, Lissajous, Polyline
from pacinian.scene.shapes.height_map import HeightMap
from pacinian.scene.shapes.texture import Texture
from pacinian.scene.shapes.voxels import Voxels
from pacinian.scene.time.envelope import Noise, Preset, Pulse, Wave
from pacinian.scene.time.technique import AM, LM, STM

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import ModuleType

bounded = settings(max_examples=150)

OPEN = Hand.open("left").joints
assert OPEN is not None
JOINTS = OPEN.tolist()

# Every key there is, once.
FULL = """
solver = { name = "lagrange", options = { steps = 20, tolerance = 1e-3, warm = true, mode = "x" } }
backend = { name = "simulated", options = {} }
rate = 500.0
gain = 0.8

[array]
type = "lattice"
width = 0.2
height = 0.1
pitch = 0.02
hinge = "y"
angle = 20.0
pose = { position = [0.0, 0.0, 0.1], rotation = [0.0, 0.0, 1.0, 0.0] }

[medium]
temperature = 25.0
humidity = 0.4
speed_of_sound = 346.0
density = 1.18
attenuation = 1.5
absorption = 0.2
ambient_pressure = 101325.0

[sampling]
budget = 128
spacing = 0.01

[workspace]
lower = [-0.2, -0.2, 0.05]
upper = [0.2, 0.2, 0.5]

[[hands]]
side = "left"
pose = { position = [0.0, 0.0, 0.2] }

[[hands]]
joints = JOINTS

[[objects]]
type = "point"
position = [0.01, 0.02, 0.2]
force = 0.001
area = 1e-4
envelope = { type = "constant", level = 0.5 }
technique = { type = "am", frequency = 120.0, depth = 0.5 }
material = { stiffness = 5000.0, reach = 0.003 }
motion = { velocity = [0.1, 0.0, 0.0], angular_velocity = [0.0, 0.0, 1.0], time = 0.5 }
priority = 2
name = "tip"

[[objects]]
type = "point"
position = [0, 0, 1]
radiation_pressure = 12

[[objects]]
type = "surface"
shape = { type = "rectangle", width = 0.05, height = 0.04 }
pose = { position = [0.0, 0.0, 0.2], rotation = [0.0, 0.0, 0.0, 1.0] }
radiation_pressure = 10.0
envelope = { type = "sine", frequency = 200.0, low = 0.1, high = 0.9 }
technique = { type = "simultaneous" }
material = {}
motion = {}
texture = { values = [[0.0, 1.0], [1.0, 0.0]], size = [0.01, 0.02], repeat = true }
thickness = 0.01
priority = 1
name = "button"

[[objects]]
type = "surface"
shape = { type = "disc", radius = 0.03 }
force = 0.01
envelope = { type = "square", frequency = 50.0, low = 0.2, high = 0.8, duty = 0.25 }

[[objects]]
type = "path"
shape = { type = "circle", radius = 0.02 }
pose = { position = [0.0, 0.0, 0.2] }
width = 0.005
force = 0.001
envelope = { type = "pulse", width = 0.02, period = 0.25, start = 0.01, rise = 0.005, low = 0.1, high = 0.9 }
technique = { type = "stm", frequency = 80.0, along = "outline", dwell = 0.0005 }
material = {}
motion = {}
priority = 3
name = "ring"

[[objects]]
type = "path"
shape = { type = "line", length = 0.05 }
radiation_pressure = 8.0
envelope = { type = "noise", low_frequency = 20.0, high_frequency = 300.0, low = 0.1, high = 0.9, seed = 7 }
technique = { type = "lm", frequency = 30.0, amplitude = 0.003, angle = 45.0 }

[[objects]]
type = "path"
shape = { type = "lissajous", width = 0.04, height = 0.03, a = 2, b = 3, phase = 90.0 }
radiation_pressure = 8.0
envelope = { type = "wave", file = "tap.wav", loop = false, mode = "loudness" }

[[objects]]
type = "path"
shape = { type = "polyline", points = [[0.0, 0.0, 0.0], [0.02, 0.0, 0.0], [0.0, 0.02, 0.01]], closed = true }
radiation_pressure = 8.0
envelope = { type = "wave", samples = [0.0, 1.0, 0.0, -1.0], rate = 800.0 }

[[objects]]
type = "particles"
positions = [[0.0, 0.0, 0.2], [0.01, 0.0, 0.21]]
pose = { position = [0.0, 0.0, 0.01] }
radius = 0.003
radiation_pressure = 15.0
envelope = "buzzing"
technique = { type = "stm", frequency = 80.0, along = { type = "circle", radius = 0.01 } }
material = {}
motion = {}
priority = -1
name = "rain"

[[objects]]
type = "particles"
positions = []
force = 0.001

[[objects]]
type = "surface"
shape = { type = "height-map", heights = [[0.0, 1.0], [1.0, 0.5]], width = 0.05, height = 0.04, depth = 0.01 }
radiation_pressure = 10.0
texture = { file = "stripes.npy", size = [0.02, 0.02], repeat = false }
envelope = { type = "preset", name = "trembling" }

[[objects]]
type = "surface"
shape = { type = "height-map", file = "hills.npy", width = 0.05, height = 0.04 }
force = 0.01

[[objects]]
type = "surface"
shape = { type = "mesh", file = "hand.stl", scale = 0.001 }
force = 0.01

[[objects]]
type = "volume"
shape = { type = "sphere", radius = 0.03 }
felt = "interior"
pose = { position = [0.0, 0.0, 0.2] }
radiation_pressure = 10.0
envelope = { type = "constant" }
technique = { type = "simultaneous" }
material = {}
motion = {}
texture = { values = [[0.5]], size = [0.01, 0.01] }
thickness = 0.015
priority = 4
name = "ball"

[[objects]]
type = "volume"
shape = { type = "mesh", file = "hand.stl", scale = 0.001 }
force = 0.01

[[objects]]
type = "volume"
shape = { type = "voxels", values = [[[1.0, 1.0]], [[0.0, 1.0]]], pitch = 0.01, level = 0.4 }
force = 0.01

[[objects]]
type = "volume"
shape = { type = "voxels", file = "block.npy", pitch = 0.005 }
force = 0.01

[[objects]]
type = "volume"
radiation_pressure = 10.0

[objects.shape]
type = "union"

[[objects.shape.parts]]
type = "placed"
shape = { type = "sphere", radius = 0.02 }
pose = { position = [0.01, 0.0, 0.0] }

[[objects.shape.parts]]
type = "intersection"
parts = [{ type = "sphere", radius = 0.02 }, { type = "box", size = [0.03, 0.03, 0.03] }]

[[objects.shape.parts]]
type = "difference"
of = { type = "sphere", radius = 0.02 }
less = [{ type = "mesh", file = "hand.stl", scale = 0.0001 }]

[[objects]]
type = "volume"
shape = { type = "box", size = [0.03, 0.02, 0.01] }
force = 0.01

[[objects]]
type = "volume"
shape = { type = "capsule", radius = 0.01, length = 0.05 }
force = 0.01

[[objects]]
type = "surface"
force = 0.01

[objects.shape]
type = "mesh"
vertices = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0]]
faces = [[0, 1, 2]]
""".replace("JOINTS", f"{JOINTS}")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the files that the full scene wants."""
    path = tmp_path_factory.mktemp("scenes")
    trimesh.creation.box((60.0, 40.0, 20.0)).export(path / "hand.stl")
    trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).export(path / "open.stl")
    np.save(path / "stripes.npy", np.array([[0.0, 1.0]]))
    np.save(path / "hills.npy", np.array([[0.0, 0.01], [0.02, 0.0]]))
    np.save(path / "block.npy", np.pad(np.ones((2, 2, 2)), 1))
    tap = np.sin(np.arange(800) / 4.0) * np.exp(-np.arange(800) / 200.0)
    wavfile.write(path / "tap.wav", 8000, (32767 * tap).astype(np.int16))
    return path


@pytest.fixture
def read(folder: Path) -> Callable[..., SceneFile]:
    """Write a scene file and load it."""

    def write_and_load(content: str | bytes, suffix: str = ".toml") -> SceneFile:
        return pc.load(written(folder, content, suffix))

    return write_and_load


def written(folder: Path, content: str | bytes, suffix: str) -> Path:
    path = folder / f"scene{suffix}"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


@pytest.fixture
def refused(folder: Path) -> Callable[..., pc.SceneFileError]:
    """The error of a scene file, which must name the file, and the key where there is one."""

    def write_and_fail(
        content: str | bytes, key: str, *words: str, suffix: str = ".toml"
    ) -> pc.SceneFileError:
        path = written(folder, content, suffix)
        with pytest.raises(pc.SceneFileError) as caught:
            pc.load(path)
        error = caught.value
        assert (error.path, error.key) == (path, key)
        assert str(error).startswith(f"{path}: {key}")
        for word in words:
            assert word in str(error)
        return error

    return write_and_fail


def toml(value: Any) -> str:
    """A value as TOML, inline; absent is what is None."""
    if isinstance(value, dict):
        inside = ", ".join(f"{toml(k)} = {toml(v)}" for k, v in value.items() if v is not None)
        return "{ " + inside + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value, ensure_ascii=False)


def tree(file: SceneFile) -> dict[str, Any]:
    return json.loads(msgspec.json.encode(file))  # type: ignore[no-any-return]


def as_toml(file: SceneFile) -> str:
    return "\n".join(f"{key} = {toml(v)}" for key, v in tree(file).items() if v is not None)


# --------------------------------------------------------------------------------- what is read


def mesh(folder: Path, scale: float = 0.001) -> pc.Mesh:
    return pc.Mesh(file=str(folder / "hand.stl"), scale=scale)


def test_every_key_is_read(read: Any, folder: Path) -> None:
    file = read(FULL)
    options = {"steps": 20, "tolerance": 1e-3, "warm": True, "mode": "x"}
    assert file == SceneFile(
        array=Lattice(0.2, 0.1, 0.02, "y", 20.0, Pose((0.0, 0.0, 0.1), (0.0, 0.0, 1.0, 0.0))),
        medium=Medium(25.0, 0.4, 346.0, 1.18, 1.5, 0.2),
        solver=Choice("lagrange", options),
        backend=Choice("simulated"),
        rate=500.0,
        gain=0.8,
        sampling=Sampling(128, 0.01),
        workspace=pc.Workspace((-0.2, -0.2, 0.05), (0.2, 0.2, 0.5)),
        hands=(
            HandPose("left", Pose((0.0, 0.0, 0.2))),
            HandPose(joints=tuple(map(tuple, JOINTS))),
        ),
        objects=(
            pc.Point(
                position=(0.01, 0.02, 0.2),
                force=0.001,
                area=1e-4,
                envelope=pc.Constant(0.5),
                technique=AM(120.0, 0.5),
                material=Material(5000.0, 0.003),
                motion=Motion((0.1, 0.0, 0.0), (0.0, 0.0, 1.0), 0.5),
                priority=2,
                name="tip",
            ),
            pc.Point(position=(0.0, 0.0, 1.0), radiation_pressure=12.0),
            pc.Surface(
                shape=pc.Rectangle(0.05, 0.04),
                pose=Pose((0.0, 0.0, 0.2)),
                radiation_pressure=10.0,
                envelope=pc.Sine(200.0, 0.1, 0.9),
                motion=Motion(),
                texture=Texture(values=((0.0, 1.0), (1.0, 0.0)), size=(0.01, 0.02)),
                thickness=0.01,
                priority=1,
                name="button",
            ),
            pc.Surface(
                shape=pc.Disc(0.03), force=0.01, envelope=pc.Square(50.0, 0.2, 0.8, duty=0.25)
            ),
            Trace(
                shape=Circle(0.02),
                pose=Pose((0.0, 0.0, 0.2)),
                width=0.005,
                force=0.001,
                envelope=Pulse(0.02, 0.25, 0.01, 0.005, 0.1, 0.9),
                technique=STM(80.0, "outline", 0.0005),
                motion=Motion(),
                priority=3,
                name="ring",
            ),
            Trace(
                shape=Line(0.05),
                radiation_pressure=8.0,
                envelope=Noise(20.0, 300.0, 0.1, 0.9, 7),
                technique=LM(30.0, 0.003, 45.0),
            ),
            Trace(
                shape=Lissajous(0.04, 0.03, 2, 3, 90.0),
                radiation_pressure=8.0,
                envelope=Wave(str(folder / "tap.wav"), loop=False, mode="loudness"),
            ),
            Trace(
                shape=Polyline(((0.0, 0.0, 0.0), (0.02, 0.0, 0.0), (0.0, 0.02, 0.01)), closed=True),
                radiation_pressure=8.0,
                envelope=Wave(samples=(0.0, 1.0, 0.0, -1.0), rate=800.0),
            ),
            Particles(
                positions=((0.0, 0.0, 0.2), (0.01, 0.0, 0.21)),
                pose=Pose((0.0, 0.0, 0.01)),
                radius=0.003,
                radiation_pressure=15.0,
                envelope="buzzing",
                technique=STM(80.0, Circle(0.01)),
                motion=Motion(),
                priority=-1,
                name="rain",
            ),
            Particles(positions=(), force=0.001),
            pc.Surface(
                shape=HeightMap(
                    heights=((0.0, 1.0), (1.0, 0.5)), width=0.05, height=0.04, depth=0.01
                ),
                radiation_pressure=10.0,
                texture=Texture(file=str(folder / "stripes.npy"), size=(0.02, 0.02), repeat=False),
                envelope=Preset("trembling"),
            ),
            pc.Surface(
                shape=HeightMap(file=str(folder / "hills.npy"), width=0.05, height=0.04), force=0.01
            ),
            pc.Surface(shape=mesh(folder), force=0.01),
            pc.Volume(
                shape=pc.Sphere(0.03),
                felt="interior",
                pose=Pose((0.0, 0.0, 0.2)),
                radiation_pressure=10.0,
                motion=Motion(),
                texture=Texture(values=((0.5,),), size=(0.01, 0.01)),
                thickness=0.015,
                priority=4,
                name="ball",
            ),
            pc.Volume(shape=mesh(folder), force=0.01),
            pc.Volume(
                shape=Voxels(values=[[[1.0, 1.0]], [[0.0, 1.0]]], pitch=0.01, level=0.4), force=0.01
            ),
            pc.Volume(shape=Voxels(file=str(folder / "block.npy"), pitch=0.005), force=0.01),
            pc.Volume(
                shape=Union(
                    (
                        Placed(pc.Sphere(0.02), Pose((0.01, 0.0, 0.0))),
                        Intersection((pc.Sphere(0.02), pc.Box((0.03, 0.03, 0.03)))),
                        Difference(pc.Sphere(0.02), (mesh(folder, 0.0001),)),
                    )
                ),
                radiation_pressure=10.0,
            ),
            pc.Volume(shape=pc.Box((0.03, 0.02, 0.01)), force=0.01),
            pc.Volume(shape=pc.Capsule(0.01, 0.05), force=0.01),
            pc.Surface(
                shape=pc.Mesh(
                    vertices=((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0)), faces=((0, 1, 2),)
                ),
                force=0.01,
            ),
        ),
    )


def keys(value: Any) -> Iterator[tuple[str, str]]:
    """Each (type, key) of a tree; the type is "" where there is none."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield value.get("type", ""), key
            yield from keys(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from keys(inner)


def test_the_full_example_has_every_key_of_the_schema(folder: Path) -> None:
    used = set(keys(msgspec.toml.decode(FULL)))
    for name, definition in schema()["$defs"].items():
        known = definition["properties"]
        kind = known["type"]["enum"][0] if "type" in known else ""
        if kind in ("autd", "device"):
            continue  # a scene has one array: the next tests'
        assert {(kind, key) for key in known} <= used, name


def test_an_array_of_units_is_read(read: Any) -> None:
    file = read('array = { type = "autd", columns = 2, rows = 1, pose = { position = [0, 0, 1] } }')
    assert file.array == Units(2, 1, Pose((0.0, 0.0, 1.0)))
    array = file.array.make()
    assert len(array) == 2 * 249
    assert (array.positions[:, 2] == 1.0).all()


def test_an_array_of_a_device_is_read(read: Any, folder: Path) -> None:
    (folder / "device.toml").write_text('[[boards]]\nserial = "A"\ndead = [3]\n')
    text = 'array = { type = "device", file = "device.toml", pose = { position = [0, 0, 1] } }'
    array = read(text).array.make()
    assert len(array) == 248
    assert (array.positions[:, 2] == 1.0).all()


def test_the_array_and_the_medium_are_made(read: Any) -> None:
    file = read(FULL)
    array = file.array.make()
    expected = pc.lattice(0.2, 0.1, 0.02).fold("y", 20.0).moved(file.array.pose)
    assert np.array_equal(array.positions, expected.positions)
    assert np.array_equal(array.normals, expected.normals)
    air = file.medium.make()
    assert (air.speed_of_sound, air.density, air.power, air.absorption) == (346.0, 1.18, 1.5, 0.2)


def test_a_loaded_scene_is_sampled_in_its_workspace(read: Any) -> None:
    file = read(FULL)
    samples = pc.Sampler(file.sampling.budget, file.sampling.spacing).sample(file.scene)
    assert 0 < len(samples) <= 128
    assert file.workspace.holds(samples.positions).all()
    assert file.scene.objects == file.objects
    assert file.scene.workspace == file.workspace


@pytest.mark.parametrize(
    ("content", "suffix"), [("", ".toml"), ("# nothing\n", ".toml"), ("{}", ".json")]
)
def test_an_empty_file_is_an_empty_scene_with_the_defaults(
    read: Any, content: str, suffix: str
) -> None:
    file = read(content, suffix)
    assert file == SceneFile()
    assert file.objects == file.scene.objects == ()
    assert (file.array, file.solver, file.backend) == (Units(3, 3), "auto", "simulated")
    assert (file.rate, file.gain, file.workspace) == (1000.0, 1.0, None)
    assert file.medium.make() == pc.Air()
    sampler = pc.Sampler()
    assert (file.sampling.budget, file.sampling.spacing) == (sampler.budget, sampler.spacing)


@pytest.mark.parametrize("suffix", [".toml", ".json"])
def test_what_is_written_comes_back(read: Any, suffix: str) -> None:
    file = read(FULL)
    content = as_toml(file) if suffix == ".toml" else msgspec.json.encode(file)
    assert read(content, suffix) == file


numbers = st.floats(-5.0, 5.0)
sizes = st.floats(1e-3, 0.5)
words = st.text(st.characters(exclude_categories=("C",)), max_size=20)
strengths = st.one_of(
    st.builds(lambda x: {"force": x}, st.floats(0, 10)),
    st.builds(lambda x: {"radiation_pressure": x}, st.floats(0, 1e4)),
)
envelopes = st.one_of(
    st.builds(pc.Constant, st.floats(0, 1)),
    st.builds(pc.Sine, st.floats(0, 1e3), st.floats(0, 0.5), st.floats(0.5, 1)),
    st.builds(pc.Square, st.floats(0, 1e3), st.floats(0, 0.5), st.floats(0.5, 1), st.floats(0, 1)),
)
poses = st.builds(
    lambda x, y, z, angle: Pose.turned("y", angle, (x, y, z)),
    numbers,
    numbers,
    numbers,
    st.floats(-180, 180),
)
stills = st.sampled_from(
    [
        {},
        {"technique": AM(90.0)},
        {"technique": STM(50.0, Circle(0.01), 0.001)},
        {"technique": LM(20.0, 0.002)},
        {"material": Material(1e3, 0.01)},
        {"motion": Motion((0.1, 0.2, 0.3), (1.0, 0.0, 0.0), 2.0)},
        {"priority": -7},
    ]
)
parts = st.floats(0.02, 0.1)
solids = st.recursive(
    st.one_of(
        st.builds(pc.Sphere, parts),
        st.builds(pc.Capsule, parts, parts),
        st.builds(lambda x, y, z: pc.Box((x, y, z)), parts, parts, parts),
    ),
    lambda inner: st.one_of(
        st.builds(lambda shape, x: Placed(shape, Pose((x, 0.0, 0.0))), inner, numbers),
        st.builds(lambda parts: Union(tuple(parts)), st.lists(inner, min_size=1, max_size=3)),
        st.builds(lambda a, b: Intersection((a, b)), inner, inner),
        st.builds(lambda a, b: Difference(a, (b,)), inner, inner),
    ),
    max_leaves=4,
)
any_object = st.one_of(
    st.builds(
        lambda at, how, more, envelope, name: pc.Point(
            position=at, envelope=envelope, name=name, **how, **more
        ),
        st.tuples(numbers, numbers, numbers),
        strengths,
        stills,
        envelopes,
        words,
    ),
    st.builds(
        lambda shape, how, more, pose, name: pc.Surface(
            shape=shape, pose=pose, name=name, **how, **more
        ),
        st.one_of(
            st.builds(pc.Disc, sizes),
            st.builds(pc.Rectangle, sizes, sizes),
            st.builds(
                lambda h, w: HeightMap(heights=[[0.0, h], [h, h]], width=w, height=w), sizes, sizes
            ),
        ),
        strengths,
        stills,
        poses,
        words,
    ),
    st.builds(
        lambda shape, pose: pc.Volume(
            shape=shape,
            pose=pose,
            radiation_pressure=3.0,
            texture=Texture(values=[[0.5, 1.0]], size=(0.1, 0.1)),
        ),
        solids,
        poses,
    ),
    st.builds(
        lambda shape, how, more, pose, name: Trace(
            shape=shape, pose=pose, name=name, **how, **more
        ),
        st.one_of(st.builds(Line, sizes), st.builds(Circle, sizes)),
        strengths,
        stills,
        poses,
        words,
    ),
    st.builds(
        lambda at, how, pose: Particles(positions=tuple(at), pose=pose, **how),
        st.lists(st.tuples(numbers, numbers, numbers), max_size=3),
        strengths,
        poses,
    ),
)
named = st.lists(any_object, max_size=5, unique_by=lambda item: item.name or id(item)).map(tuple)


@pytest.mark.parametrize("suffix", [".toml", ".json"])
@given(objects=named, rate=st.floats(1.0, 1e5))
@settings(max_examples=40)
def test_any_scene_comes_back_from_its_file(
    folder: Path, suffix: str, objects: Any, rate: float
) -> None:
    file = SceneFile(objects=objects, rate=rate)
    content = as_toml(file) if suffix == ".toml" else msgspec.json.encode(file)
    back = pc.load(written(folder, content, suffix))
    for mine, theirs in zip(back.objects, objects, strict=True):
        if not isinstance(mine, pc.Point):  # normalising again may move the last digit
            assert mine.pose.rotation == pytest.approx(theirs.pose.rotation, abs=1e-15)
            mine = replace(mine, pose=theirs.pose)  # noqa: PLW2901
        assert mine == theirs
    assert back.rate == rate


def test_windows_line_ends_are_read(read: Any) -> None:
    assert read(FULL.replace("\n", "\r\n")) == read(FULL)


def test_a_path_may_be_text(folder: Path) -> None:
    path = written(folder, "rate = 100", ".toml")
    assert pc.load(str(path)) == pc.load(path)


def test_a_mesh_is_looked_for_beside_the_scene_file(
    read: Any, folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    mesh = '[[objects]]\ntype = "surface"\nforce = 1\nshape = {{ type = "mesh", scale = 1e-3, file = "{}" }}'
    by_name = read(mesh.format("hand.stl")).objects[0]
    by_path = read(mesh.format(folder / "hand.stl")).objects[0]
    assert by_name.shape.file == by_path.shape.file == str(folder / "hand.stl")
    assert by_name.shape.area == pytest.approx(pc.Box((0.06, 0.04, 0.02)).area)
    (folder / "inner").mkdir(exist_ok=True)
    inner = written(folder / "inner", mesh.format("../hand.stl"), ".toml")
    assert pc.load(inner).objects[0].pressure == pytest.approx(by_name.pressure)


# ------------------------------------------------------------------------------ what is refused

POINT = '[[objects]]\ntype = "point"\nposition = [0, 0, 0.2]\n'
SURFACE = '[[objects]]\ntype = "surface"\nforce = 1\n'
VOLUME = '[[objects]]\ntype = "volume"\nforce = 1\n'
DISC = SURFACE + "shape = { type = 'disc', radius = 0.1 }\n"
HERE = "$.objects[0]"


@pytest.mark.parametrize(
    ("content", "key", "said"),
    [
        # unknown keys and types, with what was probably meant
        ("solvr = 'auto'", "", ["solvr", "did you mean `solver`?"]),
        ("zzzzqq = 1", "", ["zzzzqq", "pacinian schema"]),
        ("[sampling]\nspaceing = 1", "$.sampling", ["spaceing", "did you mean `spacing`?"]),
        ("[array]\ntype = 'autd'\ncolums = 3", "$.array", ["did you mean `columns`?"]),
        ("[array]\ntype = 'autd'\nwidth = 3", "$.array", ["unknown field `width`"]),
        ("[medium]\nhumdity = 1", "$.medium", ["did you mean `humidity`?"]),
        (POINT + "forc = 1", HERE, ["forc", "did you mean `force`?"]),
        (POINT.replace("point", "pont"), f"{HERE}.type", ["pont", "did you mean `point`?"]),
        ("[array]\ntype = 'lattis'", "$.array.type", ["lattis", "did you mean `lattice`?"]),
        (
            SURFACE + "shape = { type = 'rectangel', width = 1, height = 1 }",
            f"{HERE}.shape.type",
            ["did you mean `rectangle`?"],
        ),
        (SURFACE + "shape = { type = 'cube' }", f"{HERE}.shape.type", ["cube", "schema"]),
        (
            POINT + "force = 1\nenvelope = { type = 'sin', frequency = 1 }",
            f"{HERE}.envelope.type",
            ["sin", "did you mean `sine`?"],
        ),
        # what is missing
        ("[[objects]]\nposition = [0, 0, 0]", HERE, ["missing required field `type`"]),
        ("[[objects]]\ntype = 'point'\nforce = 1", HERE, ["missing", "`position`"]),
        (SURFACE, HERE, ["missing", "`shape`"]),
        (SURFACE + "shape = { type = 'disc' }", f"{HERE}.shape", ["missing", "`radius`"]),
        ("[array]\ncolumns = 1", "$.array", ["missing", "`type`"]),
        ("[workspace]\nlower = [0, 0, 0]", "$.workspace", ["missing", "`upper`"]),
        ("solver = {}", "$.solver", ["missing", "`name`"]),
        # wrong lengths and kinds
        (POINT.replace(", 0.2", ""), f"{HERE}.position", ["length 3", "got 2"]),
        (POINT.replace("0.2", "0, 0.2"), f"{HERE}.position", ["length 3", "got 4"]),
        (POINT.replace("0.2", "'a'"), f"{HERE}.position[2]", ["float", "str"]),
        (POINT + "force = '1'", f"{HERE}.force", ["float", "str"]),
        (POINT + "force = true", f"{HERE}.force", ["float", "bool"]),
        (POINT + "force = 1\nname = 3", f"{HERE}.name", ["str", "int"]),
        ("objects = 1", "$.objects", ["array", "int"]),
        ("objects = [1]", HERE, ["object", "int"]),
        ("rate = 2020-01-01", "$.rate", ["float", "date"]),
        ("sampling = { budget = 1.5 }", "$.sampling.budget", ["int", "float"]),
        ("solver = 1", "$.solver", ["int"]),
        (
            SURFACE + "pose = { rotation = [0, 0, 1] }\nshape = { type = 'disc', radius = 0.1 }",
            f"{HERE}.pose.rotation",
            ["length 4"],
        ),
        # numbers that cannot be meant
        ("rate = nan", "", ["`rate`", "finite"]),
        ("rate = 0", "", ["`rate`", "1 or more"]),
        ("gain = 0", "", ["`gain`", "more than 0"]),
        ("gain = 1.5", "", ["`gain`", "at most 1"]),
        ("sampling = { budget = 0 }", "$.sampling", ["`budget`", "at least 1"]),
        ("sampling = { spacing = 8.5 }\nrate = inf", "", ["finite"]),
        ("sampling = { spacing = 85 }", "$.sampling", ["`spacing`", "millimetres"]),
        (POINT.replace("0.2", "nan") + "force = 1", HERE, ["`position`", "finite"]),
        (POINT + "radiation_pressure = inf", HERE, ["`radiation_pressure`", "finite"]),
        (POINT + "force = -1", HERE, ["`force`", "0 or more"]),
        (POINT + "force = 1\nradiation_pressure = 1", HERE, ["`force`", "not both"]),
        (POINT, HERE, ["`force`", "must be given"]),
        (
            SURFACE + "shape = { type = 'disc', radius = 30 }",
            f"{HERE}.shape",
            ["`radius`", "metres", "millimetres"],
        ),
        (
            VOLUME + "shape = { type = 'box', size = [1, nan, 1] }",
            f"{HERE}.shape",
            ["`size`", "finite"],
        ),
        (
            SURFACE + "shape = { type = 'disc', radius = 0.1 }\npose = { rotation = [1, 1, 1, 1] }",
            f"{HERE}.pose",
            ["`rotation`", "unit quaternion"],
        ),
        (
            VOLUME + "shape = { type = 'sphere', radius = 0.1 }\nfelt = 'interior'",
            HERE,
            ["`force`", "radiation_pressure"],
        ),
        (
            VOLUME + "shape = { type = 'sphere', radius = 0.1 }\nfelt = 'inside'",
            f"{HERE}.felt",
            ["inside"],
        ),
        (
            POINT + "force = 1\nenvelope = { type = 'sine', frequency = 1, low = 0.5, high = 0.2 }",
            f"{HERE}.envelope",
            ["`high`", "0.5 or more"],
        ),
        (
            "[workspace]\nlower = [0, 0, 0]\nupper = [1, 1, 0]",
            "$.workspace",
            ["`lower` below that of `upper`"],
        ),
        # meshes
        (SURFACE + "shape = { type = 'mesh' }", f"{HERE}.shape", ["file", "vertices"]),
        (SURFACE + "shape = { type = 'mesh', file = 'no.obj' }", f"{HERE}.shape", ["no.obj"]),
        (SURFACE + "shape = { type = 'mesh', file = '.' }", f"{HERE}.shape", ["mesh"]),
        (SURFACE + "shape = { type = 'mesh', file = 'a\\u0000' }", f"{HERE}.shape", ["mesh"]),
        (SURFACE + "shape = { type = 'mesh', file = 'hand.stl' }", f"{HERE}.shape", ["metres"]),
        (VOLUME + "shape = { type = 'mesh', file = 'no.obj' }", f"{HERE}.shape", ["no.obj"]),
        (VOLUME + "shape = { type = 'mesh', file = 'open.stl' }", f"{HERE}.shape", ["no volume"]),
        (
            VOLUME + "shape = { type = 'union', parts = [{ type = 'mesh', file = 'open.stl' }] }",
            f"{HERE}.shape",
            ["no volume"],
        ),
        # files of other kinds
        (DISC + "texture = { file = 'no.png', size = [1, 1] }", f"{HERE}.texture", ["no.png"]),
        (DISC + "texture = { file = 'hand.stl', size = [1, 1] }", f"{HERE}.texture", ["hand.stl"]),
        (DISC + "envelope = { type = 'wave', file = 'no.wav' }", f"{HERE}.envelope", ["no.wav"]),
        (DISC + "envelope = { type = 'wave', file = 'hand.stl' }", f"{HERE}.envelope", ["WAV"]),
        (
            VOLUME + "shape = { type = 'voxels', file = 'no.npy', pitch = 0.01 }",
            f"{HERE}.shape",
            ["no.npy"],
        ),
        (
            SURFACE + "shape = { type = 'height-map', file = 'no.npy', width = 1, height = 1 }",
            f"{HERE}.shape",
            ["no.npy"],
        ),
        # of objects, hands and how they are felt
        (POINT + "force = 1\nname = 'a'\n" + POINT + "force = 1\nname = 'a'", "$", ["'a'"]),
        ("hands = [{ side = 'right' }, { side = 'right' }]", "$", ["`hands`", "'right'"]),
        ("hands = [{ side = 'both' }]", "$.hands[0].side", ["both"]),
        ("hands = [{ joints = [[0, 0, 0]] }]", "$", ["`joints`", "(26, 3)"]),
        (POINT + "force = 1\nenvelope = 'buzing'", f"{HERE}.envelope", ["`buzzing`?"]),
        (
            POINT + "force = 1\ntechnique = { type = 'stn', frequency = 1 }",
            f"{HERE}.technique.type",
            ["did you mean `stm`?"],
        ),
        (
            POINT + "force = 1\ntechnique = { type = 'stm', frequency = 0 }",
            f"{HERE}.technique",
            ["`frequency`", "more than 0"],
        ),
        (POINT + "force = 1\nmaterial = { stiffness = 0 }", f"{HERE}.material", ["`stiffness`"]),
        (
            POINT + "force = 1\nmotion = { velocity = [500, 0, 0] }",
            f"{HERE}.motion",
            ["`velocity`", "metres"],
        ),
        (POINT + "force = 1\npriority = 1.5", f"{HERE}.priority", ["int"]),
        (
            "[[objects]]\ntype = 'path'\nforce = 1\nshape = { type = 'polyline', points = [] }",
            f"{HERE}.shape",
            ["`points`"],
        ),
        (
            "[[objects]]\ntype = 'particles'\nforce = 1\npositions = [[0, 0, 200]]",
            HERE,
            ["`positions`", "metres"],
        ),
        (DISC + "thickness = 0", HERE, ["`thickness`"]),
        (DISC + "texture = { values = [[2]], size = [1, 1] }", f"{HERE}.texture", ["`values`"]),
        (
            POINT + "force = 1\n" + SURFACE + "shape = { type = 'mesh', file = 'no.obj' }",
            "$.objects[1].shape",
            ["no.obj"],
        ),
    ],
)
def test_what_cannot_be_meant_is_refused_by_file_and_key_and_with_advice(
    refused: Any, content: str, key: str, said: list[str]
) -> None:
    refused(content, key, *said)


@pytest.mark.parametrize(
    ("content", "suffix"),
    [
        ("rate 100", ".toml"),
        ("rate = 100\nrate = 200", ".toml"),
        ("[unclosed", ".toml"),
        ("{}", ".toml"),
        ("rate = 2020-13-45", ".toml"),
        (b"\xff\xfe\x00", ".toml"),
        (b"\x00" * 100, ".toml"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", ".toml"),
        ("a = " + "[" * 100_000, ".toml"),
        ("a = " + "{ a = " * 100_000, ".toml"),
        ("", ".json"),
        ("{", ".json"),
        ("{'rate': 1}", ".json"),
        ("rate = 1", ".json"),
        ('{"rate": NaN}', ".json"),
        ('{"solver": "\\ud800"}', ".json"),
        (b"\xff\xfe\x00", ".json"),
        (b"\x00" * 100, ".json"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", ".json"),
    ],
)
def test_what_is_not_toml_or_json_is_refused_with_the_file_s_name(
    refused: Any, content: str | bytes, suffix: str
) -> None:
    refused(content, "", f"is not {suffix[1:].upper()}", suffix=suffix)


@pytest.mark.parametrize(
    "content",
    ["[" * 100_000, '{"a":' * 100_000, '{"objects":' + "[" * 100_000, '{"x": {"a":' * 100_000],
)
def test_huge_nesting_is_refused(folder: Path, content: str) -> None:
    with pytest.raises(pc.SceneFileError):
        pc.load(written(folder, content, ".json"))


@pytest.mark.parametrize("content", ["[]", "1", '"text"', "null", "true"])
def test_json_that_is_no_object_is_refused(refused: Any, content: str) -> None:
    refused(content, "", "Expected `object`", suffix=".json")


@pytest.mark.parametrize("digits", ["1" + "0" * 400, "1" * 5000, "1e999", "-1e999"])
def test_json_numbers_beyond_floats_are_refused(refused: Any, digits: str) -> None:
    refused(f'{{"rate": {digits}}}', "$.rate", "out of range", suffix=".json")


@pytest.mark.parametrize("name", ["scene.txt", "scene", "scene.toml.bak", ".toml", "scene.yaml"])
def test_a_file_of_another_suffix_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("")
    with pytest.raises(pc.SceneFileError, match=r"must end in \.toml or \.json") as caught:
        pc.load(tmp_path / name)
    assert caught.value.path == tmp_path / name


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(pc.SceneFileError, match=r"no such\.toml: cannot be read: it is not there"):
        pc.load(tmp_path / "no such.toml")


def test_a_folder_is_no_scene_file(tmp_path: Path) -> None:
    (tmp_path / "folder.toml").mkdir()
    with pytest.raises(pc.SceneFileError, match=r"folder\.toml: cannot be read"):
        pc.load(tmp_path / "folder.toml")


def test_a_file_under_a_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(pc.SceneFileError, match="cannot be read"):
        pc.load(tmp_path / "file" / "scene.toml")


def test_an_enormous_file_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "big.json"
    with path.open("wb") as file:
        file.truncate((64 << 20) + 1)
    with pytest.raises(pc.SceneFileError, match="larger than 64 MiB"):
        pc.load(path)


def test_a_scene_file_error_is_a_value_error() -> None:
    assert issubclass(pc.SceneFileError, ValueError)
    assert issubclass(pc.SceneFileError, pc.PacinianError)


def test_a_toml_number_of_thousands_of_digits_is_refused(refused: Any) -> None:
    refused("rate = " + "1" * 5000, "")


def test_a_path_with_a_nul_is_refused() -> None:
    with pytest.raises(pc.SceneFileError):
        pc.load("nul\0.toml")


@pytest.mark.parametrize("face", [[0, 1, 3], [0, 1, -4]])
def test_faces_of_vertices_that_are_not_there_are_refused(refused: Any, face: list[int]) -> None:
    mesh = {"type": "mesh", "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "faces": [face]}
    content = json.dumps({"objects": [{"type": "surface", "force": 1, "shape": mesh}]})
    refused(content, f"{HERE}.shape", "faces", suffix=".json")


def test_huge_vertices_are_refused_without_a_warning(refused: Any) -> None:
    mesh = {"type": "mesh", "vertices": [[0, 0, 0], [1e300, 0, 0], [0, 1e300, 0]]}
    mesh["faces"] = [[0, 1, 2]]
    content = json.dumps({"objects": [{"type": "surface", "force": 1, "shape": mesh}]})
    refused(content, HERE, "mesh", suffix=".json")


@pytest.mark.parametrize(("content", "suffix"), [("rate = 100", ".toml"), ("{}", ".json")])
def test_a_byte_order_mark_is_skipped(read: Any, content: str, suffix: str) -> None:
    read(b"\xef\xbb\xbf" + content.encode(), suffix)


@pytest.mark.parametrize(
    ("content", "key"),
    [
        ("medium = { humidity = 7 }", "$.medium"),
        ("medium = { attenuation = 'cubic' }", "$.medium"),
        ("array = { type = 'autd', columns = 0 }", "$.array"),
        ("array = { type = 'lattice', width = -1, height = 1 }", "$.array"),
        ("array = { type = 'lattice', width = 1, height = 1, hinge = 'q', angle = 9 }", "$.array"),
    ],
)
def test_a_bad_array_or_medium_is_refused_on_loading(refused: Any, content: str, key: str) -> None:
    refused(content, key)


def test_an_unknown_key_without_a_name_is_refused(refused: Any) -> None:
    refused('"" = 1', "", "unknown field ``")


def test_a_type_without_a_name_is_refused(refused: Any) -> None:
    refused("[array]\ntype = ''", "$.array.type", "Invalid value ''")


def test_an_unknown_key_that_reads_like_a_place_is_named_whole(refused: Any) -> None:
    refused('"a - at b" = 1', "", "a - at b")


def test_only_keys_that_would_be_right_there_are_suggested(refused: Any) -> None:
    assert "did you mean" not in str(refused("[medium]\nwidht = 1", "$.medium"))


# --------------------------------------------------------------------------------------- fuzz


def survives(folder: Path, content: str | bytes, suffix: str) -> None:
    """Load it: a scene, or a SceneFileError that names the file."""
    path = written(folder, content, suffix)
    try:
        file = pc.load(path)
    except pc.SceneFileError as error:
        assert str(error).startswith(str(path))  # noqa: PT017
    else:
        assert isinstance(file.scene, pc.Scene)


@pytest.mark.parametrize("suffix", [".toml", ".json"])
@given(content=st.one_of(st.binary(max_size=200), st.text(max_size=200).map(lambda s: s.encode())))
@bounded
def test_random_bytes_are_a_scene_or_a_scene_file_error(
    folder: Path, suffix: str, content: bytes
) -> None:
    survives(folder, content, suffix)


@pytest.mark.parametrize("suffix", [".toml", ".json"])
@given(place=st.floats(0, 1), length=st.integers(0, 20), junk=st.binary(max_size=10))
@bounded
def test_a_damaged_file_is_a_scene_or_a_scene_file_error(
    folder: Path, suffix: str, place: float, length: int, junk: bytes
) -> None:
    whole = FULL.encode() if suffix == ".toml" else json.dumps(msgspec.toml.decode(FULL)).encode()
    whole = whole[: whole.index(b"[objects.shape]")] if suffix == ".toml" else whole
    at = int(place * len(whole))
    survives(folder, whole[:at] + junk + whole[at + length :], suffix)


KNOWN = sorted({key for _, key in keys(msgspec.toml.decode(FULL))})
TYPES = [
    *("point", "path", "particles", "surface", "volume", "disc", "sphere", "box", "mesh", "voxels"),
    *("height-map", "placed", "union", "difference", "circle", "sine", "wave", "stm", "buzzing"),
    *("autd", "lattice"),
]
leaves = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(2**70), 2**70),
    st.floats(allow_nan=False, allow_infinity=False),
    st.text(max_size=8),
    st.sampled_from(TYPES),
)
json_like = st.recursive(
    leaves,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4),
        st.dictionaries(
            st.one_of(st.sampled_from(KNOWN), st.text(min_size=1, max_size=5)), inner, max_size=5
        ),
    ),
    max_leaves=12,
)


@given(value=st.dictionaries(st.sampled_from(KNOWN), json_like, max_size=4))
@bounded
def test_random_structures_are_a_scene_or_a_scene_file_error(folder: Path, value: Any) -> None:
    survives(folder, json.dumps(value), ".json")
    survives(folder, "\n".join(f"{k} = {toml(v)}" for k, v in value.items()), ".toml")


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Where anything is in a tree."""
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    for key, item in inner:
        yield (*path, key)
        if isinstance(item, (dict, list)):
            yield from places(item, (*path, key))


# without the last object: its `faces` and `vertices` have tests of their own
EXAMPLE = msgspec.toml.decode(FULL.rpartition("[[objects]]")[0])


@given(place=st.sampled_from(sorted(places(EXAMPLE), key=str)), value=json_like)
@bounded
def test_one_wrong_value_anywhere_is_a_scene_or_a_scene_file_error(
    folder: Path, place: tuple[Any, ...], value: Any
) -> None:
    changed = json.loads(json.dumps(EXAMPLE))
    inner = changed
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    survives(folder, json.dumps(changed), ".json")


# ------------------------------------------------------------------------------------- schema


@pytest.fixture
def validator(need: Callable[..., ModuleType]) -> Any:
    jsonschema = need("jsonschema")
    jsonschema.Draft202012Validator.check_schema(schema())
    return jsonschema.Draft202012Validator(schema())


def test_the_schema_is_json() -> None:
    assert (
        json.loads(json.dumps(schema(), allow_nan=False))["$defs"].keys()
        == schema()["$defs"].keys()
    )
    assert schema()["$schema"] == "https://json-schema.org/draft/2020-12/schema"


def test_the_schema_accepts_every_key(validator: Any) -> None:
    validator.validate(msgspec.toml.decode(FULL))
    validator.validate({})


def test_the_schema_accepts_what_is_written(validator: Any, read: Any) -> None:
    validator.validate(tree(read(FULL)))
    validator.validate(tree(SceneFile()))


def test_the_schema_refuses_an_unknown_key_in_any_table(validator: Any) -> None:
    tables = [p for p in places(EXAMPLE) if isinstance(at(EXAMPLE, p), dict)]
    assert len(tables) > 20
    for place in ((), *tables):
        if place[-1:] == ("options",):
            continue
        changed = json.loads(json.dumps(EXAMPLE))
        at(changed, place)["colour"] = 1.0
        assert not validator.is_valid(changed), place


def at(value: Any, place: tuple[Any, ...]) -> Any:
    for key in place:
        value = value[key]
    return value


@given(place=st.sampled_from(sorted(places(EXAMPLE), key=str)), value=json_like)
@settings(max_examples=60)
def test_what_the_schema_refuses_is_not_loaded(
    need: Callable[..., ModuleType], folder: Path, place: tuple[Any, ...], value: Any
) -> None:
    judge = need("jsonschema").Draft202012Validator(schema())
    changed = json.loads(json.dumps(EXAMPLE))
    at(changed, place[:-1])[place[-1]] = value
    if not judge.is_valid(changed):
        with pytest.raises(pc.SceneFileError):
            pc.load(written(folder, json.dumps(changed), ".json"))


def test_the_schema_describes_itself(validator: Any) -> None:
    for name, definition in schema()["$defs"].items():
        assert definition.get("description"), name
    assert np.all([d["additionalProperties"] is False for d in schema()["$defs"].values()])


def test_the_page_about_scene_files_names_every_key_and_type() -> None:
    page = (Path(__file__).parents[3] / "docs" / "scene-files.md").read_text()
    named = set(re.findall(r"[\w-]+", " ".join(re.findall(r"`([^`]*)`", page))))
    for name, definition in schema()["$defs"].items():
        for key, values in definition["properties"].items():
            assert key in named, (name, key)
            assert named >= set(values.get("enum", ())), (name, key)
