"""Which shapes surfaces and volumes may have, and how far points are from any of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.scene.shapes import Disc, Rectangle, Sphere
from pacinian.scene.shapes.csg import SOLIDS, Combination, Placed, SolidShape, check_closed
from pacinian.scene.shapes.height_map import HeightMap
from pacinian.scene.shapes.mesh import Mesh

if TYPE_CHECKING:
    from pacinian.types import Floats

__all__ = ["SHELLS", "SOLIDS", "Shell", "SolidShape", "check_closed", "distance"]

Shell = Rectangle | Disc | Sphere | HeightMap | Mesh
SHELLS = Rectangle, Disc, Sphere, HeightMap, Mesh


def distance(shape: Shell | SolidShape, points: Floats, beyond: float, deep: float) -> Floats:
    """Signed distance of points, (K, 3), to a shape, (K,) [m], in its own frame; negative inside or behind.

    beyond, deep: farther outside or inside than these [m] it need not be exact.
    """
    if isinstance(shape, (Mesh, Placed, Combination)):
        return shape.distance(points, beyond, deep)
    return shape.distance(points)
