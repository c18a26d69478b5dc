"""Animates a slice of the field over time: GIF, WebP, animated PNG or MP4."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.argument_checks import check_number
from pacinian.errors import ArgumentError
from pacinian.plot.emissions import Emission, Run, collect_emission
from pacinian.plot.fields import fit_column
from pacinian.plot.outlines import draw_outlines, find_pose
from pacinian.plot.page import DPI, figure
from pacinian.plot.planes import Plane, cut, draw, middle_of
from pacinian.plot.quantities import (
    QUANTITIES,
    compute_colour_limits,
    compute_quantity,
    find_distant_points,
)
from pacinian.plot.style import COLUMN, bar, dress

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.acoustics.pose import Pose
    from pacinian.plot.quantities import Show
    from pacinian.types import ArrayLike, Floats

MAX_PICTURES = 1000  # pictures of one animation; more fill the memory
MAX_MOMENTS = 8  # rows whose mean one picture shows
COARSE = 2  # the grid is this many times coarser than that of a single picture
QUALITY = 80  # of WebP
PILLOW = ".gif", ".webp", ".png"
KINDS = *PILLOW, ".mp4"


def animate(
    run: Run,
    path: str | Path,
    plane: str | Pose = "xy",
    at: ArrayLike | None = None,
    *,
    show: Show = "radiation",
    size: float | tuple[float, float] | None = None,
    start: float = 0.0,
    duration: float | None = None,
    slower: float = 1.0,
    fps: float = 20.0,
    top: float | None = None,
) -> Path:
    """Write an animation of a slice of the field, with the outlines of hands and objects; return its path.

    run: a recording, its file, or a renderer with the simulated backend, which is run without waiting. path: ends in
    .gif, .webp, .png (animated) or .mp4, which needs the program ffmpeg. plane, at, show, size: as for `plot.field`; by
    default, `at` is the middle of the objects' places. start, duration: part of the run [s]; a renderer needs a
    duration. slower: slow motion by this factor, for example 100 to see a focus run along a circle. fps: pictures per
    second of the animation, 1..60. top: upper end of the colour scale, in the unit of `show`.

    Each picture shows the mean over the time that it stands for, from at most 8 moments. The colour scale is the same
    in all pictures; it ends at the largest value that is farther than a wavelength from the transducers.
    Raises ArgumentError, RecordingError, MissingExtra, OSError.
    """
    path = Path(path)
    _check_kind(path)
    slower = check_number("slower", slower, low=1e-3, high=1e6)
    fps = check_number("fps", fps, low=1.0, high=60.0)
    if top is not None:
        top = check_number("top", top, low=0.0, above=True)
    if show not in QUANTITIES:
        raise ArgumentError("show", f"must be one of {', '.join(QUANTITIES)}, not {show!r}")
    if duration is not None:
        _count_pictures(check_number("duration", duration, low=0.0, above=True), slower, fps)
    emission = collect_emission(run, start, duration)
    count = _count_pictures(emission.duration, slower, fps)
    places = _find_places(emission)
    middle = middle_of(emission.array, places) if at is None and isinstance(plane, str) else at
    where = _thin(cut(emission.array, plane, middle, places, size))
    rows = np.linspace(0, len(emission.gains), count + 1).astype(int)
    found = [
        _compute_mean(emission, first, max(last, first + 1), where, show)
        for first, last in itertools.pairwise(rows)
    ]
    pictures = _draw_pictures(emission, rows[:-1], where, found, show, top)
    if path.suffix.lower() in PILLOW:
        _write_by_pillow(path, pictures, fps)
    else:
        _write_by_ffmpeg(path, pictures, fps)
    return path


def _check_kind(path: Path) -> None:
    """Refuse a file that cannot be written, before anything is computed. Raises ArgumentError."""
    kind = path.suffix.lower()
    if kind not in KINDS:
        raise ArgumentError("path", f"must end in {', '.join(KINDS[:-1])} or {KINDS[-1]}")
    figure()  # raises if Matplotlib is missing
    from matplotlib.animation import FFMpegWriter

    if kind == ".mp4" and not FFMpegWriter.isAvailable():
        raise ArgumentError(
            "path",
            "ends in .mp4, which needs the program ffmpeg: install it (on Debian, `apt install ffmpeg`), "
            "or choose .webp or .gif",
        )


def _count_pictures(duration: float, slower: float, fps: float) -> int:
    """Return the number of pictures. Raises ArgumentError if they are too many."""
    count = max(1, round(duration * slower * fps))
    if count > MAX_PICTURES:
        most = MAX_PICTURES / (slower * fps)
        raise ArgumentError(
            "duration",
            f"of {duration:.3g} s makes {count} pictures, more than {MAX_PICTURES}: "
            f"choose at most {most:.3g} s, or a smaller `slower` or `fps`",
        )
    return count


def _find_places(emission: Emission) -> Floats:
    """Return where objects have been, (K, 3) [m]."""
    seen = [
        find_pose(item, t).position for _, t, scene in emission.scenes for item in scene.objects
    ]
    return np.unique(np.array(seen).reshape(-1, 3), axis=0)


def _thin(plane: Plane) -> Plane:
    """Return the plane with fewer points, which are drawn and computed many times."""
    return Plane(
        plane.points[::COARSE, ::COARSE], plane.u[::COARSE], plane.v[::COARSE], plane.axes,
        plane.height,
    )  # fmt: skip


def _compute_mean(emission: Emission, first: int, last: int, plane: Plane, show: Show) -> Floats:
    """Return a quantity in the plane, (rows, columns), as the mean over rows of gains from `first` to `last`."""
    some = 1 if show == "phase" else min(MAX_MOMENTS, last - first)
    gains = emission.gains[np.linspace(first, last - 1, some).astype(int)]
    different = [k for k, row in enumerate(gains) if not k or (row != gains[k - 1]).any()]
    if len(different) == 1:  # equal moments are computed once
        gains = gains[:1]
    return compute_quantity(emission.array, gains, plane.points, emission.medium, show).astype(
        np.float64
    )


def _draw_pictures(
    emission: Emission,
    rows: Any,
    plane: Plane,
    found: list[Floats],
    show: Show,
    top: float | None,
) -> Iterator[Any]:
    """Yield the pictures, (height, width, 3) bytes each, with even sides."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.contour import ContourSet

    near = find_distant_points(emission.array, plane.points, emission.medium)
    ends = compute_colour_limits(
        np.array(found), np.broadcast_to(near, (len(found), *near.shape)), show
    )
    if top is not None and show != "phase":
        ends = min(ends[0], top - 1.0) if show == "level" else 0.0, top
    flat, height = fit_column(plane)
    page = figure(COLUMN, height)
    canvas: Any = FigureCanvasAgg(page)
    panel: Any = page.subplots()
    brightest = max(found, key=np.nanmax)  # so that the bar tells of values beyond its end
    image = draw(panel, plane, brightest, show, ends)
    bar(page, image, panel, QUANTITIES[show].label, below=flat)
    digits = 0 if len(found) < 2 or np.diff(rows).min() >= 0.01 * emission.rate else 1
    for k, (row, part) in enumerate(zip(rows, found, strict=True)):
        image.set_data(np.maximum(part, ends[0]))
        for drawn in list(panel.collections):
            if isinstance(drawn, ContourSet):
                drawn.remove()
        t, scene = emission.find_scene(int(row))
        draw_outlines(panel, plane, scene, t)
        at = emission.start + row / emission.rate  # [s]
        title = [plane.place] if plane.place else []
        panel.title.set_text(", ".join([*title, f"t = {1e3 * at:.{digits}f} ms"]))
        if not k:
            dress(page)
            page.set_layout_engine("none")  # so that nothing moves
        canvas.draw()
        drawn = np.asarray(canvas.buffer_rgba())
        yield drawn[: len(drawn) // 2 * 2, : drawn.shape[1] // 2 * 2, :3].copy()


def _write_by_pillow(path: Path, pictures: Iterator[Any], fps: float) -> None:
    from PIL import Image

    first, *others = [Image.fromarray(picture) for picture in pictures]
    how: dict[str, Any] = (
        {"quality": QUALITY, "method": 4} if path.suffix.lower() == ".webp" else {}
    )
    first.save(
        path, save_all=True, append_images=others, duration=round(1000.0 / fps), loop=0, **how
    )


def _write_by_ffmpeg(path: Path, pictures: Iterator[Any], fps: float) -> None:
    from matplotlib.animation import FFMpegWriter

    first = next(pictures)
    height, width = first.shape[:2]
    page = figure(width / DPI, height / DPI)
    page.set_layout_engine("none")
    shown: Any = page.figimage(first)
    writer = FFMpegWriter(fps=fps)  # type: ignore[arg-type]
    with writer.saving(page, str(path), DPI):
        writer.grab_frame()
        for picture in pictures:
            shown.set_data(picture)
            writer.grab_frame()
