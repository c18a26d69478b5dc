"""The hand's flesh as a union of tapered capsules, one around each bone and some that fill the palm.

Two that share a joint share its sphere, so that the skin of a straight finger has no steps.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.native import scene as kernels
from pacinian.scene.hands.bones import ENDS

if TYPE_CHECKING:
    from pacinian.scene.hands.hand import Hand
    from pacinian.types import Flags, Floats, Indices

SEARCH = 1000  # steps from inside of the union to its surface


class Nearest(NamedTuple):
    """The nearest skin to each of P points.

    points: on the skin, (P, 3) [m]. normals: its outward normals there, (P, 3). distance: to the skin,
    negative inside, (P,) [m]. bone: whose skin, (P,).
    """

    points: Floats
    normals: Floats
    distance: Floats
    bone: Indices


def make_capsules(hand: Hand) -> Floats:
    """A hand's C capsules, (C, 8) [m]: both ends of the axis, and the radius at either, the mean of its joints'."""
    if hand.joints is None:
        return np.empty((0, 8))
    out = np.empty((len(ENDS), 8))
    kernels.capsules(hand.joints.copy(), hand.radii.copy(), ENDS, out)
    return out


def find_bounds(capsules: Floats) -> Floats:
    """A sphere around each capsule: its centre and radius, (C, 4) [m]."""
    out = np.empty((len(capsules), 4))
    kernels.bounds(capsules, out)
    return out


def distance_to_skin(capsules: Floats, points: Floats) -> Floats:
    """Signed distance of points, (P, 3), to the union of the capsules, (P,) [m]; negative inside.

    Exact outside; inside it is the depth within the capsule that the point is deepest in, and the skin
    may be further away.
    """
    return _found(capsules, points, 0).distance


def find_closest(capsules: Floats, points: Floats) -> Nearest:
    """The nearest skin of the union of the capsules to points, (P, 3).

    Exact outside. From inside, the way goes out of the capsule that the point is deepest in, and on out
    of the next if that ends in another; if that goes round in circles, straight on. The distance is as of
    `distance_to_skin`. From an axis, where all ways are the same, it goes to some side.
    """
    return _found(capsules, points, SEARCH)


def _found(capsules: Floats, points: Floats, steps: int) -> Nearest:
    """`find_closest` in at most so many steps; with 0 the distances alone are to be used."""
    P = len(points)
    out = Nearest(np.empty((P, 3)), np.empty((P, 3)), np.empty(P), np.empty(P, dtype=np.intp))
    kernels.nearest(np.ascontiguousarray(capsules), np.ascontiguousarray(points), steps, *out)
    return out


def are_buried(
    capsules: Floats, points: Floats, bone: Indices, slack: Floats, which: Indices
) -> Flags:
    """Whether each of the points `which`, (K,), lies inside of a capsule, deeper than its slack, (K,).

    points: (P, 3). bone: each point's own capsule, which does not count, (P,). slack: (P,) [m].
    """
    out = np.empty(len(which), dtype=np.bool_)
    kernels.buried(capsules, points, bone, slack, np.ascontiguousarray(which), out)
    return out
