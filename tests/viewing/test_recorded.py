"""Recordings of the feed, and of a renderer, replayed."""

from __future__ import annotations

import asyncio
import os
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import msgpack
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.plugins.backend import Frame
from pacinian.rendering.recording import Recorder as Tape
from pacinian.rendering.recording import Tick
from pacinian.serving.render import renderer_status
from pacinian.testing import ManualClock
from pacinian.viewing.feed_file import FeedFile, FeedRecorder, FeedWriter
from pacinian.viewing.feed_player import FeedPlayer
from pacinian.viewing.hub import Hub
from pacinian.viewing.messages import Lost, Replay, encode_message
from pacinian.viewing.recording_tick_stats import TickStats
from pacinian.viewing.run import open_view
from pacinian.viewing.scene_mirror import SceneMirror

if TYPE_CHECKING:
    from pathlib import Path

from msgspec import Raw

BALL = Raw(msgpack.packb({"type": "point", "position": [0.0, 0.0, 0.2], "force": 0.01}))
POSE = np.arange(7, dtype="<f4").tobytes()


def state(sequence: int) -> bytes:
    """Return a state, encoded for the feed."""
    import msgspec

    from pacinian.wire.state import State

    made = State(
        sequence=sequence, time=0.0, output="silent", armed=False, owner="", scene="", solver="", backend="",
        technique="", intensity=1.0,
    )  # fmt: skip
    return msgspec.msgpack.encode(made)


@pytest.fixture
def feed(tmp_path: Path) -> Path:
    """Write a feed of 10 s: ten states a second, a ball from 2 s to 5 s, server lost at 9 s."""
    writer, scenery = FeedWriter(tmp_path / "a.feed"), SceneMirror()
    for i in range(100):
        at = 0.1 * i
        if i == 20:
            before, scenery = scenery, scenery.with_("hall", {"ball": BALL}, {"ball": POSE})
            writer.write(at, *scenery.encode(before.version))
        if i == 50:
            before, scenery = scenery, scenery.with_("hall", {}, {})
            writer.write(at, *scenery.encode(before.version))
        if i == 90:
            writer.write(at, "lost", encode_message(Lost(reason="gone")))
            break
        writer.write(at, "state", state(i))
    writer.close()
    return tmp_path / "a.feed"


class Shown:
    """A player, and the view of a page."""

    def __init__(self, path: Path) -> None:
        self.hub = Hub()
        self.recorded = FeedFile(path)
        self.player = FeedPlayer(self.hub, self.recorded)
        self.view = self.hub.join(lambda: None)

    def at(self, time: float, **more: Any) -> dict[str, Any]:
        self.hub.ask(self.view.number, Replay(time=time, **more))
        self.player.show()
        return {kind: msgpack.unpackb(data) for kind, data in self.view.take()}


def test_any_time_is_shown_as_it_was(feed: Path) -> None:
    shown = Shown(feed)
    assert shown.recorded.duration == 9.0
    for time in (0.0, 3.05, 8.0, 3.05, 0.5, 6.0, 2.0):
        told = shown.at(time)
        assert told["state"]["sequence"] == int(10 * time + 1e-9)
        assert (shown.hub.scenery.poses.keys() == {"ball"}) == (2.0 <= time < 5.0)
        assert told["replay"]["time"] == time
    assert shown.at(2.5)["replay"]["duration"] == 9.0
    assert shown.at(9.0)["lost"]["reason"] == "gone"
    assert "state" not in shown.hub.values
    assert shown.at(100.0)["replay"]["time"] == 9.0
    shown.recorded.close()


def test_time_goes_on_while_it_plays(feed: Path) -> None:
    shown = Shown(feed)
    player = shown.player
    assert player.playing
    player.advance(1.0)
    assert player.time == 1.0
    shown.at(2.0, speed=2.0, playing=False)
    player.advance(1.0)
    assert player.time == 2.0
    shown.at(2.0, playing=True)
    player.advance(1.0)
    assert player.time == 4.0
    player.advance(100.0)
    assert (player.time, player.playing) == (9.0, False)
    player.ask(1, Replay(playing=True))
    assert (player.time, player.playing) == (0.0, True)
    shown.recorded.close()


