"""Pictures. Needs Matplotlib: `pip install "pacinian[plot]"`; works without a display."""

from __future__ import annotations

from pacinian.plot.page import figure, save
from pacinian.plot.planes import slices
from pacinian.plot.scenes import scene

__all__ = ["figure", "save", "scene", "slices"]
