"""The hand's flesh as a union of tapered capsules, one around each bone and some that fill the palm.

Capsules that share a joint share its sphere, so that the skin of a straight finger has no steps.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.native import scene as kernels
from pacinian.scene.hands.bones import ENDS

if TYPE_CHECKING:
    from pacinian.scene.hands.hand import Hand
    from pacinian.types import Flags, Floats, Indices

MAX_SEARCH_STEPS = 1000  # largest number of steps from inside the union to its surface


class Nearest(NamedTuple):
    """The nearest skin to each of P points.

    points: on the skin, (P, 3) [m]. normals: outward normals of the skin there, (P, 3). distance: to the skin, negative
    inside, (P,) [m]. bone: the bone of that skin, (P,).
    """

    points: Floats
    normals: Floats
    distance: Floats
    bone: Indices


def make_capsules(hand: Hand) -> Floats:
    """Return a hand's C capsules, (C, 8) [m]: both ends of each axis, and the radius at each end.

    An end between two joints has the mean of their radii. Without joints, there are no capsules.
    """
    if hand.joints is None:
        return np.empty((0, 8))
    out = np.empty((len(ENDS), 8))
    kernels.capsules(hand.joints.copy(), hand.radii.copy(), ENDS, out)
    return out


def find_bounds(capsules: Floats) -> Floats:
    """Return the bounding sphere of each capsule: centre and radius, (C, 4) [m]."""
    out = np.empty((len(capsules), 4))
    kernels.bounds(capsules, out)
    return out


def distance_to_skin(capsules: Floats, points: Floats) -> Floats:
    """Return the signed distance of points, (P, 3), to the union of the capsules, (P,) [m]; negative inside.

    The distance is exact outside. Inside, it is the depth in the capsule in which the point is deepest, and the skin
    may be farther away.
    """
    return _found(capsules, points, 0).distance


def find_closest(capsules: Floats, points: Floats) -> Nearest:
    """Find the nearest skin of the union of the capsules to points, (P, 3).

    The result is exact outside. From inside, the search leaves the capsule in which the point is deepest, then the next
    one if it ends up inside another. If this does not end, the search goes straight on. The distance is that of
    `distance_to_skin`. From a point on an axis, where all directions are equal, the search picks one.
    """
    return _found(capsules, points, MAX_SEARCH_STEPS)


def _found(capsules: Floats, points: Floats, steps: int) -> Nearest:
    """Run `find_closest` with at most `steps` steps. With 0, only the distances are valid."""
    P = len(points)
    out = Nearest(np.empty((P, 3)), np.empty((P, 3)), np.empty(P), np.empty(P, dtype=np.intp))
    kernels.nearest(np.ascontiguousarray(capsules), np.ascontiguousarray(points), steps, *out)
    return out


def are_buried(
    capsules: Floats, points: Floats, bone: Indices, slack: Floats, which: Indices
) -> Flags:
    """Return whether each of the points `which`, (K,), lies inside a capsule, deeper than its slack: (K,).

    points: (P, 3) [m]. bone: each point's own capsule, which is ignored, (P,). slack: (P,) [m].
    """
    out = np.empty(len(which), dtype=np.bool_)
    kernels.buried(capsules, points, bone, slack, np.ascontiguousarray(which), out)
    return out
