"""A cache of distances from skin to objects, for skin that has hardly moved."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.native.scene import stale
from pacinian.scene.shapes.csg import Combination, Placed
from pacinian.scene.shapes.mesh import Mesh

if TYPE_CHECKING:
    from pacinian.scene.objects import Surface, Volume
    from pacinian.scene.sampling.posed_skin import PosedSkin
    from pacinian.types import Floats, Indices

CACHED_SHAPES = Mesh, Placed, Combination  # shapes whose distances are expensive enough to cache
NOWHERE = 1e6  # coordinate of points without a cached distance [m]
MAX_PAIRS = 16  # largest number of cached pairs of a hand and an object


class _Known:
    """Cached distances of one hand's points to one object [m], and where each point was then [m]."""

    def __init__(self, count: int) -> None:
        self.places = np.full((count, 3), NOWHERE)
        self.distance = np.zeros(count)


class DistanceCache:
    """Cached distances from the points of hands to surfaces and volumes."""

    def __init__(self) -> None:
        self._known: dict[tuple[object, ...], tuple[object, object, _Known]] = {}

    def of(
        self,
        item: Surface | Volume,
        name: int,
        hand: PosedSkin,
        which: Indices,
        local: Floats,
        beyond: float,
    ) -> Floats:
        """Return `item.distance` of the hand's points, (I,) [m], from the cache where that suffices.

        name: number that identifies this object for this hand. which: indices of the points, (I,). local: their
        positions in the object's frame, (I, 3) [m]. beyond: distances farther outside than this need not be exact [m],
        nor those below the depth of full pressure.
        """
        deep = item.material.compute_full_depth(item.pressure)
        if not isinstance(item.shape, CACHED_SHAPES):
            return item.distance(local, beyond, deep)
        known = self._of(item, name, hand)
        d, ask = np.empty(len(which)), np.empty(len(which), dtype=np.intp)
        count = stale(which, local, known.places, known.distance, beyond, deep, d, ask)
        if count:
            ask = ask[:count]
            points, asked = local[ask], which[ask]
            d[ask] = known.distance[asked] = item.distance(points, beyond, deep)
            known.places[asked] = points
        return d

    def _of(self, item: Surface | Volume, name: int, hand: PosedSkin) -> _Known:
        key = name, item.thickness, getattr(item, "felt", "")
        kept = self._known.pop(key, None)
        if kept is None or kept[0] is not item.shape or kept[1] is not hand.skin:
            while len(self._known) >= MAX_PAIRS:  # evict the least recently used pair
                del self._known[next(iter(self._known))]
            kept = item.shape, hand.skin, _Known(hand.skin.count)
        self._known[key] = kept
        return kept[2]
