"""`pacinian status`."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import click

from pacinian.cli.options import CONNECTION
from pacinian.cli.run_verdict import TIMELY_SHARE
from pacinian.errors import replace_unprintable
from pacinian.skip_reasons import split_skips

if TYPE_CHECKING:
    from rich.table import Table

    from pacinian.wire.replies import Sound
    from pacinian.wire.state import State

OUTPUT_COLOURS = {
    "sounding": "bold green",
    "silent": "bold yellow",
    "stale": "bold yellow",
    "stopped": "bold red",
    "faulted": "bold red",
}

BULK = {  # type and width of the rows
    "points": ("<f4", 3),
    "normals": ("<f4", 3),
    "asked": ("<f4", 1),
    "achieved": ("<f4", 1),
    "index": ("<i4", 1),
    "hands": ("<f4", 78),
    "inputs": ("<f8", 4),
}


@click.command()
@CONNECTION
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of a table.")
def status(connection: str | None, as_json: bool) -> None:
    """Print what a server emits, or why it is silent.

    Also prints its health.

    Exit code 1 after a fault, 2 if no server answers.
    """
    from pacinian.client.client import Client

    with Client(connection, name="pacinian status") as client:
        state, sound = client.status(), client.capabilities().sound
    if as_json:
        click.echo(json.dumps({**plain(state), **air(sound)}))
    else:
        from pacinian.cli.console import make_console

        made = make_table(state)
        made.add_row("air", describe_air(sound))
        make_console().print(made)
    if state.output == "faulted":
        raise SystemExit(1)


def air(sound: Sound | None) -> dict[str, float | None]:
    """Return the temperature [degC] and speed of sound [m/s] that the server uses; empty if it does not report them."""
    if sound is None:
        return {}
    return {"temperature": sound.temperature, "speed_of_sound": sound.speed_of_sound}


def describe_air(sound: Sound | None) -> str:
    """Return the same as text."""
    if sound is None:
        return "not reported"
    temperature = "" if sound.temperature is None else f"{sound.temperature:g} °C, "
    return f"{temperature}{sound.speed_of_sound:.1f} m/s"


def plain(state: State) -> dict[str, Any]:
    """Convert a state for JSON. Bulk numbers become lists, or lists of rows if a row has several numbers.

    Adds `silence`: cause and text, or null; see `State.silence`.
    """
    import msgspec
    import numpy as np

    plain_state: dict[str, Any] = msgspec.to_builtins(state)
    for name, (kind, width) in BULK.items():
        rows = np.frombuffer(getattr(state, name), kind).reshape(-1, width)
        plain_state[name] = (rows[:, 0] if width == 1 else rows).tolist()
    del plain_state["id"], plain_state["type"]
    plain_state["silence"] = state.silence and state.silence._asdict()
    return plain_state


def make_table(state: State) -> Table:
    """Return a state as a table: what is wrong is coloured."""
    from rich.table import Table
    from rich.text import Text

    made = Table(box=None, show_header=False, pad_edge=False)
    made.add_column(style="dim", no_wrap=True)
    made.add_column(overflow="fold")
    colours = {"output": OUTPUT_COLOURS[state.output], "why": OUTPUT_COLOURS[state.output]}
    if state.ticks - state.late < TIMELY_SHARE * state.ticks:
        colours["ticks"] = "yellow"
    if split_skips(state.skipped).problems:
        colours["left out"] = "yellow"
    faulty = {"faults", "restarts", *(f"  {i + 1}" for i in range(len(state.faults)))}
    colours |= dict.fromkeys(faulty, "red")
    for name, value in state.summarise().items():
        label, shown = replace_unprintable(name), replace_unprintable(value)  # clients choose names
        made.add_row(Text(label), Text(shown, style=colours.get(name, "")))
    return made
