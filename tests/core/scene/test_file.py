from __future__ import annotations

import json
import math
import os
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
from pacinian.scene.config_sections import Units
from pacinian.scene.file import SceneFile, make_schema
from pacinian.scene.hands.hand import Hand
from pacinian.scene.material import Material
from pacinian.scene.modulation.technique import STM
from pacinian.scene.motion import Motion
from pacinian.scene.shapes.csg import Difference, Intersection, Placed, Union
from pacinian.scene.shapes.curves import Circle

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import ModuleType


OPEN = Hand.open("left").joints
assert OPEN is not None
JOINTS = OPEN.tolist()

# Every key that exists, once.
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
angle = 0.35
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
technique = { type = "lm", frequency = 30.0, amplitude = 0.003, angle = 0.785 }

[[objects]]
type = "path"
shape = { type = "lissajous", width = 0.04, height = 0.03, a = 2, b = 3, phase = 1.57 }
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
    """Return a folder with the files of the full scene."""
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
        return pc.load_scene_file(written(folder, content, suffix))

    return write_and_load


def written(folder: Path, content: str | bytes, suffix: str) -> Path:
    path = folder / f"scene{suffix}"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


@pytest.fixture
def refused(folder: Path) -> Callable[..., pc.SceneFileError]:
    """Return the error of a scene file. It must name the file, and the key if there is one."""

    def write_and_fail(
        content: str | bytes, key: str, *words: str, suffix: str = ".toml"
    ) -> pc.SceneFileError:
        path = written(folder, content, suffix)
        with pytest.raises(pc.SceneFileError) as caught:
            pc.load_scene_file(path)
        error = caught.value
        assert (error.path, error.key) == (path, key)
        assert str(error).startswith(f"{path}: {key}")
        for word in words:
            assert word in str(error)
        return error

    return write_and_fail


def toml(value: Any) -> str:
    """Return a value as inline TOML; None is left out."""
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


def test_every_key_is_read(read: Any, folder: Path) -> None:
    """The loaded scene has each value of the file under its key. Other tests cover the numbers of arrays."""
    expect(msgspec.toml.decode(FULL), tree(read(FULL)), folder)


def expect(given_as: Any, kept: Any, folder: Path, key: str = "") -> None:
    if isinstance(given_as, dict):
        for inner, value in given_as.items():
            expect(value, kept[inner], folder, inner)
    elif kept == {"type": "preset", "name": given_as}:
        return  # a preset name
    elif key in ("values", "heights"):  # packed
        assert isinstance(kept, str)
    elif key == "file":
        assert kept == str(folder / given_as)
    elif isinstance(given_as, list):
        assert len(given_as) == len(kept)
        for one, other in zip(given_as, kept, strict=True):
            expect(one, other, folder)
    else:
        assert given_as == kept, key


