"""Skins of hands are built before the run, or while the output is silent: never while an old field sounds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from trimesh.creation import icosphere

import pacinian as pc
from pacinian.rendering.recording import Recording
from pacinian.rendering.rerender import rerender
from pacinian.rendering.skin_loader import SkinLoader
from pacinian.scene.hands import skin_cache
from pacinian.scene.hands.capsule_skin import CapsuleSkin
from pacinian.scene.hands.mesh_skin import MeshSkin
from pacinian.testing import ManualClock
from pacinian_plugins.backends.simulated import Simulated

if TYPE_CHECKING:
    from pathlib import Path

BALL = pc.Volume(
    shape=pc.Sphere(0.015), pose=pc.Pose((0.0, 0.0, 0.15)), radiation_pressure=1.0, name="ball"
)
JOINTS = pc.Hand.open(pose=pc.Pose((0.0, 0.0, 0.165)), time=0.0)


def make_mesh(subdivisions: int) -> pc.Hand:
    """Return a ball of skin whose kind no other test uses."""
    mesh = icosphere(subdivisions, 0.029)
    return pc.Hand(
        vertices=mesh.vertices + np.array([0.0, 0.0, 0.19]),
        faces=np.roll(mesh.faces[:-1], 2, axis=0),
        name="ball of skin",
    )


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> list[bool]:
    """Forget all skins; return whether the device was silent each time that one was built."""
    found: list[bool] = []
    monkeypatch.setattr(skin_cache, "_skins", {})
    for kind in (CapsuleSkin, MeshSkin):

        def build(*given: Any, kind: Any = kind, **options: Any) -> Any:
            found.append(DEVICES[-1].silent)
            return kind(*given, **options)

        monkeypatch.setattr(skin_cache, kind.__name__, build)
    return found


DEVICES: list[Simulated] = []


def run(hands: list[tuple[pc.Hand, ...]], *, fixed: bool = False, **options: Any) -> bool:
    """Run a tick with each of these hands, and return whether one sounded. fixed: give scenes instead of a function."""
    clock = ManualClock()
    DEVICES.append(Simulated(wait=clock.advance, keep=1000))
    scenes = [pc.Scene((BALL,), hands=some) for some in hands]
    given: Any = scenes[0] if fixed else lambda t: scenes[min(round(t * 1000), len(scenes) - 1)]
    renderer = pc.Renderer(
        pc.autd(), given, backend=DEVICES[-1], clock=clock, adaptive=False, **options
    )
    loud = False
    with renderer:
        for k, scene in enumerate(scenes):
            if fixed:
                renderer.scene = scene
            renderer.tick(k / 1000)
            loud = loud or bool(DEVICES[-1].frames[-1].amplitude.any())
    assert not renderer.report.faults
    return loud


def test_joints_are_ready_before_a_run_in_which_hands_may_come(built: list[bool]) -> None:
    run([(), (), (JOINTS,), (JOINTS,)], peak=3.0)
    assert built == [True]


@pytest.mark.parametrize("peak", [3.0, float("inf")])
@pytest.mark.parametrize("hand", [JOINTS, make_mesh(2)])
def test_the_output_is_silent_while_the_skin_of_a_new_kind_is_built(
    hand: pc.Hand, peak: float, built: list[bool]
) -> None:
    assert run([(), (), (), (hand,), (hand,)], fixed=True, peak=peak)
    assert built == [True]


def test_a_first_scene_has_its_skins_before_the_first_tick(built: list[bool]) -> None:
    run([(make_mesh(2),)] * 3)
    assert built == [True, True]  # of joints, which may come, and of the mesh


def test_a_lost_hand_is_built_when_it_is_found(built: list[bool]) -> None:
    lost = pc.Hand(np.full((26, 3), np.nan), time=0.0)
    run([(), (lost,), (lost,), (JOINTS,)], fixed=True)
    assert built == [True]


def test_a_recording_renders_again_whether_or_not_the_skin_was_built(
    tmp_path: Path, built: list[bool]
) -> None:
    mesh = make_mesh(2)
    hands: list[tuple[pc.Hand, ...]] = [(), (), (mesh,), (mesh,), (JOINTS,), (JOINTS, mesh), ()]
    for name, forgotten in (("first", True), ("second", False)):
        path = tmp_path / name
        run(hands, fixed=True, recorder=pc.Recorder(path))
        if forgotten:
            skin_cache._skins.clear()
        assert rerender(Recording(path)).different == 0
    assert len(built) == 4


def test_kinds_are_forgotten_after_some_others() -> None:
    loader = SkinLoader(limited=False)
    faces = [np.array([[0, 1, k]]) for k in range(2, 2 + skin_cache.MAX_SKINS)]
    vertices = np.random.default_rng(1).uniform(-0.1, 0.1, (20, 3))
    hands = [pc.Hand(vertices=vertices, faces=one) for one in faces]
    assert loader.find_new(hands[:1]) == hands[:1]
    assert loader.find_new(hands[:1]) == []
    assert loader.find_new([*hands, hands[0]]) == hands[1:]
    assert loader.find_new([JOINTS]) == [JOINTS]
    assert loader.find_new(hands[2:]) == []
    assert loader.find_new(hands[:1]) == []
    assert loader.find_new(hands[1:2]) == hands[1:2], "the one that was not seen for longest"
