"""Arguments of the API as fields of the wire, in batches that each fit in one message."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from pacinian.acoustics.pose import Pose
from pacinian.argument_checks import check_kind, check_numbers
from pacinian.errors import ArgumentError, WireError
from pacinian.scene.hands.hand import RADII, Hand
from pacinian.scene.motion import STILL, Motion
from pacinian.solving.quiet_zone import Zone
from pacinian.wire import commands
from pacinian.wire.binary_arrays import pack
from pacinian.wire.codec import encode
from pacinian.wire.commands import HandFrame
from pacinian.wire.convert import to_wire
from pacinian.wire.protocol import MAX_COMMAND_BYTES, MAX_OBJECTS, MAX_POINTS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from pacinian.scene.objects import Object
    from pacinian.types import ArrayLike
    from pacinian.wire import objects

T = TypeVar("T")

MAX_MESSAGE_OBJECT_BYTES = 900_000  # maximum size of the objects in one message [bytes]
# Maximum size of one object [bytes]; the rest is for the command's other fields.
MAX_OBJECT_BYTES = MAX_COMMAND_BYTES - 1024


def split_batches(items: Sequence[T]) -> Iterator[tuple[T, ...]]:
    """Yield the parts of a sequence that each fit in one message."""
    for i in range(0, len(items), MAX_OBJECTS):
        yield tuple(items[i : i + MAX_OBJECTS])


def make_put(
    items: Sequence[Object], duration: float | None
) -> Iterator[dict[str, objects.Object]]:
    """Yield objects by name, as many as fit in one message each. Raises ArgumentError, WireError before the first."""
    made: dict[str, objects.Object] = {}
    sizes: dict[str, int] = {}
    for i, item in enumerate(items):
        name = getattr(item, "name", None)
        if not name:
            raise ArgumentError(f"objects[{i}]", f"must be an object with a name, not {item!r}")
        if name in made:
            raise ArgumentError(f"objects[{i}]", f"must have a unique name, not {name!r} again")
        try:
            made[name] = to_wire(item, duration)
            sizes[name] = _size(made[name])
        except WireError as error:
            path = f"$.objects[{name}]{error.path.removeprefix('$')}"
            raise WireError(error.problem, path) from error
    batch: dict[str, objects.Object] = {}
    filled = 0
    for name, size in sizes.items():
        if len(batch) == MAX_OBJECTS or (batch and filled + size > MAX_MESSAGE_OBJECT_BYTES):
            yield batch
            batch, filled = {}, 0
        batch[name] = made[name]
        filled += size
    if batch:
        yield batch


def make_moves(
    poses: Mapping[str, Pose], motions: Mapping[str, Motion]
) -> Iterator[dict[str, Any]]:
    """Yield names, poses and velocities. Raises ArgumentError."""
    for name, pose in poses.items():
        check_kind(f"poses[{name!r}]", pose, Pose)
    for name, motion in motions.items():
        check_kind(f"motions[{name!r}]", motion, Motion)
        if name not in poses:
            raise ArgumentError(
                "motions", f"must belong to moved objects: {name!r} is not in `poses`"
            )
    for names in split_batches(list(poses)):
        at = [(*poses[name].position, *poses[name].rotation) for name in names]
        fields = {"names": names, "poses": pack(at)}
        if any(name in motions for name in names):
            fields["velocities"] = pack([_velocity(motions.get(name)) for name in names])
        yield fields


def make_hands(given: Sequence[Hand]) -> tuple[HandFrame, ...]:
    """Return tracked hands as wire fields. Raises ArgumentError."""
    return tuple(_hand(f"hands[{i}]", hand) for i, hand in enumerate(given))


def make_zones(given: Sequence[Zone]) -> tuple[commands.Zone, ...]:
    """Return quiet zones as wire fields. Raises ArgumentError."""
    for zone in given:
        check_kind("zones", zone, Zone)
    return tuple(
        commands.Zone(position=zone.position, pressure=zone.pressure, radius=zone.radius)
        for zone in given
    )


def make_points(given: ArrayLike) -> bytes:
    """Return points (K, 3) [m] as bytes. Raises ArgumentError."""
    array = check_numbers("points", given, (None, 3))
    if len(array) > MAX_POINTS:
        raise ArgumentError("points", f"must be at most {MAX_POINTS}, not {len(array)}")
    return pack(array)


def _size(item: objects.Object) -> int:
    """Return the size of an object in a message, without its name [bytes].

    Raises WireError if no message can hold it.
    """
    size = len(encode(item))
    if size > MAX_OBJECT_BYTES:
        raise WireError(f"is {size:,} bytes: keep to {MAX_OBJECT_BYTES:,}", "$")
    return size


def _velocity(motion: Motion | None) -> tuple[float, ...]:
    return (*motion.velocity, *motion.angular_velocity) if motion else (*STILL, *STILL)


def _hand(name: str, hand: Hand) -> HandFrame:
    check_kind(name, hand, Hand)
    if hand.lost:
        return HandFrame(side=hand.side, name=hand.name)
    if hand.joints is None:
        raise ArgumentError(name, "must have joints: meshes of hands are not sent")
    velocities = b""
    if (v := hand.velocities) is not None:
        velocities = pack(v[:1] if np.array_equal(v, np.broadcast_to(v[0], v.shape)) else v)
    return HandFrame(
        side=hand.side,
        name=hand.name,
        joints=pack(hand.joints),
        radii=b"" if hand.radii is RADII else pack(hand.radii),
        velocities=velocities,
    )
