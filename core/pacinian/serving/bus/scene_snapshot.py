"""What is in the scene that is felt, for those who look on: never more in one answer than the bus has time for."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING, cast

from msgspec import Raw
from msgspec.msgpack import Encoder

from pacinian.errors import WireError
from pacinian.wire.protocol import MAX_REPLY_BYTES, MAX_SHOWN
from pacinian.wire.replies import Shown

if TYPE_CHECKING:
    from pacinian.serving.bus.shared_scene import SharedScene
    from pacinian.serving.bus.stored_object import StoredObject
    from pacinian.wire.commands import Show
    from pacinian.wire.objects import Object

FULL = 1 << 18  # [bytes] of objects in one answer, but for a single one that is larger
HEAD, NAMED = 512, 4  # [bytes] of an answer, and before a name or object, at most

_encoder = Encoder()


def make_snapshot(room: SharedScene | None, asked: Show) -> Shown:
    """What is new of a scene, and all poses. Raises WireError."""
    if not asked.id:
        raise WireError("must not be 0: a scene is asked for its answer", "$.id")
    if room is None:
        return Shown(id=asked.id, scene="", version=0, names=(), poses=b"", objects={})
    since = asked.since if asked.scene == room.name else 0
    things = list(islice(room.objects.values(), MAX_SHOWN))
    names = tuple(thing.name for thing in things)
    poses = b"".join([thing.pose() for thing in things])
    taken = HEAD + len(poses) + sum(NAMED + len(name.encode()) for name in names)
    new = sorted((t for t in things if t.number > since), key=lambda t: t.number)
    objects, version = _objects(new, MAX_REPLY_BYTES - taken)
    return Shown(
        id=asked.id, scene=room.name, version=max(since, version), names=names, poses=poses,
        objects=objects,
    )  # fmt: skip


def _objects(things: list[StoredObject], most: int) -> tuple[dict[str, Object], int]:
    """The first of these, encoded, so many as have room in `most` [bytes]; and the number of the last."""
    made: dict[str, Raw] = {}
    size, version = 0, 0
    for thing in things:
        data = _encoder.encode(thing.sent)
        more = len(data) + len(thing.name.encode()) + 2 * NAMED
        if made and size + more > min(FULL, most):
            break
        if more <= most:
            made[thing.name] = Raw(data)
            size += more
        version = thing.number
    return cast("dict[str, Object]", made), version
