from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from msgspec.structs import fields

from pacinian.acoustics.pose import Pose
from pacinian.scene.material import DEFAULT_MATERIAL, Material
from pacinian.scene.modulation.envelope import (
    STEADY,
    Constant,
    Noise,
    Preset,
    Pulse,
    Sine,
    Square,
    Wave,
)
from pacinian.scene.modulation.technique import AM, LM, SIMULTANEOUS, STM
from pacinian.scene.motion import Motion
from pacinian.scene.objects import DEFAULT_WIDTH, SPOT, Particles, Path, Point, Surface, Volume
from pacinian.scene.shapes import box_disc_rectangle
from pacinian.scene.shapes import sphere_capsule as rounds
from pacinian.scene.shapes.csg import Difference, Intersection, Placed, Union
from pacinian.scene.shapes.curves import Circle, Line, Lissajous, Polyline
from pacinian.scene.shapes.height_map import HeightMap
from pacinian.scene.shapes.mesh import Mesh
from pacinian.scene.shapes.texture import Texture
from pacinian.scene.shapes.voxels import Voxels
from pacinian.wire import commands, modulation, objects, protocol, shapes
from pacinian.wire.codec import decode_command, encode
from pacinian.wire.convert import (
    envelope_to_scene,
    envelope_to_wire,
    technique_to_scene,
    technique_to_wire,
    to_scene,
    to_wire,
)
from pacinian.wire.convert_modulation import ENVELOPES, TECHNIQUES
from pacinian.wire.convert_shapes import SAME_FIELDS

bounded = settings(max_examples=150)

single = st.floats(-1.0, 1.0, width=32)
length = st.floats(1e-3, 1.0)
share = st.floats(0.0, 1.0)
frequency = st.floats(1.0, 1000.0)
vector = st.tuples(single, single, single)
angles = st.integers(-360, 360).map(lambda half: math.radians(half / 2.0))  # exact on the wire
poses = st.builds(
    lambda axis, angle, position: Pose(position).rotate(axis, angle),
    st.sampled_from("xyz"),
    st.floats(-math.pi, math.pi),
    st.tuples(length, length, length),
)


def grids(*sides: int, low: float = 0.0) -> st.SearchStrategy[Any]:
    return arrays(np.float32, sides, elements=st.floats(low, 1.0, width=32))


CORNERS = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
SIDES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
BLOCK = np.pad(np.ones((2, 1, 2), np.float32), 1)

