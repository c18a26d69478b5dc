"""A state in words: one line, and the rows that `pacinian status` and notebooks show."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.rendering.skip_reasons import split_skips
from pacinian.solving.felt_regions import FeltRegion
from pacinian.wire.silence import explain_silence

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pacinian.wire.silence import Silence
    from pacinian.wire.state import ClientState, State

MAX_LISTED_FAULTS = 3
HAND = 26 * 3 * 4  # size of the joints of one hand in `State.hands` [bytes]


def describe_state(state: State, silence: Silence | None = None) -> str:
    """Return one line on what a state emits, and for whom.

    silence: why it is silent, if that is known from more than the state.
    """
    silence = silence or explain_silence(state)
    if state.output != "sounding":
        return f"{state.output}: {silence}" if silence else state.output
    hands, samples = len(state.hands) // HAND, len(state.asked) // 4
    return (
        f'sounding, armed by "{state.owner}": {count(samples, "sample")} of '
        f"{count(len(state.objects), 'object')}, {count(hands, 'hand')}, error {state.error:.2%}"
    )


def summarise_state(state: State, silence: Silence | None = None) -> dict[str, str]:
    """Return names and values of what a person wants to know first. silence: as for `describe_state`."""
    silence = silence or explain_silence(state)
    hands, samples = len(state.hands) // HAND, len(state.asked) // 4
    median, p99, longest = state.tick_ms
    rows = {"output": state.output + (", armed" if state.armed else "")}
    if silence is not None:
        rows["why"] = silence.text
    rows |= {
        "owner": f"{state.owner}, scene {state.scene}" if state.owner else "nobody",
        "solver, backend": f"{state.solver or 'none'}, {state.backend or 'none'}",
        "technique, strength": f"{state.technique or 'of each object'}, {state.intensity:.0%}",
        "rendered": f"{count(samples, 'sample')} of {count(len(state.objects), 'object')}, {count(hands, 'hand')}",
    }
    if samples:
        rows["error"] = f"{state.error:.2%} of the target sound pressures, as emitted"
    rows |= {f"felt of {name}": str(felt) for name, felt in _decode_felt(state).items()}
    rows |= {
        "ticks": f"{state.ticks:,} at {state.rate:g} Hz, {share(state.late, state.ticks)} late",
        "tick time": f"median {median:.2f} ms, p99 {p99:.2f} ms, max {longest:.2f} ms",
        "frames": f"{state.frames:,}, longest gap {1e3 * state.longest_gap:.1f} ms",
        "left out": str(split_skips(state.skipped)),
    }
    if restarts := _list_counts(state.restarts):
        rows["restarts"] = restarts
    if state.fault_count:
        rows["faults"] = f"{state.fault_count}, newest first:"
        for i, fault in enumerate(reversed(state.faults[-MAX_LISTED_FAULTS:])):
            rows[f"  {i + 1}"] = fault
    return rows | {f"client {client.name}": _describe_client(client) for client in state.clients}


def count(number: int, what: str) -> str:
    """Return a number and what it counts, in the plural if it is not 1."""
    return f"{number:,} {what}{'' if number == 1 else 's'}"


def share(part: int, whole: int) -> str:
    """Return part / whole in percent; "0 %" only if there are none."""
    if not part:
        return "0 %"
    percent = 100.0 * part / max(1, whole)
    return f"{percent:.0f} %" if percent >= 1.0 else f"{max(percent, 0.01):.2f} %"


def _decode_felt(state: State) -> dict[str, FeltRegion]:
    """Return the felt quality of objects that have regions, between their samples."""
    figures = np.frombuffer(state.felt, "<f4").reshape(-1, 4).tolist()
    told = zip(state.objects, figures, strict=False)
    return {name: FeltRegion(*four) for name, four in told if four[0] == four[0]}


def _list_counts(counts: Mapping[str, int]) -> str:
    return ", ".join(f"{n} {name}" for name, n in counts.items() if n)


def _describe_client(client: ClientState) -> str:
    owner = "owner, " if client.owner else ""
    told = f"{owner}scene {client.scene}, {count(client.objects, 'object')}, {count(client.commands, 'command')}"
    if client.errors:
        told += f", {count(client.errors, 'error')}"
    if client.dropped:
        told += f", {client.dropped:,} dropped"
    return told + (f", newest applied after {1e3 * client.age:.1f} ms" if client.commands else "")
