"""Distances of skin to objects, remembered: what has hardly moved need not be asked again."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.scene.shapes.csg import Combination, Placed
from pacinian.scene.shapes.mesh import Mesh

if TYPE_CHECKING:
    from pacinian.scene.objects import Surface, Volume
    from pacinian.scene.sampling.posed_skin import PosedSkin
    from pacinian.types import Floats, Indices

DEAR = Mesh, Placed, Combination  # shapes that take longer to ask than to remember
NOWHERE = 1e6  # [m]
MAX_PAIRS = 16  # pairs of a hand and an object


class _Known:
    """What was asked of one object for one hand's points: where each was [m], and its distance [m]."""

    def __init__(self, count: int) -> None:
        self.places = np.full((count, 3), NOWHERE)
        self.distance = np.zeros(count)


class DistanceCache:
    """Of hands' points to surfaces and volumes."""

    def __init__(self) -> None:
        self._known: dict[tuple[object, ...], tuple[object, object, _Known]] = {}

    def of(
        self, item: Surface | Volume, name: int, hand: PosedSkin, which: Indices, local: Floats,
        beyond: float, deep: float,
    ) -> Floats:  # fmt: skip
        """As `item.distance` of the hand's points `which`, (I,), in its frame at `local`, (I, 3) [m]: (I,).

        name: of this object for this hand.
        """
        from pacinian.native.scene import stale

        if not isinstance(item.shape, DEAR):
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
            while len(self._known) >= MAX_PAIRS:  # the pair that was not asked for longest
                del self._known[next(iter(self._known))]
            kept = item.shape, hand.skin, _Known(len(hand.points))
        self._known[key] = kept
        return kept[2]
