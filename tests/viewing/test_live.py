"""A real server and a real viewer, with websockets instead of pages."""

from __future__ import annotations

import math
import struct
import threading
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed

import pacinian as pc
from pacinian.viewing import server_connection

from .conftest import Game
from .watching import LIMIT, Page, viewer

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from pacinian.testing.server import Running

pytestmark = pytest.mark.usefixtures("patient")

ARRAY = pc.autd(1, 1)
PLANE = {
    "centre": [0.0, 0.0, 0.15], "u": [1.0, 0.0, 0.0], "v": [0.0, 0.0, 1.0], "size": [0.06, 0.04],
    "shape": [20, 30],
}  # fmt: skip


def test_a_page_is_told_of_everything_in_order(url: str, server: Running) -> None:
    with Page(url) as page, Game(server.connection) as game:
        first = page.hear(LIMIT)
        assert first is not None
        assert (first["type"], first["version"], first["recording"]) == ("hello", 2, "")
        page.until(lambda: page.newest.get("frame", {}).get("phase"))
        array = page.newest["array"]
        positions = np.frombuffer(array["positions"], "<f4").reshape(-1, 3)
        assert np.abs(positions - ARRAY.positions).max() < 1e-7
        assert array["fields"]
        assert "auto" in [solver["name"] for solver in array["solvers"]]
        page.until(lambda: {"ball", "plate"} <= page.objects.keys())
        assert page.objects["ball"]["shape"] == {"type": "sphere", "radius": 0.02}
        assert page.newest["scenery"]["scene"] == "room"
        page.until(lambda: page.output == "sounding")
        page.until(lambda: page.newest["state"]["objects"])
        state = page.newest["state"]
        assert (state["owner"], state["objects"]) == ("game", ["ball", "plate", "spark"])
        page.until(lambda: "histogram" in page.newest)
        histogram = page.newest["histogram"]
        assert len(histogram["edges_ms"]) == len(histogram["counts"]) + 1
        assert histogram["deadline_ms"] == 4.0
        assert 0 < sum(histogram["counts"]) <= 1000

        told = page.counts["scenery"]
        page.until(lambda: page.counts["state"] > 20)
        assert page.counts["scenery"] <= told + 2  # nothing moves, so nothing is sent again
        game.moves = True
        seen = set[float]()
        while len(seen) < 5:
            told_now = page.next("scenery")
            assert not told_now["objects"]  # shapes are sent once
            seen.add(struct.unpack("<7f", told_now["poses"]["plate"])[2])
        assert 0 < page.counts["histogram"] < page.counts["state"]


def gains(frame: dict[str, bytes]) -> pc.Gains:
    """Return the gains of a frame: phase / phases turns, amplitude / (amplitudes - 1)."""
    phase, amplitude = (np.frombuffer(frame[name], "<u2") for name in ("phase", "amplitude"))
    turn = phase / frame["phases"]  # type: ignore[operator]
    size = amplitude / (frame["amplitudes"] - 1)  # type: ignore[operator]
    return np.asarray(size * np.exp(2j * np.pi * turn), dtype=np.complex64)


