"""`pacinian replay`."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import click

from pacinian.cli.options import PATH, TEXT

if TYPE_CHECKING:
    from pacinian.rendering.recording import Recording

CUT_SHORT = "the recording is cut short: it ends within a tick, so later ticks are missing"


@click.command()
@click.argument("recording", type=PATH)
@click.option(
    "--backend", type=TEXT, default="simulated", show_default=True, help="Backend to play on."
)
@click.option(
    "--strict",
    is_flag=True,
    help="Refuse to play on an array that differs from the recording's, and exit with code 1 if frames are late.",
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of a line.")
def replay(recording: str, backend: str, strict: bool, as_json: bool) -> None:
    """Play a recording again.

    Sends its frames to a backend, with their original timing. `pacinian rerender` renders its scenes again instead.
    """
    from pacinian.cli.plugin_blame import blame_plugin, forbid_exit
    from pacinian.plugins.registry import backend as make
    from pacinian.plugins.registry import read_capability
    from pacinian.rendering.recording import Recording
    from pacinian.rendering.replay import replay as play

    opened = Recording(recording)
    can = opened.capability
    fits = {"phases": can.phases, "amplitudes": can.amplitudes, "rate": can.rate}
    options = fits if backend == "simulated" else {}
    device = make(backend, **options)
    read_capability(device)
    with forbid_exit(), blame_plugin(f"backend {backend!r}"):
        frames, late = play(opened, device, opened.array, strict=strict)
    warn_if_cut_short(opened)
    if as_json:
        figures = {"recording": recording, "backend": backend, "frames": frames, "late": late}
        click.echo(json.dumps(figures))
    else:
        click.echo(
            f"{frames} frames of {len(opened.positions)} transducers played on {backend}, {late} late"
        )
    raise SystemExit(1 if strict and late else 0)


def warn_if_cut_short(recording: Recording) -> None:
    """Write to standard error if ticks are missing at the end of a recording."""
    if recording.cut_short:
        click.echo(CUT_SHORT, err=True)