def keys(value: Any) -> Iterator[tuple[str, str]]:
    """Yield each (type, key) of a tree; the type is "" if there is none."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield value.get("type", ""), key
            yield from keys(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from keys(inner)


def test_the_full_example_has_every_key_of_the_schema(folder: Path) -> None:
    used = set(keys(msgspec.toml.decode(FULL)))
    for name, definition in make_schema()["$defs"].items():
        known = definition["properties"]
        kind = known["type"]["enum"][0] if "type" in known else ""
        if kind in ("autd", "device"):
            continue  # a scene has only one array; the next tests cover the others
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
    expected = pc.lattice(0.2, 0.1, 0.02).fold("y", 0.35).transform(file.array.pose)
    assert np.array_equal(array.positions, expected.positions)
    assert np.array_equal(array.normals, expected.normals)
    air = file.medium.make()
    assert (air.speed_of_sound, air.density, air.exponent, air.absorption) == (
        346.0,
        1.18,
        1.5,
        0.2,
    )


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
words = st.text(st.characters(exclude_categories=("C",)), max_size=20)
poses = st.builds(
    lambda x, y, z, angle: Pose((x, y, z)).rotate("y", math.radians(angle)),
    *(numbers, numbers, numbers, st.floats(-180, 180)),
)
stills = st.sampled_from(
    [
        {},
        {"technique": STM(50.0, Circle(0.01), 0.001)},
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
        lambda at, force, more, name: pc.Point(position=at, force=force, name=name, **more),
        *(st.tuples(numbers, numbers, numbers), st.floats(0, 10), stills, words),
    ),
    st.builds(
        lambda shape, pose, pressure: pc.Volume(
            shape=shape, pose=pose, radiation_pressure=pressure
        ),
        *(solids, poses, st.floats(0, 1e4)),
    ),
)
objects = st.lists(any_object, max_size=5, unique_by=lambda item: item.name or id(item)).map(tuple)


@pytest.mark.parametrize("suffix", [".toml", ".json"])
@given(objects=objects, rate=st.floats(1.0, 1e5))
@settings(max_examples=40)
def test_any_scene_comes_back_from_its_file(
    folder: Path, suffix: str, objects: Any, rate: float
) -> None:
    file = SceneFile(objects=objects, rate=rate)
    content = as_toml(file) if suffix == ".toml" else msgspec.json.encode(file)
    back = pc.load_scene_file(written(folder, content, suffix))
    for mine, theirs in zip(back.objects, objects, strict=True):
        if isinstance(theirs, pc.Point):
            assert mine == theirs
        else:  # normalising again may change the last digit
            assert mine.pose.rotation == pytest.approx(theirs.pose.rotation, abs=1e-15)
            assert replace(mine, pose=theirs.pose) == theirs
    assert back.rate == rate


def test_windows_line_ends_are_read(read: Any) -> None:
    assert read(FULL.replace("\n", "\r\n")) == read(FULL)


def test_a_path_may_be_text(folder: Path) -> None:
    path = written(folder, "rate = 100", ".toml")
    assert pc.load_scene_file(str(path)) == pc.load_scene_file(path)


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
    assert pc.load_scene_file(inner).objects[0].pressure == pytest.approx(by_name.pressure)


# ------------------------------------------------------------------------------ what is refused

POINT = '[[objects]]\ntype = "point"\nposition = [0, 0, 0.2]\n'
SURFACE = '[[objects]]\ntype = "surface"\nforce = 1\n'
VOLUME = '[[objects]]\ntype = "volume"\nforce = 1\n'
DISC = SURFACE + "shape = { type = 'disc', radius = 0.1 }\n"
BUZZ = POINT + "force = 1\nenvelope = "
FOLDED = "array = { type = 'lattice', width = 1, height = 1, hinge = 'q', angle = 9 }"
NO_MESH = SURFACE + "shape = { type = 'mesh', file = 'no.obj' }"
NO_VOXELS = VOLUME + "shape = { type = 'voxels', file = 'no.npy', pitch = 0.01 }"
NO_HEIGHTS = SURFACE + "shape = { type = 'height-map', file = 'no.npy', width = 1, height = 1 }"
UNION_OF_OPEN = (
    VOLUME + "shape = { type = 'union', parts = [{ type = 'mesh', file = 'open.stl' }] }"
)
UNION_OF_DISC = VOLUME + "shape = { type = 'union', parts = [{ type = 'disc', radius = 0.1 }] }"
HERE = "$.objects[0]"


@pytest.mark.parametrize(
    ("content", "key", "said"),
    [
        # unknown keys and types, with a suggestion
        ("solvr = 'auto'", "", ["solvr", "did you mean `solver`?"]),
        ("zzzzqq = 1", "", ["zzzzqq", "pacinian schema"]),
        ('"" = 1', "", ["unknown field ``"]),
        ('"a - at b" = 1', "", ["a - at b"]),  # a key that looks like a location
        ("[sampling]\nspaceing = 1", "$.sampling", ["spaceing", "did you mean `spacing`?"]),
        ("[array]\ntype = 'autd'\ncolums = 3", "$.array", ["did you mean `columns`?"]),
        ("[array]\ntype = 'autd'\nwidth = 3", "$.array", ["unknown field `width`"]),
        ("[array]\ntype = ''", "$.array.type", ["Invalid value ''"]),
        (POINT + "forc = 1", HERE, ["forc", "did you mean `force`?"]),
        (POINT.replace("point", "pont"), f"{HERE}.type", ["pont", "did you mean `point`?"]),
        (UNION_OF_DISC, f"{HERE}.shape.parts[0].type", ["disc"]),
        (
            SURFACE + "shape = { type = 'cube' }",
            f"{HERE}.shape.type",
            ["cube", "there are rectangle, disc"],
        ),
        (BUZZ + "{ type = 'sin', frequency = 1 }", f"{HERE}.envelope.type", ["`sine`?"]),
        (BUZZ + "'buzing'", f"{HERE}.envelope", ["`buzzing`?"]),
        # missing values, and values of another type
        ("[[objects]]\nposition = [0, 0, 0]", HERE, ["missing required field `type`"]),
        (SURFACE + "shape = { type = 'disc' }", f"{HERE}.shape", ["missing", "`radius`"]),
        ("solver = {}", "$.solver", ["missing", "`name`"]),
        ("solver = 1", "$.solver", ["int"]),
        (POINT.replace(", 0.2", ""), f"{HERE}.position", ["length 3", "got 2"]),
        (POINT.replace("0.2", "'a'"), f"{HERE}.position[2]", ["float", "str"]),
        (POINT + "force = true", f"{HERE}.force", ["float", "bool"]),
        ("objects = [1]", HERE, ["object", "int"]),
        ("rate = 2020-01-01", "$.rate", ["float", "date"]),
        ("sampling = { budget = 1.5 }", "$.sampling.budget", ["int", "float"]),
        # implausible numbers
        ("rate = nan", "", ["`rate`", "finite"]),
        ("rate = 0", "", ["`rate`", "1 or more"]),
        ("gain = 0", "", ["`gain`", "more than 0"]),
        ("gain = 1.5", "", ["`gain`", "at most 1"]),
        ("sampling = { budget = 0 }", "$.sampling", ["`budget`", "at least 1"]),
        ("sampling = { spacing = 85 }", "$.sampling", ["`spacing`", "millimetres"]),
        ("workspace = { lower = [0, 0, 0], upper = [1, 1, 0] }", "$.workspace", ["`lower` below"]),
        ("medium = { humidity = 7 }", "$.medium", ["`humidity`"]),
        ("medium = { attenuation = 'cubic' }", "$.medium", ["`attenuation`"]),
        ("array = { type = 'autd', columns = 0 }", "$.array", ["`columns`"]),
        ("array = { type = 'lattice', width = -1, height = 1 }", "$.array", ["`width`"]),
        (FOLDED, "$.array", ["`hinge`"]),
        (POINT, HERE, ["`force`", "must be given"]),
        (SURFACE + "shape = { type = 'disc', radius = 30 }", f"{HERE}.shape", ["millimetres"]),
        (
            BUZZ + "{ type = 'sine', frequency = 1, low = 1, high = 0 }",
            f"{HERE}.envelope",
            ["`high`"],
        ),
        ("hands = [{ side = 'both' }]", "$.hands[0].side", ["both"]),
        # files, each named with its key
        (SURFACE + "shape = { type = 'mesh' }", f"{HERE}.shape", ["file", "vertices"]),
        (SURFACE + "shape = { type = 'mesh', file = 'a\\u0000' }", f"{HERE}.shape", ["mesh"]),
        (SURFACE + "shape = { type = 'mesh', file = 'hand.stl' }", f"{HERE}.shape", ["metres"]),
        (VOLUME + "shape = { type = 'mesh', file = 'no.obj' }", f"{HERE}.shape", ["no.obj"]),
        (VOLUME + "shape = { type = 'mesh', file = 'open.stl' }", f"{HERE}.shape", ["no volume"]),
        (UNION_OF_OPEN, f"{HERE}.shape", ["no volume"]),
        (POINT + "force = 1\n" + NO_MESH, "$.objects[1].shape", ["no.obj"]),
        (NO_VOXELS, f"{HERE}.shape", ["no.npy"]),
        (NO_HEIGHTS, f"{HERE}.shape", ["no.npy"]),
        (DISC + "texture = { file = 'no.png', size = [1, 1] }", f"{HERE}.texture", ["no.png"]),
        (DISC + "envelope = { type = 'wave', file = 'hand.stl' }", f"{HERE}.envelope", ["WAV"]),
        # unknown types, and types that are not allowed here
        (SURFACE + "shape = { type = 'dsc' }", f"{HERE}.shape.type", ["did you mean `disc`"]),
        (
            SURFACE + "shape = { type = 'banana' }",
            f"{HERE}.shape.type",
            ["rectangle, disc, sphere"],
        ),
        (
            SURFACE + "shape = { type = 'box', size = [1, 1, 1] }",
            f"{HERE}.shape.type",
            ["height-map"],
        ),
        (SURFACE + "shape = 'disc'", f"{HERE}.shape", ['type = "..."', "rectangle, disc, sphere"]),
        (DISC + "envelope = { type = 'melody' }", f"{HERE}.envelope.type", ["noise, wave"]),
        ("[[objects]]\ntype = 'cloud'", f"{HERE}.type", ["point, path, particles"]),
        ("array = { type = 'ring' }", "$.array.type", ["autd, lattice, device"]),
        # errors between several objects or hands
        (POINT + "force = 1\nname = 'a'\n" + POINT + "force = 1\nname = 'a'", "$", ["'a'"]),
        ("hands = [{ side = 'right' }, { side = 'right' }]", "$", ["`hands`", "'right'"]),
        ("hands = [{ joints = [[0, 0, 0]] }]", "$", ["`joints`", "(26, 3)"]),
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
        (b"\xff\xfe\x00", ".toml"),
        ("a = " + "[" * 100_000, ".toml"),
        ("", ".json"),
        ("{", ".json"),
        ('{"rate": NaN}', ".json"),
        ('{"solver": "\\ud800"}', ".json"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", ".json"),
    ],
    ids=range(9),
)
def test_what_is_not_toml_or_json_is_refused_with_the_file_s_name(
    refused: Any, content: str | bytes, suffix: str
) -> None:
    refused(content, "", f"is not {suffix[1:].upper()}", suffix=suffix)


@pytest.mark.parametrize(
    "content", ['{"a":' * 100_000, '{"objects":' + "[" * 100_000], ids=range(2)
)
def test_huge_nesting_is_refused(folder: Path, content: str) -> None:
    with pytest.raises(pc.SceneFileError):
        pc.load_scene_file(written(folder, content, ".json"))


@pytest.mark.parametrize("content", ["[]", "null"])
def test_json_that_is_no_object_is_refused(refused: Any, content: str) -> None:
    refused(content, "", "Expected `object`", suffix=".json")


def test_numbers_beyond_floats_are_refused(refused: Any) -> None:
    for digits in ("1" + "0" * 400, "1" * 5000, "-1e999"):
        refused(f'{{"rate": {digits}}}', "$.rate", "out of range", suffix=".json")
    refused("rate = " + "1" * 5000, "")


@pytest.mark.parametrize("name", ["scene", "scene.toml.bak", ".toml"])
def test_a_file_of_another_suffix_is_refused(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("")
    with pytest.raises(pc.SceneFileError, match=r"must end in \.toml or \.json") as caught:
        pc.load_scene_file(tmp_path / name)
    assert caught.value.path == tmp_path / name


def test_what_cannot_be_read_is_named(tmp_path: Path) -> None:
    (tmp_path / "folder.toml").mkdir()
    (tmp_path / "file").write_text("")
    for name in ("no such.toml", "folder.toml", "file/scene.toml", "nul\0.toml"):
        with pytest.raises(pc.SceneFileError, match="cannot be read") as caught:
            pc.load_scene_file(tmp_path / name)
        assert caught.value.path == tmp_path / name
        assert isinstance(caught.value, ValueError)
    with pytest.raises(pc.SceneFileError, match="it is not there"):
        pc.load_scene_file(tmp_path / "no such.toml")


def test_an_enormous_file_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "big.json"
    with path.open("wb") as file:
        file.truncate((64 << 20) + 1)
    with pytest.raises(pc.SceneFileError, match="larger than 64 MiB"):
        pc.load_scene_file(path)


@pytest.mark.parametrize(
    ("corner", "face", "key", "said"),
    [
        (1.0, [0, 1, 3], f"{HERE}.shape", "faces"),
        (1.0, [0, 1, -4], f"{HERE}.shape", "faces"),
        (1e300, [0, 1, 2], HERE, "mesh"),
    ],
)
def test_meshes_of_bad_numbers_are_refused(
    refused: Any, corner: float, face: list[int], key: str, said: str
) -> None:
    vertices = [[0, 0, 0], [corner, 0, 0], [0, corner, 0]]
    mesh = {"type": "mesh", "vertices": vertices, "faces": [face]}
    content = json.dumps({"objects": [{"type": "surface", "force": 1, "shape": mesh}]})
    refused(content, key, said, suffix=".json")


@pytest.mark.parametrize(("content", "suffix"), [("rate = 100", ".toml"), ("{}", ".json")])
def test_a_byte_order_mark_is_skipped(read: Any, content: str, suffix: str) -> None:
    read(b"\xef\xbb\xbf" + content.encode(), suffix)


def test_only_keys_that_would_be_right_there_are_suggested(refused: Any) -> None:
    assert "did you mean" not in str(refused("[medium]\nwidht = 1", "$.medium"))


# --------------------------------------------------------------------------------------- fuzz


def survives(folder: Path, content: str | bytes, suffix: str) -> bool:
    """Load a file. It must give a scene, or a SceneFileError that names the file. Return whether it is a scene."""
    path = written(folder, content, suffix)
    try:
        file = pc.load_scene_file(path)
    except pc.SceneFileError as error:
        assert str(error).startswith(str(path))  # noqa: PT017
        return False
    assert isinstance(file.scene, pc.Scene)
    return True


@pytest.mark.parametrize("suffix", [".toml", ".json"])
@given(place=st.floats(0, 1), length=st.integers(0, 20), junk=st.binary(max_size=10))
@settings(max_examples=100)
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


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield the paths of all values in a tree."""
    inner = value.items() if isinstance(value, dict) else enumerate(value)
    for key, item in inner:
        yield (*path, key)
        if isinstance(item, (dict, list)):
            yield from places(item, (*path, key))


