"""A recording rendered again gives the same frames, bit for bit, whatever the timing was."""

from __future__ import annotations

import concurrent.futures
import dataclasses
import itertools
import math
import shutil
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import msgpack
import numpy as np
import pytest
from msgspec.structs import replace
from PIL import Image
from scipy.io import wavfile
from threadpoolctl import threadpool_limits
from trimesh.creation import box, icosphere

import pacinian as pc
from pacinian.gallery import HAND, SCENES
from pacinian.native import VARIANT
from pacinian.rendering.background_solve import BackgroundSolve
from pacinian.rendering.replay import replay
from pacinian.rendering.rerender import rerender
from pacinian.rendering.smoothing import Smoothing
from pacinian.scene.hands.hand import Hand
from pacinian.scene.modulation.technique import LM, STM
from pacinian.scene.motion import Motion
from pacinian.scene.shapes.curves import Circle
from pacinian.solving import quiet_subspace
from pacinian.solving.blas import ONE
from pacinian.solving.quiet_subspace import Preparation
from pacinian.testing import ManualClock
from pacinian_plugins.backends.simulated import Simulated

from .manual_background import ManualBackground

if TYPE_CHECKING:
    from pathlib import Path

ARRAY = pc.autd()
TICK = 1e-3  # [s]


class Slow(ManualClock):
    """A clock that advances at each call, so that deadlines pass and the budget controller acts."""

    def __init__(self, each: float = 2e-5) -> None:
        super().__init__(3.0)
        self.each, self.looks = each, 0

    def now(self) -> float:
        self.looks += 1
        self.advance(self.each * (1 + self.looks * 7919 % 13))
        return self.time


def make(path: Path, scene: Any, clock: Any = None, **options: Any) -> pc.Renderer:
    options.setdefault("backend", Simulated(rate=2000.0))
    clock = clock or ManualClock(3.0)
    return pc.Renderer(ARRAY, scene, clock=clock, recorder=pc.Recorder(path), **options)


def again(path: Path) -> tuple[int, int]:
    """Render a recording again; return the number of ticks, and of those that differ."""
    found = rerender(pc.Recording(path))
    assert not found.environment
    assert not found.objects
    return found.ticks, found.different


@pytest.mark.parametrize("name", SCENES)
def test_every_built_in_scene_comes_out_the_same(tmp_path: Path, name: str) -> None:
    report = make(tmp_path / "run.pac", SCENES[name]).run(0.02)
    assert not report.faults
    assert again(tmp_path / "run.pac") == (20, 0)


def grid(t: float) -> pc.Scene:
    """Return a scene of points that all move."""
    side = (0.01 * np.arange(-4.0, 5.0)).tolist()
    places = tuple((x, y, 0.2 + 0.01 * t) for x in side for y in side)
    return pc.Scene((pc.Particles(positions=places, radiation_pressure=1.0),))


@pytest.mark.parametrize("name", ["palm", "crowd", "stm-circle", "rain", "grid"])
def test_it_comes_out_the_same_where_time_decides(tmp_path: Path, name: str) -> None:
    clock = Slow({"grid": 4e-4, "palm": 6e-5}.get(name, 2e-5))
    renderer = make(tmp_path / "run.pac", SCENES.get(name, grid), clock)
    with renderer:
        renderer._pipeline.background = ManualBackground()
        for k in range(60):
            renderer.tick(3.0 + k * TICK)
        assert not renderer.report.faults
        if name == "palm":
            assert renderer.report.statuses["deadline"] > 3
        if name == "grid":
            assert renderer.sampler.allowed < renderer.sampler.budget
    assert again(tmp_path / "run.pac") == (60, 0)


def test_it_comes_out_the_same_by_the_systems_clock(tmp_path: Path) -> None:
    report = make(tmp_path / "run.pac", SCENES["palm"], pc.SystemClock()).run(0.3)
    assert not report.faults
    assert again(tmp_path / "run.pac") == (report.frames_sent, 0)


