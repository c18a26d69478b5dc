from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.scene.material import Material
from pacinian.scene.modulation.technique import AM
from pacinian.scene.motion import Motion
from pacinian.scene.objects import SPOT, Particles, Path
from pacinian.scene.shapes.curves import Circle, Line, Polyline
from pacinian.scene.shapes.texture import Texture, grating

lengths = st.floats(1e-3, 1.0)
shells = st.one_of(
    st.builds(pc.Rectangle, lengths, lengths),
    st.builds(pc.Disc, lengths),
    st.just(
        pc.Mesh(vertices=((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.2, 0.0)), faces=((0, 1, 2),))
    ),
)
solids = st.one_of(
    st.builds(pc.Sphere, lengths),
    st.builds(lambda x, y, z: pc.Box((x, y, z)), lengths, lengths, lengths),
    st.builds(pc.Capsule, lengths, lengths),
)
forced = st.one_of(  # functions that make an object from a force, with the area on which it presses
    (shells | st.builds(pc.Sphere, lengths)).map(
        lambda shape: (partial(pc.Surface, shape=shape), shape.area)
    ),
    solids.map(lambda shape: (partial(pc.Volume, shape=shape), shape.area)),
    st.floats(1e-6, 1.0).map(lambda a: (partial(pc.Point, position=(0, 0, 0.2), area=a), a)),
    st.builds(lambda x, w: (partial(Path, shape=Line(x), width=w), x * w), lengths, lengths),
)
BALL = pc.SDF(lambda p: np.linalg.norm(p, axis=1) - 0.03, (0.03, 0.03, 0.03))
MAKERS = {
    "point": lambda **how: pc.Point(**{"position": (0, 0, 0.2), **how}),
    "surface": lambda **how: pc.Surface(**{"shape": pc.Disc(0.03), **how}),
    "volume": lambda **how: pc.Volume(**{"shape": pc.Box((0.1, 0.1, 0.1)), **how}),
    "path": lambda **how: Path(**{"shape": Circle(0.03), **how}),
    "particles": lambda **how: Particles(positions=((0.0, 0.0, 0.1), (0.0, 0.1, 0.0)), **how),
}
each_maker = pytest.mark.parametrize("make", MAKERS.values(), ids=MAKERS.keys())
TETRAHEDRON = pc.Mesh(
    vertices=((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1)),
    faces=((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)),
)
TRIANGLE = pc.Mesh(vertices=TETRAHEDRON.vertices, faces=((0, 1, 2),))


@given(forced=forced, force=st.floats(0.0, 10.0))
def test_pressure_times_area_is_the_force(forced: Any, force: float) -> None:
    make, area = forced
    item = make(force=force)
    assert item.pressure * area == pytest.approx(force, rel=1e-12)


def test_a_force_of_particles_is_that_of_each() -> None:
    crowd = Particles(positions=((0, 0, 0), (0, 0, 1), (0, 1, 0)), radius=0.01, force=0.5)
    assert crowd.pressure * math.pi * 0.01**2 == pytest.approx(0.5)
    assert crowd.sample_surface(0.01).area.sum() * crowd.pressure == pytest.approx(1.5)


@pytest.mark.parametrize(
    "item",
    [
        pc.Surface(shape=pc.Rectangle(0.05, 0.04), force=0.02),
        pc.Surface(shape=TRIANGLE, force=0.02),
        pc.Volume(shape=pc.Sphere(0.03), force=0.02),
        pc.Volume(shape=TETRAHEDRON, force=0.02),
        pc.Volume(shape=BALL, force=0.02),
        Path(shape=Polyline(((0, 0, 0), (0.1, 0, 0), (0.1, 0.1, 0.05))), force=0.02),
        pc.Point(position=(0.0, 0.0, 0.2), force=0.02),
    ],
    ids=["rectangle", "triangle", "sphere", "tetrahedron", "SDF", "path", "point"],
)
def test_samples_share_out_the_force_of_an_object(item: Any) -> None:
    for spacing in (0.005, 0.01, 0.03):
        samples = pc.Sampler(spacing=spacing).sample(pc.Scene((item,)))
        assert samples.force == pytest.approx(0.02)


