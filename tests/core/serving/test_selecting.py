"""Selections: ordered at once, answered when they are done."""

from __future__ import annotations

from typing import Any

import pytest

from pacinian.scene.file import Choice as Configured
from pacinian.serving.ownership import Session
from pacinian.serving.selecting import PATIENCE, SUSPECT, Selection
from pacinian.serving.settings import Settings
from pacinian.wire.control import Choice, Select
from pacinian.wire.replies import Error, Ok

KNOWN = {"solver": ("auto", "gs"), "backend": ("simulated",)}
GAME = Session(bytes(16), b"game", "", "game", "room", 0.25, 0.0)


def ask(selection: Selection, now: float = 0.0, **what: Any) -> Any:
    return selection.ask(GAME, Select(session=GAME.key, id=3, **what), KNOWN, now)


@pytest.mark.parametrize("kind", ["solver", "backend"])
def test_names_that_nothing_has_are_refused_with_those_there_are(kind: str) -> None:
    selection = Selection(Settings())
    reply = ask(selection, **{kind: Choice(name="nope")})
    assert isinstance(reply, Error)
    assert (reply.code, reply.path) == ("unknown", f"$.{kind}.name")
    assert KNOWN[kind][0] in reply.message
    assert getattr(selection.orders, kind) == (0, None), "and nothing is ordered"


def test_what_is_not_given_stays() -> None:
    selection = Selection(Settings())
    assert ask(selection) == Ok(id=3)
    assert ask(selection, solver=Choice(name="gs"), intensity=0.0) is None
    assert selection.orders.solver == (1, Choice(name="gs"))
    assert selection.orders.intensity == (1, 0.0)
    assert selection.orders.backend == (0, None)
    assert ask(selection, solver=Choice(name="auto")) is None
    assert selection.orders.solver == (2, Choice(name="auto"))


def test_it_is_answered_once_when_all_is_done() -> None:
    selection = Selection(Settings())
    ask(selection, solver=Choice(name="gs"), intensity=0.5)
    assert selection.answers({}, 0.1) == []
    assert selection.answers({"solver 1": ""}, 0.2) == []
    assert selection.answers({"solver 1": "", "intensity 1": ""}, 0.3) == [(b"game", Ok(id=3))]
    assert selection.answers({"solver 1": "", "intensity 1": ""}, 0.4) == []


def test_what_failed_is_told_at_once_and_what_hangs_after_a_while() -> None:
    selection = Selection(Settings())
    ask(selection, solver=Choice(name="gs"), backend=Choice(name="simulated"))
    ((_, reply),) = selection.answers({"backend 1": "no device"}, 0.1)
    assert (reply.code, reply.message) == ("fault", "backend: no device")
    ask(selection, now=1.0, solver=Choice(name="gs"))
    assert selection.answers({}, 1.0 + PATIENCE - 0.01) == []
    ((_, reply),) = selection.answers({}, 1.0 + PATIENCE)
    assert reply.code == "fault"
    assert "solver: not done" in reply.message


def test_a_solver_that_ends_the_renderer_twice_is_given_up_for_the_configured_one() -> None:
    selection = Selection(Settings(solver=Configured("lagrange", {"steps": 5})))
    assert not selection.renderer_ended(0.0)
    assert not selection.renderer_ended(0.1), "nothing was selected"
    ask(selection, now=1.0, solver=Choice(name="gs"))
    assert not selection.renderer_ended(2.0)
    assert selection.renderer_ended(1.0 + SUSPECT - 0.1)
    assert selection.orders.solver == (2, Choice(name="lagrange", options={"steps": 5}))
    assert not selection.renderer_ended(3.0)
    ask(selection, now=100.0, solver=Choice(name="gs"))
    assert not selection.renderer_ended(101.0)
    assert not selection.renderer_ended(101.0 + SUSPECT), "it was not the solver"


def test_resets_are_counted() -> None:
    selection = Selection(Settings())
    selection.reset(4)
    assert selection.orders.reset == 4
