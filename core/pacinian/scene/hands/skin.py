"""Points fixed on the skin of a hand: where they are at each pose, and how coarser levels share their forces."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.scene.hands.skin_lod import SPACINGS, gather_pressure, share_pressure

if TYPE_CHECKING:
    from pacinian.scene.hands.capsules import Nearest
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.hands.skin_lod import Between, SkinNodes
    from pacinian.types import Flags, Floats, Indices

CREASE = 5e-4  # a point deeper than this inside another part of the hand is not exposed [m]


class PosedPoints(NamedTuple):
    """The K points of a skin on a posed hand.

    points: (K, 3) [m]. normals: outward, (K, 3). area: of skin that each point represents, (K,) [m^2]. capsules: of the
    hand, (C, 8) [m]; empty for a mesh. bounds: centre and radius of the bounding sphere of each bone's points, (C, 4)
    [m].
    """

    points: Floats
    normals: Floats
    area: Floats
    capsules: Floats
    bounds: Floats


class Skin(ABC):
    """K points fixed on the skin of a kind of hand. They are ordered so that any first part is evenly spread.

    levels: spacing of the nodes of each level of detail at rest, fine to coarse, (9,) [m]. counts: number of points,
    from the first on, that are the nodes of each level, (9,). share: how the nodes of each level share the force of
    each point. bone: the capsule, or the patch of a mesh, to which each point belongs, (K,). hidden: whether a point is
    inside the flesh at rest, (K,). slack: depth inside other flesh down to which a point is still exposed, (K,) [m].
    surface, area: the points at rest, and the area that each represents, (K,) [m^2]. between: points between these,
    which are placed only where they are needed; None if there are none. bones_between, hidden_between: `bone` and
    `hidden` of these, (E,).
    """

    levels: Floats = SPACINGS
    between: Between | None = None
    bones_between: Indices
    hidden_between: Flags

    def __init__(
        self, surface: SkinNodes, apart: Floats, area: Floats, bone: Indices, hidden: Flags
    ) -> None:
        self.surface, self.area, self.bone, self.hidden = surface, area, bone, hidden
        self.slack = np.where(hidden, 0.0, CREASE)
        self.counts = tuple(int((apart >= spacing).sum()) for spacing in self.levels)
        self.share = tuple(
            share_pressure(surface, count, spacing)
            for count, spacing in zip(self.counts, self.levels.tolist(), strict=True)
        )

    def __len__(self) -> int:
        return len(self.area)

    @property
    def count(self) -> int:
        """Number of all points, those between the others included."""
        return len(self) + (0 if self.between is None else len(self.between.apart))

    @lru_cache(maxsize=64)  # noqa: B019  (skins are few and live long)
    def level(self, spacing: float) -> int:
        """Return the level whose spacing is nearest to `spacing` [m]."""
        return int(np.abs(np.log(self.levels / spacing)).argmin())

    @cached_property
    def node_area(self) -> tuple[Floats, ...]:
        """For each level, the area that each node represents at rest, (count,) [m^2]."""
        shown = np.where(self.hidden, 0.0, self.area)[:, None]
        coarser = zip(self.share[1:], self.counts[1:], strict=True)
        return self.area[: self.counts[0]], *(
            gather_pressure(indices.ravel(), (weights * shown).ravel(), count)
            for (indices, weights), count in coarser
        )

    @abstractmethod
    def place(self, hand: Hand) -> PosedPoints:
        """Place the points on a hand of this kind, which must not be lost."""

    @abstractmethod
    def place_between(
        self, hand: Hand, which: Indices, area: Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Place the points `which`, (I,), between the others; `area`: of each at rest, (I,) [m^2].

        Returns their positions, (I, 3) [m], outward normals, (I, 3), and the area that each represents now, (I,) [m^2].
        """

    @abstractmethod
    def find_exposed(self, placed: PosedPoints, which: Indices) -> Flags:
        """Return which of the points `which`, (I,), are no deeper inside other flesh than their slack: (I,)."""

    @abstractmethod
    def closest(self, hand: Hand, points: Floats) -> Nearest:
        """Find the nearest skin of the hand to points, (P, 3) [m]."""