def test_a_point_presses_on_a_spot_one_wavelength_across() -> None:
    assert pytest.approx(math.pi * (0.0085 / 2) ** 2) == SPOT
    assert pc.Point(position=(0, 0, 0.2), force=0.01).pressure == pytest.approx(0.01 / SPOT)


@each_maker
@given(pressure=st.floats(0.0, 1e4))
def test_a_pressure_given_is_the_pressure(make: Any, pressure: float) -> None:
    assert make(radiation_pressure=pressure).pressure == pressure


@each_maker
@pytest.mark.parametrize("how", [{}, {"force": 1.0, "radiation_pressure": 1.0}])
def test_exactly_one_of_force_and_pressure_must_be_given(make: Any, how: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="`force` must be given, and not both"):
        make(**how)


@each_maker
@pytest.mark.parametrize("argument", ["force", "radiation_pressure"])
def test_bad_strengths_are_refused_by_name(make: Any, argument: str) -> None:
    for bad in (-1.0, math.inf, "hard"):
        with pytest.raises(pc.ArgumentError, match=f"^`{argument}` ") as caught:
            make(**{argument: bad})
        assert caught.value.argument == argument
    assert make(force=0.0).pressure == make(radiation_pressure=0.0).pressure == 0.0


def test_a_force_on_next_to_no_area_is_refused_or_finite() -> None:
    assert math.isfinite(pc.Surface(shape=pc.Rectangle(1e-200, 1e-200), force=1.0).pressure)
    with pytest.raises(pc.ArgumentError, match=r"^`area` "):
        pc.Point(position=(0, 0, 0.2), force=1.0, area=1e-310)


def test_positions_are_kept_as_numbers_however_they_are_given() -> None:
    position = np.array([0, 0, 1], dtype=np.float32)
    for given_as in ((0, 0, 1), [0, 0, 1], position):
        point = pc.Point(position=given_as, radiation_pressure="1")  # type: ignore[arg-type]
        assert point.pressure == 1.0
        assert all(type(x) is float for x in point.position)
    position[:] = 9.0
    assert point.position == (0.0, 0.0, 1.0)


def test_a_volume_is_felt_by_its_shell_or_its_interior() -> None:
    for felt in ("surface", None):
        with pytest.raises(pc.ArgumentError, match=r'^`felt` must be "shell" or "interior"'):
            pc.Volume(shape=pc.Sphere(0.1), felt=felt, radiation_pressure=1.0)  # type: ignore[arg-type]


def test_a_force_over_an_interior_is_refused() -> None:
    with pytest.raises(pc.ArgumentError, match=r"^`force` .*give radiation_pressure"):
        pc.Volume(shape=pc.Sphere(0.1), felt="interior", force=1.0)
    inside = pc.Volume(shape=pc.Sphere(0.1), felt="interior", radiation_pressure=3.0)
    assert inside.pressure == 3.0


def test_the_area_of_a_signed_distance_function_is_estimated() -> None:
    ball = pc.Volume(shape=BALL, force=1.0)
    assert ball.pressure == pytest.approx(1.0 / (4.0 * math.pi * 0.03**2), rel=0.02)


def test_a_mesh_of_a_file_is_not_read_before_it_is_used() -> None:
    for shape in (pc.Mesh(file="not there.obj"), pc.Mesh(file="not there.obj", scale=2.0)):
        pc.Volume(shape=shape, force=1.0)
        pc.Surface(shape=shape, force=1.0)


def test_an_interior_is_covered_inside_and_a_shell_is_not() -> None:
    shell, inside = (
        pc.Volume(shape=pc.Sphere(0.04), felt=felt, radiation_pressure=1.0).sample_surface(0.01)
        for felt in ("shell", "interior")
    )
    assert np.linalg.norm(shell.points, axis=1) == pytest.approx(np.full(len(shell.points), 0.04))
    assert np.linalg.norm(inside.points, axis=1).max() == pytest.approx(0.04)
    assert np.linalg.norm(inside.points, axis=1).min() < 0.01


@each_maker
def test_objects_cannot_be_changed(make: Any) -> None:
    item = make(force=1.0)
    for name in item.__struct_fields__:
        with pytest.raises(AttributeError):
            setattr(item, name, getattr(item, name))


