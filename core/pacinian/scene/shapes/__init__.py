"""The primitive shapes, and the samples that cover a shape."""

from __future__ import annotations

from pacinian.scene.shapes.local_samples import LocalSamples
from pacinian.scene.shapes.planar import Box, Disc, Rectangle
from pacinian.scene.shapes.sphere_capsule import Capsule, Sphere

__all__ = ["Box", "Capsule", "Disc", "LocalSamples", "Rectangle", "Sphere"]
