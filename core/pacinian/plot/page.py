"""Creates figures and panels, and saves them."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pacinian.argument_checks import check_integer, check_number
from pacinian.atomic_file import replace_file
from pacinian.errors import ArgumentError, MissingExtra
from pacinian.plot.style import COLUMN

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from pacinian.plot.style import Panel

DPI = 130  # [1/inch]
MAX_SIDE = 400.0  # largest side that PNG writers accept [inch]
FONTS: Any = {"pdf.fonttype": 42, "ps.fonttype": 42, "svg.fonttype": "none"}  # text stays text


def require() -> type[Figure]:
    """Import Matplotlib's figure module. Raises MissingExtra if Matplotlib is not installed."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingExtra("matplotlib", "plot") from error
    return Figure


def figure(width: float = COLUMN, height: float = 2.6) -> Figure:
    """Create an empty figure, width x height [inch], that notebooks show. Raises ArgumentError, MissingExtra."""
    require()
    for name, side in (("width", width), ("height", height)):
        check_number(name, side, low=0.1, high=MAX_SIDE)
    from pacinian.plot.notebook_figure import NotebookFigure

    return NotebookFigure(figsize=(width, height), layout="constrained", dpi=DPI)


def set_title(page: Figure, text: str, **style: Any) -> None:
    """Set the title of a figure, which may be the name of a file. A long title is broken at its spaces.

    Characters that the locale or Unicode lacks are drawn as U+FFFD, and dollar signs as they are.
    """
    # Matplotlib measures a wrapped text as mathematics even with parse_math=False, but not if its dollars are escaped.
    page.suptitle(make_printable(text).replace("$", r"\$"), wrap=True, **style)


def make_printable(text: str) -> str:
    """Return a text without lone surrogates, which fonts cannot draw.

    Python puts them into the name of a file in place of bytes that the locale cannot decode. If these bytes are UTF-8,
    they are decoded; otherwise U+FFFD replaces them.
    """
    try:
        data = text.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError:  # other surrogates
        data = text.encode("utf-8", "replace")
    return data.decode("utf-8", "replace")


def panels(
    ax: Panel | Sequence[Panel] | None, heights: Sequence[float]
) -> tuple[Figure, list[Panel], bool]:
    """Return the axes to draw into, one for each height [inch], their figure, and whether the figure is new.

    ax: one, or as many as there are heights; None for a new figure as wide as a paper's column. Raises ArgumentError.
    """
    count = len(heights)
    if ax is None:
        page = figure(COLUMN, sum(heights))
        made = page.subplots(count, 1, height_ratios=list(heights), squeeze=False)
        return page, list(made.flat), True
    given: list[Panel] = list(ax) if hasattr(ax, "__iter__") else [ax]
    if len(given) != count or not all(hasattr(one, "imshow") for one in given):
        raise ArgumentError("ax", f"must be Matplotlib's axes, {count} of them")
    return given[0].get_figure(root=True), given, False


def save(page: Figure, path: str | Path, colours: int | None = None) -> None:
    """Write a figure to a file; the extension selects the format: .pdf, .svg, .png, ...

    If it cannot be written, an earlier file stays as it was. Text in vector files stays text. colours: of a PNG, 2 to
    256; a small number makes the file a third as large, but shows steps in a field. Raises ArgumentError, MissingExtra,
    OSError.
    """
    require()
    from matplotlib import rc_context

    known = page.canvas.get_supported_filetypes()
    if (kind := Path(path).suffix[1:].lower()) not in known:
        raise ArgumentError("path", f"must end in one of {', '.join(sorted(known))}, not {kind!r}")
    if colours is None:
        with rc_context(FONTS), replace_file(Path(path)) as file:
            page.savefig(file, dpi=DPI, format=kind)
        return
    if kind != "png" or not 2 <= check_integer("colours", colours, low=2) <= 256:
        raise ArgumentError("colours", "must be 2 to 256, and only of a .png")
    from PIL import Image

    buffer = BytesIO()
    page.savefig(buffer, dpi=DPI, format="png")
    picture = Image.open(buffer).convert("RGB").quantize(colours, kmeans=3)
    with replace_file(Path(path)) as file:
        picture.save(file, "PNG", optimize=True)
