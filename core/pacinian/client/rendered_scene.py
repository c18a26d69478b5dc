"""The rendered scene as its server shows it, kept from one reply to the next."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, TypeVar

from msgspec.structs import replace

from pacinian.acoustics.pose import Pose
from pacinian.scene.objects import Point
from pacinian.wire.binary_arrays import unpack
from pacinian.wire.convert import to_scene

if TYPE_CHECKING:
    from collections.abc import Mapping
    from collections.abc import Set as Names

    from pacinian.scene.objects import Object
    from pacinian.wire.objects import Object as SentObject
    from pacinian.wire.replies import Shown


T = TypeVar("T")


class RenderedScene:
    """Objects and newest poses. scene, version: for the next request of `show`, which then sends only what is new."""

    def __init__(self) -> None:
        self.scene, self.version = "", 0
        self._sent: dict[str, SentObject] = {}  # not converted yet
        self._made: dict[str, Object] = {}
        self._poses: dict[str, list[float]] = {}

    def update(self, shown: Shown) -> None:
        """Take over a reply: new objects, and all poses. Objects without a pose are gone."""
        if shown.scene != self.scene:
            self._sent, self._made = {}, {}
        self.scene, self.version = shown.scene, shown.version
        self._poses = dict(zip(shown.names, unpack(shown.poses, 7).tolist(), strict=True))
        self._sent |= shown.objects
        self._made = _keep(self._made, self._poses.keys() - shown.objects.keys())
        self._sent = _keep(self._sent, self._poses.keys())

    @property
    def objects(self) -> list[Object]:
        """The objects where they are now. Objects that cannot be converted are left out."""
        for name, item in self._sent.items():
            with suppress(ValueError):
                self._made[name] = to_scene(name, item)
        self._sent = {}
        return [_place(item, self._poses[name]) for name, item in self._made.items()]


def _keep(items: Mapping[str, T], names: Names[str]) -> dict[str, T]:
    return {name: item for name, item in items.items() if name in names}


def _place(item: Object, row: list[float]) -> Object:
    """Return the object at a pose: position [m], rotation (x, y, z, w)."""
    x, y, z, *rotation = row
    if isinstance(item, Point):
        return replace(item, position=(x, y, z))
    i, j, k, w = rotation
    return replace(item, pose=Pose((x, y, z), (i, j, k, w)))