def test_a_file_that_was_cut_off_is_whole_as_far_as_it_goes(feed: Path) -> None:
    data = feed.read_bytes()
    for length in range(len(data) - 400, len(data), 7):
        feed.write_bytes(data[:length])
        recorded = FeedFile(feed)
        assert len(recorded.entries) >= 85
        recorded.close()


def test_what_is_no_recording_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "x"
    for content, problem in (
        (b"", "is no recording"), (b"hello", "is no recording"), (b"\x80", "is no recording"),
        (msgpack.packb({"format": "pacinian feed", "version": 9}), "version 9"),
        (msgpack.packb({"format": "pacinian feed", "version": 1}), "is empty"),
    ):  # fmt: skip
        path.write_bytes(content or b"")
        with pytest.raises(pc.RecordingError, match=problem):
            FeedFile(path)
    for content, problem in (
        (b"hello", "is no recording of a viewer or of a renderer"),
        (msgpack.packb({"format": "pacinian recording", "version": 99}), "update Pacinian"),
        (msgpack.packb({"format": "pacinian recording", "version": 1})[:-1], "not a Pacinian rec"),
    ):
        path.write_bytes(content)
        with pytest.raises(pc.RecordingError, match=problem), open_view(path):
            pass
    for missing in (tmp_path / "y", tmp_path):
        with pytest.raises(pc.RecordingError, match="cannot be read"), open_view(missing):
            pass


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=200)
@given(st.data())
def test_damage_raises_or_is_left_out(feed: Path, data: st.DataObject) -> None:
    content = bytearray((feed.parent / "a.feed").read_bytes())
    for _ in range(data.draw(st.integers(1, 5))):
        content[data.draw(st.integers(40, len(content) - 1))] = data.draw(st.integers(0, 255))
    path = feed.parent / "b.feed"
    path.write_bytes(content)
    try:
        shown = Shown(path)
    except pc.RecordingError:
        return
    for time in (0.0, 4.0, 1.0, 8.9):
        shown.at(time)
    shown.recorded.close()


def test_a_recorder_writes_what_a_page_is_told_from_order_to_order(tmp_path: Path) -> None:
    hub = Hub()
    recorder = FeedRecorder(hub, tmp_path)
    view = hub.join(lambda: None)
    hub.put("state", state(1))
    hub.record(view.number, True)
    hub.record(view.number, True)  # already on: ignored
    hub.show(SceneMirror().with_("hall", {"ball": BALL}, {"ball": POSE}))
    hub.put("state", state(2))
    hub.refuse(0, "arm", "is not recorded")
    hub.record(view.number, False)
    hub.put("state", state(3))
    recorder.close()
    (file,) = tmp_path.iterdir()
    recorded = FeedFile(file)
    kinds = [entry.kind for entry in recorded.entries]
    assert "scenery" in kinds
    sequences = [
        msgpack.unpackb(recorded.data(e))["sequence"] for e in recorded.entries if e.kind == "state"
    ]
    assert sequences == [1, 2]
    assert "refused" not in kinds
    recorded.close()
    (on,) = [msgpack.unpackb(data) for kind, data in view.take() if kind == "record"]
    assert on == {"type": "record", "on": False, "file": str(file)}


def test_recordings_begun_in_the_same_second_are_two_files(tmp_path: Path) -> None:
    hub = Hub()
    recorder = FeedRecorder(hub, tmp_path)
    for on in (True, False, True, False):
        hub.record(0, on)
    recorder.close()
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no /dev/full here")
def test_a_full_disk_ends_a_recording_and_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hub = Hub()
    FeedRecorder(hub, tmp_path)
    view = hub.join(lambda: None)
    hub.record(0, True)
    (file,) = tmp_path.iterdir()
    recorder = hub.record.__self__  # type: ignore[attr-defined]
    recorder._writer._file.close()
    recorder._writer._file = open("/dev/full", "wb", buffering=0)  # noqa: SIM115
    hub.put("state", state(1))
    told = {kind: msgpack.unpackb(data) for kind, data in view.take()}
    assert not told["record"]["on"]
    assert told["refused"]["action"] == "record"
    hub.put("state", state(2))  # the feed continues without recording
    assert file.exists()


