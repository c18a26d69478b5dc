"""A figure, and the file it goes to."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING

from pacinian.errors import MissingExtra

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

DPI = 130


def figure(width: float, height: float) -> Figure:
    """An empty figure, width x height [inch]. Raises MissingExtra."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingExtra("matplotlib", "plot") from error
    return Figure(figsize=(width, height), layout="constrained")


def save(page: Figure, path: str | Path, colours: int | None = None) -> None:
    """Write a figure to a file (PNG by its name); a PNG with so many colours only is a third as large."""
    if colours is None:
        page.savefig(path, dpi=DPI)
        return
    from PIL import Image

    buffer = BytesIO()
    page.savefig(buffer, dpi=DPI, format="png")
    Image.open(buffer).convert("RGB").quantize(colours, kmeans=3).save(path, "PNG", optimize=True)
