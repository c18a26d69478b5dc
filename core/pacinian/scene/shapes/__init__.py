"""Primitive shapes, and the samples of a shape's surface."""

from __future__ import annotations

from pacinian.scene.shapes.box_disc_rectangle import Box, Disc, Rectangle
from pacinian.scene.shapes.local_samples import LocalSamples
from pacinian.scene.shapes.sphere_capsule import Capsule, Sphere

__all__ = ["Box", "Capsule", "Disc", "LocalSamples", "Rectangle", "Sphere"]
