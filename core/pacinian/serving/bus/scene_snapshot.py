"""Snapshots of the rendered scene for observers. One reply never holds more than the bus has time for."""

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

MAX_SNAPSHOT_BYTES = (
    1 << 18
)  # size limit of the objects in one reply, unless a single one is larger [bytes]
# Largest size of what a reply contains besides names, poses and objects, and of the prefix of a name or object [bytes].
HEAD_BYTES, NAME_BYTES = 512, 4

_encoder = Encoder()


def make_snapshot(scene: SharedScene | None, asked: Show) -> Shown:
    """Return the new objects of a scene, and all poses. Raises WireError."""
    if not asked.id:
        raise WireError("must not be 0, because a snapshot needs an answer", "$.id")
    if scene is None:
        return Shown(id=asked.id, scene="", version=0, names=(), poses=b"", objects={})
    since = asked.since if asked.scene == scene.name else 0
    stored_objects = list(islice(scene.objects.values(), MAX_SHOWN))
    names = tuple(stored.name for stored in stored_objects)
    poses = b"".join([stored.encode_pose() for stored in stored_objects])
    taken = HEAD_BYTES + len(poses) + sum(NAME_BYTES + len(name.encode()) for name in names)
    new = sorted((t for t in stored_objects if t.number > since), key=lambda t: t.number)
    objects, version = _encode_objects(new, MAX_REPLY_BYTES - taken)
    return Shown(
        id=asked.id, scene=scene.name, version=max(since, version), names=names, poses=poses,
        objects=objects,
    )  # fmt: skip


def _encode_objects(stored_objects: list[StoredObject], most: int) -> tuple[dict[str, Object], int]:
    """Encode as many objects as fit in `most` [bytes]; return them, and the number of the last."""
    made: dict[str, Raw] = {}
    size, version = 0, 0
    for stored in stored_objects:
        data = _encoder.encode(stored.sent)
        more = len(data) + len(stored.name.encode()) + 2 * NAME_BYTES
        if made and size + more > min(MAX_SNAPSHOT_BYTES, most):
            break
        if more <= most:
            made[stored.name] = Raw(data)
            size += more
        version = stored.number
    return cast("dict[str, Object]", made), version
