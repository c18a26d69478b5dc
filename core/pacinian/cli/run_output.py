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


def progress(
    what: str, seconds: float, quiet: bool
) -> AbstractContextManager[Callable[[Report], object] | None]:
    """Return a progress bar on standard error, which the loop's own thread draws between ticks; none if `quiet`."""
    from pacinian.notebook import progress as bar

    return nullcontext() if quiet else bar(what, seconds)


def picture(renderer: Renderer, path: str, title: str) -> str:
    """Draw the field of the last gains. Return the path of the file, or "" if it cannot be drawn."""
    import numpy as np

    from pacinian import plot
    from pacinian.errors import MissingExtra

    if not path:
        return ""
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


def summary(renderer: Renderer, extra: dict[str, Any]) -> dict[str, Any]:
    """Return the figures of a run."""
    session = renderer.session
    return {
        "transducers": len(session.array),
        "samples": len(session.propagator.points),
        "rate": 1.0 / renderer.period,
        "solver": session.solver.name,
        "backend": renderer.backend.name,
        **renderer.report.summary(),
        **extra,
    }


def tell(told: dict[str, Any], as_json: bool) -> None:
    """Print a summary as a table, or as one JSON object. Exits with code 1 after a fault, 130 after Ctrl-C."""
    if as_json:
        click.echo(json.dumps(told))
    else:
        _print_table(told)
    if told["interrupted"]:
        raise SystemExit(130)
    if told["fault_count"]:
        raise SystemExit(1)


def _print_table(told: dict[str, Any]) -> None:
    from rich.console import Console
    from rich.table import Table

    from pacinian.solving.felt_regions import FeltRegion

    table = Table(box=None, show_header=False, pad_edge=False)
    rows = {
        "array": f"{told['transducers']} transducers, {told['samples']} samples at the end",
        "solver, backend": f"{told['solver']}, {told['backend']}",
        "ticks": f"{told['ticks']} at {told['rate']:g} Hz, {_late(told)}",
        "tick time": f"{_times(told)}, max {told['tick_max_ms']:.3f} ms",
        "at the samples, as emitted": f"{told['error_at_samples']:.3%} off the target sound pressures",
        **{
            f"felt of {name}": str(FeltRegion(**felt))
            for name, felt in list(told["felt"].items())[:MAX_LISTED]
        },
        "solves": ", ".join(f"{n} {name}" for name, n in told["statuses"].items()) or "none",
        "skipped": ", ".join(f"{n} {name}" for name, n in told["skipped"].items() if n)
        or "nothing",
    }
    if base := told.get("dummy"):
        rows["dummy loop"] = f"{base['ticks']} ticks, {_late(base)}, {_times(base)}"
    if told.get("picture"):
        rows["picture"] = told["picture"]
    if told.get("record"):
        rows["recording"] = told["record"]
    for i, fault in enumerate(told["faults"][:5]):
        rows[f"fault {i + 1} of {told['fault_count']}"] = fault
    for name, value in rows.items():
        table.add_row(name, value)
    Console().print(table)


def _late(told: dict[str, Any]) -> str:
    return f"{told['late_ticks']} late ({told['late_ticks'] / max(1, told['ticks']):.2%})"


def _times(told: dict[str, Any]) -> str:
    return f"p50 {told['tick_p50_ms']:.3f} ms, p99 {told['tick_p99_ms']:.3f} ms"