# without the last object, whose `faces` and `vertices` have their own tests
EXAMPLE = msgspec.toml.decode(FULL.rpartition("[[objects]]")[0])


@given(place=st.sampled_from(sorted(places(EXAMPLE), key=str)), value=json_like)
@settings(max_examples=150)
def test_one_wrong_value_anywhere_is_refused_as_the_schema_refuses_it_and_never_an_accident(
    validator: Any, folder: Path, place: tuple[Any, ...], value: Any
) -> None:
    changed = json.loads(json.dumps(EXAMPLE))
    at(changed, place[:-1])[place[-1]] = value
    loaded = survives(folder, json.dumps(changed), ".json")
    assert validator.is_valid(changed) or not loaded


# ------------------------------------------------------------------------------------- schema


@pytest.fixture(scope="module")
def validator(need: Callable[..., ModuleType]) -> Any:
    jsonschema = need("jsonschema")
    json.dumps(make_schema(), allow_nan=False)
    jsonschema.Draft202012Validator.check_schema(make_schema())
    return jsonschema.Draft202012Validator(make_schema())


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


def test_the_schema_describes_itself(validator: Any) -> None:
    for name, definition in make_schema()["$defs"].items():
        assert definition.get("description"), name
    assert np.all([d["additionalProperties"] is False for d in make_schema()["$defs"].values()])