curves: st.SearchStrategy[Any] = st.one_of(
    st.builds(Line, length),
    st.builds(Circle, length),
    st.builds(Lissajous, length, length, st.integers(1, 9), st.integers(1, 9), angles),
    st.builds(
        lambda points, closed: Polyline(((0.0, 0.0, 0.5), (0.5, 0.0, 0.5), *points), closed),
        st.lists(vector, max_size=5),
        st.booleans(),
    ),
)
meshes = st.builds(lambda scale: Mesh(scale=scale, vertices=CORNERS, faces=SIDES), length)
primitives: st.SearchStrategy[Any] = st.one_of(
    st.builds(rounds.Sphere, length),
    st.builds(box_disc_rectangle.Box, st.tuples(length, length, length)),
    st.builds(rounds.Capsule, length, length),
    meshes,
    st.builds(
        lambda pitch, level: Voxels(values=BLOCK, pitch=pitch, level=level),
        length,
        st.floats(0.1, 0.9),
    ),
)
parts = primitives | st.builds(Placed, primitives, poses)
several = st.lists(parts, min_size=1, max_size=4).map(tuple)
solids = st.one_of(
    parts,
    st.builds(Union, several),
    st.builds(Intersection, several),
    st.builds(Difference, parts, several),
)
shells: st.SearchStrategy[Any] = st.one_of(
    st.builds(box_disc_rectangle.Rectangle, length, length),
    st.builds(box_disc_rectangle.Disc, length),
    st.builds(rounds.Sphere, length),
    meshes,
    st.builds(HeightMap, heights=grids(3, 2), width=length, height=length, depth=length),
)
bounds = st.tuples(share, share).map(sorted)
envelopes: st.SearchStrategy[Any] = st.one_of(
    st.just(STEADY),
    st.builds(Constant, share),
    st.builds(lambda f, b: Sine(f, *b), frequency, bounds),
    st.builds(lambda f, b, d: Square(f, *b, d), frequency, bounds, share),
    st.builds(lambda w, s, b: Pulse(w, 2.0 * w, s, w / 4.0, *b), length, single, bounds),
    st.builds(
        lambda f, b, n: Noise(f, 2.0 * f, *b, n), frequency, bounds, st.integers(0, 2**32 - 1)
    ),
    st.sampled_from(["impulsive", "rapturous", "trembling", "buzzing"]).map(Preset),
    st.builds(
        lambda x, rate, loop, mode: Wave("", tuple(x.tolist()), rate, loop, mode),
        grids(9, low=-1.0),
        st.floats(1.0, 1e5),
        st.booleans(),
        st.sampled_from(["waveform", "loudness"]),
    ),
)
techniques: st.SearchStrategy[Any] = st.one_of(
    st.just(SIMULTANEOUS),
    st.builds(AM, frequency, share),
    st.builds(LM, frequency, length, angles),
    st.builds(
        lambda f, along, dwell: STM(f, along, dwell and 0.1 / f),
        frequency,
        st.sampled_from(["samples", "outline"]) | curves,
        st.none() | st.just(True),
    ),
)
textures = st.none() | st.builds(
    Texture, values=grids(2, 3), size=st.tuples(length, length), repeat=st.booleans()
)
felt: dict[str, Any] = {
    "radiation_pressure": st.floats(0.0, 1e6),
    "envelope": envelopes,
    "technique": techniques,
    "material": st.just(DEFAULT_MATERIAL)
    | st.builds(Material, st.none() | st.floats(1.0, 1e9), share),
    "motion": st.none() | st.builds(Motion, vector, vector, st.just(7.5)),
    "priority": st.integers(-1000, 1000),
    "name": st.text(min_size=1, max_size=9),
}
placed = felt | {"pose": poses}
body = placed | {"texture": textures, "thickness": length}
positions = st.lists(vector, max_size=6).map(tuple)
EACH = {
    "point": st.builds(Point, position=vector, area=length, **felt),
    "path": st.builds(Path, shape=curves, width=length, **placed),
    "particles": st.builds(Particles, positions=positions, radius=length, **placed),
    "surface": st.builds(Surface, shape=shells, **body),
    "volume": st.builds(Volume, shape=solids, felt=st.sampled_from(["shell", "interior"]), **body),
}


@pytest.mark.parametrize("kind", EACH)
@bounded
@given(data=st.data())
def test_an_object_is_the_same_after_the_wire(kind: str, data: st.DataObject) -> None:
    item = data.draw(EACH[kind])
    put = commands.Put(session=bytes(16), sequence=1, time=0.0, objects={item.name: to_wire(item)})
    back = decode_command(encode(put))
    assert isinstance(back, commands.Put)
    assert to_scene(item.name, back.objects[item.name], time=7.5) == item


def test_forces_come_over_too() -> None:
    item = Surface(shape=box_disc_rectangle.Disc(0.02), force=0.01, name="a")
    assert to_scene("a", to_wire(item)) == item


def test_bulk_numbers_are_rounded_to_single_precision() -> None:
    rng = np.random.default_rng(0)
    given_ = Particles(positions=rng.uniform(-0.1, 0.1, (100, 3)), radiation_pressure=1.0, name="a")
    made = to_scene("a", to_wire(given_))
    assert isinstance(made, Particles)
    np.testing.assert_allclose(made.positions, given_.positions, rtol=2.0**-24)


@given(st.floats(-2.0 * math.pi, 2.0 * math.pi))
def test_angles_are_radians_in_a_scene_and_degrees_on_the_wire(angle: float) -> None:
    sent: Any = technique_to_wire(LM(60.0, 0.003, angle))
    assert sent.angle == pytest.approx(math.degrees(angle), abs=1e-11)
    again: Any = technique_to_scene(sent)
    assert again.angle == pytest.approx(angle, abs=1e-13)


