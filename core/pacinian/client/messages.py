"""What users give, as the wire's fields, in batches that fit into one message each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from pacinian.acoustics.pose import Pose
from pacinian.checks import check_kind, check_numbers
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

FULL = 900_000  # [bytes] of objects in one message
MAX_OBJECT_BYTES = (
    MAX_COMMAND_BYTES - 1024
)  # [bytes] of one object: the rest is for the command's other fields


def split_batches(items: Sequence[T]) -> Iterator[tuple[T, ...]]:
    """Parts of a sequence, as many as fit into one message each."""
    for i in range(0, len(items), MAX_OBJECTS):
        yield tuple(items[i : i + MAX_OBJECTS])


def make_put(
    items: Sequence[Object], duration: float | None
) -> Iterator[dict[str, objects.Object]]:
    """Objects by name, so many that a message has room. Raises ArgumentError, WireError before the first."""
    made: dict[str, objects.Object] = {}
    sizes: dict[str, int] = {}
    for i, item in enumerate(items):
        name = getattr(item, "name", None)
        if not name:
            raise ArgumentError(f"objects[{i}]", f"must be an object with a name, not {item!r}")
        if name in made:
            raise ArgumentError(f"objects[{i}]", f"must have a name of its own, not {name!r} again")
        try:
            made[name] = to_wire(item, duration)
            sizes[name] = _size(made[name])
        except WireError as error:
            path = f"$.objects[{name}]{error.path.removeprefix('$')}"
            raise WireError(error.problem, path) from error
    batch: dict[str, objects.Object] = {}
    filled = 0
    for name, size in sizes.items():
        if len(batch) == MAX_OBJECTS or (batch and filled + size > FULL):
            yield batch
            batch, filled = {}, 0
        batch[name] = made[name]
        filled += size
    if batch:
        yield batch


def make_moves(
    poses: Mapping[str, Pose], motions: Mapping[str, Motion]
) -> Iterator[dict[str, Any]]:
    """Names, poses and velocities. Raises ArgumentError."""
    for name, pose in poses.items():
        check_kind(f"poses[{name!r}]", pose, Pose)
    for name, motion in motions.items():
        check_kind(f"motions[{name!r}]", motion, Motion)
        if name not in poses:
            raise ArgumentError("motions", f"must be of what is moved: {name!r} is not in `poses`")
    for names in split_batches(list(poses)):
        at = [(*poses[name].position, *poses[name].rotation) for name in names]
        fields = {"names": names, "poses": pack(at)}
        if any(name in motions for name in names):
            fields["velocities"] = pack([_velocity(motions.get(name)) for name in names])
        yield fields


def make_hands(given: Sequence[Hand]) -> tuple[HandFrame, ...]:
    """Hands as they are tracked. Raises ArgumentError."""
    return tuple(_hand(f"hands[{i}]", hand) for i, hand in enumerate(given))


def make_zones(given: Sequence[Zone]) -> tuple[commands.Zone, ...]:
    """Balls that are to stay quiet. Raises ArgumentError."""
    for zone in given:
        check_kind("zones", zone, Zone)
    return tuple(
        commands.Zone(position=zone.position, pressure=zone.pressure, radius=zone.radius)
        for zone in given
    )


def make_points(given: ArrayLike) -> bytes:
    """Points (K, 3) [m]. Raises ArgumentError."""
    array = check_numbers("points", given, (None, 3))
    if len(array) > MAX_POINTS:
        raise ArgumentError("points", f"must be at most {MAX_POINTS}, not {len(array)}")
    return pack(array)


def _size(item: objects.Object) -> int:
    """Of an object in a message, without its name [bytes]. Raises WireError if it is too large for any."""
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
