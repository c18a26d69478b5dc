"""Selections: made at once, answered when they are done."""

from __future__ import annotations

from typing import Any

import pytest

from pacinian.scene.config_sections import PluginConfig
from pacinian.serving.control.client_session import ClientSession
from pacinian.serving.control.selection import (
    MAX_PENDING,
    MAX_SELECTION_TIME,
    SUSPECT_TIME,
    SelectionManager,
)
from pacinian.serving.settings import Settings
from pacinian.wire.control import Choice, Select
from pacinian.wire.modulation import AM, STM
from pacinian.wire.replies import Error, Ok
from pacinian.wire.shapes import Polyline

KNOWN = {"solver": ("auto", "gs"), "backend": ("simulated",)}
GAME = ClientSession(bytes(16), b"game", "", "game", "room", 0.25, 0.0)


def ask(selection: SelectionManager, now: float = 0.0, **what: Any) -> Any:
    return selection.select(GAME, Select(session=GAME.key, id=3, **what), KNOWN, now)


@pytest.mark.parametrize("kind", ["solver", "backend"])
def test_names_that_nothing_has_are_refused_with_those_there_are(kind: str) -> None:
    selection = SelectionManager(Settings())
    reply = ask(selection, **{kind: Choice(name="nope")})
    assert isinstance(reply, Error)
    assert (reply.code, reply.path) == ("unknown", f"$.{kind}.name")
    assert KNOWN[kind][0] in reply.message
    assert getattr(selection.newest, kind) == (0, None), "and nothing is selected"


def test_what_is_not_given_stays() -> None:
    selection = SelectionManager(Settings())
    assert ask(selection) == Ok(id=3)
    assert ask(selection, solver=Choice(name="gs"), intensity=0.0) is None
    assert selection.newest.solver == (1, Choice(name="gs"))
    assert selection.newest.intensity == (1, 0.0)
    assert selection.newest.backend == (0, None)
    assert ask(selection, solver=Choice(name="auto")) is None
    assert selection.newest.solver == (2, Choice(name="auto"))


def test_it_is_answered_once_when_all_is_done() -> None:
    selection = SelectionManager(Settings())
    ask(selection, solver=Choice(name="gs"), intensity=0.5)
    assert selection.take_replies({}, 0.1) == []
    assert selection.take_replies({"solver 1": ""}, 0.2) == []
    assert selection.take_replies({"solver 1": "", "intensity 1": ""}, 0.3) == [(b"game", Ok(id=3))]
    assert selection.take_replies({"solver 1": "", "intensity 1": ""}, 0.4) == []


def test_what_failed_is_told_at_once_and_what_hangs_after_a_while() -> None:
    selection = SelectionManager(Settings())
    ask(selection, solver=Choice(name="gs"), backend=Choice(name="simulated"))
    ((_, reply),) = selection.take_replies({"backend 1": "no device"}, 0.1)
    assert (reply.code, reply.message) == ("fault", "backend: no device")
    ask(selection, now=1.0, solver=Choice(name="gs"))
    assert selection.take_replies({}, 1.0 + MAX_SELECTION_TIME - 0.01) == []
    ((_, reply),) = selection.take_replies({}, 1.0 + MAX_SELECTION_TIME)
    assert reply.code == "fault"
    assert "solver: the selection did not finish" in reply.message


def test_a_solver_that_ends_the_renderer_twice_is_given_up_for_the_configured_one() -> None:
    selection = SelectionManager(Settings(solver=PluginConfig("lagrange", {"steps": 5})))
    assert not selection.note_renderer_end(0.0)
    assert not selection.note_renderer_end(0.1), "nothing was selected"
    ask(selection, now=1.0, solver=Choice(name="gs"))
    assert not selection.note_renderer_end(2.0)
    assert selection.note_renderer_end(1.0 + SUSPECT_TIME - 0.1)
    assert selection.newest.solver == (2, Choice(name="lagrange")), (
        "its options are with who makes it"
    )
    assert not selection.note_renderer_end(3.0)
    ask(selection, now=100.0, solver=Choice(name="gs"))
    assert not selection.note_renderer_end(101.0)
    assert not selection.note_renderer_end(101.0 + SUSPECT_TIME), "it was not the solver"


def test_a_slider_is_answered_at_each_of_its_steps() -> None:
    """The renderer takes only the newest intensity, so it reports only some numbers."""
    selection = SelectionManager(Settings())
    for step in range(100):
        assert ask(selection, now=1.0, intensity=step / 100) is None
    assert selection.take_replies({}, 1.1) == [(b"game", Ok(id=3))] * 99
    assert selection.take_replies({"intensity 100": ""}, 1.2) == [(b"game", Ok(id=3))]
    assert selection.newest.intensity == (100, 0.99)


def test_what_a_newer_one_replaced_does_not_stand_for_the_rest() -> None:
    selection = SelectionManager(Settings())
    ask(selection, solver=Choice(name="gs"), technique=AM(100.0), intensity=0.5)
    ask(selection, technique=AM(200.0))
    assert selection.take_replies({"technique 2": ""}, 0.1) == [(b"game", Ok(id=3))]
    assert selection.take_replies({"solver 1": ""}, 0.2) == [], "its intensity is not done"
    assert selection.take_replies({"intensity 1": ""}, 0.3) == [(b"game", Ok(id=3))]


def test_only_so_many_wait() -> None:
    selection = SelectionManager(Settings())
    assert ask(selection, intensity=0.1) is None
    for _ in range(MAX_PENDING - 1):
        assert ask(selection, solver=Choice(name="gs")) is None
    before = selection.newest
    for what in (
        {"solver": Choice(name="gs")},
        {"technique": AM()},
        {"backend": Choice(name="simulated")},
    ):
        assert ask(selection, **what).code == "busy"
    assert selection.newest == before, "and nothing is selected"
    assert ask(selection, intensity=0.2) is None, "in place of one that waits"
    selection.take_replies({"solver 1": ""}, 0.1)
    assert ask(selection, solver=Choice(name="gs")) is None


def test_a_technique_that_cannot_be_meant_is_refused_with_where() -> None:
    selection = SelectionManager(Settings())
    line = Polyline(points=bytes(24))  # a line of length 0
    reply = ask(selection, technique=STM(100.0, along=line), intensity=0.5)
    assert isinstance(reply, Error)
    assert reply.code == "argument"
    assert reply.path.startswith("$.technique.along")
    assert selection.newest.technique == (0, None)
    assert selection.newest.intensity == (0, 1.0)


def test_resets_are_counted() -> None:
    selection = SelectionManager(Settings())
    selection.set_reset_count(4)
    assert selection.newest.reset == 4


def test_a_selection_that_was_overwritten_before_it_was_read_is_answered_with_the_newer_one() -> (
    None
):
    selection = SelectionManager(Settings())
    assert ask(selection, solver=Choice(name="gs")) is None
    assert ask(selection, solver=Choice(name="auto")) is None
    assert selection.take_replies({}, 0.1) == []
    first, second = (reply for _, reply in selection.take_replies({"solver 2": ""}, 0.1))
    assert isinstance(first, Error)
    assert "newer" in first.message
    assert second == Ok(id=3)