def test_it_comes_out_the_same_after_faults_and_resets(tmp_path: Path) -> None:
    device = Simulated(rate=2000.0)
    calls = iter(range(1000))

    def scene(t: float) -> pc.Scene:
        if next(calls) in (13, 14, 31):
            raise RuntimeError("in the middle")
        return SCENES["palm"](t)

    renderer = make(tmp_path / "run.pac", scene, Slow(), backend=device)
    with renderer:
        for k in range(60):
            if k in (20, 45):
                device.stall()  # after the tick has solved, and has read the clock
            renderer.tick(3.0 + k * TICK)
            device.resume()
            if renderer.halted is not None and k % 3:
                renderer.reset()
        assert renderer.report.fault_count == 5
        sent = renderer.report.frames_sent
        assert sent < 60
    assert again(tmp_path / "run.pac") == (sent, 0)


def test_it_comes_out_the_same_after_a_pause_between_two_runs(tmp_path: Path) -> None:
    clock = ManualClock(3.0)
    renderer = make(tmp_path / "run.pac", SCENES["sliding-ball"], clock)
    with renderer:
        for _ in range(3):
            renderer.run(0.01)
            clock.advance(0.2)
    assert again(tmp_path / "run.pac") == (30, 0)


POINT = pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=5.0, name="a")
BALL = pc.Volume(
    shape=pc.Sphere(0.02),
    pose=pc.Pose((0.0, 0.0, 0.19)),
    radiation_pressure=6.0,
    motion=Motion((0.3, 0.0, 0.0), (0.0, 2.0, 0.0), 0.0),
    name="ball",
)
PLATE = pc.Surface(
    shape=pc.Rectangle(0.05, 0.05), pose=pc.Pose((0, 0, 0.2)), radiation_pressure=3.0, name="plate"
)


def fresh(t: float) -> pc.Scene:
    """Return a new scene of the same objects."""
    return pc.Scene(OBJECTS, hands=(HAND,))


def hands(t: float) -> pc.Scene:
    """Return a new scene with a hand whose position changes every 8 ms."""
    return pc.Scene((PLATE,), hands=(seen(int(t / 0.008)),))


def seen(update: int) -> Any:
    if update not in SEEN:
        SEEN[update] = HAND.transform(pc.Pose((0.004 * (update % 3), 0.0, 0.0)))
    return SEEN[update]


def tracked(t: float) -> pc.Scene:
    """Return a scene with a moving hand that is lost now and then, and a moving hand that is a mesh."""
    now = int(t / 0.008) * 0.008
    joints = HAND.transform(pc.Pose((0.2 * now, 0.0, 0.0))).joints
    assert joints is not None
    if 0.02 < now < 0.04:
        joints = np.full((26, 3), np.nan)
    one = Hand(joints, velocities=(0.2, 0.0, 0.0), time=now, name="tracked")
    return pc.Scene((PLATE,), hands=(one, GLOVE.transform(pc.Pose((0.0, -0.1, now)))))


def comes_and_goes(t: float) -> pc.Scene:
    """Return one of two scenes in turn, with a moving object."""
    return pc.Scene((BALL, POINT), hands=(HAND,)) if int(t / 0.003) % 2 else OTHER


def gone_and_back(t: float) -> pc.Scene:
    """Return a scene with a moving object that is missing now and then."""
    return pc.Scene((POINT, BALL) if int(t / 0.003) % 2 else (POINT,), hands=(HAND,))


def put_and_remove(t: float) -> pc.Scene:
    """Return a scene whose objects are updated, removed and put back, as by a game engine."""
    k = round(t / TICK)
    scene = WORLD[-1] if k else OTHER
    if k % 5 == 1:
        pose = pc.Pose((0.002 * (k % 7), 0.0, 0.19))
        scene = scene.put(replace(BALL, pose=pose, motion=Motion((0.1, 0, 0), (0, 1, 0), t)))
    if k % 7 == 3:
        scene = scene.remove("a")
    if k % 7 == 6:
        scene = scene.put(POINT)
    if k == 30:
        scene = scene.put(replace(BALL, motion=None))
    WORLD.append(scene)
    return scene


def modulated(t: float) -> pc.Scene:
    """Return a scene with a hand on a plate, whose technique changes now and then."""
    techniques = STM(100.0, "outline"), LM(50.0, 0.003), STM(60.0, Circle(0.01))
    plate = replace(PLATE, technique=techniques[int(t / 0.01) % 3])
    return pc.Scene((plate, POINT), hands=(HAND,))


