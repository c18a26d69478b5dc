"""Exports, checked by independent readers."""

import struct
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pygltflib
import pytest
import trimesh

import pacinian as pc
from pacinian import plot
from pacinian.plot import meshes

ARRAY = pc.autd()
AIR = pc.Air()
BALL = pc.Volume(
    shape=pc.Sphere(0.02), pose=pc.Pose((0.0, 0.0, 0.14)), radiation_pressure=5.0, name="ball"
)
HAND = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.165)))
SCENE = pc.Scene((BALL,), hands=(HAND,))
TYPES = {5126: np.float32, 5125: np.uint32, 5123: np.uint16, 5121: np.uint8}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}


def felt(scene: pc.Scene) -> pc.Samples:
    sampler = pc.Sampler()
    sampler.prepare(ARRAY, AIR)
    return sampler.sample(scene)


SAMPLES = felt(SCENE)
GAINS = pc.solve(
    ARRAY,
    SAMPLES.positions,
    pc.sound_pressure(SAMPLES.radiation_pressure, AIR),
    regions=SAMPLES.regions,
    medium=AIR,
).gains


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("model") / "all.glb"
    plot.export(path, ARRAY, SCENE, SAMPLES, GAINS, medium=AIR)
    return path


class Gltf:
    """A glTF model, read by pygltflib, in our coordinates with z up."""

    def __init__(self, path: Path) -> None:
        self.file: Any = pygltflib.GLTF2().load(str(path))
        self.data = self.file.binary_blob()
        self.turn = np.eye(4)
        self.meshes: dict[str, Any] = {}
        self._walk(self.file.scenes[self.file.scene or 0].nodes, np.eye(4))

    def _walk(self, nodes: list[int], above: Any) -> None:
        for k in nodes:
            node = self.file.nodes[k]
            own = np.eye(4) if node.matrix is None else np.reshape(node.matrix, (4, 4)).T
            here = above @ own
            if node.mesh is not None:
                self.meshes[node.name] = (self.file.meshes[node.mesh].primitives[0], here)
            self._walk(node.children or [], here)

    def read(self, accessor: int) -> Any:
        found = self.file.accessors[accessor]
        view = self.file.bufferViews[found.bufferView]
        start = (view.byteOffset or 0) + (found.byteOffset or 0)
        width = WIDTHS[found.type]
        values = np.frombuffer(self.data, TYPES[found.componentType], found.count * width, start)
        return values.reshape(-1, width)

    def vertices(self, name: str) -> Any:
        part, where = self.meshes[name]
        r = self.read(part.attributes.POSITION) @ where[:3, :3].T + where[:3, 3]
        return np.stack([r[:, 0], -r[:, 2], r[:, 1]], axis=-1)

    def uv(self, name: str) -> Any:
        return self.read(self.meshes[name][0].attributes.TEXCOORD_0)

    def faces(self, name: str) -> Any:
        return self.read(self.meshes[name][0].indices).reshape(-1, 3)


@pytest.fixture(scope="module")
def read(model: Path) -> Gltf:
    return Gltf(model)


def test_everything_is_in_it_under_its_name(read: Gltf, model: Path) -> None:
    names = {"array", "object ball", "hand right", "samples", "isosurface"}
    assert names <= set(read.meshes)
    assert len([name for name in read.meshes if name.startswith("field ")]) == 2
    assert set(trimesh.load(model).geometry) == set(read.meshes)
    assert read.file.asset.version == "2.0"
    assert all(material.doubleSided for material in read.file.materials)


def test_transducers_are_where_they_are_and_carry_their_drive(read: Gltf) -> None:
    middles = read.vertices("array")[:: meshes.SIDES + 1]
    np.testing.assert_allclose(middles, ARRAY.positions, atol=1e-7)
    u, v = read.uv("array")[:: meshes.SIDES + 1].T
    drive = np.abs(GAINS) / np.abs(GAINS).max()
    np.testing.assert_allclose(2.0 * np.pi * (u - 0.5), np.angle(GAINS), atol=1e-5)
    np.testing.assert_allclose(1.0 - v, drive, atol=1e-6)  # glTF's v goes down


def test_both_readers_see_the_same_triangles(read: Gltf, model: Path) -> None:
    loaded = trimesh.load(model)
    for name in read.meshes:
        where, geometry = loaded.graph[name]
        other = trimesh.transform_points(loaded.geometry[geometry].vertices, where)
        r = read.vertices(name)
        mine = np.stack([r[:, 0], r[:, 2], -r[:, 1]], axis=-1)
        np.testing.assert_allclose(np.sort(mine, axis=0), np.sort(other, axis=0), atol=1e-6)


