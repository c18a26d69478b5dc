"""Output shared by `demo` and `render`: progress bar, summary and picture."""

from __future__ import annotations

import json
from contextlib import nullcontext
from pathlib import Path
from tempfile import TemporaryFile
from typing import TYPE_CHECKING, Any

import click

from pacinian.cli.run_verdict import judge_pace
from pacinian.errors import replace_unprintable
from pacinian.skip_reasons import split_skips

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from pacinian.rendering.renderer import Renderer
    from pacinian.rendering.report import Report


MAX_LISTED = 8  # objects whose felt quality is shown


def progress(
    what: str, seconds: float, quiet: bool
) -> AbstractContextManager[Callable[[Report], object] | None]:
    """Return a progress bar on standard error, which the loop's own thread draws between ticks; none if `quiet`."""
    from pacinian.notebook import progress as bar

    return nullcontext() if quiet else bar(replace_unprintable(what), seconds)


def picture(renderer: Renderer, path: str, title: str, *, quiet: bool) -> str:
    """Draw the field that is played at the end, the mean over its frames. Return the path of the file.

    If it cannot be drawn, this says why and returns "".

    quiet: whether to say nothing before.
    """
    import numpy as np

    from pacinian import plot
    from pacinian.errors import MissingExtra

    if not path:
        return ""
    if not quiet:
        click.echo("drawing the picture ...", err=True)
    session, samples = renderer.session, renderer.samples
    points = np.empty((0, 3)) if samples is None else samples.positions
    gains = renderer.cycle_gains if len(points) else renderer.emitted_gains  # one of silence
    try:
        page = plot.slices(session.array, gains, points, session.medium, title)
        plot.save(page, path)
    except (MissingExtra, OSError) as error:
        click.echo(f"no picture: {error}", err=True)
        return ""
    return path


def check_picture_path(
    context: click.Context, parameter: click.Parameter, path: str | None
) -> str | None:
    """Check that a picture can be written to `path`, if one is given, before anything runs. Raises BadParameter."""
    if path and Path(path).suffix.lower() not in (".png", ".pdf", ".svg"):
        raise click.BadParameter(f"{path!r} must end in .png, .pdf or .svg")
    try:
        if path:
            Path(path).parent.mkdir(parents=True, exist_ok=True)
            target = Path(path).resolve()
            if target.exists():
                target.open("ab").close()
            # `replace_file` writes a file beside it first
            if target.is_file() or not target.exists():
                TemporaryFile(dir=target.parent).close()
    except (OSError, ValueError) as error:
        problem = getattr(error, "strerror", None) or error
        raise click.BadParameter(f"{path!r} cannot be written: {problem}") from error
    return path


def summary(renderer: Renderer, extra: dict[str, Any], others: float | None) -> dict[str, Any]:
    """Return the figures of a run. others: the share of all processors that other programs took, if it was measured."""
    session, report = renderer.session, renderer.report
    return {
        "transducers": len(session.array),
        "samples": len(session.propagator.points),
        "rate": 1.0 / renderer.period,
        "solver": session.solver.name,
        "backend": renderer.backend.name,
        **report.summary(),
        "others_share": others,
        **extra,
    }


def print_summary(figures: dict[str, Any], as_json: bool, remedy: str) -> None:
    """Print a summary as a table, or as one JSON object.

    Exits with code 130 after Ctrl-C, and with code 1 after a fault or, if strict, if anything was not as asked.

    remedy: what helps a machine that is too slow.
    """
    if as_json:
        click.echo(json.dumps(figures))
    else:
        _print_table(figures, remedy)
    if figures["interrupted"]:
        raise SystemExit(130)
    if figures["fault_count"] or (figures.get("strict") and not figures["as_asked"]):
        raise SystemExit(1)


def _print_table(figures: dict[str, Any], remedy: str) -> None:
    from rich.table import Table
    from rich.text import Text

    from pacinian.cli.console import make_console
    from pacinian.rendering.deviation_log import Total, describe_totals
    from pacinian.solving.felt_figures import FeltRegion

    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(style="dim", no_wrap=True)
    table.add_column(overflow="fold")
    rows = {
        "array": f"{figures['transducers']} transducers, {figures['samples']} samples at the end",
        "solver, backend": f"{figures['solver']}, {figures['backend']}",
        "ticks": f"{figures['ticks']:,} at {figures['rate']:g} Hz, {_late(figures)}",
        "tick time": f"{_times(figures)}, max {figures['tick_max_ms']:.2f} ms",
        "error at samples": _describe_error(figures["error_at_samples"]),
        **{
            f"felt of {name}": str(FeltRegion(**felt))
            for name, felt in list(figures["felt"].items())[:MAX_LISTED]
        },
        "solves": ", ".join(f"{n:,} {name}" for name, n in figures["statuses"].items()) or "none",
        "left out": str(split_skips(figures["skipped"])),
        **{
            f"not as asked: {label}": describe_totals(
                {reason: Total(**total) for reason, total in reasons.items()}
            )
            for label, reasons in list(figures["deviations"].items())[:MAX_LISTED]
        },
    }
    if (more := len(figures["deviations"]) - MAX_LISTED) > 0:
        rows["not as asked: others"] = f"{more} more objects, see --json"
    if base := figures.get("dummy"):
        rows["dummy loop"] = f"{base['ticks']:,} ticks, {_late(base)}, {_times(base)}"
    if figures.get("record"):
        rows["recording"] = str(Path(figures["record"]).resolve())
    for i, fault in enumerate(figures["faults"][:5]):
        rows[f"fault {i + 1} of {figures['fault_count']}"] = fault
    for name, value in rows.items():
        label, shown = replace_unprintable(name), replace_unprintable(value)  # files name objects
        table.add_row(Text(label), Text(shown, style="red" if name.startswith("fault") else ""))
    console = make_console()
    console.print(table)
    if pace := judge_pace(figures, remedy):
        console.print(Text(pace, style="green" if pace.endswith("on time.") else "yellow"))
    if figures.get("picture"):
        console.print(Text(f"Picture: {Path(figures['picture']).resolve()}"), soft_wrap=True)


def _describe_error(error: float | None) -> str:
    if error is None:
        return "not measured, because nothing was emitted long enough"
    return f"{error:.2%} of the target sound pressures, as emitted"


def _late(figures: dict[str, Any]) -> str:
    return (
        f"{figures['late_ticks']:,} late ({figures['late_ticks'] / max(1, figures['ticks']):.0%})"
    )


def _times(figures: dict[str, Any]) -> str:
    return f"median {figures['tick_p50_ms']:.2f} ms, p99 {figures['tick_p99_ms']:.2f} ms"
