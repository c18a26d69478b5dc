"""Why the output is silent: the rules, from a state and what the renderer has found about the contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.skip_reasons import (
    HANDS_LOST,
    SAMPLES_HARDLY_REACHED,
    SAMPLES_ON_TRANSDUCER,
    SAMPLES_TOO_FAR,
)
from pacinian.wire.silence_cause import UNTOUCHED, Silence

if TYPE_CHECKING:
    from pacinian.wire.state import State

RESUMES = "the output sounds again as soon as it renews its lease"
NOT_ARMED = "not armed: the game must arm the output"
STOPPED = "stopped by an emergency stop: reset the server, then arm again"
LATE = (
    "the renderer is late: sound returns when it catches up; `pacinian status` shows the tick times"
)
OPENING = "the device is being opened (if this lasts, see the server's log)"
RESETTING = "the server is carrying out a reset"
TURNED_DOWN = "the intensity is 0: select one above 0"
NO_OBJECTS = "the scene has no objects: the game must put them there"
NOT_SEEN = "no hand is seen: the tracker must see one, and the game must send it in each frame"
UNREACHED = "the array cannot reach the touched skin: turn the palm to the array, or come nearer"
NOT_PRESSING = (
    "no object presses: check that their pressure is above 0 and that they lie in the workspace"
)
ZONES = "the quiet zones leave no sound where an object presses: move them, or make them smaller"
PAUSE = "nothing presses at this moment: an envelope is at 0, a hand has just come, or the sound has just begun"
INFEASIBLE, FAILED = "infeasible", "failed"  # names of `Status.infeasible` and `Status.failed`
# Reasons in `State.skipped` for which the array cannot press on what a hand touches.
UNREACHED_REASONS = SAMPLES_HARDLY_REACHED, SAMPLES_TOO_FAR, SAMPLES_ON_TRANSDUCER


def find_cause(
    state: State,
    *,
    resumes: bool = False,
    fault: str = "",
    stopped: bool = False,
    resetting: bool = False,
) -> Silence | None:
    """Return why the output is silent; None if it sounds.

    state: with `cause` and `why` of the contact, as the renderer found them. resumes: whether the owner's next renewal
    lets the output sound again. fault: the fault that holds the output until a reset, or "". stopped: whether an
    emergency stop holds it until a reset. resetting: whether a process still reports a fault that was reset.
    """
    if state.output == "sounding":
        return None
    if state.output == "faulted":
        if fault:
            advice = "Remove its cause, then reset the server and arm again"
            return Silence("fault", f"fault: {fault}. {advice}")
        advice = _advise_until_ready(state, resumes, stopped)
        return Silence("fault", f"{RESETTING if resetting else OPENING}. {advice}")
    if state.output == "stopped":
        return Silence("stopped", STOPPED)
    if state.output == "stale":
        return Silence("late", LATE)
    if not state.armed:
        return _explain_unarmed(state, resumes)
    if state.status.startswith("silent: "):  # such as while quiet zones are prepared
        return Silence("not ready", state.status.removeprefix("silent: "))
    if state.intensity <= 0.0:
        return Silence("no pressure", TURNED_DOWN)
    if not any(client.objects for client in state.clients if client.scene == state.scene):
        return Silence("no objects", NO_OBJECTS)
    return _explain_samples(state) if state.asked else _explain_contact(state)


def _advise_until_ready(state: State, resumes: bool, stopped: bool) -> str:
    """Return what a client must do while the server opens a device or carries out a reset."""
    if stopped:
        return f"Meanwhile, the output was {STOPPED}"
    if state.armed:
        return "Sound returns when that is done"
    if resumes:
        return f'"{state.owner}" no longer renews its lease: {RESUMES}, once that is done'
    return "Sound returns when that is done, but the game must arm the output"


def _explain_unarmed(state: State, resumes: bool) -> Silence:
    if not state.owner:
        return Silence("not armed", NOT_ARMED)
    if resumes:
        return Silence("lease lost", f'"{state.owner}" no longer renews its lease: {RESUMES}')
    advice = "it must arm again, and then renew its lease in each frame"
    return Silence("lease lost", f'"{state.owner}" lost its lease or was disarmed: {advice}')


def _explain_samples(state: State) -> Silence:
    """Explain silence although there are samples."""
    asked, achieved = np.frombuffer(state.asked, "<f4"), np.frombuffer(state.achieved, "<f4")
    if not asked.any():
        return Silence("pause", PAUSE)
    if state.status == FAILED:
        solver = f'the solver "{state.solver}"'
        return Silence("fault", f"{solver} gives gains that are not finite: select another solver")
    unreached = any(state.skipped.get(reason) for reason in UNREACHED_REASONS)
    if unreached and not achieved.any():
        return Silence("out of the array's reach", UNREACHED)
    if state.status == INFEASIBLE:
        return Silence("not ready", ZONES)
    return Silence("pause", PAUSE)


def _explain_contact(state: State) -> Silence:
    """Explain why there are no samples."""
    if state.hands:
        return Silence(state.cause or "nothing in reach", state.why or UNTOUCHED)
    if state.skipped.get(HANDS_LOST):
        return Silence("hand not seen", NOT_SEEN)
    return Silence(state.cause or "no pressure", state.why or NOT_PRESSING)