def test_objects_and_hands_have_their_shapes(read: Gltf) -> None:
    r = read.vertices("object ball") - BALL.pose.position
    np.testing.assert_allclose(np.sqrt((r * r).sum(axis=1)), 0.02, atol=2e-4)
    solid = trimesh.Trimesh(read.vertices("object ball"), read.faces("object ball"))
    assert solid.is_watertight
    assert solid.volume == pytest.approx(4.0 / 3.0 * np.pi * 0.02**3, rel=0.02)
    from pacinian.scene.hands import capsules as flesh

    skin = flesh.distance_to_skin(
        flesh.make_capsules(HAND), read.vertices("hand right").astype(float)
    )
    assert np.abs(skin).max() < 1.5e-3


def test_samples_are_where_they_are_and_carry_what_is_asked(read: Gltf) -> None:
    count = len(SAMPLES)
    r = read.vertices("samples").reshape(count, -1, 3)
    np.testing.assert_allclose(r.mean(axis=1), SAMPLES.positions, atol=1e-6)
    asked = read.uv("samples").reshape(count, -1, 2)[:, 0, 0]
    most = read.file.scenes[0].extras["samples, most radiation pressure asked [Pa]"]
    np.testing.assert_allclose(asked * most, SAMPLES.radiation_pressure, rtol=1e-5)


def test_the_isosurface_is_where_the_field_has_its_value(read: Gltf) -> None:
    value = read.file.scenes[0].extras["isosurface, radiation pressure on skin [Pa]"]
    q = read.vertices("isosurface").astype(np.float64)
    P = pc.radiation_pressure(pc.field(ARRAY, GAINS, q, AIR, "double"), AIR)
    np.testing.assert_allclose(
        P, value, rtol=0.12
    )  # interpolated between points a quarter of a wavelength apart
    assert abs(np.median(P) / value - 1.0) < 0.03


def test_the_field_in_a_plane_is_a_picture_in_its_place(read: Gltf) -> None:
    most = read.file.scenes[0].extras["field, most radiation pressure on skin [Pa]"]
    (name,) = (name for name in read.meshes if name.startswith("field z"))
    corners, uv = read.vertices(name), read.uv(name)
    part = read.file.materials[read.meshes[name][0].material].pbrMetallicRoughness
    source = read.file.textures[part.baseColorTexture.index].source
    view = read.file.bufferViews[read.file.images[source].bufferView]
    from io import BytesIO

    from matplotlib import colormaps
    from PIL import Image

    at = view.byteOffset or 0
    picture = np.asarray(Image.open(BytesIO(read.data[at : at + view.byteLength])))
    rows, columns = picture.shape[:2]
    colours = np.round(255 * colormaps["viridis"](np.linspace(0, 1, 256))[:, :3])
    for row, column in ((0.31, 0.52), (0.5, 0.5), (0.77, 0.1)):
        i, j = int(row * rows), int(column * columns)
        # as texture coordinates: from the upper left corner
        share = np.array([(j + 0.5) / columns, (i + 0.5) / rows])
        fit = np.linalg.lstsq(np.c_[uv, np.ones(4)], corners, rcond=None)[0]
        q = np.r_[share, 1.0] @ fit
        P = float(pc.radiation_pressure(pc.field(ARRAY, GAINS, q, AIR), AIR))
        pixel = picture[i, j, :3]
        seen = np.abs(colours - pixel).sum(axis=1).argmin() / 255.0 * most
        assert seen == pytest.approx(P, abs=0.01 * most)


@pytest.mark.parametrize(
    "item",
    [
        pc.Point(position=(0.01, 0.0, 0.15), radiation_pressure=5.0),
        pc.Path(shape=pc.Circle(0.02), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=5.0),
        pc.Particles(positions=((0.0, 0.0, 0.15),), radiation_pressure=5.0),
        pc.Surface(shape=pc.Disc(0.02), radiation_pressure=5.0),
        pc.Surface(shape=pc.Rectangle(0.1, 0.002), radiation_pressure=5.0),
        pc.Surface(
            shape=pc.HeightMap(width=0.05, height=0.05, heights=((0.0, 0.01), (0.01, 0.0))),
            radiation_pressure=5.0,
        ),
        pc.Volume(
            shape=pc.Difference(pc.Box((0.04, 0.02, 0.02)), (pc.Sphere(0.008),)),
            radiation_pressure=5.0,
        ),
        pc.Volume(shape=pc.Capsule(0.01, 0.04), radiation_pressure=5.0),
        pc.Volume(shape=pc.Box((0.1, 0.1, 0.001)), radiation_pressure=5.0),
        pc.Surface(
            shape=pc.Mesh(vertices=((0.0, 0.0, 0.0), (0.01, 0.0, 0.0), (0.0, 0.01, 0.0)),
                          faces=((0, 1, 2),)),
            radiation_pressure=5.0,
        ),
    ],
)  # fmt: skip
def test_every_kind_of_object_has_triangles_on_its_surface(item: Any) -> None:
    made = meshes.make_object(item)
    assert len(made.faces)
    assert made.faces.max() < len(made.vertices)
    reach = np.sqrt((made.vertices**2).sum(axis=1)).max()
    assert reach <= item.bounding_radius + meshes.DOT + 1e-6
    if isinstance(item, (pc.Volume, pc.Surface)):
        d = item.distance(made.vertices, np.inf, np.inf)
        assert np.abs(d).max() < 1e-3


