"""Warnings before the first tick about objects that cannot be rendered as asked."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.scene.sampling.sample_counts import TOO_FAST
from pacinian.testing import ManualClock
from pacinian_plugins.backends.simulated import Simulated

ARRAY = pc.autd()
AIR = pc.Air()
ROOM = pc.Workspace(lower=(-0.1, -0.1, 0.1), upper=(0.1, 0.1, 0.3))


def ball(position: tuple[float, float, float], pressure: float = 1.0, radius: float = 0.01) -> Any:
    pose = pc.Pose(position)
    return pc.Volume(shape=pc.Sphere(radius), pose=pose, radiation_pressure=pressure, name="ball")


def warn(*objects: Any, workspace: Any = None, **how: Any) -> tuple[str, ...]:
    scene = pc.Scene(objects, workspace)
    with pc.Renderer(ARRAY, scene, medium=AIR, clock=ManualClock(), **how) as renderer:
        return renderer.report.warnings


@pytest.mark.parametrize("z", [0.0, 0.095, 0.305, 3.0, -0.2])
@pytest.mark.parametrize("radius", [0.001, 0.01])
def test_an_object_outside_the_workspace_is_named(z: float, radius: float) -> None:
    found = warn(ball((0.0, 0.0, z), 1e-6, radius), workspace=ROOM)
    away = max(0.1 - z, z - 0.3)
    assert len(found) == (away > radius)
    for text in found:
        assert text.startswith("outside the workspace")
        assert f"'ball' ({away:.3g} m outside)" in text


@pytest.mark.parametrize("rate", [1000.0, 4000.0])
@pytest.mark.parametrize(
    "how",
    [
        lambda f: {"envelope": pc.Sine(f)},
        lambda f: {"envelope": pc.Square(f, duty=0.2)},
        lambda f: {"envelope": pc.Noise(0.5 * f, f)},
        lambda f: {"technique": pc.AM(f)},
        lambda f: {"technique": pc.LM(f, amplitude=0.002)},
        lambda f: {"technique": pc.STM(f)},
    ],
)
def test_a_vibration_that_the_device_cannot_play_is_named(how: Any, rate: float) -> None:
    for share in (0.45, 0.5, 1.0):
        scene = pc.Scene((replace(ball((0.0, 0.0, 0.2), 1e-3), **how(share * rate)),))
        device, clock = Simulated(rate=rate), ManualClock()
        with pc.Renderer(ARRAY, scene, medium=AIR, clock=clock, backend=device) as renderer:
            for k in range(3):
                renderer.tick(1e-3 * k)
            fast, report = share >= 0.5, renderer.report
        assert len(report.warnings) == fast
        assert all(f"'ball' ({share * rate:.4g} Hz)" in text for text in report.warnings)
        assert (TOO_FAST in report.deviations.totals.get("ball", {})) is fast


@pytest.mark.parametrize("place", [(0.0, 0.0, 0.2), (0.0, 0.0, 3.0), (0.5, 0.0, 0.1)])
@pytest.mark.parametrize("share", [0.9, 1.1])
@pytest.mark.parametrize("gain", [1.0, 0.5])
def test_an_object_that_asks_for_more_than_one_focus_is_named(
    place: Any, share: float, gain: float
) -> None:
    """The reference is the strongest focus that `pc.solve` makes there."""
    limits = pc.Limits(gain=gain)
    focus = pc.solve(ARRAY, place, 1.0, scale="max", medium=AIR, limits=limits)
    most = float(pc.radiation_pressure(np.abs(focus.sound_pressure[0]), AIR))
    found = warn(ball(place, share * most), limits=limits)
    assert len(found) == (share > 1.0)
    for text in found:
        assert (
            f"'ball' ({share * most:.3g} Pa, where the array produces at most {most:.2g} Pa)"
            in text
        )
        assert "nearer" in text
        assert "`radiation_pressure` or `force`" in text


def ring(z: float, pressure: float) -> pc.Path:
    pose = pc.Pose((0.0, 0.0, z))
    return pc.Path(shape=pc.Circle(0.05), pose=pose, radiation_pressure=pressure, name="ring")


def drops(z: float, pressure: float) -> pc.Particles:
    places = ((0.05, 0.0, 0.0), (-0.05, 0.0, 0.0))
    pose = pc.Pose((0.0, 0.0, z))
    return pc.Particles(positions=places, pose=pose, radiation_pressure=pressure, name="drops")


@pytest.mark.parametrize("make", [ring, drops])
def test_paths_and_particles_are_named_too(make: Any) -> None:
    assert warn(make(0.2, 1e-6), workspace=ROOM) == ()
    (text,) = warn(make(2.0, 1e-6), workspace=ROOM)
    assert text.startswith("outside the workspace")
    assert f"'{make(0, 1).name}' (1.7 m outside)" in text
    at = [(0.05, 0.0, 0.2), (-0.05, 0.0, 0.2)]
    most = pc.radiation_pressure(np.abs(pc.matrix(ARRAY, at, AIR)).sum(axis=1).min(), AIR)
    assert warn(make(0.2, 0.8 * most)) == ()
    (text,) = warn(make(0.2, 1.2 * most))
    assert "stronger than the array can produce" in text


def test_a_place_in_millimetres_is_answered_with_the_unit() -> None:
    for z in (150.0, 150_000.0):  # at the second, the pressure is 0
        (text,) = warn(ball((0.0, 0.0, z)))
        assert f"it is {z:.3g} m away, and positions are in metres" in text


@pytest.mark.parametrize("z", [0.0, -0.1])
def test_an_object_in_the_array_s_plane_or_behind_it_must_be_moved_to_the_front(z: float) -> None:
    array = pc.autd(transducer=pc.Transducer(directivity=pc.Piston(0.0045, 730.0)))
    scene = pc.Scene((ball((0.003, 0.003, z)), replace(ball((0.0, 0.0, 0.2)), name="")))
    with pc.Renderer(array, scene, medium=AIR, clock=ManualClock()) as renderer:
        (text,) = renderer.report.warnings
    assert "in its plane or behind it: 'ball'. Move these objects to the front of the array" in text


def test_a_force_on_a_transducer_and_an_empty_scene_warn_about_nothing() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert warn() == ()
        assert warn(pc.Point(position=(0.0, 0.0, 0.2), force=1.0)) == ()
        assert warn(ball(tuple(map(float, ARRAY.positions[0])))) == ()


def test_a_force_that_needs_too_much_pressure_is_named() -> None:
    pose = pc.Pose((0.0, 0.0, 0.2))
    for force, count in ((1e-6, 0), (1e6, 1)):
        found = warn(pc.Volume(shape=pc.Sphere(0.01), pose=pose, force=force, name="ball"))
        assert len(found) == count
        assert all("'ball'" in text for text in found)


def test_many_objects_are_one_sentence_that_names_a_few() -> None:
    (text,) = warn(*(replace(ball((0.0, 0.0, 5.0)), name="") for _ in range(30)))
    assert text.count("'volume ") == 3
    assert "and 27 more" in text


def test_a_scene_that_is_none_is_a_fault_that_says_what_it_must_be() -> None:
    renderer = pc.Renderer(ARRAY, pc.Scene(), medium=AIR, clock=ManualClock())
    with renderer:
        renderer.scene = 5  # type: ignore[assignment]
        renderer.tick(0.0)
        assert renderer.halted is not None
        assert renderer.halted.message == "`scene` must be a Scene, or a function to one, not 5"


def test_particles_have_no_single_place() -> None:
    assert warn(pc.Particles(positions=((0.0, 0.0, 0.2),), radiation_pressure=1.0)) == ()
    assert warn(pc.Particles(positions=(), radiation_pressure=1.0)) == ()


@pytest.mark.parametrize("hands", [(), (pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.17))),)])
@pytest.mark.parametrize(
    "found",
    [
        lambda points: np.ones(len(points)),  # outside everywhere
        lambda points: -np.ones(len(points)),  # inside everywhere
        lambda points: np.linalg.norm(points, axis=1) - 0.05,  # beyond the extent
        lambda points: 1e3 * np.linalg.norm(points, axis=1) - 10.0,  # in millimetres
    ],
)
def test_a_solid_without_a_surface_is_named(found: Any, hands: tuple[pc.Hand, ...]) -> None:
    solid = pc.SDF(found, (0.012, 0.012, 0.012))
    item = pc.Volume(
        shape=solid, pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=1.0, name="blob"
    )
    scene, clock = pc.Scene((item,), hands=hands), ManualClock()
    with pc.Renderer(ARRAY, scene, medium=AIR, clock=clock) as renderer:
        renderer.tick(0.0)
        assert any(
            "without a surface: 'blob'" in text and "extent" in text
            for text in renderer.report.warnings
        )
        assert not renderer.report.as_asked
        if not hands:
            assert renderer.report.deviations.totals["blob"]["no surface found"].total == 1


def test_an_intersection_of_solids_that_do_not_meet_is_named() -> None:
    far = pc.Placed(pc.Sphere(0.01), pc.Pose((0.05, 0.0, 0.0)))
    item = pc.Volume(
        shape=pc.Intersection((pc.Sphere(0.01), far)),
        pose=pc.Pose((0.0, 0.0, 0.15)),
        radiation_pressure=0.01,
        name="nothing",
    )
    (text,) = warn(item)
    assert text.startswith("without a surface: 'nothing'")


def test_a_solid_with_a_surface_is_not_named() -> None:
    solid = pc.SDF(lambda points: np.linalg.norm(points, axis=1) - 0.01, (0.012, 0.012, 0.012))
    item = pc.Volume(shape=solid, pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=0.01)
    assert not warn(item)


@pytest.mark.parametrize(
    ("device", "loop", "warned"),
    [
        (1600.0, 1000.0, True),
        (1000.0, 600.0, True),
        (4000.0, 1000.0, False),
        (1000.0, 500.0, False),
    ],
)
def test_a_device_whose_rate_fits_no_tick_is_a_warning(
    device: float, loop: float, warned: bool
) -> None:
    point = pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=1.0)
    backend, clock = Simulated(rate=device), ManualClock()
    renderer = pc.Renderer(pc.autd(), pc.Scene((point,)), backend=backend, rate=loop, clock=clock)
    with renderer:
        renderer.tick()
    found = [text for text in renderer.report.warnings if "rows a second" in text]
    assert bool(found) is warned
    if device == 1600.0:
        assert "0.8 times" in found[0]
