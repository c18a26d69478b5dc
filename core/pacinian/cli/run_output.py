"""Output shared by `demo` and `render`: progress bar, summary and picture."""

from __future__ import annotations

import json
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from pacinian.rendering.renderer import Renderer
    from pacinian.rendering.report import Report


MAX_LISTED = 8  # objects whose felt quality is shown
TIMELY_SHARE = 0.95  # share of ticks on time from which a run counts as on time
BUSY_SHARE = 0.7  # share of the ticks' time below which other programs held the processor


def progress(
    what: str, seconds: float, quiet: bool
) -> AbstractContextManager[Callable[[Report], object] | None]:
    """Return a progress bar on standard error, which the loop's own thread draws between ticks; none if `quiet`."""
    from pacinian.notebook import progress as bar

    return nullcontext() if quiet else bar(what, seconds)


def picture(renderer: Renderer, path: str, title: str, *, quiet: bool) -> str:
    """Draw the field of the last gains. Return the path of the file, or "" if it cannot be drawn.

    quiet: whether to say nothing before.
    """
    import numpy as np

    from pacinian import plot
    from pacinian.errors import MissingExtra

    if not path:
        return ""
    if not quiet:
        click.echo("drawing the picture ...", err=True)
    session = renderer.session
    points = np.array(session.propagator.points)
    try:
        page = plot.slices(session.array, renderer.emitted, points, session.medium, title)
        plot.save(page, path)
    except (MissingExtra, OSError) as error:
        click.echo(f"no picture: {error}", err=True)
        return ""
    return path


def check_picture_path(context: click.Context, parameter: click.Parameter, path: str) -> str:
    """Check that a picture can be written to `path`, before anything runs. Raises BadParameter."""
    if path and Path(path).suffix.lower() not in (".png", ".pdf", ".svg"):
        raise click.BadParameter(f"{path!r} must end in .png, .pdf or .svg")
    try:
        if path:
            Path(path).parent.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise click.BadParameter(f"{path!r} cannot be written: {error}") from error
    return path


def summary(
    renderer: Renderer, extra: dict[str, Any], processor: float | None = None
) -> dict[str, Any]:
    """Return the figures of a run. processor: time that the processor spent on it [s], if that was measured."""
    session, report = renderer.session, renderer.report
    busy = float(report.recent(report.ticks).sum())  # [s]
    return {
        "transducers": len(session.array),
        "samples": len(session.propagator.points),
        "rate": 1.0 / renderer.period,
        "solver": session.solver.name,
        "backend": renderer.backend.name,
        **report.summary(),
        "processor_share": min(1.0, processor / busy) if processor and busy else None,
        **extra,
    }


def tell(told: dict[str, Any], as_json: bool, remedy: str = "") -> None:
    """Print a summary as a table, or as one JSON object.

    Exits with code 130 after Ctrl-C, and with code 1 after a fault or, if strict, if anything was not as asked.

    remedy: what helps a machine that is too slow.
    """
    if as_json:
        click.echo(json.dumps(told))
    else:
        _print_table(told, remedy)
    if told["interrupted"]:
        raise SystemExit(130)
    if told["fault_count"] or (told.get("strict") and not told["intact"]):
        raise SystemExit(1)


def judge_pace(told: dict[str, Any], remedy: str) -> str:
    """Return in words whether the ticks of a run were on time; if not, why, and what to do.

    told: a summary. remedy: what helps if the machine is too slow for the scene.
    """
    planned = told["ticks"] + told["skipped"].get("missed ticks", 0)
    timely = told["ticks"] - told["late_ticks"]
    if not planned:
        return ""
    told_share = f"{timely / planned:.0%} of the {planned:,} planned ticks were on time"
    if timely >= TIMELY_SHARE * planned:
        return f"{told_share}."
    took, free, due = told["tick_p50_ms"], told["processor_share"], 1e3 / told["rate"]
    text = f"Only {told_share}: one took {took:.1f} ms (median), and {told['rate']:g} Hz leave {due:g} ms."
    if free is not None and free < BUSY_SHARE:
        text += f" Other programs held the processor for {1.0 - free:.0%} of that time: close them."
        took *= free
    if took >= due:
        text += f" This machine is too slow for this scene at this rate: {remedy}."
    return text


def _print_table(told: dict[str, Any], remedy: str) -> None:
    from rich.table import Table
    from rich.text import Text

    from pacinian.cli.console import make_console
    from pacinian.rendering.deviations import Total, describe_totals
    from pacinian.rendering.skip_reasons import split_skips
    from pacinian.solving.felt_regions import FeltRegion

    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    rows = {
        "array": f"{told['transducers']} transducers, {told['samples']} samples at the end",
        "solver, backend": f"{told['solver']}, {told['backend']}",
        "ticks": f"{told['ticks']:,} at {told['rate']:g} Hz, {_late(told)}",
        "tick time": f"{_times(told)}, max {told['tick_max_ms']:.2f} ms",
        "error": f"{told['error_at_samples']:.2%} of the target sound pressures, as emitted at the samples",
        **{
            f"felt of {name}": str(FeltRegion(**felt))
            for name, felt in list(told["felt"].items())[:MAX_LISTED]
        },
        "solves": ", ".join(f"{n:,} {name}" for name, n in told["statuses"].items()) or "none",
        "left out": str(split_skips(told["skipped"])),
        **{
            f"not as asked: {label}": describe_totals(
                {reason: Total(**total) for reason, total in reasons.items()}
            )
            for label, reasons in list(told["deviations"].items())[:MAX_LISTED]
        },
    }
    if (more := len(told["deviations"]) - MAX_LISTED) > 0:
        rows["not as asked: others"] = f"{more} more objects, see --json"
    if base := told.get("dummy"):
        rows["dummy loop"] = f"{base['ticks']:,} ticks, {_late(base)}, {_times(base)}"
    if told.get("record"):
        rows["recording"] = str(Path(told["record"]).resolve())
    for i, fault in enumerate(told["faults"][:5]):
        rows[f"fault {i + 1} of {told['fault_count']}"] = fault
    for name, value in rows.items():
        table.add_row(Text(name), Text(value, style="red" if name.startswith("fault") else ""))
    console = make_console()
    console.print(table)
    if pace := judge_pace(told, remedy):
        console.print(Text(pace, style="yellow" if pace.startswith("Only") else "green"))
    if told.get("picture"):
        console.print(Text(f"Picture: {Path(told['picture']).resolve()}"), soft_wrap=True)


def _late(told: dict[str, Any]) -> str:
    return f"{told['late_ticks']:,} late ({told['late_ticks'] / max(1, told['ticks']):.0%})"


def _times(told: dict[str, Any]) -> str:
    return f"median {told['tick_p50_ms']:.2f} ms, p99 {told['tick_p99_ms']:.2f} ms"
