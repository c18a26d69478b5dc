"""`pacinian replay`."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from pacinian.cli.nonempty import PATH, TEXT

if TYPE_CHECKING:
    from pacinian.rendering.recording import Recording

CUT_SHORT = "the recording is cut short: it ends within a tick, so later ticks are missing"


@click.command()
@click.argument("recording", type=PATH)
@click.option(
    "--backend", type=TEXT, default=None, help="Backend to play on.  [default: simulated]"
)
@click.option(
    "--again", is_flag=True, help="Instead, render the scenes again and compare the frames."
)
@click.option(
    "--strict", is_flag=True, help="Refuse another array, and exit with code 1 if frames are late."
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of a line.")
def replay(recording: str, backend: str | None, again: bool, strict: bool, as_json: bool) -> None:
    """Play a recording again.

    Sends its frames to a backend, with their original timing.

    With --again, render its scenes again as fast as possible, with the recorded decisions. On the same machine the
    frames are identical, bit for bit. Exit code 1 if any frame differs. Differences of versions, kernels and objects
    are named.
    """
    from pacinian.cli.run_output import blame_plugin, forbid_exit
    from pacinian.plugins.registry import backend as make
    from pacinian.plugins.registry import read_capability
    from pacinian.rendering.recording import Recording
    from pacinian.rendering.replay import replay as play

    if again and backend is not None:
        raise click.UsageError("--again plays on no backend: give one of --again and --backend")
    if again and strict:
        raise click.UsageError("--strict plays on a backend: give one of --again and --strict")
    backend = backend or "simulated"
    opened = Recording(recording)
    if again:
        from pacinian.rendering.rerender import rerender

        with forbid_exit():
            found = rerender(opened)
        _warn(opened)
        if as_json:
            click.echo(json.dumps({"recording": recording, **asdict(found)}))
        else:
            click.echo(str(found))
        raise SystemExit(1 if found.different else 0)
    can = opened.capability
    fits = {"phases": can.phases, "amplitudes": can.amplitudes, "rate": can.rate}
    options = fits if backend == "simulated" else {}
    device = make(backend, **options)
    read_capability(device)
    with forbid_exit(), blame_plugin(f"backend {backend!r}"):
        frames, late = play(opened, device, opened.array, strict=strict)
    _warn(opened)
    if as_json:
        figures = {"recording": recording, "backend": backend, "frames": frames, "late": late}
        click.echo(json.dumps(figures))
    else:
        click.echo(
            f"{frames} frames of {len(opened.positions)} transducers played on {backend}, {late} late"
        )
    raise SystemExit(1 if strict and late else 0)


def _warn(recording: Recording) -> None:
    """Say so if ticks are missing at the end of a recording."""
    if recording.cut_short:
        click.echo(CUT_SHORT, err=True)
