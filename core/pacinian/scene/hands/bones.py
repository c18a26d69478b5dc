"""The bones of a hand, and the lines that fill its palm, as lines between its joints."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np


class Bone(NamedTuple):
    """A line between two ends. Each end is the middle of two joints, or one joint given twice.

    parent: the bone whose frame this one moves with, -1 for the palm. finger: 1 to 5, from the thumb on, for bones that
    are free of the palm, else 0.
    """

    base: tuple[int, int]
    tip: tuple[int, int]
    parent: int = -1
    finger: int = 0


def _hand() -> list[Bone]:
    bones = [Bone((2, 2), (3, 3)), Bone((3, 3), (4, 4), 0, 1), Bone((4, 4), (5, 5), 1, 1)]
    for finger, metacarpal in enumerate((6, 11, 16, 21), 2):
        chain = [(joint, joint) for joint in range(metacarpal, metacarpal + 5)]
        bones.append(Bone(chain[0], chain[1]))
        for base, tip in pairwise(chain[1:]):
            bones.append(Bone(base, tip, len(bones) - 1, finger))
    between = [(joint, joint + 5) for joint in (6, 11, 16)]
    bones += [Bone(pair, (pair[0] + 1, pair[1] + 1)) for pair in between]  # between the metacarpals
    bones += [Bone((1, 1), (joint, joint)) for joint in (2, 6, 11, 21)]  # the wrist
    return [*bones, Bone((2, 3), (6, 7))]  # the web of the thumb


BONES = _hand()
ENDS = np.array([bone.base + bone.tip for bone in BONES], dtype=np.intp)
"""The two joints of each end of each bone, (C, 4)."""
PARENTS = np.array([bone.parent for bone in BONES], dtype=np.intp)
FINGERS = np.array([bone.finger for bone in BONES], dtype=np.intp)