def test_whole_turns_on_the_wire_are_taken_off() -> None:
    made: Any = technique_to_scene(modulation.LM(60.0, 0.003, 360.0 * 5 + 90.0))
    assert made.angle == pytest.approx(math.pi / 2.0)


def test_kinds_that_are_copied_have_the_same_fields() -> None:
    kinds: dict[Any, Any] = SAME_FIELDS | ENVELOPES | TECHNIQUES
    for ours, theirs in kinds.items():
        assert [f.name for f in fields(ours)] == [f.name for f in fields(theirs)]
        assert [f.default for f in fields(ours)] == [f.default for f in fields(theirs)]
        assert ours.__struct_config__.tag == theirs.__struct_config__.tag


SAME = [
    (objects.Point, Point),
    (objects.Path, Path),
    (objects.Particles, Particles),
    (objects.Surface, Surface),
    (objects.Volume, Volume),
    (objects.Material, Material),
    (objects.Motion, Motion),
    (objects.Texture, Texture),
    (shapes.Pose, Pose),
    (shapes.HeightMap, HeightMap),
    (shapes.Mesh, Mesh),
    (shapes.Voxels, Voxels),
    (shapes.Placed, Placed),
    (shapes.Union, Union),
    (shapes.Intersection, Intersection),
    (shapes.Difference, Difference),
    (shapes.Polyline, Polyline),
    (shapes.Lissajous, Lissajous),
    (modulation.Wave, Wave),
    (modulation.STM, STM),
    (modulation.LM, LM),
]


@pytest.mark.parametrize(("ours", "theirs"), SAME)
def test_who_knows_scene_files_knows_the_wire(ours: type, theirs: type) -> None:
    a = {f.name: f.default for f in fields(ours)}
    b = {f.name: f.default for f in fields(theirs)}
    assert set(a) - set(b) <= {"duration", "grid"}
    assert set(b) - set(a) <= {"name", "file", "time"}
    assert ours.__struct_config__.tag == theirs.__struct_config__.tag  # type: ignore[attr-defined]
    for name in a.keys() & b.keys() - {"envelope", "technique", "material", "pose", "shape"}:
        if isinstance(a[name], (int, float, str)):
            assert a[name] == b[name], name


def test_defaults_are_those_of_scenes() -> None:
    assert objects.SPOT == SPOT
    assert objects.DEFAULT_WIDTH == DEFAULT_WIDTH


def test_the_technique_that_nobody_chose_is_the_servers() -> None:
    item = to_wire(Point(position=(0.0, 0.0, 0.2), radiation_pressure=1.0))
    assert item.technique is None
    made = to_scene("a", item, time=3.0)
    assert made.technique is SIMULTANEOUS
    assert made.motion is None


def test_a_motion_is_of_the_time_that_it_is_told() -> None:
    item = objects.Point(
        position=(0.0, 0.0, 0.2), force=0.01, motion=objects.Motion((1.0, 0.0, 0.0))
    )
    assert to_scene("a", item, time=3.0).motion == Motion((1.0, 0.0, 0.0), time=3.0)


def test_envelopes_and_techniques_come_alone() -> None:
    assert envelope_to_scene("buzzing") == Preset("buzzing")
    assert envelope_to_wire("buzzing") == "buzzing"
    assert envelope_to_scene(modulation.Constant()) is STEADY
    assert technique_to_scene(technique_to_wire(LM(60.0, 0.003))) == LM(60.0, 0.003)
    assert technique_to_wire(SIMULTANEOUS) == modulation.Simultaneous()


def test_no_class_of_the_wire_holds_a_file() -> None:
    waiting: list[Any] = [*commands.COMMANDS, *objects.OBJECTS]
    groups = shapes.Shell, shapes.Solid, shapes.Curve, modulation.Envelope, modulation.Technique
    waiting += itertools.chain.from_iterable(group.__args__ for group in groups)
    for kind in waiting:
        assert "file" not in getattr(kind, "__struct_fields__", ())


def test_what_is_largest_still_fits_in_a_message() -> None:
    item = objects.Particles(positions=bytes(12 * protocol.MAX_PARTICLES), force=1.0)
    put = commands.Put(session=bytes(16), sequence=1, time=0.0, objects={"a": item})
    assert isinstance(decode_command(encode(put)), commands.Put)
