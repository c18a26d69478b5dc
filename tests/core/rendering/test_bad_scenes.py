"""Mistakes of games and trackers are handled, or rejected at once; they never cause NaN or an exception in the loop."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from trimesh.creation import icosphere

import pacinian as pc
from pacinian.rendering.smoothing import GainSmoother
from pacinian.scene.hands.skin_cache import get_skin
from pacinian.scene.sampling.hand_tracking import HandTrack
from pacinian.testing import ManualClock

ARRAY = pc.autd()
BALL = pc.Volume(
    shape=pc.Sphere(0.03), pose=pc.Pose((0.0, 0.0, 0.185)), radiation_pressure=8.0, name="ball"
)
OPEN = pc.Hand.open("right", pc.Pose((0.0, -0.03, 0.21)))
assert OPEN.joints is not None
J = OPEN.joints
FINE, COARSE = icosphere(2, 0.03), icosphere(1, 0.03)


def skin(mesh: Any, scale: float = 1.0, **given: Any) -> pc.Hand:
    return pc.Hand(
        vertices=scale * mesh.vertices + (0.0, 0.0, 0.2),
        faces=np.roll(mesh.faces, 1, axis=0),
        **given,
    )


def render(
    scenes: list[pc.Scene], monkeypatch: pytest.MonkeyPatch, ticks: int = 24, **given: Any
) -> pc.Report:
    """Run two ticks with each scene in turn. All amplitudes for the device must be finite and at most 1."""
    rows: list[Any] = []
    follow = GainSmoother.follow

    def followed(self: GainSmoother, gains: Any, seconds: float, out: Any, *more: Any) -> None:
        follow(self, gains, seconds, out, *more)
        rows.append(np.abs(out).max(initial=0.0))

    monkeypatch.setattr(GainSmoother, "follow", followed)
    clock = ManualClock(100.0)
    renderer = pc.Renderer(ARRAY, scenes[0], clock=clock, **given)
    with renderer:
        for i in range(ticks):
            renderer.scene = scenes[i // 2 % len(scenes)]
            renderer.tick()
            clock.advance(1e-3)
    assert (np.array(rows) <= 1.0 + 1e-5).all()  # also fails for NaN
    return renderer.report


HANDS: dict[str, list[pc.Hand]] = {
    "lost for a moment": [OPEN, pc.Hand(np.full((26, 3), math.nan))],
    "lost for ever": [pc.Hand(np.full((26, 3), math.nan))],
    "one joint lost": [pc.Hand(np.where(np.arange(26)[:, None] == 5, math.inf, J))],
    "all zero": [OPEN, pc.Hand(np.zeros((26, 3)))],
    "all at one place": [pc.Hand([(0.0, 0.0, 0.185)] * 26)],
    "nowhere": [OPEN, pc.Hand(J + 1e300)],
    "of absurd speed": [pc.Hand(J, time=0.0, velocities=[1e308] * 3), OPEN],
    "a teleport": [OPEN, OPEN.transform(pc.Pose((0.0, 0.2, 0.0)))],
    "of tiny radii": [pc.Hand(J, np.full(26, 1e-12))],
    "of huge radii": [pc.Hand(J, np.full(26, 0.1))],
    "in the array": [OPEN.transform(pc.Pose((0.0, 0.0, -0.2)))],
    "of the future": [pc.Hand(J, time=1e6, velocities=[1.0] * 3)],
    "a mesh of other faces": [skin(FINE), skin(COARSE), OPEN, skin(FINE, time=0.0), skin(COARSE)],
    "a mesh that begins as nothing": [skin(icosphere(2, 0.031), 0.0), skin(icosphere(2, 0.031))],
    "a mesh that begins tiny": [skin(icosphere(3, 0.03), 1e-7), skin(icosphere(3, 0.03))],
}


@pytest.mark.parametrize("name", HANDS)
def test_odd_hands_are_no_fault(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    low = BALL if name != "in the array" else pc.Volume(shape=pc.Sphere(0.03), force=0.01)
    scenes = [pc.Scene((low,), hands=(hand,)) for hand in HANDS[name]]
    assert not render(scenes, monkeypatch).faults


@pytest.mark.parametrize("far", [0.0, 1e-9, 0.0099])
def test_a_hand_without_size_is_lost(far: float) -> None:
    assert pc.Hand(np.linspace([0.0] * 3, [far, 0.0, 0.0], 26)).lost
    assert pc.Hand(vertices=np.eye(3) * far, faces=[[0, 1, 2]]).lost


def test_what_is_too_fast_has_no_known_velocity() -> None:
    assert pc.Hand(J, velocities=[1e9, 0.0, 0.0]).velocities is None


def test_a_mesh_that_was_nothing_at_first_gets_a_whole_skin() -> None:
    mesh, track = icosphere(2, 0.032), HandTrack()
    assert track.update(skin(mesh, 0.0), 0.0) == (None, 0.0)
    hand, share = track.update(skin(mesh), 0.001)
    assert hand is not None
    assert share == 1.0
    assert len(get_skin(hand)) > 100


def test_recordings_of_it_render_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    hands = [hand for name in HANDS for hand in HANDS[name]]
    scenes = [pc.Scene((BALL,), hands=(hand,)) for hand in hands]
    path = tmp_path / "odd.pac"
    report = render(scenes, monkeypatch, 2 * len(scenes), recorder=pc.Recorder(path))
    assert not report.faults
    again = pc.rerender(pc.Recording(path))
    assert (again.ticks, again.different) == (2 * len(scenes), 0)


MESHES: dict[str, Callable[[], object]] = {
    "area": lambda: pc.Surface(
        shape=pc.Mesh(vertices=((0.0, 0.0, 0.0), (0.1, 0.0, 0.0)), faces=((0, 0, 1),)),
        radiation_pressure=1.0,
    ),
    "radiation_pressure": lambda: pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=1e300),
    "force": lambda: pc.Point(position=(0.0, 0.0, 0.2), force=1e300),
}


@pytest.mark.parametrize("name", MESHES)
def test_what_no_tick_could_render_is_refused_at_the_door(name: str) -> None:
    with pytest.raises(pc.ArgumentError, match=name):
        MESHES[name]()


@pytest.mark.parametrize(
    ("told", "scene", "message"),
    [
        (math.nan, pc.Scene((BALL,)), "`clock` must be finite"),
        (math.inf, pc.Scene((BALL,)), "`clock` must be finite"),
        (0.0, dict[float, None]().get, "`scene` must be a Scene"),
    ],
)
def test_a_fault_says_whose_it_is(told: float, scene: Any, message: str) -> None:
    clock = ManualClock(1.0)
    with pc.Renderer(ARRAY, scene, clock=clock) as renderer:
        clock.time = told
        renderer.tick()
        assert renderer.halted is not None
        assert message in renderer.halted.message
