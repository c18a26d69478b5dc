"""Points fixed on the skin of a hand: where each is now, and what they share when fewer are wanted."""

from __future__ import annotations

from abc import ABC, abstractmethod
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.scene.hands.skin_lod import SPACINGS, gather_pressure, share_pressure

if TYPE_CHECKING:
    from pacinian.scene.hands.capsules import Nearest
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.hands.skin_lod import SkinNodes
    from pacinian.types import Flags, Floats, Indices

CREASE = 5e-4  # [m]; what lies deeper within another part of the hand is not skin


class Placed(NamedTuple):
    """A skin's K points now.

    points: (K, 3) [m]. normals: outward, (K, 3). area: of the skin that each stands for, (K,) [m^2].
    capsules: of the hand, (C, 8) [m]; none if it is a mesh. bounds: spheres around each bone's points, a
    centre and a radius, (C, 4) [m].
    """

    points: Floats
    normals: Floats
    area: Floats
    capsules: Floats
    bounds: Floats


class Skin(ABC):
    """K points fixed on a kind of hand, in an order of which every beginning is evenly spread.

    levels: how far apart the nodes of each level are at rest, fine to coarse, (9,) [m]. counts: how many
    points from the first on are its nodes, (9,). share: what each point gives to a level's nodes. bone:
    the capsule, or the patch of a mesh, that each point is of, (K,). hidden: whether it is inside of the flesh
    at rest, (K,). slack: how deep inside of other flesh each is skin still, (K,) [m]. surface, area: the points, and
    the area that each stands for, (K,) [m^2], at rest.
    """

    levels: Floats = SPACINGS

    def __init__(
        self, surface: SkinNodes, apart: Floats, area: Floats, bone: Indices, hidden: Flags
    ) -> None:
        self.surface, self.area, self.bone, self.hidden = surface, area, bone, hidden
        self.slack = np.where(hidden, 0.0, CREASE)
        self.counts = tuple(int((apart >= spacing).sum()) for spacing in self.levels)
        self.share = tuple(share_pressure(surface, count) for count in self.counts)

    def __len__(self) -> int:
        return len(self.area)

    @lru_cache(maxsize=64)  # noqa: B019  (skins are few and kept)
    def level(self, spacing: float) -> int:
        """The level whose nodes are nearest to `spacing` [m] apart."""
        return int(np.abs(np.log(self.levels / spacing)).argmin())

    @cached_property
    def node_area(self) -> tuple[Floats, ...]:
        """For each level, the area at rest that each node stands for, (count,) [m^2]."""
        shown = np.where(self.hidden, 0.0, self.area)[:, None]
        coarser = zip(self.share[1:], self.counts[1:], strict=True)
        return self.area[: self.counts[0]], *(
            gather_pressure(indices.ravel(), (weights * shown).ravel(), count)
            for (indices, weights), count in coarser
        )

    @cached_property
    def of_bone(self) -> tuple[Indices, ...]:
        """The points of each bone, in their order."""
        return tuple(np.flatnonzero(self.bone == c) for c in range(int(self.bone.max()) + 1))

    @abstractmethod
    def place(self, hand: Hand) -> Placed:
        """Where the points are on a hand of this kind, which is not lost."""

    @abstractmethod
    def exposed(self, placed: Placed, which: Indices) -> Flags:
        """Which of the points `which`, (I,), are not deeper inside of other flesh than their slack, (I,)."""

    @abstractmethod
    def closest(self, hand: Hand, points: Floats) -> Nearest:
        """The hand's nearest skin to points, (P, 3) [m]."""


def skin_of(hand: Hand) -> Skin:
    """The skin of a hand's kind, built when first asked for.

    All hands of joints are of one kind, left and right; meshes are of one kind if their faces are the
    same, and the first of them gives the rest pose: it must not be lost.
    """
    return _skin(_Kind(hand))


class _Kind:
    """What hands that have the same skin have in common."""

    def __init__(self, hand: Hand) -> None:
        self.hand, self.key = hand, None if hand.faces is None else hand.faces.tobytes()

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Kind) and self.key == other.key


@lru_cache(maxsize=8)
def _skin(kind: _Kind) -> Skin:
    from pacinian.scene.hands.capsule_skin import CapsuleSkin
    from pacinian.scene.hands.mesh_skin import MeshSkin

    return CapsuleSkin() if kind.key is None else MeshSkin(kind.hand)