@each_maker
def test_equal_objects_are_equal_and_may_be_keys(make: Any) -> None:
    assert make(force=1.0) == make(force=1.0) != make(force=2.0)
    assert len({make(force=1.0), make(force=1.0), make(force=2.0)}) == 2


@each_maker
def test_unknown_arguments_are_refused(make: Any) -> None:
    with pytest.raises(TypeError, match="strength"):
        make(strength=1.0)


def test_a_scene_takes_lists_and_keeps_a_tuple() -> None:
    objects = [MAKERS["point"](force=1.0), MAKERS["surface"](force=1.0)]
    scene = pc.Scene(objects)  # type: ignore[arg-type]
    kept = tuple(objects)
    objects.clear()
    assert scene.objects == kept
    assert pc.Scene(item for item in kept).objects == kept  # type: ignore[arg-type]


def test_a_scene_cannot_be_changed() -> None:
    scene = pc.Scene()
    for name in ("objects", "workspace"):
        with pytest.raises(AttributeError):
            setattr(scene, name, ())


@pytest.mark.parametrize(
    ("kind", "argument", "value"),
    [
        ("surface", "pose", (0.0, 0.0, 0.2)),
        ("surface", "shape", Circle(0.03)),
        ("surface", "envelope", 0.5),
        ("surface", "technique", "am"),
        ("surface", "material", 3.0),
        ("surface", "motion", (1.0, 0.0, 0.0)),
        ("surface", "texture", np.ones((4, 4))),
        ("surface", "thickness", 0.0),
        ("surface", "priority", 1.5),
        ("surface", "priority", "high"),
        ("surface", "name", 7),
        ("volume", "shape", pc.Disc(0.03)),
        ("path", "shape", pc.Disc(0.03)),
        ("path", "width", 20.0),
        ("particles", "radius", 0.0),
        ("point", "position", (0, 0)),
        ("point", "area", 0.0),
    ],
)
def test_a_part_of_the_wrong_kind_is_refused_by_name(kind: str, argument: str, value: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=f"^`{argument}`"):
        MAKERS[kind](**{"force": 1.0, argument: value})


@each_maker
def test_every_object_may_have_each_of_what_all_have(make: Any) -> None:
    for how in (
        {"envelope": "buzzing"},
        {"technique": AM(150.0)},
        {"material": Material(stiffness=1e3)},
        {"motion": Motion((0.1, 0.0, 0.0), time=3.0)},
        {"priority": -3},
        {"name": "a"},
    ):
        item = make(force=1.0, **how)
        samples = pc.Sampler().sample(pc.Scene((item,)))
        assert len(samples)
        assert samples.items[0] is item


def test_the_interior_of_a_closed_mesh_is_felt_and_an_open_one_has_none() -> None:
    inside = pc.Volume(shape=TETRAHEDRON, felt="interior", radiation_pressure=1.0)
    points = inside.sample_surface(0.01).points
    assert len(points) > 20
    assert points.min() == pytest.approx(0.0, abs=1e-9)
    assert points.sum(axis=1).max() == pytest.approx(0.1)
    for felt in ("shell", "interior"):
        with pytest.raises(pc.ArgumentError, match=r"^`mesh` .*is no volume"):
            pc.Volume(shape=TRIANGLE, felt=felt, radiation_pressure=1.0)


@pytest.mark.parametrize(
    ("positions", "said"),
    [
        ([(0, 0)], "shape"),
        ([(0, 0, 200.0)], "metres"),
        (np.zeros((100_001, 3)), "at most 100000"),
    ],
)
def test_bad_particles_are_refused(positions: Any, said: str) -> None:
    with pytest.raises(pc.ArgumentError, match=f"^`positions` .*{said}"):
        Particles(positions=positions, radiation_pressure=1.0)


def test_no_particles_are_nothing() -> None:
    none = Particles(positions=(), radiation_pressure=1.0)
    assert none.bounding_radius == none.radius
    assert len(pc.Sampler().sample(pc.Scene((none,)))) == 0


