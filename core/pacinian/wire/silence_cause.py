"""The causes of silence that a state can give."""

from __future__ import annotations

from typing import Literal, NamedTuple

Cause = Literal[
    "not connected",
    "fault",
    "stopped",
    "late",
    "not armed",
    "lease lost",
    "not ready",
    "no pressure",
    "no objects",
    "hand not seen",
    "nothing in reach",
    "out of the array's reach",
    "too faint",
    "pause",
]

CAUSES: dict[Cause, str] = {
    "fault": "a plug-in or device failed, or no device is open",
    "stopped": "emergency stop, until `reset`",
    "late": "the renderer is late",
    "not armed": "no client owns the output",
    "lease lost": "the owner does not renew its lease, or was disarmed by a fault",
    "not ready": "an object or a quiet zone is being prepared, or the quiet zones leave no sound",
    "no pressure": "the intensity or the pressure of the touched object is 0, or no object presses",
    "no objects": "the owner's scene is empty",
    "hand not seen": "the scene is felt by hands, and no hand is seen",
    "nothing in reach": "the hand touches no object; the text names the nearest",
    "out of the array's reach": "the touched skin faces away from the array, or is too far away",
    "too faint": "the pressure of the touched object is below the threshold of feeling",
    "pause": "an envelope is at 0, a hand has just come, or the sound has just begun",
}
"""Meanings of the values of `State.cause`. If several apply, the state gives the first."""

UNTOUCHED = "the hand touches no object"


class Silence(NamedTuple):
    """Why the output is silent. cause: for programs, one of `Cause`. text: for people, with what to do."""

    cause: str
    text: str

    def __str__(self) -> str:
        return self.text


DISCONNECTED = Silence(
    "not connected", "not connected to a server: start `pacinian serve`, then connect again"
)
