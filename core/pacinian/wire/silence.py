"""Why an output is silent: one answer, from a published state and the objects of the scene."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from pacinian.scene.hands.capsules import make_capsules
from pacinian.scene.hands.hand import Hand
from pacinian.scene.objects import Surface, Volume
from pacinian.scene.sampling.perception_thresholds import lowest_threshold
from pacinian.scene.sampling.sampler import find_vibration

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.scene.objects import Object
    from pacinian.types import Floats
    from pacinian.wire.state import State

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

NOT_ARMED = "not armed: call arm()"
NOT_CONNECTED = "not connected to a server: start `pacinian serve`, then connect again"
STOPPED = "stopped by an emergency stop: call reset(), then arm()"
LATE = (
    "the renderer is late: sound returns when it catches up; `pacinian status` shows the tick times"
)
TURNED_DOWN = "the intensity is 0: call select(intensity=1.0)"
NO_OBJECTS = "the scene has no objects: call put()"
NOT_SEEN = "no hand is seen: the tracker must see one, and the game must send it with hands() in each frame"
UNTOUCHED = "the hand touches no object"
UNSEEN = "the touched skin faces away from the array, or hardly touches: turn the palm to the array, or press deeper"
UNREACHED = "the array cannot reach the touched skin: turn the palm to the array, or come nearer"
NOT_PRESSING = (
    "no object presses: check that their pressure is above 0 and that they lie in the workspace"
)
PAUSE = "nothing presses at this moment: an envelope is at 0, or the sound has just begun"

HAND = 26 * 3 * 4  # size of the joints of one hand in `State.hands` [bytes]
BONE_POINTS = 5  # places on each bone at which the distance to an object is computed
HARDLY_REACHED = (
    "samples hardly reached",
    "samples out of reach",
    "samples on a transducer",
)  # reasons in `State.skipped` for which the array cannot press what a hand touches


class Silence(NamedTuple):
    """Why the output is silent. cause: for programs. text: what is the matter, and what to do; for people."""

    cause: Cause
    text: str

    def __str__(self) -> str:
        return self.text


class Nearest(NamedTuple):
    """The object nearest to a hand. gap: distance from the skin [m]; negative if the hand touches the object."""

    item: Object
    gap: float


def explain_silence(state: State | None, objects: Iterable[Object] = ()) -> Silence | None:
    """Return why the output is silent; None if it sounds.

    state: the newest state; None without a connection. objects: of the rendered scene, with their newest poses; used to
    name the object that is nearest to a hand.
    """
    if state is None:
        return Silence("not connected", NOT_CONNECTED)
    if state.output == "sounding":
        return None
    if state.output == "faulted":
        return _explain_fault(state)
    if state.output == "stopped":
        return Silence("stopped", STOPPED)
    if state.output == "stale":
        return Silence("late", LATE)
    if not state.armed:
        return _explain_unarmed(state)
    if state.status.startswith("silent: "):  # such as while quiet zones are prepared
        return Silence("not ready", state.status.removeprefix("silent: "))
    if state.intensity <= 0.0:
        return Silence("no pressure", TURNED_DOWN)
    if not any(client.objects for client in state.clients if client.scene == state.scene):
        return Silence("no objects", NO_OBJECTS)
    return _explain_samples(state) if state.asked else _explain_contact(state, objects)


def find_nearest(hands: bytes, objects: Iterable[Object]) -> Nearest | None:
    """Return the object nearest to any hand; None without hands or objects.

    hands: joints, (hands, 26, 3) float32 [m], as in `State.hands`; their radii are those of an adult.
    """
    axes = [_sample_bones(Hand(joints)) for joints in _joints(hands)]
    if not axes:
        return None
    points, radii = map(np.concatenate, zip(*axes, strict=True))
    nearest: Nearest | None = None
    for bound, item in sorted(
        ((_bound_gap(item, points, radii), item) for item in objects), key=lambda pair: pair[0]
    ):
        if nearest is not None and bound >= nearest.gap:
            break
        if (gap := _measure_gap(item, points, radii)) < (nearest.gap if nearest else math.inf):
            nearest = Nearest(item, gap)
    return nearest


def _explain_fault(state: State) -> Silence:
    if not state.backend and not state.faults:
        return Silence("fault", "no device is open: it may still be starting; see the server's log")
    fault = state.faults[-1] if state.faults else "see the server's log"
    return Silence("fault", f"fault: {fault}. Remove its cause, then call reset() and arm()")


def _explain_unarmed(state: State) -> Silence:
    if not state.owner:
        return Silence("not armed", NOT_ARMED)
    advice = "it must call arm() again, and then renew() in each of its frames"
    return Silence("lease lost", f'"{state.owner}" lost its lease or was stopped: {advice}')


def _explain_samples(state: State) -> Silence:
    """Explain silence although there are samples."""
    asked, achieved = np.frombuffer(state.asked, "<f4"), np.frombuffer(state.achieved, "<f4")
    if not asked.any():
        return Silence("pause", PAUSE)
    unreached = any(state.skipped.get(reason) for reason in HARDLY_REACHED)
    if unreached and not achieved.any():
        return Silence("out of the array's reach", UNREACHED)
    return Silence("pause", PAUSE)


def _explain_contact(state: State, objects: Iterable[Object]) -> Silence:
    """Explain why there are no samples."""
    if not state.hands:
        if state.skipped.get("hands lost"):
            return Silence("hand not seen", NOT_SEEN)
        return Silence("no pressure", NOT_PRESSING)
    nearest = find_nearest(state.hands, objects)
    if nearest is None:
        return Silence("nothing in reach", UNTOUCHED)
    name, pressure = nearest.item.name, state.intensity * nearest.item.pressure
    if nearest.gap > 0.0:
        away = f'"{name}" is nearest, {1e3 * nearest.gap:.0f} mm away'
        return Silence("nothing in reach", f"{UNTOUCHED}: {away}")
    if not pressure > 0.0:
        return Silence("no pressure", f'"{name}" is touched, but its pressure is 0')
    least = lowest_threshold(find_vibration(nearest.item))
    if pressure < least:
        told = f'"{name}" is touched, but its {pressure:.2g} Pa are below the {least:.2g} Pa that can be felt'
        return Silence("too faint", told)
    return Silence("out of the array's reach", f'"{name}" is touched, but {UNSEEN}')


def _joints(hands: bytes) -> Floats:
    whole = len(hands) // HAND * HAND
    return np.frombuffer(hands[:whole], "<f4").reshape(-1, 26, 3).astype(np.float64)


def _sample_bones(hand: Hand) -> tuple[Floats, Floats]:
    """Return points on the axes of a hand's bones, (P, 3) [m], and the radius of the flesh at each, (P,) [m]."""
    if hand.lost:
        return np.empty((0, 3)), np.empty(0)
    ends = make_capsules(hand)
    along = np.linspace(0.0, 1.0, BONE_POINTS)[:, None, None]
    first, last, radii = ends[:, :3], ends[:, 3:6], ends[:, 6:]
    points = (1.0 - along) * first + along * last
    around = (1.0 - along[..., 0]) * radii[:, 0] + along[..., 0] * radii[:, 1]
    return points.reshape(-1, 3), around.ravel()


def _bound_gap(item: Object, points: Floats, radii: Floats) -> float:
    """Return a lower bound of the gap between skin and object, from its bounding sphere [m]."""
    away = np.sqrt(((points - np.array(item.pose.position)) ** 2).sum(axis=1)) - radii
    return float(away.min(initial=math.inf)) - item.bounding_radius


def _measure_gap(item: Object, points: Floats, radii: Floats) -> float:
    """Return the gap between skin and object [m]."""
    local = (points - np.array(item.pose.position)) @ item.pose.matrix
    if isinstance(item, (Surface, Volume)):
        return float((item.distance(local, math.inf, math.inf) - radii).min(initial=math.inf))
    places = item.sample_surface(item.radius).points
    gaps = [
        math.sqrt(((places - point) ** 2).sum(axis=1).min(initial=math.inf)) - radius
        for point, radius in zip(local, radii.tolist(), strict=True)
    ]
    return min(gaps, default=math.inf) - item.radius
