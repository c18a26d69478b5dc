"""Decodes changes from the bus to scene values. start: the scene's time 0 by the clock of the changes [s]."""

from __future__ import annotations

import copy
import math
from typing import TYPE_CHECKING, Literal

import msgspec
import numpy as np
from msgspec.msgpack import Decoder
from msgspec.structs import force_setattr

from pacinian.acoustics.pose import UPRIGHT, Pose
from pacinian.scene.hands.hand import Hand
from pacinian.scene.motion import STILL, Motion
from pacinian.serving.ipc.messages import AnyChange, Changes

if TYPE_CHECKING:
    from pacinian.serving.ipc.messages import HandInfo, MoveObject
    from pacinian.types import Floats

HERE, MOTION = Pose(), Motion()
# A hand that stands for no tracked hand, because a scene without any hand is rendered whole.
LOST = Hand(np.full((26, 3), math.nan))


_changes, _change = Decoder(Changes), Decoder(AnyChange)
_parts = Decoder(tuple[int, int, list[msgspec.Raw]])


def decode_changes(data: bytes) -> tuple[Changes, int]:
    """Return the valid changes, and the number of invalid ones.

    Raises msgspec.DecodeError, msgspec.ValidationError if not even their list can be decoded.
    """
    try:
        return _changes.decode(data), 0
    except msgspec.ValidationError:
        number, run, parts = _parts.decode(data)
        found: list[AnyChange] = []
        for part in parts:
            try:
                found.append(_change.decode(part))
            except msgspec.ValidationError:
                continue
        return Changes(number, run, tuple(found)), len(parts) - len(found)


def decode_pose(change: MoveObject) -> Pose:
    """Return the new pose of an object, without checks."""
    made, rotation = copy.copy(HERE), change.rotation
    force_setattr(made, "position", change.position)
    if rotation != UPRIGHT:
        size = math.hypot(*rotation)
        x, y, z, w = rotation
        force_setattr(made, "rotation", (x / size, y / size, z / size, w / size))
    return made


def decode_motion(change: MoveObject, start: float) -> Motion | None:
    """Return the new motion of an object, without checks; None if it is unknown."""
    if change.velocity is None:
        return None
    made = copy.copy(MOTION)
    force_setattr(made, "velocity", change.velocity)
    force_setattr(made, "angular_velocity", change.angular_velocity or STILL)
    force_setattr(made, "time", change.time - start)
    return made


def decode_hand(info: HandInfo, start: float) -> Hand:
    """Return a hand; lost if it has no joints. Raises ArgumentError, ValueError."""
    joints = _decode_rows(info.joints, 3) if info.joints else LOST.joints
    radii = _decode_rows(info.radii, 1)[:, 0] if info.radii else None
    v = _decode_rows(info.velocities, 3) if info.velocities else None
    side: Literal["left", "right"] = "left" if info.side == "left" else "right"
    return Hand(
        joints, radii, side=side, velocities=v[0] if v is not None and len(v) == 1 else v,
        time=info.time - start, name=info.name,
    )  # fmt: skip


def _decode_rows(data: bytes, columns: int) -> Floats:
    return np.frombuffer(data, "<f4").reshape(-1, columns).astype(np.float64)