BLOCK = box(extents=(0.08, 0.08, 0.02)).subdivide().subdivide().subdivide()
GLOVE = Hand(vertices=BLOCK.vertices, faces=BLOCK.faces, name="glove").transform(
    pc.Pose((0, 0, 0.205))
)
OBJECTS = tuple(replace(BALL, name=f"{k}", pose=pc.Pose((0.01 * k, 0, 0.19))) for k in range(4))
OTHER = pc.Scene((PLATE, BALL, POINT), hands=(HAND,))
SEEN: dict[int, Any] = {}
WORLD: list[pc.Scene] = []


@pytest.mark.parametrize(
    "scene", [fresh, hands, tracked, comes_and_goes, gone_and_back, put_and_remove, modulated]
)
@pytest.mark.parametrize("slow", [False, True])
def test_it_comes_out_the_same_however_scenes_are_built(
    tmp_path: Path, scene: Any, slow: bool
) -> None:
    renderer = make(tmp_path / "run.pac", scene, Slow(3e-5) if slow else None)
    with renderer:
        for k in range(60):
            renderer.tick(3.0 + k * TICK if not slow else None)
        assert not renderer.report.faults
    assert renderer.recorder is not None
    assert not renderer.recorder.unrecorded
    assert again(tmp_path / "run.pac") == (60, 0)


def test_it_comes_out_the_same_with_other_solvers_limits_and_settings(tmp_path: Path) -> None:
    renderer = make(
        tmp_path / "run.pac",
        SCENES["palm"],
        Slow(),
        rate=700.0,
        adaptive=False,
        smoothing=Smoothing(rate=100.0, align=False),
        sampler=pc.Sampler(40, 0.012, ramp=0.01, perception=False),
        medium=pc.Air(temperature=31.0, attenuation="absorbing"),
        solver="gs-pat",
        backend=Simulated(phases=64, amplitudes=320, rate=2100.0),
    )
    with renderer:
        for k in range(40):
            if k == 10:
                renderer.limits = pc.Limits(power=20.0)
            if k == 20:
                renderer.session.solver = pc.solver("lagrange", mu=1e-5)
            if k == 30:
                renderer.limits = pc.Limits(gain=0.5, quiet=([[0.05, 0.0, 0.1]], 20.0))
            renderer.tick()
        assert not renderer.report.faults
    assert again(tmp_path / "run.pac") == (40, 0)


def test_a_tilted_array_of_directive_transducers_comes_out_the_same(tmp_path: Path) -> None:
    array = pc.autd(2, 1).fold("y", math.radians(37.0))
    array = pc.Array(array.positions, array.normals, pc.T4010A1)
    recorder = pc.Recorder(tmp_path / "run.pac")
    clock = ManualClock(3.0)
    renderer = pc.Renderer(array, SCENES["sliding-ball"], clock=clock, recorder=recorder)
    assert not renderer.run(0.03).faults
    assert again(tmp_path / "run.pac") == (30, 0)


def test_a_frame_that_was_changed_is_noticed(tmp_path: Path) -> None:
    path = tmp_path / "run.pac"
    make(path, SCENES["sliding-ball"]).run(0.03)
    unpacker = msgpack.Unpacker(strict_map_key=False)
    unpacker.feed(path.read_bytes())
    maps = list(unpacker)
    for k in (8, 20):
        levels = np.frombuffer(maps[k]["phase"], "<u2").copy()
        levels[17] = (levels[17] + 1) % 256
        maps[k]["phase"] = levels.tobytes()
    path.write_bytes(b"".join(map(msgpack.packb, maps)))
    assert again(path) == (30, 2)


def test_settings_that_are_missing_are_told(tmp_path: Path) -> None:
    path = tmp_path / "run.pac"
    kind = pc.Transducer(directivity=lambda cosine: np.maximum(cosine, 0.0))
    array = pc.lattice(0.05, 0.05, transducer=kind)
    pc.Renderer(array, OTHER, clock=ManualClock(), recorder=pc.Recorder(path)).run(0.01)
    assert len(list(pc.Recording(path))) == 10
    with pytest.raises(pc.RecordingError, match="no settings"):
        again(path)


def test_a_changed_clock_that_changes_what_is_done_is_told(tmp_path: Path) -> None:
    path = tmp_path / "run.pac"
    make(path, SCENES["palm"], Slow()).run(0.01)
    recording = pc.Recording(path)
    ticks = [dataclasses.replace(tick, clock=tick.clock[:1]) for tick in recording.ticks()]
    recording.ticks = lambda **_: iter(ticks)  # type: ignore[method-assign]
    with pytest.raises(pc.RecordingError, match="read more often"):
        rerender(recording)