def test_an_object_that_moves_is_where_it_is_at_the_time(tmp_path: Path) -> None:
    moving = pc.Motion(velocity=(1.0, 0.0, 0.0))
    ball = pc.Volume(
        shape=pc.Sphere(0.01), pose=BALL.pose, motion=moving, radiation_pressure=5.0, name="b"
    )
    plot.export(tmp_path / "a.glb", ARRAY, pc.Scene((ball,)), t=0.03)
    middle = Gltf(tmp_path / "a.glb").vertices("object b").mean(axis=0)
    np.testing.assert_allclose(middle, (0.03, 0.0, 0.14), atol=1e-4)


def test_less_can_be_written_and_silence_too(tmp_path: Path) -> None:
    path = tmp_path / "a.glb"
    plot.export(path, ARRAY)
    assert list(Gltf(path).meshes) == ["array"]
    lost = pc.Scene(hands=(pc.Hand(np.full((26, 3), np.nan)),))
    plot.export(path, ARRAY, lost, felt(lost), np.zeros(len(ARRAY)), medium=pc.Air())
    assert "isosurface" not in Gltf(path).meshes


def image_data(path: Path) -> tuple[dict[str, Any], dict[str, str]]:
    """Read VTK image data by the format's specification: arrays (z, y, x), and attributes."""
    raw = path.read_bytes()
    head, data = raw.split(b'<AppendedData encoding="raw">', 1)
    image = ET.fromstring(head + b"</VTKFile>").find("ImageData")
    assert image is not None
    data = data[data.index(b"_") + 1 :]
    x, y, z = (int(n) + 1 for n in image.attrib["WholeExtent"].split()[1::2])
    found = {}
    for array in image.iter("DataArray"):
        at = int(array.attrib["offset"])
        (size,) = struct.unpack("<Q", data[at : at + 8])
        values = np.frombuffer(data[at + 8 : at + 8 + size], "<f8")
        found[array.attrib["Name"]] = values.reshape(z, y, x)
    return found, image.attrib


def test_vtk_has_the_field_on_its_grid(tmp_path: Path) -> None:
    path = tmp_path / "a field.vti"
    box = (-0.02, -0.01, 0.12), (0.02, 0.015, 0.15)
    plot.export(path, ARRAY, gains=GAINS, box=box, spacing=0.005, medium=AIR)
    found, said = image_data(path)
    corner, step = (np.array([float(v) for v in said[k].split()]) for k in ("Origin", "Spacing"))
    np.testing.assert_allclose(corner, box[0])
    np.testing.assert_allclose(step, 0.005)
    p = found["sound pressure, real [Pa]"] + 1j * found["sound pressure, imaginary [Pa]"]
    assert p.shape == (7, 6, 9)
    z, y, x = np.indices(p.shape)
    exact = pc.field(ARRAY, GAINS, corner + step * np.stack([x, y, z], axis=-1), AIR, "double")
    np.testing.assert_allclose(p, exact, atol=1e-3 * np.abs(exact).max())
    np.testing.assert_allclose(
        found["radiation pressure on skin [Pa]"], pc.radiation_pressure(p, AIR), rtol=1e-5
    )
    np.testing.assert_allclose(
        found["sound pressure level [dB re 20 uPa]"], pc.sound_pressure_level(p), rtol=1e-5
    )


@pytest.mark.parametrize(
    ("name", "wrong", "argument"),
    [
        ("a.obj", {}, "path"),
        ("a", {}, "path"),
        ("a.vti", {"gains": None}, "gains"),
        ("a.glb", {"level": 0.0}, "level"),
        ("a.glb", {"level": 1.5}, "level"),
        ("a.glb", {"box": 3}, "box"),
        ("a.glb", {"box": ((0.0, 0.0, 0.2), (0.1, 0.1, 0.1))}, "box"),
        ("a.vti", {"spacing": 1e-6}, "spacing"),
        ("a.vti", {"spacing": 0.0}, "spacing"),
        ("a.glb", {"medium": None}, "medium"),
        ("a.glb", {"gains": [1.0]}, "gains"),
    ],
)
def test_bad_arguments_are_named_and_nothing_is_written(
    tmp_path: Path, name: str, wrong: Any, argument: str
) -> None:
    with pytest.raises(pc.ArgumentError) as caught:
        plot.export(tmp_path / name, ARRAY, **{"gains": GAINS, "medium": AIR, **wrong})
    assert caught.value.argument == argument
    assert not list(tmp_path.iterdir())


def test_without_the_library_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyevtk.hl", None)
    with pytest.raises(pc.MissingExtra, match=r"\[plot\]"):
        plot.export(tmp_path / "a.vti", ARRAY, gains=GAINS, spacing=0.02, medium=pc.Air())
