"""The viewer with a fake server: an older one, a broken one, a slow one."""

from __future__ import annotations

import itertools
import socket
import threading
import time
from contextlib import contextmanager
from functools import partial
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.client.emergency_stop import emergency_stop
from pacinian.testing import ManualClock
from pacinian.viewing import server_connection, states
from pacinian.viewing.hub import Hub
from pacinian.wire import commands, control, replies
from pacinian.wire.binary_arrays import pack
from pacinian.wire.state import ClientState

from ..core.client import fake_server
from ..core.client.fake_server import Fake, state, usual
from .watching import LIMIT, Page, viewer

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

pytestmark = pytest.mark.usefixtures("patient")

CLIENT = ClientState(
    name="game", scene="hall", owner=True, objects=0, commands=0, errors=0, dropped=0, age=0.0, renewed=0.0
)  # fmt: skip
EMPTY: dict[str, Any] = {"scene": "", "version": 0, "names": (), "poses": b"", "objects": {}}


def make_shown(message: Any, **fields: Any) -> replies.Shown:
    return replies.Shown(id=message.id, **{**EMPTY, **fields})


@contextmanager
def publishing() -> Iterator[Fake]:
    """Run a fake server that publishes states, has an empty scene, and reports whether it is armed."""

    def renewed(message: Any) -> replies.Renewed:
        orders = [m for m in server.seen if isinstance(m, control.Arm | control.Disarm)]
        armed = bool(orders) and isinstance(orders[-1], control.Arm)
        return replace(usual(message), armed=armed)

    with Fake() as server:
        server.answers[control.Renew] = renewed
        server.stream = state
        server.answers[commands.Show] = make_shown
        yield server


@pytest.fixture
def fake() -> Iterator[Fake]:
    with publishing() as server:
        yield server


@pytest.fixture
def connection(fake: Fake, tmp_path: Path) -> Path:
    return fake.connection.write(tmp_path / "connection.json")


@pytest.fixture
def url(connection: Path) -> Iterator[str]:
    with viewer(connection) as address:
        yield address


def armed(page: Page) -> None:
    page.say("arm")
    page.until(lambda: page.newest.get("session", {}).get("mine"))


def renewed(fake: Fake) -> bool:
    """Return whether the viewer has renewed since it armed."""
    (begin,) = fake.of(control.Arm)
    return any(isinstance(m, control.Renew) for m in fake.seen[fake.seen.index(begin) :])


def test_an_older_server_has_neither_objects_nor_fields(fake: Fake, url: str) -> None:
    problem = "Invalid value 'show'"
    fake.answers[commands.Show] = lambda m: replies.Error(
        id=m.id, code="malformed", message=problem
    )
    with Page(url) as page:
        page.until(lambda: page.counts["state"] > 10)
        assert page.newest["array"]["fields"] is False
        assert not page.counts["lost"]
        assert not page.counts["histogram"]
    assert len(fake.of(commands.Show)) == 1


def test_silence_is_explained_as_everywhere_else(fake: Fake, url: str) -> None:
    def read_reason(page: Page) -> tuple[Any, Any]:
        told = page.newest.get("silence", {})
        return told.get("cause"), told.get("text")

    with Page(url) as page:
        fake.stream = lambda: state(cause="not armed", why="call arm()")
        page.until(lambda: read_reason(page) == ("not armed", "call arm()"))
        fake.stream = lambda: state(output="sounding", armed=True, owner="game", scene="hall")
        page.until(lambda: read_reason(page) == ("", ""))


def test_a_server_that_is_busy_is_asked_again(fake: Fake, url: str) -> None:
    asked = itertools.count()

    def answer(message: Any) -> Any:
        if next(asked) < 3:
            return replies.Error(id=message.id, code="busy", message="slow down")
        return make_shown(message, scene="hall")

    fake.answers[commands.Show] = answer
    with Page(url) as page:
        page.until(lambda: page.newest.get("scenery", {}).get("scene") == "hall")
        assert not page.counts["lost"]