def test_the_page_about_scene_files_names_every_key_and_type() -> None:
    page = (Path(__file__).parents[3] / "docs" / "scene-files.md").read_text()
    named = set(re.findall(r"[\w-]+", " ".join(re.findall(r"`([^`]*)`", page))))
    for name, definition in make_schema()["$defs"].items():
        for key, values in definition["properties"].items():
            assert key in named, (name, key)
            assert named >= set(values.get("enum", ())), (name, key)


def test_a_missing_device_file_is_told_with_the_scene_file_and_the_key(tmp_path: Path) -> None:
    file = tmp_path / "scene.toml"
    file.write_text('array = { type = "device", file = "none.toml" }')
    with pytest.raises(pc.SceneFileError, match=r"scene\.toml: \$\.array: .*none\.toml"):
        pc.load_scene_file(file)


SIDES = {"width": 0.05, "height": 0.05}


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
@pytest.mark.parametrize(
    ("name", "item"),
    [
        ("a.npy", {"type": "surface", "shape": {"type": "height-map", **SIDES}}),
        ("a.npy", {"type": "volume", "shape": {"type": "voxels", "pitch": 0.01}}),
        ("a.png", {"type": "surface", "shape": {"type": "rectangle", **SIDES},
                   "texture": {"size": [0.05, 0.05]}}),
    ],
    ids=["height map", "voxels", "texture"],
)  # fmt: skip
def test_a_pipe_in_place_of_an_array_is_refused(
    name: str, item: dict[str, Any], tmp_path: Path
) -> None:
    """To open it would wait for a writer."""
    os.mkfifo(tmp_path / name)
    part = "texture" if "texture" in item else "shape"
    made = {**item, part: {**item[part], "file": name}, "radiation_pressure": 5.0}
    file = tmp_path / "scene.json"
    file.write_text(json.dumps({"objects": [made]}))
    with pytest.raises(pc.SceneFileError, match=rf"\.{part}: .*it is not there, or not a file"):
        pc.load_scene_file(file)
