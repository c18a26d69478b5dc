"""`pacinian rerender`."""

from __future__ import annotations

import json
from dataclasses import asdict

import click

from pacinian.cli.options import PATH
from pacinian.cli.replay import warn_if_cut_short


@click.command()
@click.argument("recording", type=PATH)
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of a line.")
def rerender(recording: str, as_json: bool) -> None:
    """Render the scenes of a recording again and compare the frames.

    Runs as fast as possible, with the recorded decisions, and drives no array. On the same machine the frames are
    identical, bit for bit. Exit code 1 if any frame differs. Differences of versions, kernels and objects are named.
    """
    from pacinian.cli.plugin_blame import forbid_exit
    from pacinian.rendering.recording import Recording
    from pacinian.rendering.rerender import rerender as render_again

    opened = Recording(recording)
    with forbid_exit():
        found = render_again(opened)
    warn_if_cut_short(opened)
    if as_json:
        click.echo(json.dumps({"recording": recording, **asdict(found)}))
    else:
        click.echo(str(found))
    raise SystemExit(1 if found.different else 0)
