"""The viewer and a server of one thread that says what it is told to: older ones, broken ones, slow ones."""

from __future__ import annotations

import importlib.util
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import pytest

from pacinian.viewing import bridge
from pacinian.wire import commands, control, replies
from pacinian.wire.bulk import pack

from .watching import Page, viewer

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType

EMPTY: dict[str, Any] = {"scene": "", "version": 0, "names": (), "poses": b"", "objects": {}}
THERE = {**EMPTY, "scene": "hall", "names": ("ball",), "poses": bytes(28)}
FAKE = Path(__file__).parents[1] / "core" / "client" / "fake.py"


@pytest.fixture(scope="module")
def fakes() -> ModuleType:
    spec = importlib.util.spec_from_file_location("fake_server", FAKE)
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = made
    spec.loader.exec_module(made)
    return made


@pytest.fixture
def fake(fakes: ModuleType) -> Iterator[Any]:
    with fakes.Fake() as server:
        server.stream = fakes.state
        server.answers[commands.Show] = lambda m: replies.Shown(id=m.id, **EMPTY)
        yield server


@pytest.fixture
def connection(fake: Any, tmp_path: Path) -> Path:
    return Path(fake.connection.write(tmp_path / "connection.json"))


def test_an_older_server_has_neither_objects_nor_fields(fake: Any, connection: Path) -> None:
    problem = "Invalid value 'show'"
    fake.answers[commands.Show] = lambda m: replies.Error(
        id=m.id, code="malformed", message=problem
    )
    with viewer(connection) as url, Page(url) as page:
        page.until(lambda: page.counts["state"] > 10)
        assert page.newest["array"]["fields"] is False
        assert not page.counts["lost"]
        assert not page.counts["histogram"]
    assert len(fake.of(commands.Show)) == 1


def test_a_server_that_is_busy_is_asked_again(fake: Any, connection: Path) -> None:
    told = iter([replies.Error(id=0, code="busy", message="slow down")] * 3)

    def answer(message: Any) -> Any:
        error = next(told, None)
        if error is None:
            return replies.Shown(id=message.id, **{**EMPTY, "scene": "hall"})
        return msgspec.structs.replace(error, id=message.id)

    fake.answers[commands.Show] = answer
    with viewer(connection) as url, Page(url) as page:
        page.until(lambda: page.newest.get("scenery", {}).get("scene") == "hall")
        assert not page.counts["lost"]


def test_a_server_that_is_dead_under_an_open_page_is_lost_and_stop_says_so(
    fake: Any, connection: Path
) -> None:
    with viewer(connection) as url, Page(url) as page:
        page.next("state")
        fake.deaf = True  # nothing is published, nothing answered
        page.next("lost")
        page.say("stop")
        assert page.next("refused")["advice"] == "switch the array off"
        fake.deaf = False
        page.next("array")


def test_a_stop_does_not_wait_for_what_else_goes_on(fake: Any, connection: Path) -> None:
    fake.answers[control.Arm] = lambda _: None  # never answered: the bridge waits for it
    with viewer(connection) as url, Page(url) as page:
        page.next("state")
        page.say("arm")
        fake.until(lambda: bool(fake.of(control.Arm)))
        page.say("stop")
        page.until(lambda: page.counts["lost"] or fake.of(control.Stop))
        assert not page.counts["lost"]


def test_no_lease_goes_on_for_an_alive_that_is_old(fake: Any, connection: Path) -> None:
    def slowly(message: Any) -> Any:
        time.sleep(0.1)  # a server that is busy
        return replies.Shown(id=message.id, **THERE)

    with viewer(connection) as url, Page(url) as page:
        page.next("state")
        page.say("arm")
        page.until(lambda: page.newest.get("session", {}).get("mine"))
        before = len(fake.of(control.Renew))

        def renewed() -> bool:
            page.say("alive")
            return len(fake.of(control.Renew)) > before

        fake.until(renewed)
        fake.answers[commands.Show] = slowly
        shown = len(fake.of(commands.Show))
        fake.until(lambda: len(fake.of(commands.Show)) > shown + 1)
        for _ in range(60):
            page.say("alive")
        said, shown = time.perf_counter(), len(fake.of(commands.Show))
        fake.until(lambda: len(fake.of(commands.Show)) > shown + 10)
        assert fake.of(control.Renew)[-1].time < said + page.newest["session"]["lease"]


def test_a_page_that_goes_while_it_arms_does_not_arm(fake: Any, connection: Path) -> None:
    gone = threading.Event()

    def slowly(message: Any) -> Any:
        gone.wait(10.0)
        return replies.Ok(id=message.id)

    fake.answers[control.Arm] = slowly
    with viewer(connection) as url, Page(url) as other:
        with Page(url) as page:
            page.next("state")
            page.say("arm")
            fake.until(lambda: bool(fake.of(control.Arm)))
        page.close()
        gone.set()
        fake.until(lambda: bool(fake.of(control.Disarm)))
        other.until(lambda: not other.newest.get("session", {"armed": True})["armed"])


def test_only_the_page_that_asked_is_told_that_it_is_refused(fake: Any, connection: Path) -> None:
    fake.answers[control.Select] = lambda _: None
    with viewer(connection) as url, Page(url) as one, Page(url) as other:
        for page, name in ((one, "first"), (other, "second")):
            page.next("state")
            page.say("select", solver={"name": name})
            fake.until(lambda name=name: name in [m.solver.name for m in fake.of(control.Select)])
        first, second = fake.of(control.Select)
        fake.say(replies.Error(id=second.id, code="fault", message="second"))
        fake.say(replies.Error(id=first.id, code="fault", message="first"))
        for page, message in ((one, "first"), (other, "second")):
            refused = page.next("refused")
            assert (refused["action"], refused["message"]) == ("select", message)
            page.next("state")
            assert page.counts["refused"] == 1


