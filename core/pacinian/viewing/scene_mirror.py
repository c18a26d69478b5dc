"""A copy of the server's rendered scene. Each object is sent to a page once."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, NamedTuple

from pacinian.viewing.messages import SceneryMessage, encode_message

if TYPE_CHECKING:
    from collections.abc import Mapping

    from msgspec import Raw

_versions = itertools.count(1)
POSE = 28  # size of a pose, seven float32 [bytes]


class SceneMirror(NamedTuple):
    """A version of the scene. version: counts all changes. poses: by name.

    objects: by name, the version in which the object was new, and its encoding.
    """

    version: int = 0
    scene: str = ""
    objects: Mapping[str, tuple[int, Raw]] = {}
    poses: Mapping[str, bytes] = {}

    def with_(
        self, scene: str, objects: Mapping[str, Raw], poses: Mapping[str, bytes]
    ) -> SceneMirror:
        """Return the scene with new objects and these poses, or `self` if nothing changed.

        Objects without a pose are removed.
        """
        if not objects and poses == self.poses and scene == self.scene:
            return self
        version = next(_versions)
        kept = self.objects
        if objects or kept.keys() - poses.keys():
            kept = {name: known for name, known in kept.items() if name in poses}
            kept |= {name: (version, data) for name, data in objects.items()}
        return SceneMirror(version, scene, kept, poses)

    def encode(self, since: int) -> tuple[str, bytes]:
        """Return kind and message for a page that has version `since`: "scenery", or "poses" if no object is new."""
        new = {name: data for name, (version, data) in self.objects.items() if version > since}
        scene, poses = self.scene, dict(self.poses)
        message = SceneryMessage(version=self.version, scene=scene, objects=new, poses=poses)
        return "scenery" if new else "poses", encode_message(message)
