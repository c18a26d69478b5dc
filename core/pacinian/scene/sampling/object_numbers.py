"""Numbers of objects and of contacts, which tell their samples apart from tick to tick."""

from __future__ import annotations

import zlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.posed_skin import PosedSkin

NUMBERS = 1 << 31  # every number is smaller than this, so that a sample's key fits into 64 bits


def number_object(item: Object, index: int) -> int:
    """Return the number of an object: it follows from the name, or is the `index` in the scene if it has none."""
    return zlib.crc32(item.name.encode()) % NUMBERS if item.name else index


def number_contact(number: int, hand: PosedSkin) -> int:
    """Return the number of what a hand touches of one object. number: of the object."""
    return (number + hand.salt) % NUMBERS