def test_the_page_that_armed_is_told_at_once_why_that_has_ended(
    fake: Any, connection: Path
) -> None:
    with viewer(connection) as url, Page(url) as one, Page(url) as other:
        one.next("state")
        other.say("arm")
        other.until(lambda: other.newest.get("session", {}).get("mine"))
        (armed,) = fake.of(control.Arm)
        fake.until(
            lambda: any(isinstance(m, control.Renew) for m in fake.seen[fake.seen.index(armed) :])
        )
        fake.say(replies.Error(id=0, code="owner", message="game has taken the output"))
        assert other.next("refused")["message"] == "game has taken the output"
        assert other.newest["refused"]["action"] == "arm"
        one.listen(0.2)
        assert one.counts["state"]
        assert not one.counts["refused"]


def test_what_is_asked_while_there_is_no_server_is_refused(tmp_path: Path) -> None:
    with viewer(tmp_path / "none") as url, Page(url) as page, Page(url) as other:
        page.next("lost")
        page.say("arm")
        assert page.next("refused")["action"] == "arm"
        assert "no connection file" in page.newest["refused"]["message"]
        page.say("reset")
        page.until(lambda: page.newest["refused"]["action"] == "reset")
        other.next("lost")
        other.listen(0.2)
        assert not other.counts["refused"]


def test_a_stop_that_fails_in_an_odd_way_is_told(
    connection: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError("too many open files")

    monkeypatch.setattr(bridge, "emergency_stop", fail)
    with viewer(connection) as url, Page(url) as page:
        page.say("stop")
        refused = page.next("refused")
        assert (refused["action"], refused["message"]) == ("stop", "too many open files")


def test_a_state_that_is_not_whole_is_passed_over(fake: Any, fakes: Any, connection: Path) -> None:
    fake.stream = lambda: fakes.state(tick_counts=b"abc")
    with viewer(connection) as url, Page(url) as page:
        page.until(lambda: page.counts["state"] > 10)
        assert not page.counts["histogram"]
        fake.stream = lambda: fakes.state(tick_counts=bytes(256))
        page.next("histogram")
        assert not page.counts["lost"]


def test_an_answer_that_cannot_be_is_a_loss_until_it_can(fake: Any, connection: Path) -> None:
    fake.answers[control.Capabilities] = lambda m: abilities(m, positions=bytes(7))
    with viewer(connection) as url, Page(url) as page:
        page.next("lost")
        fake.answers[control.Capabilities] = abilities
        page.next("array")
        page.next("state")


def test_plugins_that_are_listed_late_are_told(fake: Any, connection: Path) -> None:
    solvers = iter([(), (), (replies.Plugin(name="gs"),)])
    fake.answers[control.Capabilities] = lambda m: abilities(
        m, solvers=next(solvers), backends=(replies.Plugin(name="simulated"),)
    )
    with viewer(connection) as url, Page(url) as page:
        page.until(lambda: page.newest.get("array", {}).get("solvers"))
        assert page.counts["array"] == 2  # what is not new is not told again
        page.next("state")
        assert len(fake.of(control.Capabilities)) == 3


def test_who_comes_later_is_not_told_what_was(fake: Any, fakes: Any, connection: Path) -> None:
    fake.answers[control.Renew] = lambda m: msgspec.structs.replace(fakes.usual(m), armed=False)
    with viewer(connection) as url:
        with Page(url) as page:
            page.next("state")
        renewed = len(fake.of(control.Renew))
        # in the first of these rounds the page may not yet have gone; in the next nobody looks
        fake.until(lambda: len(fake.of(control.Renew)) > renewed + 1)
        fake.stream = None
        with Page(url) as page:
            page.next("session")
            page.listen(0.1)
            assert page.counts["array"]
            assert not page.counts["state"]


def abilities(message: Any, **fields: Any) -> replies.Abilities:
    sound = replies.Sound(
        pressure=1.0, directivity="omni", speed_of_sound=343.0, density=1.2, power=1.0,
        absorption=0.0,
    )  # fmt: skip
    given: dict[str, Any] = {
        "solvers": (), "backends": (), "techniques": (), "presets": (), "limits": {}, "rate": 1e3,
        "positions": pack([0.0, 0.0, 0.0]), "normals": pack([0.0, 0.0, 1.0]), "frequency": 40e3,
        "wavelength": 0.0085, "phases": 320, "amplitudes": 320, "device_rate": 1e3,
    }  # fmt: skip
    return replies.Abilities(id=message.id, sound=sound, **{**given, **fields})


def test_nobody_is_asked_for_anything_while_no_page_is_open(fake: Any, connection: Path) -> None:
    with viewer(connection) as url:
        fake.until(lambda: len(fake.of(control.Renew)) >= 1)
        assert not fake.of(commands.Show)
        with Page(url) as page:
            page.next("state")
            fake.until(lambda: bool(fake.of(commands.Show)))


def test_too_much_at_once_is_refused_and_alive_never_is(fake: Any, connection: Path) -> None:
    fake.answers[control.Reset] = lambda _: None
    with viewer(connection) as url, Page(url) as page:
        page.next("state")
        for _ in range(200):
            page.say("reset")
        for _ in range(200):
            page.say("alive")
        refused = page.next("refused")
        assert (refused["action"], refused["message"]) == ("reset", "too much is asked at once")
        page.listen(0.2)
        assert page.newest["refused"]["action"] == "reset"
