"""The viewer and a server of one thread that says what it is told to: older ones, broken ones, slow ones."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import pytest

from pacinian.wire import commands, control, replies

from .watching import Page, viewer

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import ModuleType

EMPTY: dict[str, Any] = {"scene": "", "version": 0, "names": (), "poses": b"", "objects": {}}
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
        fake.until(lambda: bool(fake.of(control.Stop)))
        assert not page.counts["lost"]


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
