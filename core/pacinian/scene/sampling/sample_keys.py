"""Keys of samples, which tell them apart from tick to tick: from numbers of objects, of contacts and of samples."""

from __future__ import annotations

import math
import zlib
from typing import TYPE_CHECKING

import numpy as np

from pacinian.scene.config_sections import MIN_SAMPLE_SPACING

if TYPE_CHECKING:
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.posed_skin import PosedSkin
    from pacinian.types import Indices, Longs

NUMBERS = 1 << 31  # every number is smaller than this, so that a sample's key fits into 64 bits


def number_object(item: Object, index: int) -> int:
    """Return the number of an object: it follows from the name, or is the `index` in the scene if it has none."""
    return zlib.crc32(item.name.encode()) % NUMBERS if item.name else index


def number_contact(number: int, hand: PosedSkin) -> int:
    """Return the number of what a hand touches of one object. number: of the object."""
    return (number + hand.salt) % NUMBERS


def make_keys(name: int, spacing: float, which: Indices) -> Longs:
    """Return the keys of samples, (K,), made of an object's number, the spacing and each sample's index.

    name: number of the object. spacing: [m]; 0 if the samples are the same at all spacings. which: indices, (K,).
    """
    level = 1 + round(2.0 * math.log2(spacing / MIN_SAMPLE_SPACING)) if spacing else 0
    return (name << 31) + (level << 25) + which.astype(np.int64)