def test_a_server_that_goes_is_lost_and_another_one_is_found(tmp_path: Path) -> None:
    connection = tmp_path / "connection.json"
    with viewer(connection) as url, Page(url) as page:
        assert "no connection file" in page.next("lost")["reason"]
        page.say("stop")
        refused = page.next("refused")
        assert (refused["action"], refused["advice"]) == ("stop", "switch the array off")
        for _ in range(2):
            with publishing() as server:
                server.connection.write(connection)
                page.next("array")
                page.next("state")
                page.until(lambda: "session" in page.newest)
                assert page.newest["session"]["armed"] is False
            page.next("lost")


def test_a_server_that_is_dead_under_an_open_page_is_lost_and_stop_says_so(
    fake: Fake, connection: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server_connection, "Client", partial(pc.Client, timeout=1.0))
    monkeypatch.setattr(server_connection, "emergency_stop", partial(emergency_stop, timeout=0.1))
    with viewer(connection) as url, Page(url) as page:
        page.next("state")
        fake.deaf = True
        page.next("lost")
        page.say("stop")
        assert page.next("refused")["advice"] == "switch the array off"
        fake.deaf = False
        page.next("array")


def test_a_server_that_publishes_nothing_any_more_is_lost(
    fake: Fake, url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    with Page(url) as page:
        page.next("state")
        monkeypatch.setattr(states, "MAX_STATE_AGE", 0.1)
        fake.stream = None
        assert "has published no state" in page.next("lost")["reason"]
        monkeypatch.setattr(states, "MAX_STATE_AGE", LIMIT)
        fake.stream = state
        page.next("array")
        page.next("state")


def test_a_stop_does_not_wait_for_what_else_goes_on(fake: Fake, url: str) -> None:
    fake.answers[control.Arm] = lambda _: None  # never answered
    with Page(url) as page:
        page.next("state")
        page.say("arm")
        fake.until(lambda: bool(fake.of(control.Arm)))
        page.say("stop")
        fake.until(lambda: bool(fake.of(control.Stop)))
        (waiting,) = fake.of(control.Arm)
        fake.say(replies.Ok(id=waiting.id))


def test_a_fresh_alive_of_the_page_that_armed_renews_the_lease_and_no_other(
    fake: Fake, url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = partial(make_shown, scene="hall", names=("ball",), poses=bytes(28))
    held, free = threading.Event(), threading.Event()

    def held_up(message: Any) -> Any:
        held.set()
        assert free.wait(LIMIT)
        return there(message)

    def renewals() -> int:
        return len(fake.of(control.Renew))

    with Page(url) as page, Page(url) as other:
        fake.answers[commands.Show] = there  # the viewer requests poses in each round
        page.until(lambda: page.newest.get("scenery", {}).get("scene") == "hall")
        armed(page)
        fake.until(lambda: renewed(fake))
        clock = ManualClock(time.perf_counter())
        monkeypatch.setattr(server_connection, "time", SimpleNamespace(perf_counter=clock.now))

        def look() -> None:
            """Let the viewer renew its lease, if it is due, in one complete round."""
            for _ in range(2):
                before = len(fake.of(commands.Show))
                clock.advance(server_connection.POLL_INTERVAL)
                fake.until(lambda before=before: len(fake.of(commands.Show)) > before)

        clock.advance(0.01)
        count = renewals()
        page.say("alive")
        fake.until(lambda: renewals() == count + 1)
        clock.advance(0.01)
        other.say("alive")
        other.catch_up()
        look()
        fake.answers[commands.Show] = held_up
        clock.advance(server_connection.POLL_INTERVAL)
        assert held.wait(LIMIT)
        page.say("alive")
        page.catch_up()
        clock.advance(server_connection.MAX_ALIVE_AGE * page.newest["session"]["lease"])
        fake.answers[commands.Show] = there
        free.set()
        look()
        assert renewals() == count + 1
        page.say("alive")
        fake.until(lambda: renewals() == count + 2)


@pytest.mark.parametrize("how", ["closed", "killed"])
def test_a_page_that_goes_lets_go_of_the_output(fake: Fake, url: str, how: str) -> None:
    with Page(url) as other, Page(url) as page:
        armed(page)
        if how == "killed":
            page.socket.socket.shutdown(socket.SHUT_RDWR)
        else:
            page.close()
        fake.until(lambda: bool(fake.of(control.Disarm)))
        other.until(lambda: not other.newest.get("session", {"armed": True})["armed"])
        assert not other.refusals


def test_a_page_that_goes_while_it_arms_does_not_arm(fake: Fake, url: str) -> None:
    gone = threading.Event()

    def slowly(message: Any) -> Any:
        assert gone.wait(LIMIT)
        return replies.Ok(id=message.id)

    fake.answers[control.Arm] = slowly
    with Page(url) as other:
        with Page(url) as page:
            page.next("state")
            page.say("arm")
            fake.until(lambda: bool(fake.of(control.Arm)))
        gone.set()
        fake.until(lambda: bool(fake.of(control.Disarm)))
        other.until(lambda: not other.newest.get("session", {"armed": True})["armed"])


def test_a_page_that_took_over_from_another_keeps_the_output_when_that_goes(
    fake: Fake, url: str
) -> None:
    with Page(url) as page:
        with Page(url) as before:
            armed(before)
            armed(page)
            before.until(lambda: not before.newest["session"]["mine"])
        page.catch_up()
        renewed = len(fake.of(control.Renew))

        def goes_on() -> bool:
            page.say("alive")
            return len(fake.of(control.Renew)) > renewed

        fake.until(goes_on)
        assert not fake.of(control.Disarm)


def test_only_the_page_that_asked_is_told_that_it_is_refused(fake: Fake, url: str) -> None:
    fake.answers[control.Select] = lambda _: None
    with Page(url) as one, Page(url) as other:
        for page, name in ((one, "first"), (other, "second")):
            page.next("state")
            page.say("select", solver={"name": name})
            fake.until(lambda name=name: name in [m.solver.name for m in fake.of(control.Select)])
        for request in fake.of(control.Select)[::-1]:
            name = request.solver.name
            fake.say(replies.Error(id=request.id, code="fault", message=name))
        for page in (one, other):
            page.until(lambda page=page: page.refusals)
        for page, name in ((one, "first"), (other, "second")):
            page.catch_up()
            assert [(r["action"], r["message"]) for r in page.refusals] == [("select", name)]


@pytest.fixture
def long_lease(monkeypatch: pytest.MonkeyPatch) -> None:
    """The lease outlasts a machine that stops for a second, and is still renewed soon: after an eighth of it."""
    monkeypatch.setattr(fake_server, "LEASE", 6.0)


@pytest.mark.usefixtures("long_lease")
def test_the_page_that_armed_is_told_at_once_why_that_has_ended(fake: Fake, url: str) -> None:
    with Page(url) as one, Page(url) as other:
        one.next("state")
        armed(other)
        fake.until(lambda: other.say("alive") or renewed(fake))
        ended = {control.Renew: lambda m: replace(usual(m), armed=False)}
        fake.say(
            replies.Error(id=0, code="owner", message="game has taken the output"), answers=ended
        )
        refused = other.next("refused")
        assert (refused["action"], refused["message"]) == ("arm", "game has taken the output")
        one.catch_up()
        assert not one.refusals


def test_what_is_asked_while_there_is_no_server_is_refused(tmp_path: Path) -> None:
    with viewer(tmp_path / "none") as url, Page(url) as page, Page(url) as other:
        page.next("lost")
        page.say("arm")
        assert page.next("refused")["action"] == "arm"
        assert "no connection file" in page.newest["refused"]["message"]
        page.say("reset")
        page.until(lambda: page.newest["refused"]["action"] == "reset")
        other.catch_up()
        assert not other.refusals


def test_a_stop_that_fails_in_an_odd_way_is_told(url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise OSError("too many open files")

    monkeypatch.setattr(server_connection, "emergency_stop", fail)
    with Page(url) as page:
        page.say("stop")
        refused = page.next("refused")
        assert (refused["action"], refused["message"]) == ("stop", "OSError: too many open files")


def test_a_stop_while_another_is_under_way_is_carried_out_after_it(
    url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun, may_end = threading.Semaphore(0), threading.Semaphore(0)

    def stop(*_: object) -> None:
        begun.release()
        assert may_end.acquire(timeout=LIMIT)

    monkeypatch.setattr(server_connection, "emergency_stop", stop)
    with Page(url) as page:
        page.say("stop")
        assert begun.acquire(timeout=LIMIT)
        for _ in range(5):
            page.say("stop")
        page.say("play")  # refused, once all before it has been received
        page.next("refused")
        may_end.release()
        assert begun.acquire(timeout=LIMIT)
        may_end.release(6)
        page.say("play")
        page.next("refused")
        assert not begun.acquire(blocking=False), "the other presses are one stop"


def test_a_state_that_is_not_whole_is_passed_over(fake: Fake, url: str) -> None:
    fake.stream = lambda: state(tick_counts=b"abc")
    with Page(url) as page:
        page.until(lambda: page.counts["state"] > 10)
        assert not page.counts["histogram"]
        fake.stream = lambda: state(tick_counts=bytes(256))
        page.next("histogram")
        assert not page.counts["lost"]


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


def test_an_answer_that_cannot_be_is_a_loss_until_it_can(fake: Fake, connection: Path) -> None:
    fake.answers[control.Capabilities] = lambda m: abilities(m, positions=bytes(7))
    with viewer(connection) as url, Page(url) as page:
        page.next("lost")
        fake.answers[control.Capabilities] = abilities
        page.next("array")
        page.next("state")


def test_plugins_that_are_listed_late_are_told(fake: Fake, connection: Path) -> None:
    solvers = iter([(), (), (replies.Plugin(name="gs"),)])
    fake.answers[control.Capabilities] = lambda m: abilities(
        m, solvers=next(solvers), backends=(replies.Plugin(name="simulated"),)
    )
    with viewer(connection) as url, Page(url) as page:
        page.until(lambda: page.newest.get("array", {}).get("solvers"))
        assert page.counts["array"] == 2  # an equal list is not sent again
        page.next("state")
        assert len(fake.of(control.Capabilities)) == 3


def test_who_comes_later_is_not_told_what_was(
    fake: Fake, url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    rest, rests = Hub.set_idle, threading.Event()
    monkeypatch.setattr(Hub, "set_idle", lambda hub: (rest(hub), rests.set()))
    with Page(url) as page:
        page.next("state")
    assert rests.wait(LIMIT)
    fake.stream = None
    with Page(url) as page:
        page.next("session")
        page.catch_up()
        assert page.counts["array"]
        assert not page.counts["state"]


def test_nobody_is_asked_for_anything_while_no_page_is_open(
    fake: Fake, connection: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server_connection, "UNARMED_RENEWAL", 0.0)
    with viewer(connection) as url:
        fake.until(
            lambda: len(fake.of(control.Renew)) >= 3
        )  # between them, it could have requested objects
        assert not fake.of(commands.Show)
        with Page(url) as page:
            page.next("state")
            fake.until(lambda: bool(fake.of(commands.Show)))


def test_too_much_at_once_is_refused_and_alive_never_is(fake: Fake, url: str) -> None:
    fake.answers[control.Reset] = lambda _: None  # never answered
    with Page(url) as page:
        page.next("state")
        for kind in ("reset", "alive"):
            for _ in range(200):
                page.say(kind)
        page.catch_up()
        assert page.refusals
        told = {(refused["action"], refused["message"]) for refused in page.refusals}
        assert told == {("reset", "too much is asked at once")}
        fake.until(lambda: bool(fake.of(control.Reset)))
        del fake.answers[control.Reset]
        fake.say(replies.Ok(id=fake.of(control.Reset)[0].id))
