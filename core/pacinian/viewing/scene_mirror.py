"""The objects of the scene that is felt, as they come from the server: each is told to a page once."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, NamedTuple

from pacinian.viewing.messages import SceneryMessage, encode_message

if TYPE_CHECKING:
    from collections.abc import Mapping

    from msgspec import Raw

_versions = itertools.count(1)
POSE = 28  # [bytes] of seven float32


class SceneMirror(NamedTuple):
    """What is there. version: counts all changes. objects: by name, since which version, encoded. poses: by name."""

    version: int = 0
    scene: str = ""
    objects: Mapping[str, tuple[int, Raw]] = {}
    poses: Mapping[str, bytes] = {}

    def with_(
        self, scene: str, objects: Mapping[str, Raw], poses: Mapping[str, bytes]
    ) -> SceneMirror:
        """With what is new, in these poses; objects that have none are gone. The same if nothing has changed."""
        if not objects and poses == self.poses and scene == self.scene:
            return self
        version = next(_versions)
        kept = self.objects
        if objects or kept.keys() - poses.keys():
            kept = {name: known for name, known in kept.items() if name in poses}
            kept |= {name: (version, data) for name, data in objects.items()}
        return SceneMirror(version, scene, kept, poses)

    def told(self, since: int) -> tuple[str, bytes]:
        """For one who was told `since`: "scenery", or "poses" where no object is new; and the message."""
        new = {name: data for name, (version, data) in self.objects.items() if version > since}
        scene, poses = self.scene, dict(self.poses)
        message = SceneryMessage(version=self.version, scene=scene, objects=new, poses=poses)
        return "scenery" if new else "poses", encode_message(message)
