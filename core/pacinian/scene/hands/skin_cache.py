"""The skin of each kind of hand, built once."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from pacinian.scene.hands.capsule_skin import CapsuleSkin
from pacinian.scene.hands.mesh_skin import MeshSkin

if TYPE_CHECKING:
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.hands.skin import Skin

MAX_SKINS = 8  # largest number of skins that are kept

_skins: dict[bytes | None, Skin] = {}  # the one used last is the last
_lock = threading.RLock()


def get_skin(hand: Hand) -> Skin:
    """Return the skin of a hand's kind, which is built at first use, in up to a second.

    The first mesh of a kind gives the rest pose, so it must not be lost. Raises ArgumentError.
    """
    kind = find_kind(hand)
    with _lock:
        skin = _skins.pop(kind, None)
        if skin is None:
            skin = CapsuleSkin(finely=True) if kind is None else MeshSkin(hand)
        _skins[kind] = skin
        while len(_skins) > MAX_SKINS:
            del _skins[next(iter(_skins))]
    return skin


def is_built(kind: bytes | None) -> bool:
    """Return whether the skin of a kind of hand is built."""
    return kind in _skins


def find_kind(hand: Hand) -> bytes | None:
    """Return the kind of a hand, whose hands have one skin.

    All hands made of joints are of one kind, None, left and right. Meshes are of one kind if their faces are the same.
    """
    return None if hand.faces is None else hand.faces.tobytes()
