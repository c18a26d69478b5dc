"""Results of the server benchmarks, as tables for a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian_lab.solvers.tables import plain_table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table

    from pacinian_lab.server import load, soak
    from pacinian_lab.server.latency_sender import Times
    from pacinian_lab.server.quantiles import Quantiles

MAX_ROWS = 12  # rows shown of a soak


def _ms(found: Quantiles) -> list[str]:
    return [f"{1e3 * value:.2f}" for value in (found.p50, found.p99, found.p999, found.most)]


def latency(found: Sequence[Times]) -> list[Table]:
    """Return a table of latencies for each rate, and one of the server's condition."""
    head = ["", "p50\n[ms]", "p99\n[ms]", "p99.9\n[ms]", "most\n[ms]", "count"]
    made: list[Table] = []
    for times in found:
        ways = {
            "hand sent to frame emitted": times.whole,
            "  sent to received": times.bus,
            "  received to emitted": times.loop,
            "echo round trip during the run": times.echo,
            "echo round trip alone": times.alone,
        }
        lines = [[name, *_ms(one), str(one.count)] for name, one in ways.items()]
        made.append(
            plain_table(f"Hands at {times.rate:g} Hz, {times.size} bytes each", head, lines)
        )
    lines = [
        [
            f"{times.rate:g} Hz", f"{100 * times.reached / max(1, times.sent):.1f}",
            "-".join(map(str, times.samples)), f"{100 * times.sounding:.1f}",
            f"{times.tick_ms[0]:.2f}", f"{times.tick_ms[1]:.2f}", f"{100 * times.late:.2f}",
            f"{100 * times.waiting:.1f}",
        ]
        for times in found
    ]  # fmt: skip
    head = [
        "", "reached\n[%]", "samples\nmin-med-max", "sounding\n[%]", "tick p50\n[ms]",
        "tick p99\n[ms]", "late\n[%]", "waiting\n[%]",
    ]  # fmt: skip
    return [*made, plain_table("The server during the run", head, lines)]


def load_(rows: Sequence[load.Row]) -> list[Table]:
    """Return two tables: what is felt and how control answers; what is sent and what it costs."""
    head = [
        "clients\nat [1/s]", "ticks\n[Hz]", "late\n[%]", "tick p50\n[ms]", "p99\n[ms]", "age p50\n[ms]",
        "p99\n[ms]", "most\n[ms]", "back", "ping p50\n[ms]", "p99\n[ms]", "most\n[ms]",
    ]  # fmt: skip
    felt = [
        [
            f"{row.clients} at {row.rate:g}", f"{row.seen.ticks:.0f}", f"{100 * row.seen.late:.2f}",
            *(f"{value:.2f}" for value in row.seen.tick_ms), *(_ages(row) if row.rate else [""] * 4),
            *(f"{1e3 * v:.1f}" for v in (row.seen.ping.p50, row.seen.ping.p99, row.seen.ping.most)),
        ]
        for row in rows
    ]  # fmt: skip
    made = [plain_table("Under load: latency and control", head, felt)]
    head = [
        "clients\nat [1/s]", "sent\n[1/s]", "full\n[1/s]", "errors", "frames\n[Hz]", "gap\n[ms]",
        "memory\n[MB]", "most\n[MB]", "control\n[%]", "bus\n[%]", "render\n[%]", "guard\n[%]",
    ]  # fmt: skip
    taken = [
        [
            f"{row.clients} at {row.rate:g}", f"{row.sent:.0f}", f"{row.full:.0f}",
            str(sum(row.errors.values())), f"{row.seen.frames:.0f}", f"{1e3 * row.seen.gap:.1f}",
            f"{row.memory[0]:.0f}", f"{row.memory[2]:.0f}",
            *(f"{100 * row.cpu.get(name, 0.0):.0f}" for name in ("control", "bus", "render", "guard")),
        ]
        for row in rows
    ]  # fmt: skip
    return [*made, plain_table("Under load: messages and resources", head, taken)]


def _ages(row: load.Row) -> list[str]:
    age = row.seen.age
    return [f"{1e3 * v:.1f}" for v in (age.p50, age.p99, age.most)] + [str(row.seen.backwards)]


def windows(rows: Sequence[soak.Row]) -> Table:
    """Return a table of some windows of a soak."""
    step = max(1, len(rows) // MAX_ROWS)
    head = [
        "t [s]", "memory\n[MB]", "files", "tick p50\n[ms]", "p99\n[ms]", "late\n[%]",
        "age p50\n[ms]", "p99\n[ms]", "sounding\n[%]", "events",
    ]  # fmt: skip
    lines = [
        [
            f"{row.t:.0f}", f"{sum(row.memory.values()):.1f}", str(sum(row.files.values())),
            *(f"{v:.2f}" for v in row.heard.tick_ms[:2]), f"{100 * row.heard.late:.2f}",
            f"{1e3 * row.heard.age.p50:.2f}", f"{1e3 * row.heard.age.p99:.2f}",
            f"{100 * row.heard.sounding:.0f}", str(sum(row.heard.events.values())),
        ]
        for row in [*rows[:-1:step], rows[-1]]
    ]  # fmt: skip
    return plain_table("Soak", head, lines)


def events(rows: Sequence[soak.Row]) -> Table:
    """Return a table of all events: actions taken and problems met."""
    names = dict.fromkeys(name for row in rows for name in row.heard.events)
    lines = [[name, str(sum(row.heard.events.get(name, 0) for row in rows))] for name in names]
    return plain_table("Events", ["", "times"], lines)
