"""Recordings contain all inputs and frames of a run, and survive damage to the file."""

from __future__ import annotations

import contextlib
import dataclasses
import math
import re
from pathlib import Path
from typing import Any, ClassVar

import msgpack
import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

import pacinian as pc
from pacinian.cli.main import cli
from pacinian.rendering.replay import replay
from pacinian.rendering.rerender import Rerendering, rerender
from pacinian.rendering.smoothing import Smoothing
from pacinian.scene.hands.hand import Hand
from pacinian.scene.modulation.technique import STM
from pacinian.testing import ManualClock
from pacinian_plugins.backends.simulated import Simulated

bounded = settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
SMALL = pc.lattice(0.05, 0.05)  # 36 transducers
POINT = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=0.02)
SCENE = pc.Scene((POINT,))
TICK = 1e-3  # [s]


def moving(t: float) -> pc.Scene:
    return pc.Scene((replace(POINT, position=(0.02 * math.sin(100.0 * t), 0.0, 0.15)),))


def make(path: Path, scene: Any = moving, **options: Any) -> tuple[pc.Renderer, Simulated]:
    device = Simulated(keep=1000, rate=options.pop("rows", 1) * 1000.0)
    options.setdefault("clock", ManualClock(50.0))
    recorder = pc.Recorder(path)
    array = options.pop("array", SMALL)
    return pc.Renderer(array, scene, backend=device, recorder=recorder, **options), device


def record(path: Path, scene: Any = moving, ticks: int = 20, **options: Any) -> list[pc.Frame]:
    """Record a run; return the frames that were sent."""
    renderer, device = make(path, scene, **options)
    report = renderer.run(ticks * TICK)
    assert not report.faults
    assert renderer.recorder is not None
    return list(device.frames)[:ticks]


def alike(a: pc.Frame, b: pc.Frame) -> bool:
    return np.array_equal(a.phase, b.phase) and np.array_equal(a.amplitude, b.amplitude)


def test_its_length_is_the_number_of_its_ticks(tmp_path: Path) -> None:
    path = tmp_path / "run.pac"
    record(path, ticks=7)
    recording = pc.Recording(path)
    assert len(recording) == len(list(recording.ticks())) == 7
    assert repr(recording) == f"<Recording {path}: 7 ticks, 36 transducers, device at 1000 Hz>"
    whole = path.read_bytes()
    for cut in (1, 100):  # the last tick is incomplete
        path.write_bytes(whole[:-cut])
        assert len(pc.Recording(path)) == len(list(pc.Recording(path).ticks()))
    path.write_bytes(whole[: whole.index(b"sequence") - 2])
    assert len(pc.Recording(path)) == 0
    assert pc.Recording(path)
    path.write_bytes(whole + b"\xc1")
    assert "damaged" in repr(recording)
    with pytest.raises(pc.RecordingError, match="damaged"):
        len(recording)
    path.unlink()
    with pytest.raises(pc.RecordingError, match="read"):
        len(recording)


@pytest.mark.parametrize("rows", [1, 3])
def test_every_tick_is_there(tmp_path: Path, rows: int) -> None:
    sent = record(tmp_path / "run.pac", rows=rows)
    recording = pc.Recording(tmp_path / "run.pac")
    ticks = list(recording.ticks())
    assert len(ticks) == len(sent) == 20
    np.testing.assert_array_equal(recording.positions, SMALL.positions)
    np.testing.assert_array_equal(recording.normals, SMALL.normals)
    for k, (tick, frame) in enumerate(zip(ticks, sent, strict=True)):
        assert alike(tick.frame, frame)
        assert tick.frame.phase.shape == (rows, len(SMALL))
        assert (tick.frame.sequence, tick.frame.time) == (k, frame.time)
        assert tick.time == frame.time - 50.0
        assert tick.begins is (k == 0)
        assert tick.asked is not None
        assert tick.asked.scene.objects == moving(tick.time).objects
        assert tick.asked.solver.name == "auto"
        assert len(tick.clock) >= 2
    assert [alike(a, b) for a, b in zip(recording, sent, strict=True)] == [True] * 20