def mean_pressure(page: Page, at: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the radiation pressure at points (..., 3) [Pa], the mean over the frames that the page has received."""
    cycle = {(frame["phase"], frame["amplitude"]): frame for frame in page.frames}
    fields = [
        pc.field(ARRAY, gains(frame), at, precision="double", medium=pc.Air())
        for frame in cycle.values()
    ]
    return np.mean([pc.radiation_pressure(p, pc.Air()) for p in fields], axis=0)


def levels(page: Page) -> set[tuple[bytes, bytes]]:
    """Return the phases and amplitudes of the last frames, each once."""
    return {(frame["phase"], frame["amplitude"]) for frame in page.frames}


def cycles(page: Page) -> bool:
    """Return whether the last frames sound, and are at most three different ones."""
    found = levels(page)
    return len(page.frames) == page.frames.maxlen and len(found) < 4 and all(map(all, found))


def _apart(found: dict[str, Any], page: Page, at: NDArray[np.float64]) -> float:
    """Return the largest error of `found` against the page's frames at points (..., 3), over the largest pressure."""
    wanted = mean_pressure(page, at)
    pressure = np.frombuffer(found["pressure"], "<f4").reshape(wanted.shape)
    most = float(wanted.max())
    return float(np.abs(pressure - wanted).max()) / most if most > 0.1 else math.inf


def test_a_slice_and_a_volume_are_the_field(url: str, server: Running) -> None:
    i, j = np.mgrid[0:20, 0:30]
    x, z = ((j + 0.5) / 30 - 0.5) * 0.06, 0.15 + ((i + 0.5) / 20 - 0.5) * 0.04
    plane = np.stack([x, np.zeros_like(x), z], axis=-1)
    box = np.moveaxis(np.indices((5, 6, 7)), 0, -1) * 0.004 + np.array([-0.01, -0.01, 0.14])

    seen: list[Any] = []

    def same() -> bool:
        """Return whether slice and volume fit the frames. At first they do not: sound fades in; fields come later."""
        new = page.newest
        if not (cycles(page) and new.get("slice") and new.get("volume")):
            return False
        # not only the newest frame: earlier ones, of the fade, count until ten others have come
        now = [new["slice"]["time"], new["volume"]["time"], levels(page)]
        if seen == now:
            return False
        seen[:] = now
        return _apart(new["slice"], page, plane) < 1e-3 and _apart(new["volume"], page, box) < 1e-3

    with Page(url) as page, Game(server.connection):
        page.until(lambda: page.newest.get("frame", {}).get("phase"))
        page.say("slice", id=1, **PLANE)
        page.say("volume", id=2, origin=[-0.01, -0.01, 0.14], spacing=0.004, shape=[5, 6, 7])
        page.until(same)
        assert {k: page.newest["slice"][k] for k in PLANE} == PLANE


@pytest.mark.parametrize("missed", [40, pytest.param(200, marks=pytest.mark.deep)])
def test_a_page_that_does_not_read_for_a_while_sees_the_present(
    url: str, server: Running, missed: int
) -> None:
    """The websocket's client buffers 16 messages, and 200 are more than all buffers on the way hold."""
    with Page(url) as page, Page(url) as other, Game(server.connection):
        page.next("state")
        other.next("state")
        other.until(lambda: other.counts["state"] > missed)
        present = other.newest["state"]["time"]
        heard = page.counts["state"]
        page.until(lambda: page.newest["state"]["time"] >= present)
        assert page.counts["state"] <= heard + 2


def test_a_slice_of_the_error_is_the_field_less_what_is_asked(url: str, server: Running) -> None:
    i, j = np.mgrid[0:40, 0:40]
    x, y = (0.03 + ((k + 0.5) / 40 - 0.5) * 0.04 for k in (j, i))
    plane = np.stack([x, y, np.full_like(x, 0.15)], axis=-1)
    away = np.hypot(x - 0.03, y - 0.03)

    def same() -> bool:
        """Compare on the plate, whose radius is 10 mm. Just beside it, and from 5.5 mm on, the error is NaN."""
        new = page.newest
        if not cycles(page) or "slice" not in new:
            return False
        found = np.frombuffer(new["slice"]["pressure"], "<f4").reshape(40, 40)
        on = away < 0.009
        off = ((away > 0.0105) & (away < 0.0115)) | (away > 0.0155)
        if not np.isfinite(found[on]).all() or np.isfinite(found[off]).any():
            return False  # an earlier scene still fades out
        wanted = mean_pressure(page, plane[on]) - 5.0
        return float(np.abs(found[on] - wanted).max()) < 0.01

    with Page(url) as page, Game(server.connection, names=("plate",)):
        page.say(
            "slice", id=1, of="error", centre=[0.03, 0.03, 0.15], u=[1.0, 0.0, 0.0], v=[0.0, 1.0, 0.0],
            size=[0.04, 0.04], shape=[40, 40],
        )  # fmt: skip
        page.until(same)
        assert page.newest["slice"]["of"] == "error"


def test_when_a_game_goes_its_objects_its_sound_and_its_field_go(url: str, server: Running) -> None:
    def pressure() -> bytes:
        found: bytes = page.newest.get("slice", {"pressure": b"?"})["pressure"]
        return found.strip(b"\0")

    with Page(url) as page:
        page.say("slice", id=1, **PLANE)
        page.until(lambda: not pressure())
        with Game(server.connection):
            page.until(lambda: pressure() and "ball" in page.objects)
        page.until(lambda: not page.objects)
        page.until(lambda: page.output == "silent" and not page.newest["frame"]["phase"])
        page.until(lambda: not pressure())
        assert page.newest["slice"]["id"] == 1


def test_the_mean_of_a_modulation_is_shown_its_peak_and_an_instant(
    url: str, server: Running
) -> None:
    """For one point with amplitude modulation, mean and peak are always 1/2 and 1 of the target."""
    point = pc.Point(
        name="hum", position=(0.0, 0.0, 0.15), radiation_pressure=8.0, technique=pc.AM(frequency=120.0)
    )  # fmt: skip
    place = {**PLANE, "size": [0.002, 0.002], "shape": [2, 2]}

    def at_point() -> float:
        return float(np.frombuffer(page.newest["slice"]["pressure"], "<f4").mean())

    def holds(over: str, low: float, high: float) -> None:
        page.say("slice", id=1, over=over, **place)
        page.until(lambda: page.newest.get("slice", {}).get("over") == over)
        seen: list[float] = []
        while len(seen) < 8:
            page.next("slice")
            seen = [*seen, at_point()] if low < at_point() < high else []

    def hum() -> None:
        with pc.Client(server.connection, name="hummer") as client:
            client.put(point)
            client.arm(take=True)
            while not ended.is_set():
                client.hold(0.02)

    ended, game = threading.Event(), threading.Thread(target=hum)
    with Page(url) as page:
        game.start()
        try:
            holds("mean", 3.9, 4.1)
            holds("peak", 6.5, 8.2)
            page.say("slice", id=1, over="instant", **place)
            instants = set[float]()
            while not instants or max(instants) - min(instants) < 4.0:
                if page.next("slice")["over"] == "instant":
                    instants.add(at_point())
        finally:
            ended.set()
            game.join(LIMIT)


@pytest.mark.parametrize(("envelope", "mean"), [(pc.Constant(), 5.0), (pc.Sine(150.0), 2.5)])
def test_what_is_felt_is_told_beside_what_is_asked(
    url: str, server: Running, envelope: pc.Constant | pc.Sine, mean: float
) -> None:
    def told() -> bool:
        found = page.newest.get("skin")
        if not found or (isinstance(envelope, pc.Constant) and not cycles(page)):
            return False
        felt, asked = (np.frombuffer(found[name], "<f4") for name in ("felt", "asked"))
        inside = (asked > 0.8 * mean) & (asked < 1.02 * mean)
        return inside.any() and bool(np.abs(felt[inside].mean() / asked[inside].mean() - 1.0) < 0.1)

    with Page(url) as page, Game(server.connection, names=("plate",), envelope=envelope):
        page.say(
            "skin", id=1, centre=[0.03, 0.03, 0.17], u=[1.0, 0.0, 0.0], v=[0.0, 1.0, 0.0],
            size=[0.04, 0.04], shape=[40, 40],
        )  # fmt: skip
        page.until(told)
        page.say("hide", what="skin")


def _demonstrated(page: Page) -> bool:
    """Keep the demonstration alive. Return whether it can be felt."""
    page.say("alive")
    state = page.newest.get("state", {})
    return (state.get("owner"), state.get("output")) == ("demonstration", "sounding")


def test_a_demonstration_plays_for_a_page_and_takes_nothing_from_others(
    url: str, server: Running
) -> None:
    with Page(url) as other:
        with Page(url) as page:
            page.say("demonstrate", on=True)
            page.until(lambda: _demonstrated(page))
            page.until(lambda: "ball" in page.objects and len(page.newest["state"]["hands"]) > 0)
            page.say("demonstrate", on=False)
            page.until(lambda: page.newest["state"]["owner"] == "")
            page.say("demonstrate", on=True)
            page.until(lambda: _demonstrated(page))
        other.until(lambda: other.newest.get("state", {}).get("owner") == "")  # its page is closed
        with Game(server.connection):
            other.say("demonstrate", on=True)
            refused = other.next("refused")
            assert (refused["action"], "owns the output" in refused["message"]) == (
                "demonstrate",
                True,
            )
            assert other.next("state")["owner"] == "game"


def test_a_page_that_takes_over_or_stops_ends_the_demonstration_without_a_refusal(url: str) -> None:
    with Page(url) as page:
        for end, after in (("arm", "disarm"), ("stop", "reset")):
            page.say("demonstrate", on=True)
            page.until(lambda: _demonstrated(page))
            page.say(end, **({"scene": "", "take": True} if end == "arm" else {}))
            page.until(
                lambda: (
                    "demonstration"
                    not in [client["name"] for client in page.newest["state"]["clients"]]
                )
            )
            page.until(lambda: page.output in ("silent", "stopped"))
            page.say(after)
            page.until(lambda: (page.output, page.newest["state"]["owner"]) == ("silent", ""))
        page.catch_up()
        assert not page.refusals


def test_a_solver_is_selected_by_the_rules_of_the_server(url: str, server: Running) -> None:
    with Page(url) as page, Page(url) as other:
        page.until(lambda: "state" in page.newest)
        page.say("select", solver={"name": "gs-pat", "options": {"steps": 30}}, intensity=0.5)
        page.say("select", technique={"type": "am", "frequency": 150.0})
        page.until(lambda: page.newest["state"]["solver"] == "gs-pat")
        page.until(lambda: page.newest["state"]["technique"] == "am")
        assert page.newest["state"]["intensity"] == 0.5
        page.say("select", solver={"name": "nonesuch"})
        assert "nonesuch" in page.next("refused")["message"]
        other.catch_up()
        assert not other.refusals  # it requested nothing
        page.say(
            "select", solver={"name": "auto"}, intensity=1.0, technique={"type": "simultaneous"}
        )
        page.until(lambda: page.newest["state"]["solver"] == "auto")
        with Game(server.connection):
            page.say("select", solver={"name": "gs"})
            page.until(
                lambda: page.newest["refused"]["message"] == "another client owns the output"
            )
            assert page.newest["refused"]["action"] == "select"


def test_a_device_with_other_levels_is_told_anew(url: str, server: Running) -> None:
    with Page(url) as page:
        before = page.next("array")
        page.say("select", backend={"name": "simulated", "options": {"phases": 16}})
        page.until(lambda: page.newest["array"]["phases"] == 16)
        page.say("select", backend={"name": "simulated"})
        page.until(lambda: page.newest["array"] == before)


def test_another_clients_scene_is_armed_by_its_name(url: str, server: Running) -> None:
    with Page(url) as page, Game(server.connection, scene="hall") as game:
        page.say("arm", scene="hall")
        assert "owns the output" in page.next("refused")["message"]
        page.say("arm", scene="hall", take=True)
        page.until(lambda: page.newest.get("session", {}).get("mine"))
        assert page.newest["session"]["scene"] == "hall"

        def sounds() -> bool:
            page.say("alive")
            state = page.newest.get("state", {})
            return (state.get("owner"), state.get("output")) == ("viewer", "sounding")

        page.until(sounds)
        page.until(lambda: "owner" in game.refused)
        page.say("disarm")
        page.until(lambda: not page.newest["session"]["armed"])
        page.say("arm", scene="own secret")
        refused = page.next("refused")
        assert (refused["action"], "own" in refused["message"]) == ("arm", True)
        page.until(lambda: page.newest["session"]["scene"] == "")


def test_there_is_silence_when_a_page_that_sounds_goes(url: str, server: Running) -> None:
    with Page(url) as other, Game(server.connection):
        # earlier states are from before the game
        other.until(lambda: other.newest.get("state", {}).get("owner") == "game")
        with Page(url) as page:

            def sounds() -> bool:
                page.say("alive")
                state = other.newest.get("state", {})
                return (state.get("owner"), state.get("output")) == ("viewer", "sounding")

            page.say("arm", scene="room", take=True)
            other.until(sounds)
        other.until(lambda: other.output == "silent")
        assert other.newest["state"]["owner"] == ""  # it disarmed; its lease did not run out


def test_there_is_silence_when_a_page_that_armed_says_nothing_any_more(
    server: Running, monkeypatch: pytest.MonkeyPatch
) -> None:
    short = partial(pc.Client, lease=0.2)
    monkeypatch.setattr(server_connection, "Client", short)
    with viewer(server.connection) as url, Page(url) as page:
        page.say("arm")
        assert page.next("refused")["message"] == "the lease was not renewed in time: silence"
        page.until(lambda: page.output == "silent" and not page.newest["state"]["armed"])
        page.until(lambda: not page.newest["state"]["owner"])  # others need not take it over


def test_a_game_that_takes_the_output_back_is_not_disturbed_by_a_page_that_is_alive(
    url: str, server: Running
) -> None:
    with Page(url) as page:
        page.say("arm")
        page.until(lambda: page.newest.get("session", {}).get("mine"))
        with Game(server.connection) as game:  # it takes the output, and sounds
            page.until(lambda: page.refusals)
            # the state may arrive later
            page.until(lambda: page.newest.get("state", {}).get("owner") == "game")
            for _ in range(10):
                page.say("alive")
                assert page.next("state")["owner"] == "game"
            page.catch_up()
            refused = [(told["action"], told["message"]) for told in page.refusals]
            assert refused == [("arm", "game has taken the output")]
            assert not page.newest["session"]["armed"]
            assert not game.refused


def test_a_stop_of_any_page_always_works(url: str, server: Running) -> None:
    with Page(url) as page, Game(server.connection) as game:
        page.until(lambda: page.output == "sounding")
        page.say("stop")
        page.until(lambda: page.output == "stopped")
        page.say("arm")
        assert page.next("refused")["action"] == "arm"
        page.say("reset")
        page.until(lambda: page.output == "silent")
        page.until(lambda: "stopped" in game.refused)


def test_two_viewers_and_many_pages(url: str, server: Running) -> None:
    def sees(page: Page) -> None:
        page.until(lambda: page.counts["state"] > 10 and "ball" in page.objects)

    with viewer(server.connection) as second, Game(server.connection):
        pages = [Page(address) for address in (url, second) for _ in range(8)]
        try:
            with ThreadPoolExecutor(len(pages)) as readers:  # all read at the same time
                list(readers.map(sees, pages))
            last = pages[-1]
            last.until(
                lambda: [c["name"] for c in last.newest["state"]["clients"]].count("viewer") == 2
            )
        finally:
            for page in pages:
                page.close()


def test_what_cannot_be_meant_is_refused_and_nothing_else_happens(url: str) -> None:
    with Page(url) as page, Page(url) as other:
        for data in (b"", b"\xc1", "text", bytes(60_000)):
            page.socket.send(data)
            assert page.next("refused")["action"] == "message"
        page.say("slice", id=1, **{**PLANE, "shape": [1024, 1024]})
        assert page.next("refused")["action"] == "message"
        other.catch_up()
        assert not other.refusals


def test_a_message_that_is_too_long_ends_the_connection_of_that_page_alone(url: str) -> None:
    with Page(url) as page, Page(url) as other:
        page.socket.send(bytes(1 << 17))
        with pytest.raises(ConnectionClosed):  # the reason is lost if bytes were not read
            page.until(lambda: False)
        other.next("state")


def test_a_recording_is_the_feed(url: str, server: Running, folder: Path) -> None:
    with Page(url) as page:
        page.say("record", on=True)
        file = page.next("record")
        assert file["on"]
        with Game(server.connection) as game:
            game.moves = True
            page.until(lambda: page.output == "sounding")
            page.until(lambda: "ball" in page.objects)
            begin = page.newest["state"]["time"]
            page.until(lambda: page.newest["state"]["time"] > begin + 0.3)
        page.say("record", on=False)
        assert page.next("record") == {"type": "record", "on": False, "file": file["file"]}
        (found,) = folder.glob("*.feed")
        assert str(found) == file["file"]
        live = page.newest["array"]
    with viewer(recording=found) as replayed, Page(replayed) as again:
        assert again.next("hello")["recording"] == found.name
        duration = again.next("replay")["duration"]
        for time in np.linspace(0.0, duration, 100):
            again.say("replay", time=float(time), playing=False)
            again.until(lambda time=time: again.newest["replay"]["time"] == time)
            sounds = again.newest.get("frame", {}).get("amplitude", b"").strip(b"\0")
            if again.output == "sounding" and "ball" in again.objects and sounds:
                break  # wait, because a frame may be older than the state
        assert again.output == "sounding"
        assert again.newest["array"] == live
        found_at = again.newest["replay"]["time"]
        again.say("replay", time=duration, playing=False)  # the history is of all that was before
        again.until(lambda: again.newest["replay"]["time"] == duration)
        again.until(lambda: len(again.newest["history"]["times"]) > 8)
        past = again.newest["history"]
        count = len(past["times"]) // 8
        assert len(past["error"]) == len(past["drive_max"]) == 4 * count
        assert np.nanmax(np.frombuffer(past["drive_max"], "<f4")) > 0.0
        again.say("replay", time=found_at, playing=False)
        again.until(lambda: again.newest["replay"]["time"] == found_at)
        again.say("slice", id=1, **PLANE)
        again.until(lambda: again.newest.get("slice", {}).get("pressure", b"").strip(b"\0"))
        again.say("replay", playing=True)
        again.until(lambda: again.newest["replay"]["time"] == duration)
        assert not again.newest["replay"]["playing"]
        again.say("stop")
        assert again.next("refused")["action"] == "stop"
        again.say("record", on=True)
        assert again.next("refused")["action"] == "record"
