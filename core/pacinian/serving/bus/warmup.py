"""Warm-up: loads libraries before clients connect, because the first use is slow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.propagation import field
from pacinian.wire.convert import to_scene
from pacinian.wire.objects import Surface
from pacinian.wire.shapes import Mesh

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array

CORNERS = ((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0))  # corners of a triangle [m]


def warm_up(array: Array, medium: Air) -> None:
    """Compute a field and convert a mesh once."""
    above = array.centre + np.array([[0.0, 0.0, 0.2]])
    field(array, np.zeros(len(array), np.complex64), above, medium)
    vertices, faces = np.array(CORNERS, "<f4"), np.array([0, 1, 2], "<u4")
    shape = Mesh(vertices=vertices.tobytes(), faces=faces.tobytes())
    to_scene("warm", Surface(radiation_pressure=1.0, shape=shape))