def test_a_texture_is_a_factor_on_the_pressure() -> None:
    stripes = pc.Surface(
        shape=pc.Rectangle(0.1, 0.1), radiation_pressure=8.0, texture=grating(0.05, duty=0.5)
    )
    samples = pc.Sampler(spacing=0.002, budget=4000).sample(pc.Scene((stripes,)))
    assert samples.radiation_pressure.max() == pytest.approx(8.0)
    assert samples.radiation_pressure.min() == pytest.approx(0.0)
    assert samples.force == pytest.approx(8.0 * 0.01 / 2.0, rel=0.05)
    half = Texture(values=((0.5,),), size=(0.1, 0.1))
    even = pc.Volume(shape=pc.Sphere(0.03), radiation_pressure=8.0, texture=half)
    assert pc.Sampler().sample(pc.Scene((even,))).radiation_pressure == pytest.approx(4.0)


@given(at=st.tuples(*[st.floats(-0.05, 0.05)] * 3))
def test_a_surface_is_felt_down_to_its_thickness(at: Any) -> None:
    plate = pc.Surface(shape=pc.Rectangle(0.2, 0.2), radiation_pressure=1.0, thickness=0.01)
    d = plate.distance(np.array([at]), 0.0, 0.0)[0]
    assert (d < 0.0) == (-0.01 < at[2] < 0.0)
    assert abs(d) == pytest.approx(min(abs(at[2]), abs(at[2] + 0.01)))


@given(r=st.floats(0.0, 0.1))
def test_a_shell_is_felt_down_to_its_thickness_and_an_interior_everywhere(r: float) -> None:
    shell, inside = (
        pc.Volume(shape=pc.Sphere(0.05), felt=felt, radiation_pressure=1.0, thickness=0.01)
        for felt in ("shell", "interior")
    )
    at = np.array([[r, 0.0, 0.0]])
    assert shell.distance(at, 0.0, math.inf)[0] == pytest.approx(max(r - 0.05, 0.04 - r))
    assert inside.distance(at, 0.0, math.inf)[0] == pytest.approx(r - 0.05)


# -------------------------------------------------------------------------------- workspaces

corner = st.tuples(*[st.floats(-1.0, 0.9)] * 3)


@given(lower=corner, size=st.tuples(*[st.floats(0.01, 1.0)] * 3), seed=st.integers(0, 2**31))
def test_a_workspace_holds_what_is_between_its_corners(lower: Any, size: Any, seed: int) -> None:
    upper = tuple(a + b for a, b in zip(lower, size, strict=True))
    share = np.random.default_rng(seed).uniform(-0.5, 1.5, (50, 3))
    held = pc.Workspace(lower, upper).holds(np.array(lower) + share * size)
    clear = np.abs(share - 0.5).max(axis=1) - 0.5
    assert held[clear < -1e-9].all()
    assert not held[clear > 1e-9].any()


def test_a_workspace_holds_its_corners() -> None:
    workspace = pc.Workspace((-0.1, -0.1, 0.1), (0.1, 0.1, 0.3))
    assert workspace.holds(np.array([workspace.lower, workspace.upper])).all()
    assert workspace.holds(np.empty((0, 3))).shape == (0,)
    given_so = pc.Workspace([-0.1, -0.1, 0.1], np.array([0.1, 0.1, 0.3]))  # type: ignore[arg-type]
    assert given_so == workspace


def test_a_workspace_without_volume_is_refused() -> None:
    for upper in ((0.0, 1.0, 1.0), (1.0, -0.1, 1.0), (1.0, 1.0, 0.0)):
        with pytest.raises(pc.ArgumentError, match=r"^`workspace` must have `lower` below `upper`"):
            pc.Workspace((0.0, 0.0, 0.0), upper)


@pytest.mark.parametrize("argument", ["lower", "upper"])
def test_bad_corners_are_refused_by_name(argument: str) -> None:
    for bad in ((0, 0), (0, 0, math.inf)):
        corners: Any = {"lower": (-9.0, -9.0, -9.0), "upper": (9.0, 9.0, 9.0), argument: bad}
        with pytest.raises(pc.ArgumentError, match=f"^`{argument}` "):
            pc.Workspace(**corners)
