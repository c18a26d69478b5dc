"""Values in changes as those of the scene. start: what is its time 0, by the clock that changes are dated by [s]."""

from __future__ import annotations

import copy
import math
from typing import TYPE_CHECKING, Literal

import numpy as np
from msgspec.structs import force_setattr

from pacinian.acoustics.pose import UPRIGHT, Pose
from pacinian.scene.hands.hand import Hand
from pacinian.scene.motion import STILL, Motion

if TYPE_CHECKING:
    from pacinian.serving.ipc.messages import HandInfo, MoveObject
    from pacinian.types import Floats

HERE, MOTION = Pose(), Motion()
LOST = Hand(np.full((26, 3), math.nan))  # with no hand at all, objects are rendered whole


def pose(change: MoveObject) -> Pose:
    """Where an object is now, checked already."""
    made, rotation = copy.copy(HERE), change.rotation
    force_setattr(made, "position", change.position)
    if rotation != UPRIGHT:
        size = math.hypot(*rotation)
        x, y, z, w = rotation
        force_setattr(made, "rotation", (x / size, y / size, z / size, w / size))
    return made


def motion(change: MoveObject, start: float) -> Motion | None:
    """How it goes on, checked already; None where that is not known."""
    if change.velocity is None:
        return None
    made = copy.copy(MOTION)
    force_setattr(made, "velocity", change.velocity)
    force_setattr(made, "angular_velocity", change.angular_velocity or STILL)
    force_setattr(made, "time", change.time - start)
    return made


def hand(info: HandInfo, start: float) -> Hand:
    """A hand; lost, where it has no joints. Raises ArgumentError, ValueError."""
    joints = _rows(info.joints, 3) if info.joints else LOST.joints
    radii = _rows(info.radii, 1)[:, 0] if info.radii else None
    v = _rows(info.velocities, 3) if info.velocities else None
    side: Literal["left", "right"] = "left" if info.side == "left" else "right"
    return Hand(
        joints, radii, side=side, velocities=v[0] if v is not None and len(v) == 1 else v,
        time=info.time - start, name=info.name,
    )  # fmt: skip


def _rows(data: bytes, columns: int) -> Floats:
    return np.frombuffer(data, "<f4").reshape(-1, columns).astype(np.float64)