def write_files(folder: Path) -> pc.Scene:
    """Write a scene with all kinds of objects that need files. The mesh is inside out."""
    rng = np.random.default_rng(0)
    ball = icosphere(subdivisions=2, radius=0.03)
    ball.invert()
    ball.export(folder / "ball.stl")
    Image.fromarray(rng.integers(0, 255, (16, 16), np.uint8)).save(folder / "texture.png")
    np.save(folder / "heights.npy", 0.01 * rng.random((5, 6)))
    np.save(folder / "voxels.npy", np.pad(np.ones((4, 4, 4)), 2))
    wavfile.write(folder / "wave.wav", 8000, rng.integers(-20000, 20000, 800, np.int16))
    names = {path.stem: str(path) for path in folder.iterdir()}
    texture = pc.Texture(file=names["texture"], size=(0.02, 0.02))
    heights = pc.HeightMap(file=names["heights"], width=0.03, height=0.03, depth=0.5)
    block = pc.Placed(pc.Voxels(file=names["voxels"], pitch=0.004))
    envelope = pc.Wave(names["wave"])

    def pose(x: float) -> pc.Pose:
        return pc.Pose((x, 0.0, 0.19))

    how: dict[str, Any] = {"radiation_pressure": 2.0}
    ball_ = pc.Volume(
        shape=pc.Mesh(names["ball"]), pose=pose(0.0), envelope=envelope, name="ball", **how
    )
    map_ = pc.Surface(shape=heights, texture=texture, pose=pose(0.06), name="map", **how)
    union = pc.Union((block, pc.Sphere(0.01)))
    return pc.Scene((ball_, map_, pc.Volume(shape=union, pose=pose(-0.06), name="block", **how)))


def test_a_recording_needs_none_of_the_files_of_its_objects(tmp_path: Path) -> None:
    files, path = tmp_path / "files", tmp_path / "run.pac"
    files.mkdir()
    scene = write_files(files)

    def at(t: float) -> pc.Scene:
        ball = replace(scene.objects[0], pose=pc.Pose((0.1 * t, 0.0, 0.19)))
        return pc.Scene(scene.objects[1:] if int(t / 0.004) % 2 else (ball, *scene.objects[1:]))

    assert not make(path, at).run(0.02).faults
    shutil.rmtree(files)
    assert again(path) == (20, 0)
    ticks = list(pc.Recording(path).ticks())
    assert ticks[0].asked is not None
    ticks[0].asked.scene.check_files()
    assert path.read_bytes().count(b"sha256:") >= 5
    data = path.read_bytes()
    unpacker = msgpack.Unpacker(strict_map_key=False)
    unpacker.feed(data)
    kinds = [kind for m in unpacker for kind, _ in m.get("new", {}).get("files", {}).values()]
    assert sorted(kinds) == [
        "HeightMap",
        "Mesh",
        "Texture",
        "Voxels",
        "Wave",
    ]  # each is stored once
    for cut in np.random.default_rng(1).integers(1, len(data), 40).tolist():
        path.write_bytes(data[:cut])
        with suppress(pc.RecordingError):
            list(pc.Recording(path).ticks())
    unpacker.feed(data)
    maps = list(unpacker)
    del maps[1]["new"]["files"]
    path.write_bytes(b"".join(map(msgpack.packb, maps)))
    with pytest.raises(pc.RecordingError, match="content of 'sha256:"):
        list(pc.Recording(path).ticks())


def test_what_differs_when_rendered_again_is_named(tmp_path: Path) -> None:
    path = tmp_path / "run.pac"
    make(path, SCENES["sliding-ball"]).run(0.01)
    recording = pc.Recording(path)
    recording.environment.update(kernels="v9", NumPy="0.1")
    found = rerender(recording)
    assert (found.different, len(found.environment)) == (0, 2)
    assert f"kernels: v9 when recorded, {VARIANT} now" in str(found)
    moved = ARRAY.transform(pc.Pose((0.001, 0.0, 0.0)))
    moved = moved.replace_transducer(dataclasses.replace(pc.T4010A1, pressure=9.0))
    found = rerender(recording, moved)
    assert found.different > 0
    assert any("positions differ by up to 0.001 m" in text for text in found.array)
    assert "array: another pressure" in found.array
    with pytest.raises(pc.RecordingError, match=r"another array.*positions"):
        replay(recording, Simulated(rate=2000.0), moved, ManualClock(), strict=True)
    assert replay(recording, Simulated(rate=2000.0), ARRAY, ManualClock(), strict=True).frames == 10
    recording.settings["sampler"]["budget"] = 9
    assert list(rerender(recording).objects) == ["ball"]
    with pytest.raises(pc.ArgumentError, match="249 transducers"):
        rerender(recording, pc.lattice(0.05, 0.05))