def test_ticks_in_which_nothing_changes_take_next_to_no_space(tmp_path: Path) -> None:
    path = tmp_path / "run.pac"
    record(path, SCENE, 20, sampler=pc.Sampler())
    short = path.stat().st_size
    sent = record(path, SCENE, 120, sampler=pc.Sampler())
    assert path.stat().st_size - short < 100 * 100
    assert all(alike(a, b) for a, b in zip(pc.Recording(path), sent, strict=True))


def test_it_replays_the_same_frames_at_the_same_times(tmp_path: Path) -> None:
    sent = record(tmp_path / "run.pac")
    again, clock = Simulated(keep=1000), ManualClock(5.0)
    assert replay(pc.Recording(tmp_path / "run.pac"), again, SMALL, clock) == (20, 0)
    for before, after in zip(sent, list(again.frames)[:20], strict=True):
        assert alike(before, after)
        assert before.time == after.time
    np.testing.assert_allclose(clock.waits, 5.0 + np.arange(20) * TICK)
    assert again.silent


def test_a_replay_is_silent_where_the_renderer_was(tmp_path: Path) -> None:
    clock = ManualClock(50.0)
    at_once = {"sampler": pc.Sampler(), "smoothing": Smoothing(rate=None)}
    renderer, device = make(tmp_path / "run.pac", clock=clock, **at_once)
    with renderer:
        for _ in range(3):
            renderer.run(3 * TICK)  # each run ends in silence
            clock.advance(0.5)
        renderer.tick()
        device.stall()
        renderer.tick()
        device.resume()
        renderer.reset()
        renderer.tick()

    class Notes(Simulated):
        seen: ClassVar[list[str]] = []

        def send(self, frame: pc.Frame) -> None:
            self.seen.append("frame")
            super().send(frame)

        def silence(self) -> None:
            if not self.silent:
                self.seen.append("silence")
            super().silence()

    again = ManualClock()
    replay(pc.Recording(tmp_path / "run.pac"), Notes(), SMALL, again)
    three = ["frame"] * 3 + ["silence"]
    assert Notes.seen == [*three, *three, *three, "frame", "silence", "frame", "silence"]
    assert again.waits == sorted(again.waits)


def test_a_replay_does_not_sound_on_where_the_renderer_was_held_up(tmp_path: Path) -> None:
    clock = ManualClock()
    renderer, _ = make(tmp_path / "run.pac", clock=clock, sampler=pc.Sampler())
    with renderer:
        renderer.tick()
        clock.advance(0.5)
        renderer.tick()
    again = Simulated()
    replay(pc.Recording(tmp_path / "run.pac"), again, SMALL, ManualClock())
    assert [frame.amplitude.any() for frame in again.frames] == [True, False, True, False]


def test_a_pause_that_cannot_be_meant_is_no_wait(tmp_path: Path) -> None:
    clock = ManualClock()
    renderer, _ = make(tmp_path / "run.pac", clock=clock)
    with renderer:
        renderer.tick()
        clock.advance(1e6)
        renderer.tick()
    again = Simulated()
    with pytest.raises(pc.RecordingError, match="pauses for"):
        replay(pc.Recording(tmp_path / "run.pac"), again, SMALL, ManualClock())
    assert again.silent


def test_another_array_or_other_levels_are_refused(tmp_path: Path) -> None:
    record(tmp_path / "run.pac")
    recording = pc.Recording(tmp_path / "run.pac")
    with pytest.raises(pc.RecordingError, match="36 transducers"):
        replay(recording, Simulated(), pc.autd(), ManualClock())
    with pytest.raises(pc.RecordingError, match="320 amplitudes"):
        replay(recording, Simulated(amplitudes=320), SMALL, ManualClock())


def test_the_amplitudes_of_levels_that_are_not_even_are_recorded(tmp_path: Path) -> None:
    path, pulses = tmp_path / "run.pac", tuple(np.sin(np.pi / 128.0 * np.arange(65)).tolist())
    device = Simulated(phases=128, amplitudes=pulses, keep=100)
    recorder, clock = pc.Recorder(path), ManualClock()
    report = pc.Renderer(SMALL, moving, backend=device, recorder=recorder, clock=clock).run(0.02)
    assert not report.faults
    recording = pc.Recording(path)
    assert recording.capability == device.capability
    for tick, frame in zip(recording.ticks(), device.frames, strict=False):
        made = tick.frame.gains(recording.capability)
        np.testing.assert_array_equal(made, frame.gains(device.capability))
    assert rerender(recording) == Rerendering(20, 0)
    again = Simulated(phases=128, amplitudes=pulses)
    assert replay(recording, again, SMALL, ManualClock()) == (20, 0)
    with pytest.raises(pc.RecordingError, match="65 uneven amplitudes"):
        replay(recording, Simulated(phases=128, amplitudes=65), SMALL, ManualClock())


