"""Causes of silence, from states: each cause alone, and the first that applies."""

import re
from typing import Any, get_args

import numpy as np
import pytest
from msgspec.structs import replace

from pacinian.serving.control import explain_silence
from pacinian.serving.control.explain_silence import find_cause
from pacinian.solving.solution_status import Status
from pacinian.wire.silence_cause import CAUSES, Cause
from pacinian.wire.state import ClientState, State

HAND = bytes(26 * 3 * 4)


def client(**fields: Any) -> ClientState:
    given = {
        "name": "game", "scene": "hall", "owner": True, "objects": 1, "commands": 9, "errors": 0,
        "dropped": 0, "age": 0.001, "renewed": 0.01,
    }  # fmt: skip
    return ClientState(**{**given, **fields})


def state(**fields: Any) -> State:
    """Return a state with an armed, silent output and one object."""
    given = {
        "sequence": 1, "time": 1.0, "output": "silent", "armed": True, "owner": "game", "scene": "hall",
        "solver": "auto", "backend": "simulated", "technique": "", "intensity": 1.0, "status": "silent",
        "clients": (client(),),
    }  # fmt: skip
    return State(**{**given, **fields})


ONE = np.ones(1, "<f4").tobytes()
ZERO = np.zeros(1, "<f4").tobytes()
OPENS, RESETS = "the device is being opened", "carrying out a reset"
"""What the server does when no fault holds the output."""
CASES: list[tuple[Cause, State, str]] = [
    ("fault", state(output="faulted", backend=""), f"{OPENS}.*log"),
    ("fault", state(output="faulted"), f"{OPENS}.*log"),
    ("stopped", state(output="stopped", armed=False), r"emergency stop: reset the server, then arm"),
    ("late", state(output="stale"), "late"),
    ("not armed", state(armed=False, owner="", scene=""), r"not armed: the game must arm"),
    ("lease lost", state(armed=False), r'"game" lost its lease.*must arm again'),
    ("not ready", state(status="silent: the quiet zones are being prepared"), "quiet zones"),
    ("no pressure", state(intensity=0.0), "intensity is 0"),
    ("no objects", state(clients=(client(objects=0),)), r"the game must put them there"),
    ("no objects", state(clients=(client(), client(scene="x"))[1:]), r"the game must put them there"),
    ("hand not seen", state(skipped={"hands lost": 9}), "no hand is seen"),
    ("no pressure", state(), "no object presses"),
    ("no pressure", state(cause="no pressure", why='outside the workspace: "far"'), "outside.*far"),
    ("nothing in reach", state(hands=HAND, skipped={"objects away from hands": 3}), "touches no"),
    ("out of the array's reach",
     state(hands=HAND, asked=ONE, achieved=ZERO, skipped={"samples hardly reached": 1}), "palm"),
    ("not ready", state(asked=ONE, achieved=ZERO, status="infeasible"), "quiet zones.*move them"),
    ("fault", state(solver="mine", asked=ONE, achieved=ZERO, status="failed", skipped={"samples hardly reached": 1}),
     'solver "mine" gives gains that are not finite: select another solver'),
    ("pause", state(hands=HAND, asked=ONE, achieved=ONE), "envelope"),
    ("pause", state(asked=ZERO, achieved=ZERO), "envelope"),
]  # fmt: skip


@pytest.mark.parametrize(("cause", "told", "says"), CASES)
def test_each_cause_is_told_with_what_to_do(cause: Cause, told: State, says: str) -> None:
    found = find_cause(told)
    assert found is not None
    assert found.cause == cause
    with pytest.raises(AssertionError, match=says):
        raise AssertionError(str(found))


@pytest.mark.parametrize(
    ("told", "rules", "says"),
    [
        ({}, {"fault": "device: gone"}, "fault: device: gone. Remove its cause, then reset the server and arm again"),
        ({"armed": False}, {"fault": "x", "stopped": True, "resetting": True}, "fault: x. Remove its cause, then"),
        ({}, {}, f"{OPENS}.*Sound returns when that is done$"),
        ({"armed": False}, {}, f"{OPENS}.*but the game must arm the output$"),
        ({"armed": False}, {"resumes": True}, f'{OPENS}.*"game" no longer renews its lease: .*as soon as it renews'),
        ({"armed": False}, {"stopped": True}, f"{OPENS}.*emergency stop: reset the server, then arm again$"),
        ({}, {"resetting": True}, f"{RESETS}. Sound returns when that is done$"),
        ({"armed": False}, {"resetting": True}, f"{RESETS}.*but the game must arm the output$"),
        ({"armed": False}, {"resetting": True, "stopped": True}, f"{RESETS}.*reset the server, then arm again$"),
    ],
)  # fmt: skip
def test_a_faulted_output_is_explained_by_the_fault_that_holds_it(
    told: dict[str, Any], rules: dict[str, Any], says: str
) -> None:
    """Other faults in the list are over: they neither silence the output nor need a reset."""
    found = find_cause(state(output="faulted", faults=("device: over",), **told), **rules)
    assert found is not None
    assert found.cause == "fault"
    assert re.search(says, found.text)
    assert "over" not in found.text
    assert ("reset the server" in found.text) == bool({"fault", "stopped"} & rules.keys())


def test_all_causes_are_tried_here() -> None:
    """The list lacks only `too faint`, which the renderer finds, and the loss of the server, which the client finds."""
    assert {case[0] for case in CASES} | {"too faint"} == set(CAUSES)
    assert {*CAUSES, "not connected"} == set(get_args(Cause))


def test_the_statuses_are_those_of_solves() -> None:
    assert {explain_silence.INFEASIBLE, explain_silence.FAILED} <= set(Status.__members__)


def test_what_sounds_has_no_cause() -> None:
    assert find_cause(state(output="sounding")) is None


def test_the_first_cause_that_applies_is_told() -> None:
    """A cause hides later ones, which assume that the output could sound otherwise."""
    worst = state(
        output="faulted",
        armed=False,
        intensity=0.0,
        faults=("x",),
        hands=HAND,
        cause="too faint",
        why="0.1 Pa",
    )
    order = [worst]
    for change in (
        {"output": "stopped"}, {"output": "silent"}, {"armed": True}, {"intensity": 1.0}, {"output": "sounding"},
    ):  # fmt: skip
        order.append(replace(order[-1], **change))
    causes = [found and found.cause for found in map(find_cause, order)]
    assert causes == ["fault", "stopped", "lease lost", "no pressure", "too faint", None]


def test_a_pause_that_ends_by_itself_needs_no_arm() -> None:
    found = find_cause(state(armed=False), resumes=True)
    assert found is not None
    assert found.cause == "lease lost"
    assert "sounds again as soon as it renews its lease" in found.text
    assert "arm()" not in found.text


def test_a_client_reads_what_the_server_has_found() -> None:
    assert str(state(cause="pause", why="an envelope is at 0").silence) == "an envelope is at 0"
    assert state(output="sounding").silence is None
