"""The primitive shapes, and the samples that cover a shape."""

from __future__ import annotations

from pacinian.scene.shapes.flat import Box, Disc, Rectangle
from pacinian.scene.shapes.local import LocalSamples
from pacinian.scene.shapes.round import Capsule, Sphere

__all__ = ["Box", "Capsule", "Disc", "LocalSamples", "Rectangle", "Sphere"]
