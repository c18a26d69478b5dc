"""An object as a client sent it, with its encoding for the renderer, which is made when first needed."""

from __future__ import annotations

import itertools
import struct
from typing import TYPE_CHECKING, cast

import msgspec

from pacinian.acoustics.pose import UPRIGHT
from pacinian.errors import WireError, describe_error
from pacinian.serving.ipc.messages import CAPACITIES, MoveObject
from pacinian.wire.convert import to_scene
from pacinian.wire.objects import Point, Surface, Volume
from pacinian.wire.replies import Error
from pacinian.wire.shapes import (
    Difference,
    HeightMap,
    Intersection,
    Mesh,
    Placed,
    Union,
    Voxels,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.serving.bus.message_admission import BusSession
    from pacinian.wire.commands import Move
    from pacinian.wire.objects import Object
    from pacinian.wire.replies import Code

# Focal area that turns a force into a pressure [m^2]. A force over the limit even on so large a
# focus is refused; others are limited.
MAX_FOCAL_AREA = 1e-3
# Size of an object's bulk data from which its conversion takes more than 0.1 ms [bytes].
MIN_HEAVY_BYTES = 1 << 11
# Largest number of objects that are converted in a row while commands wait.
MAX_CONVERTED_AT_ONCE = 16
# Types of shapes that are slow to convert at any size.
SLOW = Mesh, Voxels, HeightMap, Placed, Union, Intersection, Difference
MAX_OBJECT_BYTES = CAPACITIES["changes"] * 5 // 8  # maximum size of one encoded object [bytes]
MAX_SPEED = 100.0  # maximum speed [m/s], [rad/s]
UNIT_TOLERANCE = 0.01  # tolerance of a quaternion's length
SCALARS = {float, int, str, bool, type(None)}
POSE, VELOCITY, VECTOR = struct.Struct("<7f"), struct.Struct("<6f"), struct.Struct("<3f")


NUMBERS = itertools.count(1)


class StoredObject:
    """A named object. owner: the client that put it. size: its memory [bytes].

    Until the object is converted, `size` includes its share of the message. number: counts all objects. sent: as it was
    put. seen: when it was put; until: when it expires; by the server's clock [s]. moved: pose, velocities or none, time
    [s]. envelope: the last one, encoded; empty if it was never set. envelope_job: pending conversion of the newest
    envelope; waits: its size [bytes]. slow: whether the object takes long to convert. placed: whether it counts towards
    its owner's limits.
    """

    def __init__(self, name: str, item: Object, owner: BusSession, seen: float) -> None:
        self.name, self.owner, self.size, self.seen = name, owner, count_bulk_bytes(item), seen
        self.item: Object | None = item
        self.sent, self.number = item, next(NUMBERS)
        self.packed, self.placed = b"", False
        self.default = item.technique is None
        self.until = None if item.duration is None else seen + item.duration
        self.moved: tuple[bytes, bytes, float] | None = None
        self.envelope = b""
        self.envelope_job: object = None
        self.waits = 0
        shape = item.shape if isinstance(item, (Surface, Volume)) else None
        self.slow = isinstance(shape, SLOW) or self.size > MIN_HEAVY_BYTES

    @property
    def heavy(self) -> bool:
        """Whether the object takes long to convert and is not converted yet."""
        return self.slow and self.item is not None

    def pack(self, most: float) -> None:
        """Encode the object, if it is not. most: maximum radiation pressure [Pa]. Raises WireError, TooStrong."""
        if self.item is not None:
            self.accept(encode_object(self.name, self.item, self.seen, most))

    def accept(self, packed: bytes) -> None:
        """Store the encoded object."""
        self.packed, self.item = packed, None
        more = len(packed) + len(self.envelope) + self.waits + count_bulk_bytes(self.sent)
        self.grow(more - self.size)

    def grow(self, more: int) -> None:
        """Add `more` bytes to the object's size, and to its owner's memory while the object is placed."""
        self.size += more
        if self.placed:
            self.owner.bytes += more

    def set_envelope(self, envelope: bytes, job: object = None, waits: int = 0) -> None:
        """Set the encoded envelope. job: conversion of a newer one, of `waits` bytes; it is only compared."""
        self.grow(len(envelope) + waits - len(self.envelope) - self.waits)
        self.envelope, self.envelope_job, self.waits = envelope, job, waits

    def leave(self) -> None:
        """Note that the object was removed, so that nothing more is converted for it."""
        self.item = self.envelope_job = None

    def encode_pose(self) -> bytes:
        """Return the last known pose: x, y, z [m], quaternion x, y, z, w, (7,) float32."""
        if self.moved is not None:
            return self.moved[0]
        if isinstance(self.sent, Point):
            return POSE.pack(*self.sent.position, *UPRIGHT)
        return POSE.pack(*self.sent.pose.position, *self.sent.pose.rotation)

    def make_move(self) -> MoveObject | None:
        """Return the last move, if there was one since the put."""
        if self.moved is None:
            return None
        pose, velocity, seen = self.moved
        x, y, z, *q = POSE.unpack(pose)
        u, v, w, p, q_, r = VELOCITY.unpack(velocity) if velocity else (0.0,) * 6
        return MoveObject(
            self.name,
            (x, y, z),
            (q[0], q[1], q[2], q[3]),
            (u, v, w) if velocity else None,
            (p, q_, r) if velocity else None,
            seen,
        )


def count_bulk_bytes(value: object) -> int:
    """Return the size of the bulk numbers in a wire object [bytes]."""
    if isinstance(value, bytes):
        return len(value)
    parts: Sequence[object] = ()
    if isinstance(value, msgspec.Struct):
        parts = [getattr(value, name) for name in value.__struct_fields__]
    elif isinstance(value, tuple):
        parts = cast("tuple[object, ...]", value)
    return sum([count_bulk_bytes(part) for part in parts if type(part) not in SCALARS])


def encode_object(name: str, item: Object, seen: float, most: float) -> bytes:
    """Return the object of `pacinian.scene`, encoded. Raises WireError; TooStrong above `most` [Pa]."""
    try:
        scene = to_scene(name, item, time=seen)
        pressure = (scene.force or 0.0) / MAX_FOCAL_AREA if scene.focal else scene.pressure
    except WireError:
        raise
    except Exception as error:  # a shape may raise anything for invalid numbers; the bus must go on
        raise WireError(describe_error(error), f"$.objects[{name}]") from error
    if pressure > most:
        raise reject_strength(name, item, pressure, most)
    packed = msgspec.msgpack.encode(scene)
    if len(packed) > MAX_OBJECT_BYTES:
        raise WireError("is too large: keep to fewer numbers", f"$.objects[{name}]")
    return packed


class TooStrong(WireError):
    """The radiation pressure is higher than the server allows."""


def make_error_reply(error: WireError, id: int = 0) -> Error:  # noqa: A002
    """Return the reply to a command that is invalid or exceeds a limit."""
    code: Code = "limit" if isinstance(error, TooStrong) else "argument"
    return Error(id=id, code=code, message=error.problem[:1000], path=error.path[:200])


def reject_strength(name: str, item: Object, pressure: float, most: float) -> TooStrong:
    """Return the error for an object that is too strong."""
    field = "force" if item.radiation_pressure is None else "radiation_pressure"
    return TooStrong(
        f"makes a radiation pressure of {pressure:.4g} Pa: keep to {most:g} Pa",
        f"$.objects[{name}].{field}",
    )


def check_poses(command: Move) -> None:
    """Check rotations and speeds; the rest is already checked. Raises WireError."""
    for i, (_, _, _, x, y, z, w) in enumerate(POSE.iter_unpack(command.poses)):
        if abs(x * x + y * y + z * z + w * w - 1.0) > 2.0 * UNIT_TOLERANCE:
            raise WireError("must have a unit quaternion (x, y, z, w)", f"$.poses[{i}]")
    for i, (x, y, z) in enumerate(VECTOR.iter_unpack(command.velocities)):
        if x * x + y * y + z * z > MAX_SPEED * MAX_SPEED:
            problem = f"must be at most {MAX_SPEED:g} m/s, and rad/s"
            raise WireError(problem, f"$.velocities[{i // 2}]")