def test_it_comes_out_the_same_with_several_blas_threads(tmp_path: Path) -> None:
    """With two threads, the matrix of this zone is rounded otherwise than with one."""
    zone = pc.Zone((0.2, 0.0, 0.3), pressure=20.0, radius=0.02)
    path = tmp_path / "run.pac"
    with threadpool_limits(2):
        renderer = make(path, OTHER, limits=pc.Limits(zones=(zone,)), strict=True)
        with renderer:
            for k in range(5):
                renderer.tick(3.0 + k * TICK)
            assert not renderer.report.faults
    for threads in (1, 2):
        with threadpool_limits(threads):
            assert again(path) == (5, 0)


def test_every_tick_and_every_job_limits_blas_to_one_thread(tmp_path: Path) -> None:
    limited: list[bool] = []

    def scene(t: float) -> pc.Scene:
        limited.append(ONE._inside > 0)
        return OTHER

    with make(tmp_path / "run.pac", scene) as renderer:
        renderer.tick()
    background = BackgroundSolve[pc.Scene]()
    background.start(lambda: scene(0.0))
    background.take()
    assert limited == [True] * 3  # the warm-up, the tick and the job


@pytest.mark.parametrize("ready", [0, 3, 100])
def test_it_comes_out_the_same_whenever_a_zone_is_prepared(
    tmp_path: Path, ready: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The preparation ends at another tick when it is rendered again, or not at all before it is needed."""
    zone = pc.Zone((0.2, 0.0, 0.3), pressure=20.0 + ready, radius=0.0)
    waits = itertools.count()

    def wait(futures: Any, _: float) -> Any:
        return concurrent.futures.wait(futures if next(waits) >= ready else ())

    path = tmp_path / "run.pac"
    with make(path, OTHER, limits=pc.Limits(zones=(zone,))) as renderer:
        monkeypatch.setattr(quiet_subspace, "wait", wait)
        for k in range(10):
            renderer.tick(3.0 + k * TICK)
        assert not renderer.report.faults
    loud = [bool(frame.amplitude.any()) for frame in pc.Recording(path)]
    assert any(loud) == (ready < 10)
    monkeypatch.setattr(Preparation, "_kept", {})
    assert again(path) == (10, 0)


def test_limits_that_change_while_a_measurement_runs_beside_change_no_frame(tmp_path: Path) -> None:
    """Then solves run in the ticks, and when the measurement is taken depends on how long it took."""
    path, clock = tmp_path / "r", Slow(0.0)
    x, y = ARRAY.centre[:2].tolist()
    ball = pc.Volume(shape=pc.Sphere(0.02), pose=pc.Pose((x, y, 0.163)), radiation_pressure=1.0)

    def scene(t: float) -> pc.Scene:
        at = pc.Pose((x + 0.1 * t - 0.02, y, 0.1955))
        return pc.Scene((ball,), hands=(pc.Hand.open("right", at),))

    renderer = pc.Renderer(ARRAY, scene, clock=clock, recorder=pc.Recorder(path))
    begun = None
    with renderer:
        pipeline = renderer._pipeline
        for k in range(420):
            clock.each = 4e-5 if k < 60 else 0.0  # solves move in the background
            clock.time = max(clock.time, renderer.start + k * TICK)
            if begun is None and k > 130 and pipeline._measures and pipeline.background.running:
                begun = k
            if begun is not None and begun <= k < begun + 150:
                renderer.limits = pc.Limits(gain=1.0 - 1e-6 * (k - begun + 1))
            renderer.tick(renderer.start + k * TICK)
            time.sleep(2e-4)  # the measurement goes on
    assert begun is not None
    assert rerender(pc.Recording(path)).different == 0
