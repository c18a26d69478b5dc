"""`pacinian status`."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import click

from pacinian.cli.connection_option import CONNECTION

if TYPE_CHECKING:
    from rich.table import Table

    from pacinian.wire.replies import Sound
    from pacinian.wire.state import State

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
    """Print what a running server emits, and its health.

    Exit code 1 after a fault, 2 if no server answers.
    """
    from pacinian.client.client import Client

    with Client(connection, name="pacinian status") as client:
        state, sound = client.status(), client.capabilities().sound
    if as_json:
        click.echo(json.dumps({**plain(state), **air(sound)}))
    else:
        from rich.console import Console

        made = make_table(state)
        made.add_row("air", describe_air(sound))
        Console().print(made)
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
    told = "" if sound.temperature is None else f"{sound.temperature:g} °C, "
    return f"{told}{sound.speed_of_sound:.1f} m/s"


def plain(state: State) -> dict[str, Any]:
    """Convert a state for JSON. Bulk numbers become lists, or lists of rows if a row has several numbers."""
    import msgspec
    import numpy as np

    told: dict[str, Any] = msgspec.to_builtins(state)
    for name, (kind, width) in BULK.items():
        rows = np.frombuffer(getattr(state, name), kind).reshape(-1, width)
        told[name] = (rows[:, 0] if width == 1 else rows).tolist()
    del told["id"], told["type"]
    return told


def make_table(state: State) -> Table:
    """Return a state as a table."""
    from rich.markup import escape
    from rich.table import Table

    made = Table(box=None, show_header=False, pad_edge=False)
    samples, median, p99, longest = len(state.asked) // 4, *state.tick_ms
    rows = {
        "output": f"[bold]{state.output}[/bold]" + (", armed" if state.armed else ""),
        "owner": escape(f"{state.owner}, scene {state.scene}") if state.owner else "nobody",
        "solver, backend": escape(f"{state.solver}, {state.backend}"),
        "technique, strength": escape(
            f"{state.technique or 'of each object'}, {state.intensity:.0%}"
        ),
        "rendered": f"{samples} samples of {len(state.objects)} objects, {len(state.hands) // 312} hands",
        "at the samples, as emitted": f"{state.error:.3%} off the target sound pressures",
        **_format_felt(state),
        "ticks": f"{state.ticks} at {state.rate:g} Hz, {state.late} late",
        "tick time": f"p50 {median:.3f} ms, p99 {p99:.3f} ms, max {longest:.3f} ms",
        "frames": f"{state.frames}, longest gap {1e3 * state.longest_gap:.1f} ms",
        "skipped": _counts(state.skipped),
        "restarts": _counts(state.restarts),
        "faults": f"{state.fault_count}",
    }
    for i, fault in enumerate(reversed(state.faults[-3:])):
        rows[f"  {i + 1} from the end" if i else "  the last"] = escape(fault)
    for client in state.clients:
        what = "owner, " if client.owner else ""
        rows[escape(f"client {client.name}")] = escape(
            f"{what}scene {client.scene}, {client.objects} objects, {client.commands} commands, "
            f"{client.errors} errors, {client.dropped} dropped, age {1e3 * client.age:.1f} ms"
        )
    for name, value in rows.items():
        made.add_row(name, value)
    return made


def _format_felt(state: State) -> dict[str, str]:
    """Return the felt quality of objects that have regions, between their samples."""
    import numpy as np
    from rich.markup import escape

    from pacinian.solving.felt_regions import FeltRegion

    figures = np.frombuffer(state.felt, "<f4").reshape(-1, 4).tolist()
    told = zip(state.objects, figures, strict=False)
    return {
        escape(f"felt of {name}"): str(FeltRegion(*four))
        for name, four in told
        if four[0] == four[0]
    }


def _counts(counts: dict[str, int]) -> str:
    return ", ".join(f"{n} {name}" for name, n in counts.items() if n) or "none"
