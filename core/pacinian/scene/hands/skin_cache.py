"""The skin of each kind of hand, built once."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from pacinian.scene.hands.capsule_skin import CapsuleSkin
from pacinian.scene.hands.mesh_skin import MeshSkin

if TYPE_CHECKING:
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.hands.skin import Skin


def get_skin(hand: Hand) -> Skin:
    """Return the skin of a hand's kind, which is built at first use.

    All hands made of joints are of one kind, left and right. Meshes are of one kind if their faces are the same. The
    first mesh of a kind gives the rest pose, so it must not be lost.
    """
    return _make_skin(_Kind(hand))


class _Kind:
    """Cache key that is equal for all hands with the same skin."""

    def __init__(self, hand: Hand) -> None:
        self.hand, self.key = hand, None if hand.faces is None else hand.faces.tobytes()

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Kind) and self.key == other.key


@lru_cache(maxsize=8)
def _make_skin(kind: _Kind) -> Skin:
    return CapsuleSkin(finely=True) if kind.key is None else MeshSkin(kind.hand)
