from __future__ import annotations

import gc
import math
import os
import pickle
import sys
import threading
import tomllib
import weakref
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import pytest
import trimesh
from scipy.spatial import KDTree

import pacinian as pc
from pacinian.scene.shapes import triangles
from pacinian.scene.shapes.mesh import Mesh

from ..tools import mesh_of

if TYPE_CHECKING:
    from collections.abc import Iterator

TRIANGLE = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
BOX = trimesh.creation.box((0.06, 0.04, 0.02))
BALL = trimesh.creation.icosphere(2, 0.03)
BRACELET = trimesh.creation.annulus(r_min=0.02, r_max=0.04, height=0.02, sections=24)


def moved(mesh: trimesh.Trimesh, *by: float) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.vertices + by, mesh.faces, process=False)


def soup(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """Return the same mesh with separate vertices for each triangle, as in an STL file."""
    F = len(mesh.faces)
    return trimesh.Trimesh(
        mesh.triangles.reshape(-1, 3), np.arange(3 * F).reshape(F, 3), process=False
    )


def turned(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    return trimesh.Trimesh(mesh.vertices, mesh.faces[:, ::-1], process=False)


@pytest.mark.parametrize("suffix", ["obj", "stl", "ply", "glb"])
def test_meshes_are_read_from_the_usual_files(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"bracelet.{suffix}"
    BRACELET.export(path)
    mesh = Mesh(file=str(path))
    assert mesh.closed
    assert mesh.area == pytest.approx(BRACELET.area, rel=1e-5)
    assert mesh.bounding_radius == pytest.approx(math.hypot(0.04, 0.01), rel=1e-5)
    assert mesh.extent == pytest.approx((0.04, 0.04, 0.01), rel=1e-5)
    points, normals, area = mesh.sample_surface(0.006)
    assert np.abs(mesh_of(BRACELET).distance(points)).max() < 1e-7
    assert (mesh_of(BRACELET).distance(points + 1e-4 * normals) > 0.0).all()
    assert len(points) == pytest.approx(mesh.area / 0.006**2, rel=0.25)
    assert area.sum() == pytest.approx(mesh.area)


def test_scale_turns_the_mesh_s_units_into_metres(tmp_path: Path) -> None:
    path = tmp_path / "box.stl"
    trimesh.creation.box((60.0, 40.0, 20.0)).export(path)
    mesh = Mesh(file=str(path), scale=0.001)
    assert mesh.area == pytest.approx(pc.Box((0.06, 0.04, 0.02)).area)
    assert np.abs(mesh.sample_surface(0.004).points).max(axis=0) == pytest.approx(
        [0.03, 0.02, 0.01]
    )
    with pytest.raises(pc.ArgumentError, match=r"metres.*millimetres"):
        _ = Mesh(file=str(path)).area
    with pytest.raises(pc.ArgumentError, match=r"^`scale` "):
        Mesh(file=str(path), scale=0.0)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("points.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
        ("flat.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
        ("nan.obj", b"v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n"),
        ("beyond.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
        ("empty.stl", b""),
        ("junk.stl", b"\x00\xff" * 60),
        ("junk.ply", b"ply\nformat what 1.0\nend_header\n"),
        ("junk.glb", b"glTF\x02\x00\x00\x00junk"),
        ("cloud.ply", trimesh.PointCloud(BALL.vertices).export(file_type="ply")),
        ("text.txt", b"not a mesh"),
        ("missing.obj", None),
        ("folder", None),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_file_without_triangles_is_refused_by_name(
    tmp_path: Path, name: str, content: bytes | None
) -> None:
    (tmp_path / "folder").mkdir()
    if content is not None:
        (tmp_path / name).write_bytes(content)
    mesh = Mesh(file=str(tmp_path / name))
    for ask in (lambda: mesh.area, lambda: mesh.sample_surface(0.01)):
        with pytest.raises(pc.ArgumentError, match=name) as caught:
            ask()
        assert caught.value.argument == "mesh"


def damaged() -> Iterator[tuple[str, str, bytes]]:
    """Yield damaged files: cut off, of another kind, or with false counts. Kind, damage, bytes."""
    whole: dict[str, bytes] = {kind: BALL.export(file_type=kind) for kind in ("stl", "ply", "glb")}
    whole |= {kind: BALL.export(file_type=kind).encode() for kind in ("obj", "off")}
    whole["gltf"] = BALL.export(file_type="gltf")["model.gltf"]
    for kind, data in whole.items():
        yield kind, "empty", b""
        yield kind, "cut off", data[: len(data) // 3]
        yield kind, "of something else", b"<html>404</html>" * 10
        yield kind, "not text", data[: len(data) // 3] + b"\xff\xfe\x80" * 50
    yield "stl", "a count too large", whole["stl"][:80] + b"\xff" * 4 + whole["stl"][84:]
    count = str(len(BALL.vertices)).encode()
    yield (
        "ply",
        "a count too large",
        whole["ply"].replace(b"vertex " + count, b"vertex 999999999999"),
    )
    yield "off", "a count too large", whole["off"].replace(count + b" ", b"999999999999 ", 1)
    yield "obj", "a count too large", whole["obj"] + b"\nf 1 2 99999999999999999999\n"


@pytest.mark.parametrize(("kind", "damage", "data"), [*damaged()])
def test_an_error_about_a_damaged_file_names_it_and_says_so(
    tmp_path: Path, kind: str, damage: str, data: bytes
) -> None:
    path = tmp_path / f"hand.{kind}"
    path.write_bytes(data)
    with pytest.raises(pc.ArgumentError, match=rf"hand\.{kind} .*damaged"):
        _ = Mesh(file=str(path)).area


def test_what_is_no_mesh_file_is_refused_before_it_is_read(tmp_path: Path) -> None:
    (tmp_path / "hand.zip").write_bytes(b"PK")
    os.mkfifo(tmp_path / "hand.stl")  # reading it would never end
    with pytest.raises(pc.ArgumentError, match=r"hand\.zip must end in one of \.obj, \.stl"):
        _ = Mesh(file=str(tmp_path / "hand.zip")).area
    with pytest.raises(pc.ArgumentError, match=r"hand\.stl cannot be read: it is not there, or no"):
        _ = Mesh(file=str(tmp_path / "hand.stl")).area


def test_text_in_an_old_encoding_is_read_and_what_that_takes_is_installed_with_us(
    tmp_path: Path,
) -> None:
    path = tmp_path / "wuerfel.obj"
    path.write_bytes(
        "mtllib Würfel.mtl\n".encode("latin-1") + BALL.export(file_type="obj").encode()
    )
    assert Mesh(file=str(path)).area == pytest.approx(BALL.area, rel=1e-5)
    project = tomllib.loads((Path(__file__).parents[4] / "pyproject.toml").read_text("utf-8"))
    assert any(d.startswith("charset-normalizer") for d in project["project"]["dependencies"])


def test_a_library_that_a_file_needs_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "hand.obj"
    path.write_bytes(b"\xff\xfe\x80")
    monkeypatch.setitem(sys.modules, "charset_normalizer", None)
    with pytest.raises(
        pc.ArgumentError, match=r"hand\.obj .*without the library charset_normalizer"
    ):
        _ = Mesh(file=str(path)).area


@pytest.mark.parametrize(
    ("corner", "face", "problem"),
    [
        ((2.0, 0.0, 0.0), (0, 1, 2), "no area"),
        ((0.0, math.nan, 0.0), (0, 1, 2), "finite"),
        ((0.0, 1e300, 0.0), (0, 1, 2), "mesh"),
        ((0.0, 1.0, 0.0), (0, 1, 3), "faces"),
        ((0.0, 1.0, 0.0), (0, 1, -1), "faces"),
        ((0.0, 1.0, 0.0), (0, 1, 2.5), "^`faces` "),
        ((0.0, 1.0, 0.0), (0, 1, math.nan), "^`faces` "),
        ((0.0, 1.0, 0.0), (0, 1), "^`faces` "),
    ],
)
def test_numbers_that_make_no_triangle_are_refused(corner: Any, face: Any, problem: str) -> None:
    with pytest.raises(pc.ArgumentError, match=problem):
        _ = Mesh(vertices=(*TRIANGLE[:2], corner), faces=(face,)).area


@pytest.mark.parametrize(
    "given_as",
    [
        {},
        {"vertices": TRIANGLE},
        {"file": "hand.obj", "vertices": TRIANGLE},
        {"file": "hand.obj", "vertices": TRIANGLE, "faces": ((0, 1, 2),)},
    ],
)
def test_a_mesh_needs_a_file_or_faces_and_not_both(given_as: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="either a file or vertices and faces"):
        Mesh(**given_as)


def test_a_mesh_file_is_read_once(tmp_path: Path) -> None:
    path = tmp_path / "box.stl"
    trimesh.creation.box((0.06, 0.04, 0.02)).export(path)
    mesh = Mesh(file=str(path))
    area = mesh.area
    path.unlink()
    assert mesh.area == area
    assert len(mesh.sample_surface(0.01).points) > 0


def test_a_mesh_file_that_changed_is_read_again(tmp_path: Path) -> None:
    path = tmp_path / "box.stl"
    trimesh.creation.box((0.02, 0.02, 0.02)).export(path)
    mesh = Mesh(file=str(path))
    assert mesh.area == pytest.approx(6 * 0.02**2)
    assert mesh.distance(np.zeros((1, 3))) == pytest.approx([-0.01])
    trimesh.creation.icosphere(4, radius=0.04).export(path)
    assert mesh.area > 0.018
    assert mesh.distance(np.zeros((1, 3))) == pytest.approx([-0.04], rel=1e-2)


def test_a_mesh_file_that_changed_to_no_mesh_is_told_once_and_left(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "box.stl"
    BOX.export(path)
    mesh = Mesh(file=str(path))
    area = mesh.area
    path.write_bytes(b"half of a mesh")
    assert mesh.area == area == mesh.area
    assert [record.levelname for record in caplog.records] == ["WARNING"]
    assert "box.stl" in caplog.text


def test_equal_meshes_of_a_file_share_what_is_read_as_long_as_one_is_there(tmp_path: Path) -> None:
    path = tmp_path / "box.stl"
    BOX.export(path)
    first, second, other = (Mesh(file=str(path), scale=s) for s in (1.0, 1.0, 0.5))
    assert first.triangles is second.triangles
    assert other.area == pytest.approx(first.area / 4.0)
    read = weakref.ref(first.triangles)
    del first
    gc.collect()
    assert read() is second.triangles
    del second
    gc.collect()
    assert read() is None


def test_threads_that_ask_at_once_get_the_same(tmp_path: Path) -> None:
    path = tmp_path / "bracelet.stl"
    BRACELET.export(path)
    mesh, points = Mesh(file=str(path)), np.linspace(-0.03, 0.03, 60).reshape(20, 3)
    found: list[Any] = []
    threads = [
        threading.Thread(target=lambda: found.append(mesh.distance(points, 0.005)))
        for _ in range(4)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4
    assert all(np.array_equal(d, found[0]) for d in found)


# ------------------------------------------------------------------------- encoding


@pytest.mark.parametrize("codec", [msgspec.json, msgspec.msgpack], ids=["json", "msgpack"])
def test_meshes_go_over_the_wire(codec: Any) -> None:
    given = mesh_of(BOX)
    given.distance(np.zeros((1, 3)))  # cached results are not encoded
    for mesh in (given, Mesh(file="hand.obj", scale=0.001)):
        encoded = codec.encode(mesh)
        assert len(encoded) < 2000
        assert codec.decode(encoded, type=Mesh) == mesh
        assert pickle.loads(pickle.dumps(mesh)) == mesh
        assert hash(pickle.loads(pickle.dumps(mesh))) == hash(mesh)


def test_a_mesh_given_by_arrays_or_lists_keeps_plain_numbers_of_its_own() -> None:
    vertices = np.array(BOX.vertices)
    mesh = Mesh(vertices=vertices, faces=BOX.faces)  # type: ignore[arg-type]
    assert mesh == Mesh(vertices=BOX.vertices.tolist(), faces=BOX.faces.tolist())
    vertices *= 2.0
    assert mesh.area == pytest.approx(BOX.area)
    assert all(type(x) is float for vertex in mesh.vertices for x in vertex)
    assert all(type(i) is int for face in mesh.faces for i in face)


# ------------------------------------------------------------------------- what it encloses


@pytest.mark.parametrize("mesh", [BOX, BALL, BRACELET], ids=["box", "ball", "bracelet"])
@pytest.mark.parametrize("how", [lambda m: m, soup, turned, lambda m: turned(soup(m))])
def test_a_closed_mesh_is_closed_however_it_is_given(mesh: trimesh.Trimesh, how: Any) -> None:
    given = mesh_of(how(mesh))
    assert given.closed
    given.check_closed()
    points, normals, _ = given.sample_surface(0.008)
    straight, outward, _ = mesh_of(mesh).sample_surface(0.008)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(normals)))
    assert (given.distance(points + 1e-5 * normals) > 0.0).all()
    assert (given.distance(straight + 1e-5 * outward) > 0.0).all()


@pytest.mark.parametrize(
    ("mesh", "problem"),
    [
        (trimesh.Trimesh(BOX.vertices, BOX.faces[1:], process=False), "does not close at 3 edges"),
        (
            trimesh.Trimesh(
                BOX.vertices, np.concatenate([BOX.faces[1:], BOX.faces[:1, ::-1]]), process=False
            ),
            "not all wound the same way",
        ),
        (trimesh.Trimesh(TRIANGLE, [[0, 1, 2]], process=False), "does not close at 3 edges"),
        # front and back of a sheet coincide
        (trimesh.Trimesh(TRIANGLE, [[0, 1, 2], [0, 2, 1]], process=False), "close at 3 edges"),
        # a sheet whose front and back are divided along different diagonals
        (
            trimesh.Trimesh(
                [*TRIANGLE, (1.0, 1.0, 0.0)],
                [[0, 1, 3], [0, 3, 2], [1, 0, 2], [1, 2, 3]],
                process=False,
            ),
            "encloses nothing",
        ),
        # three sheets that meet in an edge
        (
            trimesh.Trimesh(
                [*TRIANGLE, (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)],
                [[0, 1, 2], [1, 0, 3], [0, 1, 4]],
                process=False,
            ),
            "does not close at 7 edges",
        ),
    ],
    ids=["open", "inconsistent", "triangle", "two-sided", "flat", "three sheets"],
)
def test_a_mesh_that_encloses_nothing_is_no_volume_and_says_why(mesh: Any, problem: str) -> None:
    given = mesh_of(mesh)
    assert not given.closed
    with pytest.raises(pc.ArgumentError, match=rf"{problem}.*close it, or use it as a surface"):
        given.check_closed()
    d = given.distance(np.random.default_rng(0).uniform(-1.0, 2.0, (50, 3)))
    assert np.isfinite(d).all()
    assert len(given.sample_surface(0.01).points) > 0


def test_each_body_that_is_inside_out_is_turned_and_a_cavity_is_not() -> None:
    # a hollow ball, and beside it one that is inside out
    hollow, hole = trimesh.creation.icosphere(3, 0.04), trimesh.creation.icosphere(2, 0.02)
    other = turned(moved(BALL, 0.1, 0.0, 0.0))
    points = np.array([(0.0, 0, 0), (0.03, 0, 0), (0.06, 0, 0), (0.1, 0, 0), (0.2, 0, 0)])
    expected = [1, -1, 1, -1, 1]
    for bodies in ([hollow, turned(hole), other], [turned(hollow), hole, other]):
        mesh = mesh_of(trimesh.util.concatenate(bodies))
        assert mesh.closed
        for beyond in (math.inf, 0.001):
            assert np.sign(mesh.distance(points, beyond)).tolist() == expected


def test_bodies_that_touch_along_an_edge_enclose_something() -> None:
    both = trimesh.util.concatenate([BOX, moved(BOX, 0.06, 0.04, 0.0)])
    mesh = mesh_of(soup(both))
    assert mesh.closed
    points = np.array(
        [(0.0, 0.0, 0.0), (0.06, 0.04, 0.0), (0.029, 0.021, 0.0), (0.031, 0.019, 0.0)]
    )
    assert np.sign(mesh.distance(points)).tolist() == [-1, -1, 1, 1]


# ------------------------------------------------------------------------- what is mended


@pytest.mark.parametrize(
    "faces",
    [
        np.concatenate([BOX.faces, [[0, 0, 1], [2, 2, 2], [3, 1, 3]]]),
        np.concatenate([BOX.faces, BOX.faces[:5], np.roll(BOX.faces[5:], 1, axis=1)]),
    ],
    ids=["without area", "twice"],
)
def test_triangles_without_area_or_twice_and_vertices_without_a_face_do_not_count(
    faces: Any,
) -> None:
    vertices = np.concatenate([BOX.vertices, [[1.0, 1.0, 1.0]]])
    mesh = mesh_of(trimesh.Trimesh(vertices, faces, process=False))
    assert mesh.closed
    assert mesh.area == pytest.approx(BOX.area)
    assert mesh.extent == pytest.approx((0.03, 0.02, 0.01))
    assert mesh.bounding_radius == pytest.approx(np.linalg.norm(mesh.extent))


def test_rounding_to_single_precision_keeps_a_mesh_closed() -> None:
    away = moved(soup(BRACELET), 0.3, 0.2, 0.1)
    rounded = trimesh.Trimesh(away.vertices.astype(np.float32), away.faces, process=False)
    assert mesh_of(rounded).closed


# ------------------------------------------------------------------------- files


def test_several_meshes_in_a_scene_graph_are_one_each_in_its_place(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    place = trimesh.transformations.rotation_matrix(math.pi / 2, (0, 0, 1))
    place[:3, 3] = (0.1, 0.0, 0.0)
    mirrored = np.diag([-1.0, 1.0, 1.0, 1.0])
    mirrored[0, 3] = -0.1
    scene.add_geometry(BOX, transform=place)
    scene.add_geometry(BRACELET, transform=mirrored)
    path = tmp_path / "both.glb"
    scene.export(path)
    mesh = Mesh(file=str(path))
    assert mesh.closed
    assert mesh.area == pytest.approx(BOX.area + BRACELET.area, rel=1e-5)
    points = np.array([(0.1, 0.029, 0.0), (0.129, 0.0, 0.0), (-0.13, 0.0, 0.0), (-0.1, 0.0, 0.0)])
    assert mesh.distance(points) == pytest.approx([-0.001, 0.009, -0.01, 0.02], abs=4e-4)


def test_a_textured_mesh_is_closed_in_spite_of_its_seams(tmp_path: Path) -> None:
    lines = [f"v {x} {y} {z}" for x, y, z in BOX.vertices]
    lines += [f"vt {k / 40} {k / 40}" for k in range(36)]
    for f, face in enumerate(BOX.faces):
        lines.append("f " + " ".join(f"{v + 1}/{3 * f + k + 1}" for k, v in enumerate(face)))
    path = tmp_path / "box.obj"
    path.write_text("\n".join(lines))
    mesh = Mesh(file=str(path))
    assert mesh.closed
    assert mesh.area == pytest.approx(BOX.area)


def test_meshes_too_large_are_refused_before_they_take_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "ball.stl"
    BALL.export(path)
    monkeypatch.setattr(triangles, "MAX_TRIANGLES", 100)
    for mesh in (Mesh(file=str(path)), mesh_of(BALL)):
        with pytest.raises(pc.ArgumentError, match=r"320 triangles: keep to 100"):
            _ = mesh.area
    monkeypatch.setattr(triangles, "MAX_FILE_BYTES", 1 << 10)
    with pytest.raises(pc.ArgumentError, match=r"ball\.stl is .* MiB: keep to"):
        _ = Mesh(file=str(path)).area


# ------------------------------------------------------------------------- covers


@pytest.mark.parametrize("mesh", [BOX, BALL, BRACELET], ids=["box", "ball", "bracelet"])
def test_samples_are_blue_noise_that_stands_for_the_whole_area(mesh: trimesh.Trimesh) -> None:
    spacing, shape = 0.005, mesh_of(mesh)
    points, normals, area = shape.sample_surface(spacing)
    assert np.abs(shape.distance(points)).max() < 1e-12
    assert (normals != 0.0).any(axis=1).all()
    assert area.sum() == pytest.approx(shape.area)
    assert (area > 0.0).all()
    nearest = KDTree(points).query(points, k=2)[0][:, 1]
    assert nearest.min() >= 0.8 * spacing
    fine = shape.sample_surface(spacing / 3.0).points
    assert KDTree(points).query(fine)[0].max() < 1.2 * spacing