def test_the_array_comes_back_with_how_its_transducers_differ(tmp_path: Path) -> None:
    rng = np.random.default_rng(7)
    s = rng.uniform(0.3, 2.0, 35) * np.exp(1j * rng.uniform(-3.0, 3.0, 35))
    places = SMALL.remove_transducers([17]).transform(pc.Pose().rotate("x", math.radians(20.0)))
    array = pc.Array(places.positions, places.normals, pc.T4010A1, s)
    record(tmp_path / "run.pac", array=array)
    recording = pc.Recording(tmp_path / "run.pac")
    for name in ("positions", "normals", "response"):
        np.testing.assert_array_equal(getattr(recording.array, name), getattr(array, name))
    assert recording.array.transducer == array.transducer
    assert rerender(recording) == Rerendering(20, 0)


def test_a_directivity_that_cannot_be_recorded_does_not_keep_a_recording_from_being_played(
    tmp_path: Path,
) -> None:
    kind = pc.Transducer(pressure=3.0, directivity=lambda cosine: cosine**2)
    record(tmp_path / "run.pac", array=SMALL.replace_transducer(kind))
    recording = pc.Recording(tmp_path / "run.pac")
    assert recording.array.transducer == pc.Transducer(pressure=3.0)
    assert replay(recording, Simulated(), recording.array, ManualClock()) == (20, 0)


def unpacked(data: bytes) -> Any:
    unpacker = msgpack.Unpacker(strict_map_key=False)
    unpacker.feed(data)
    return unpacker


def changed(path: Path, change: Any, index: int = 0) -> pc.Recording:
    """Change the map with this index in the recording at `path`; 0 is the header."""
    maps = list(unpacked(path.read_bytes()))
    change(maps[index])
    path.write_bytes(b"".join(map(msgpack.packb, maps)))
    return pc.Recording(path)


@pytest.mark.parametrize(
    "bad",
    [{"transducer": None}, {"response": b"1234"}, {"response": bytes(16 * 36)}, {"response": 5}],
)
def test_settings_of_no_array_are_told(tmp_path: Path, bad: dict[str, Any]) -> None:
    record(tmp_path / "run.pac", ticks=1)
    recording = changed(tmp_path / "run.pac", lambda header: header["settings"].update(bad))
    assert len(list(recording)) == 1
    with pytest.raises(pc.RecordingError, match="no array can be made"):
        recording.array  # noqa: B018


@pytest.mark.parametrize("bad", [[0.0, 0.5], [1.0, 0.0], [0.0, "x", 1.0], [[0.0, 1.0]], [], 0.5])
def test_amplitudes_that_no_device_has_are_a_damaged_header(tmp_path: Path, bad: Any) -> None:
    record(tmp_path / "run.pac", ticks=1)
    with pytest.raises(pc.RecordingError, match="damaged header"):
        changed(tmp_path / "run.pac", lambda header: header.update(amplitudes=bad))


@pytest.mark.parametrize(
    "bad",
    [
        *({"rate": rate} for rate in (0.0, math.nan, 1e308, {"a": 1}, None)),
        *({"medium": medium} for medium in ({"speed_of_sound": -1.0}, {"x": 1}, 5.0, None)),
    ],
)
def test_a_header_of_other_types_is_damaged(tmp_path: Path, bad: dict[str, Any]) -> None:
    record(tmp_path / "run.pac", ticks=1)
    with pytest.raises(pc.RecordingError, match="damaged header"):
        changed(tmp_path / "run.pac", lambda header: header["settings"].update(bad))
    with pytest.raises(pc.RecordingError, match="damaged header"):
        changed(tmp_path / "run.pac", lambda header: header.update(made=[bad]))


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[bytes, list[pc.Frame]]:
    """Return a recording of many kinds of objects, and the frames that were sent."""
    path = tmp_path_factory.mktemp("whole") / "run.pac"
    hand = Hand.open("left", pc.Pose((0.0, 0.0, 0.16)))

    def scene(t: float) -> pc.Scene:
        ball = pc.Volume(
            shape=pc.Sphere(0.01), pose=pc.Pose((t, 0.0, 0.15)), radiation_pressure=0.5, name="ball"
        )
        room = pc.Workspace((-1.0, -1.0, 0.0), (1.0, 1.0, 1.0))
        return pc.Scene((ball,), room, (hand.transform(pc.Pose((0.0, t, 0.0))),))

    sent = record(path, scene, 6, limits=pc.Limits(quiet=([[0.0, 0.1, 0.1]], 3.0)))
    return path.read_bytes(), sent