def test_a_folder_that_is_not_there_is_refused(tmp_path: Path) -> None:
    hub = Hub()
    FeedRecorder(hub, tmp_path / "none")
    view = hub.join(lambda: None)
    hub.record(view.number, True)
    told = {kind: msgpack.unpackb(data) for kind, data in view.take()}
    assert told["refused"]["action"] == "record"
    assert "record" not in told


def rendered(path: Path, seconds: float = 0.5) -> pc.Renderer:
    """Record a renderer: a moving plate, and a hand on it."""
    hand = pc.Hand.open("right", pc.Pose((0.0, 0.0, 0.16)))
    clock = ManualClock()

    def scene(t: float) -> pc.Scene:
        plate = pc.Surface(
            name="plate", shape=DISC, pose=pc.Pose((0.02 * t, 0.0, 0.15)), radiation_pressure=3.0
        )
        return pc.Scene((plate,), hands=(hand,))

    renderer = pc.Renderer(pc.autd(), scene, rate=100.0, clock=clock, recorder=Tape(path))
    with renderer:
        renderer.run(seconds)
    return renderer


DISC = pc.Disc(0.01)
OWN = pc.SDF(lambda q: np.sqrt((q * q).sum(axis=1)) - 0.01, (0.01, 0.01, 0.01))


def test_a_renderers_recording_is_replayed_with_scene_hands_and_field(tmp_path: Path) -> None:
    rendered(tmp_path / "r.pac")
    with open_view(tmp_path / "r.pac") as recorded:
        hub = Hub()
        player, view = FeedPlayer(hub, recorded), hub.join(lambda: None)
        assert 0.4 < recorded.duration < 0.5
        player.ask(0, Replay(time=recorded.duration, playing=False))
        player.show()
        told = {kind: msgpack.unpackb(data) for kind, data in view.take()}
        assert told["array"]["fields"]
        assert told["state"]["output"] == "sounding"
        assert len(told["state"]["hands"]) == 312
        assert told["scenery"]["objects"]["plate"]["shape"] == {"type": "disc", "radius": 0.01}
        x = np.frombuffer(told["scenery"]["poses"]["plate"], "<f4")[0]
        assert abs(x - 0.02 * recorded.duration) < 1e-3
        assert [e.kind for e in recorded.entries].count("scenery") == 1  # the shape is sent once
        assert hub.drive is not None
        assert len(hub.drive.gains) == 8 * 249
        assert not told["state"]["points"]


def test_a_page_that_joins_later_has_the_whole_past_of_the_charts(tmp_path: Path) -> None:
    rendered(tmp_path / "r.pac")
    with open_view(tmp_path / "r.pac") as recorded:
        hub = Hub()
        player = FeedPlayer(hub, recorded)

        def past() -> int:
            """Return the number of values that a page receives which joins now."""
            view = hub.join(lambda: None)
            if player.playing:
                player.show()
            told = {kind: msgpack.unpackb(data) for kind, data in view.take()}
            return len(told["history"]["times"]) // 8

        first = past()
        player.advance(0.3)
        middle = past()
        player.advance(1.0)
        player.show()
        assert not player.playing
        assert first < middle < past()


def test_a_renderers_recording_is_rendered_again_for_its_samples(tmp_path: Path) -> None:
    renderer = rendered(tmp_path / "r.pac", 0.49)
    with open_view(tmp_path / "r.pac", samples=True) as recorded:
        states = [msgpack.unpackb(recorded.data(e)) for e in recorded.entries if e.kind == "state"]
    wanted = renderer_status.make_status(renderer, 0.48)  # after the last tick
    assert states[-1]["ticks"] == wanted["ticks"] == 49
    for name in ("points", "normals", "asked", "achieved", "index", "error", "status", "hands"):
        assert states[-1][name] == wanted[name], name
    assert states[-1]["objects"] == list(wanted["objects"]) == ["plate"]
    assert [state["sequence"] for state in states if not state["points"]] == [
        1
    ]  # ramps start from nothing
    assert not any(state["faults"] for state in states)


