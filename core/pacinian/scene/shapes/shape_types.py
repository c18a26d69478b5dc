"""The shapes that surfaces and volumes may have, and the distance of points from any of them."""

from __future__ import annotations

from pacinian.scene.shapes import Disc, Rectangle, Sphere
from pacinian.scene.shapes.csg import SOLIDS, SolidShape, check_closed, distance
from pacinian.scene.shapes.height_map import HeightMap
from pacinian.scene.shapes.mesh import Mesh

__all__ = ["SHELLS", "SOLIDS", "Shell", "SolidShape", "check_closed", "distance"]

Shell = Rectangle | Disc | Sphere | HeightMap | Mesh
SHELLS = Rectangle, Disc, Sphere, HeightMap, Mesh