@bounded
@given(cut=st.floats(0.0, 1.0))
def test_what_was_cut_off_is_whole_up_to_there(
    whole: tuple[bytes, list[pc.Frame]], tmp_path: Path, cut: float
) -> None:
    data, sent = whole
    path = tmp_path / "cut.pac"
    path.write_bytes(data[: round(cut * len(data))])
    try:
        ticks = list(pc.Recording(path).ticks())
    except pc.RecordingError:
        assert cut < 0.3  # within the header
        return
    assert cut < 1.0 or len(ticks) == len(sent)
    assert all(alike(tick.frame, frame) for tick, frame in zip(ticks, sent, strict=False))
    assert all(tick.asked is not None for tick in ticks)


def heard(path: Path) -> None:
    """Read the whole file in every way. Only RecordingError is allowed."""
    with contextlib.suppress(pc.RecordingError):
        list(pc.Recording(path))
    with contextlib.suppress(pc.RecordingError):
        list(pc.Recording(path).ticks())
    with contextlib.suppress(pc.RecordingError):
        rerender(pc.Recording(path))


@bounded
@given(flips=st.lists(st.tuples(st.floats(0.0, 1.0), st.integers(0, 255)), min_size=1, max_size=4))
def test_damaged_bytes_are_a_recording_error_or_a_valid_reading(
    whole: tuple[bytes, list[pc.Frame]], tmp_path: Path, flips: list[tuple[float, int]]
) -> None:
    data = bytearray(whole[0])
    for place, value in flips:
        data[min(int(place * len(data)), len(data) - 1)] = value
    path = tmp_path / "damaged.pac"
    path.write_bytes(data)
    heard(path)


junk = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**63), 2**64 - 1) | st.floats() | st.text(max_size=5)
    | st.binary(max_size=20),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)  # fmt: skip
places = st.lists(st.integers(0, 30), min_size=1, max_size=7)


@bounded
@given(tick=st.integers(0, 6), place=places, value=junk)
def test_values_of_any_kind_are_a_recording_error_or_a_valid_reading(
    whole: tuple[bytes, list[pc.Frame]], tmp_path: Path, tick: int, place: list[int], value: Any
) -> None:
    maps = list(unpacked(whole[0]))
    inside: Any = maps[tick]
    for step in place[:-1]:
        keys = list(inside) if isinstance(inside, dict) else range(len(inside))
        inner = inside[keys[step % len(keys)]]
        if not isinstance(inner, (dict, list)) or not inner:
            break
        inside = inner
    keys = list(inside) if isinstance(inside, dict) else range(len(inside))
    inside[keys[place[-1] % len(keys)]] = value
    path = tmp_path / "strange.pac"
    path.write_bytes(b"".join(map(msgpack.packb, maps)))
    heard(path)


@pytest.mark.parametrize(
    "data", [b"", b"hello", b"\x81\xa1a\x01", b"\xc1", b"\xdf\xff\xff\xff\xff", b"\x81\x90\x01"]
)
def test_what_is_no_recording_is_refused(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "junk").write_bytes(data)
    with pytest.raises(pc.RecordingError, match="junk"):
        pc.Recording(tmp_path / "junk")


@pytest.mark.parametrize(
    "damage",
    [
        {"amplitude": np.full((1, 36), 256, "<u2").tobytes()},
        {"phase": np.full((1, 36), 60000, "<u2").tobytes()},
        {"time": math.inf},
        {"time": math.nan},
        {"t": math.nan},
        {"phase": b"odd"},
        {"sequence": math.inf},
    ],
)
def test_what_no_device_can_do_is_refused(tmp_path: Path, damage: dict[str, Any]) -> None:
    path, device = tmp_path / "run.pac", Simulated()
    record(path, ticks=2)
    recording = changed(path, lambda tick: tick.update(damage), 1)
    with pytest.raises(pc.RecordingError, match=r"run.pac: has a damaged tick"):
        replay(recording, device, SMALL, ManualClock())
    assert device.silent
    assert not device.received