def test_how_long_a_renderers_ticks_took_is_replayed(tmp_path: Path) -> None:
    frame = Frame(1, 0.0, np.zeros((1, 2), np.uint16), np.zeros((1, 2), np.uint16))
    past = TickStats(1e-3)
    assert past.tick_ms == (0.0, 0.0, 0.0)
    assert not any(past.histogram.counts)
    for k in range(1500):  # the first 500 are late, and older than a second
        took = 2e-3 if k < 500 else 0.5e-3 if k % 2 else 0.0
        past.add(Tick(replace(frame, time=1e-3 * k), clock=(1e-3 * k, 1e-3 * k + took)), None)
    past.add(Tick(frame), None)  # without recorded times
    assert (past.ticks, past.late, past.different) == (1501, 500, 0)
    assert past.tick_ms == pytest.approx((0.25, 0.5, 0.5))
    told = past.histogram
    (at,) = (k for k in range(64) if told.edges_ms[k] <= 0.5 < told.edges_ms[k + 1])
    assert (told.counts[0], told.counts[at], sum(told.counts)) == (500, 500, 1000)
    assert told.deadline_ms == 1.0


def test_frames_that_are_others_when_rendered_again_are_told(tmp_path: Path) -> None:
    rendered(tmp_path / "r.pac")
    with (tmp_path / "r.pac").open("rb") as file:
        maps = list(msgpack.Unpacker(file, strict_map_key=False))
    for tick in maps[1:]:
        if "phase" in tick:
            tick["phase"] = bytes(len(tick["phase"]))
    (tmp_path / "s.pac").write_bytes(b"".join(map(msgpack.packb, maps)))
    with open_view(tmp_path / "s.pac", samples=True) as recorded:
        (*_, last) = (e for e in recorded.entries if e.kind == "state")
        (fault,) = msgpack.unpackb(recorded.data(last))["faults"]
    assert fault.endswith("rendered again, differ from what was sent")


def test_what_lacks_its_scenes_cannot_be_rendered_again(tmp_path: Path) -> None:
    tape, at = Tape(tmp_path / "r.pac"), pc.Pose((0.0, 0.0, 0.15))
    item = pc.Volume(shape=OWN, pose=at, radiation_pressure=1.0)
    with pc.Renderer(pc.autd(), pc.Scene((item,)), clock=ManualClock(), recorder=tape) as made:
        made.tick()
    with open_view(tmp_path / "r.pac") as recorded:
        assert len(recorded.entries) > 2
    with (
        pytest.raises(pc.RecordingError, match="lacks the scene"),
        open_view(tmp_path / "r.pac", samples=True),
    ):
        pass


def test_a_file_that_cannot_be_read_any_more_does_not_end_the_player(feed: Path) -> None:
    shown = Shown(feed)
    shown.recorded.close()
    told = shown.at(3.0)
    assert told.keys() == {"replay", "poses"}


def test_a_player_waits_while_it_is_paused(feed: Path) -> None:
    async def settle() -> None:
        for _ in range(20):
            await asyncio.sleep(0)

    async def run() -> None:
        shown = Shown(feed)
        shown.player.playing = False
        playing = asyncio.create_task(shown.player.run())
        await settle()
        assert shown.player.time == 0.0
        shown.hub.ask(0, Replay(time=3.0))
        await settle()
        told = {kind: msgpack.unpackb(data) for kind, data in shown.view.take()}
        assert told["state"]["sequence"] == 30
        playing.cancel()
        await asyncio.gather(playing, return_exceptions=True)
        shown.recorded.close()

    asyncio.run(run())
