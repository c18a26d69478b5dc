"""`pacinian replay`."""

from __future__ import annotations

import json

import click


@click.command()
@click.argument("recording")
@click.option("--backend", default="simulated", show_default=True, help="Where to play it.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of a line.")
def replay(recording: str, backend: str, as_json: bool) -> None:
    """Play a recording's frames on a backend, at the times they had."""
    from pacinian.acoustics.array import Array
    from pacinian.plugins.registry import backend as make
    from pacinian.rendering.recording import Recording
    from pacinian.rendering.replay import replay as play

    opened = Recording(recording)
    can = opened.capability
    fits = {"phases": can.phases, "amplitudes": can.amplitudes, "rate": can.rate}
    options = fits if backend == "simulated" else {}
    count = play(opened, make(backend, **options), Array(opened.positions, opened.normals))
    if as_json:
        click.echo(json.dumps({"recording": recording, "backend": backend, "frames": count}))
    else:
        click.echo(f"{count} frames of {len(opened.positions)} transducers played on {backend}")