def test_a_missing_file_and_one_that_cannot_be_written_are_named(tmp_path: Path) -> None:
    for path in (tmp_path / "gone", tmp_path):
        with pytest.raises(pc.RecordingError, match=path.name):
            pc.Recording(path)
    for path in (tmp_path / "nowhere" / "run.pac", tmp_path):
        with pytest.raises(pc.RecordingError, match=path.name):
            pc.Recorder(path)


def test_an_earlier_recording_stays_until_a_run_begins_and_other_files_are_not_touched(
    tmp_path: Path,
) -> None:
    path, scene = tmp_path / "run.pac", tmp_path / "scene.toml"
    renderer, _ = make(path)
    renderer.run(0.01)
    before = path.read_bytes()
    pc.Recorder(path)
    assert path.read_bytes() == before
    again, _ = make(path)
    again.run(0.005)
    assert len(pc.Recording(path)) == 5
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "never")
    late = pc.Recorder(link)
    assert link.is_symlink()
    (tmp_path / "never").write_text("made meanwhile")
    with pytest.raises(pc.RecordingError, match="does not overwrite it"):
        late.begin(pc.autd(), renderer.backend.capability, {})
    with pytest.raises(pc.RecordingError, match="cannot be written"):
        pc.Recorder(tmp_path / ("x" * 300))
    scene.write_text("[[objects]]\n")
    with pytest.raises(pc.RecordingError, match="does not overwrite it"):
        pc.Recorder(scene)
    assert scene.read_text() == "[[objects]]\n"


