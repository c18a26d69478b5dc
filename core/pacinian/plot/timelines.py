"""Plots a run over time: its drive, ticks, errors and skipped work."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, overload

import numpy as np

from pacinian.argument_checks import check_kind
from pacinian.errors import ArgumentError, RecordingError
from pacinian.plot.feeds import read_feed
from pacinian.plot.page import panels
from pacinian.plot.style import BLUE, GREEN, GREY, LINE, ORANGE, RED, SMALL, dress
from pacinian.rendering.recording import Recording
from pacinian.rendering.report import REMEMBERED, Report

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pacinian.plot.style import Panel
    from pacinian.types import Flags, Floats

MAX_VALUES, HISTOGRAM_BINS = 600, 150  # values up to which each is drawn; bins if there are more
TALL = 1.6  # height of a panel [inch]
MIN_SHARE_TICKS = 20  # least number of ticks per share
MAX_FRAME_INTERVAL = 1.5  # interval between two frames from which ticks count as missed [periods]
PALE = "#99d6c4"
ABOVE = {
    "loc": "lower right",
    "bbox_to_anchor": (1.0, 0.98),
    "ncols": 2,
    "frameon": False,
    "borderpad": 0.1,
}


@overload
def timeline(
    run: Report | Recording | str | Path,
    show: str | None = None,
    *,
    ax: None = None,
) -> Figure: ...
@overload
def timeline(
    run: Report | Recording | str | Path,
    show: str | None = None,
    *,
    ax: Axes,
) -> Axes: ...
@overload
def timeline(
    run: Report | Recording | str | Path,
    show: str | None = None,
    *,
    ax: Sequence[Axes],
) -> Sequence[Axes]: ...
def timeline(
    run: Report | Recording | str | Path,
    show: str | None = None,
    *,
    ax: Axes | Sequence[Axes] | None = None,
) -> Figure | Axes | Sequence[Axes]:
    """Plot a run over time, one panel per quantity.

    run: a report, for "ticks" (durations of the last 100,000), "error" (at the samples of every 64th solve, as emitted)
    and "skipped" (skipped work by reason); a recording, for "drive" (mean and maximum of all amplitudes), "ticks" (time
    between the first and the last reading of the clock, and lateness of the start) and "skipped" (repeated frames and
    missed ticks); or a file: a recording, or a feed of the viewer (.feed), for "drive", "error" (at the samples, as
    emitted) and "ticks" (of the last second). show: one quantity only. ax: axes to draw into and return, one per
    quantity. Many values are drawn as a min-max band with the median. Raises ArgumentError, RecordingError and
    MissingExtra.
    """
    check_kind("run", run, Report, Recording, str, Path)
    if isinstance(run, Report):
        drawn = _of_report(run)
    elif isinstance(run, Recording):
        drawn = _of_recording(run)
    else:
        drawn = _of_file(Path(run))
    if show is not None and show not in drawn:
        raise ArgumentError("show", f"must be one of {', '.join(drawn)}, not {show!r}")
    names = list(drawn) if show is None else [show]
    page, axes, _ = panels(ax, [TALL] * len(names))
    for panel, name in zip(axes, names, strict=True):
        drawn[name](panel)
    if not isinstance(run, Report):
        for panel in axes[:-1]:
            panel.set_xlabel("")
            panel.sharex(axes[-1])
            panel.tick_params(labelbottom=False)
    return dress(page) if ax is None else ax


def _of_report(report: Report) -> dict[str, Callable[[Panel], None]]:
    def ticks(panel: Panel) -> None:
        times = 1e3 * report.recent(REMEMBERED)
        _line(
            panel, np.arange(report.ticks - len(times), report.ticks, dtype=np.float64), times, BLUE
        )
        panel.set(xlabel="tick", ylabel="tick time [ms]", ylim=(0.0, None))

    def error(panel: Panel) -> None:
        errors = 100.0 * report.errors_at_samples
        panel.plot(np.arange(len(errors)), errors, ".", color=RED, ms=3)
        panel.set(
            xlabel="measured solve (one of 64)", ylabel="error at samples [%]", ylim=(0.0, None)
        )

    def skipped(panel: Panel) -> None:
        found = [(name, count) for name, count in report.skipped.most_common() if count]
        names = [name for name, _ in reversed(found)]
        panel.barh(names, [count for _, count in reversed(found)], color=PALE, height=0.35)
        for k, name in enumerate(names):  # above its bar
            panel.annotate(
                name, (0.0, k + 0.2), xycoords=panel.get_yaxis_transform(), xytext=(3, 1),
                textcoords="offset points", va="bottom", fontsize=SMALL,
            )  # fmt: skip
        panel.set(yticks=(), ylim=(-0.4, max(1.8, len(found) - 0.2)))
        panel.set_xlabel("times skipped" if found else "nothing skipped")
        if not found:
            panel.set_xticks(())

    return {"ticks": ticks, "error": error, "skipped": skipped}


class _Course(NamedTuple):
    """The T ticks of a recording: (T,) each; times from the first [s], shares of full drive."""

    t: Floats
    mean: Floats
    most: Floats
    took: Floats  # [s]
    late: Floats  # [s]
    kept: Flags
    missed: Floats  # times of the missed ticks, (K,) [s]
    anew: Flags
    period: float  # [s]


def _of_recording(recording: Recording) -> dict[str, Callable[[Panel], None]]:
    course = _course(recording)

    def drive(panel: Panel) -> None:
        _drive(panel, course.t, course.mean, course.most)

    def ticks(panel: Panel) -> None:
        _line(panel, course.t, 1e3 * course.took, BLUE, "tick")
        if (course.late > course.period).any():
            _line(panel, course.t, 1e3 * course.late, RED, "late by")
        panel.set(xlabel="time [s]", ylabel="time [ms]", ylim=(0.0, None))
        panel.legend(**ABOVE)

    def skipped(panel: Panel) -> None:
        end = max(course.t[-1], course.period)
        edges = np.linspace(
            0.0, end, int(np.clip(len(course.t) // MIN_SHARE_TICKS, 2, HISTOGRAM_BINS))
        )
        kept, missed, seen = (
            np.histogram(t, edges)[0] for t in (course.t[course.kept], course.missed, course.t)
        )
        every = np.maximum(seen + missed, 1)
        for count, colour, name in ((kept, GREEN, "frame kept"), (missed, RED, "tick missed")):
            panel.stairs(100.0 * count / every, edges, color=colour, linewidth=LINE, label=name)
        for t in course.t[course.anew][1:]:
            panel.axvline(t, color=GREY, linestyle=":", linewidth=LINE)
        panel.set(xlabel="time [s]", ylabel="skipped [%]", ylim=(-3.0, 103.0))
        if kept.any() or missed.any():
            panel.legend(**ABOVE)
        else:
            panel.text(
                0.5,
                0.5,
                "no frame kept, no tick missed",
                transform=panel.transAxes,
                ha="center",
                fontsize=SMALL,
            )

    return {"drive": drive, "ticks": ticks, "skipped": skipped}


def _of_file(path: Path) -> dict[str, Callable[[Panel], None]]:
    try:
        course = read_feed(path)
    except RecordingError as other:
        try:
            return _of_recording(Recording(path))
        except RecordingError:
            raise other from None
    t, missed, half, most, worst, period = course.states.T

    def drive(panel: Panel) -> None:
        _drive(panel, *course.drive.T)

    def error(panel: Panel) -> None:
        _line(panel, t, 100.0 * missed, RED)
        panel.set(xlabel="time [s]", ylabel="error at samples [%]", ylim=(0.0, None))

    def ticks(panel: Panel) -> None:
        for values, colour, name in (
            (worst, ORANGE, "max"),
            (most, GREEN, "99 %"),
            (half, BLUE, "median"),
        ):
            _line(panel, t, 1e3 * values, colour, name)
        if np.isfinite(period).any():
            panel.axhline(1e3 * np.nanmin(period), color=GREY, linestyle=":", linewidth=LINE)
        panel.set(xlabel="time [s]", ylabel="tick time [ms]", ylim=(0.0, None))
        panel.legend(**{**ABOVE, "ncols": 3})

    return {"drive": drive, "error": error, "ticks": ticks}


def _course(recording: Recording) -> _Course:
    sizes = recording.capability.sizes
    rows: list[tuple[float, ...]] = []
    last, mean, most = None, 0.0, 0.0
    for tick in recording.ticks(frames_only=True):
        frame, clock = tick.frame, tick.clock
        same = last is not None and frame.amplitude is last.amplitude
        if not same:
            amplitude = sizes[frame.amplitude]
            mean, most = float(amplitude.mean()), float(amplitude.max())
        took, late = (clock[-1] - clock[0], clock[0] - frame.time) if clock else (np.nan, np.nan)
        rows.append((frame.time, mean, most, took, late, same, tick.begins))
        last = frame
    if not rows:
        raise RecordingError(recording.path, "has no tick")
    time, means, mosts, took, lates, kept, anew = np.array(rows).T
    steps = np.diff(time, prepend=time[0])
    period = float(np.median(steps[1:])) if len(rows) > 1 else 1.0 / recording.capability.rate
    gaps = np.flatnonzero(steps > MAX_FRAME_INTERVAL * period)
    missed = [np.arange(time[k - 1] + period, time[k] - period / 2.0, period) for k in gaps]
    return _Course(
        time - time[0], means, mosts, took, lates, kept > 0.0,
        np.concatenate([np.empty(0), *missed]) - time[0], anew > 0.0, period,
    )  # fmt: skip


def _drive(panel: Panel, t: Floats, mean: Floats, largest: Floats) -> None:
    """Draw mean and maximum of all amplitudes over time."""
    _line(panel, t, largest, ORANGE, "max")
    _line(panel, t, mean, BLUE, "mean")
    top = np.nanmax(largest, initial=0.0)
    panel.set(
        xlabel="time [s]", ylabel="amplitude (1: full)", ylim=(0.0, min(1.05, 1.2 * top) or 1.05)
    )
    panel.legend(**ABOVE)


def _line(panel: Panel, x: Floats, y: Floats, colour: str, name: str = "") -> None:
    """Draw a curve with gaps for missing values; many values become a min-max band with the median."""
    given = {"color": colour, "linewidth": LINE, "label": name or None}
    x, y = x[np.isfinite(y)], y[np.isfinite(y)]
    if len(x) <= MAX_VALUES:
        steps = np.diff(x)
        usual = np.median(steps) if len(steps) else 0.0
        after = 1 + np.flatnonzero(steps > MAX_FRAME_INTERVAL * usual)
        panel.plot(np.insert(x, after, np.nan), np.insert(y, after, np.nan), **given)
        return
    parts = np.array_split(np.arange(len(x)), HISTOGRAM_BINS)
    middle = [x[part[len(part) // 2]] for part in parts]
    low, half, high = (
        np.array([f(y[part]) for part in parts]) for f in (np.min, np.median, np.max)
    )
    panel.fill_between(middle, low, high, color=colour, alpha=0.3, linewidth=0)
    panel.plot(middle, half, **given)
