"""Results of the server benchmarks: the verdicts, and everything as one object for JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import msgspec

from pacinian_lab.scenes.report import Verdict
from pacinian_lab.server.load import FULL
from pacinian_lab.solvers.report import about

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian_lab.server.latency_sender import Times
    from pacinian_lab.server.load import Final, Row

TICK = 1e-3  # [s]
FRESH = 0.1  # [s] maximum age of what is felt, at any load
CONTROL = 0.05  # [s] within which control must answer, at any load
HELD = 0.98  # fraction of the unloaded ticks per second that must remain
GROWN = 1.25  # maximum ratio of the memory to that at the start of a phase
# maximum increase of the share of late ticks over that at a tenth of the load
MAX_LATE_INCREASE = 0.005


def latency(found: Sequence[Times]) -> list[Verdict]:
    """Return a verdict for each rate."""
    return [
        Verdict(
            f"hands at {times.rate:g} Hz: median less than a tick above the echo's round trip",
            times.whole.p50 - times.echo.p50 < TICK,
            f"{1e3 * (times.whole.p50 - times.echo.p50):.2f} ms above",
        )
        for times in found
    ]


def load(rows: Sequence[Row], finals: Sequence[Final]) -> list[Verdict]:
    """Return a verdict for each target and number of clients."""
    made = list[Verdict]()
    for final in finals:
        own = [row for row in rows if row.clients == final.clients]
        who = f"{final.clients} client{'s' * (final.clients > 1)}"
        lost = len(final.missing) + abs(final.objects - final.known)
        made.append(
            Verdict(
                f"{who}: no object lost",
                not lost,
                f"{lost} of {final.objects}; {final.sent - final.received} of {final.sent} messages; "
                f"{sum(final.refused.values())} late or refused",
            )
        )
        made += [_control(who, own), _judge_ticks(who, own), _judge_memory(who, own)]
        backwards, moved = sum(row.seen.backwards for row in own), [row for row in own if row.rate]
        age = max((row.seen.age.p99 for row in moved), default=0.0)
        made.append(
            Verdict(
                f"{who}: newest wins, 99 % younger than {1e3 * FRESH:g} ms",
                not backwards and age < FRESH,
                f"{1e3 * age:.0f} ms, {backwards} steps back",
            )
        )
    return made


def _control(who: str, rows: Sequence[Row]) -> Verdict:
    worst, lost = max(row.seen.ping.most for row in rows), sum(row.seen.lost for row in rows)
    return Verdict(
        f"{who}: control answers within {1e3 * CONTROL:g} ms",
        worst <= CONTROL and not lost,
        f"at most {1e3 * worst:.1f} ms, {lost} lost",
    )


def _judge_ticks(who: str, rows: Sequence[Row]) -> Verdict:
    """Compare with a tenth of the load, at which the solver has the same work."""
    quiet = [row for row in rows if row.rate < FULL][-1:] or rows[:1]
    loaded = [row for row in rows if row.rate <= FULL][-1:] or rows[:1]
    a, b = quiet[0].seen, loaded[0].seen
    return Verdict(
        f"{who}: ticks held at {loaded[0].rate:g}/s",
        b.ticks >= HELD * a.ticks and b.late <= a.late + MAX_LATE_INCREASE,
        f"{b.ticks:.0f} Hz, {b.late:.2%} late; at {quiet[0].rate:g}/s {a.ticks:.0f} Hz, {a.late:.2%}",
    )


def _judge_memory(who: str, rows: Sequence[Row]) -> Verdict:
    worst = max(rows, key=lambda row: row.memory[2] / row.memory[0])
    return Verdict(
        f"{who}: memory bounded",
        worst.memory[2] <= GROWN * worst.memory[0],
        f"{worst.memory[0]:.0f} MB, at most {worst.memory[2]:.0f} MB",
    )


def plain(
    times: Sequence[Times], rows: Sequence[Row], finals: Sequence[Final], **said: Any
) -> dict[str, Any]:
    """Return all results, in SI units unless a name gives another unit."""
    return {
        **said,
        **about(),
        "targets": [asdict(verdict) for verdict in [*latency(times), *load(rows, finals)]],
        "latency": msgspec.to_builtins(times),
        "load": msgspec.to_builtins(rows),
        "finals": msgspec.to_builtins(finals),
    }