def test_a_recording_that_ends_within_a_tick_is_cut_short(tmp_path: Path) -> None:
    path = tmp_path / "run.pac"
    renderer, _ = make(path)
    renderer.run(0.01)
    whole = path.read_bytes()
    assert not pc.Recording(path).cut_short
    for size in (len(whole) - 1, len(whole) // 2):
        path.write_bytes(whole[:size])
        recording = pc.Recording(path)
        assert recording.cut_short
        assert len(recording) == len(list(recording)) < 10
        done = CliRunner().invoke(cli, ["replay", str(path)])
        assert done.exit_code == 0, done.output
        assert "cut short" in done.stderr


@pytest.mark.parametrize("value", [0.0, 10.0, 1e6, -1e30, 1e200])
def test_normals_that_are_no_unit_vectors_are_damage(tmp_path: Path, value: float) -> None:
    path = tmp_path / "run.pac"
    renderer, _ = make(path)
    renderer.run(0.005)
    normals = pc.Recording(path).normals
    changed = normals.copy()
    changed[0] = value, 0.0, 0.0
    path.write_bytes(path.read_bytes().replace(normals.astype("<f8").tobytes(), changed.tobytes()))
    with pytest.raises(pc.RecordingError, match="unit vectors"):
        pc.Recording(path)


def test_a_newer_version_says_what_to_do(tmp_path: Path) -> None:
    path = tmp_path / "run.pac"
    path.write_bytes(msgpack.packb({"format": "pacinian recording", "version": 99}))
    with pytest.raises(pc.RecordingError, match=r"version 99.*update"):
        pc.Recording(path)


def test_a_recorder_is_for_one_run_of_a_renderer(tmp_path: Path) -> None:
    renderer, _ = make(tmp_path / "run.pac")
    renderer.run(0.01)
    with pytest.raises(pc.RecordingError, match="a new Recorder"):
        renderer.run(0.01)
    assert len(list(pc.Recording(tmp_path / "run.pac"))) == 10


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_disk_is_a_fault_that_silences() -> None:
    renderer, device = make(Path("/dev/full"))
    with renderer:
        report = renderer.run(0.2)
        assert report.ticks == 200
        assert 0 < report.frames_sent < 200
        assert [fault.stage for fault in report.faults] == ["record"]
        assert "No space left" in report.faults[0].message
        assert device.silent


class Square:
    """A user's own envelope."""

    def at(self, t: Any) -> Any:
        return np.ones(len(t))


@dataclasses.dataclass
class Data:
    """A user's own envelope that could be written, but not read."""

    level: float = 0.5

    def at(self, t: Any) -> Any:
        return np.full(len(t), self.level)


class Spot:
    """A user's own curve."""

    length, reach = 0.01, 0.0

    def at(self, s: Any) -> Any:
        return np.zeros((len(s), 3))


class Own(pc.Solver):
    name = "own"

    def solve(self, *arguments: Any) -> pc.Result:
        arguments[-1][:] = 0.1
        return pc.Result()


class Posing(Own):
    name = "lagrange"


BALL = pc.SDF(lambda q: np.sqrt((q * q).sum(axis=1)) - 0.01, (0.01, 0.01, 0.01))


@pytest.mark.parametrize(
    ("options", "why"),
    [
        ({"item": pc.Volume(shape=BALL, radiation_pressure=0.1, name="blob")}, "blob.*function"),
        ({"item": replace(POINT, envelope=pc.Function(np.ones_like))}, "Point.*Encoding"),
        ({"item": replace(POINT, envelope=Square())}, "Square"),
        ({"item": replace(POINT, envelope=Data())}, "Point"),
        ({"item": replace(POINT, technique=STM(frequency=50.0, along=Spot()))}, "Spot"),
        ({"item": replace(POINT, priority=2**70)}, "Point"),
        ({"solver": Own()}, "own"),
        ({"solver": Posing()}, "'lagrange' is another"),
    ],
)
def test_of_what_cannot_be_recorded_the_frames_still_are(
    tmp_path: Path, options: dict[str, Any], why: str
) -> None:
    item = options.pop("item", POINT)
    lift = pc.Pose((0.0, 0.0, 0.15))
    item = replace(item, pose=lift) if isinstance(item, pc.Volume) else item
    renderer, device = make(tmp_path / "run.pac", pc.Scene((item,)), **options)
    report = renderer.run(0.02)
    assert not report.faults
    assert renderer.recorder is not None
    assert re.search(why, renderer.recorder.unrecorded)
    assert re.search(f"no longer recorded: .*(?:{why})", report.warnings[-1])
    recording = pc.Recording(tmp_path / "run.pac")
    ticks = list(recording.ticks())
    assert len(ticks) == 20
    assert {tick.asked for tick in ticks} == {None}
    assert all(alike(t.frame, f) for t, f in zip(ticks, list(device.frames)[:20], strict=True))
    with pytest.raises(pc.RecordingError, match="lacks the scene of tick 0"):
        rerender(recording)


def test_solver_and_limits_may_change_in_the_middle(tmp_path: Path) -> None:
    renderer, _ = make(tmp_path / "run.pac")
    asked: list[Any] = [
        ("auto", pc.Limits()),
        ("gs-pat", pc.Limits(gain=0.5)),
        (pc.solver("lagrange", rounds=7), pc.Limits(power=0.3, quiet=([[0.0, 0.1, 0.1]], [2.0]))),
        ("lagrange", pc.Limits(exact=[0])),
        ("lagrange", pc.Limits(exact=[True])),
    ]
    with renderer:
        for solver, limits in asked:
            renderer.session.solver, renderer.limits = solver, limits
            renderer.tick()
            renderer.tick()
        assert not renderer.report.faults
    ticks = [tick.asked for tick in pc.Recording(tmp_path / "run.pac").ticks()]
    for k, (solver, limits) in enumerate(asked):
        for seen in ticks[2 * k : 2 * k + 2]:
            assert seen is not None
            name = solver if isinstance(solver, str) else solver.name
            assert seen.solver.name == name
            assert (seen.limits.gain, seen.limits.power) == (limits.gain, limits.power)
            for one, other in (
                (seen.limits.quiet, limits.quiet),
                (seen.limits.exact, limits.exact),
            ):
                assert (one is None) == (other is None)
                if other is not None:
                    assert all(map(np.array_equal, one, other))
    assert ticks[4].solver == asked[2][0]  # type: ignore[union-attr]


def test_a_second_run_cannot_record_to_the_file_of_the_first(tmp_path: Path) -> None:
    path = tmp_path / "run.pac"
    (first, _), (second, _) = make(path), make(path)
    with first:
        first.tick()
        with pytest.raises(pc.RecordingError, match="recorded by another run"):
            second.open()
        first.tick()
    assert len(pc.Recording(path)) == 2
    with second:  # the first has ended
        second.tick()
    assert len(pc.Recording(path)) == 1
