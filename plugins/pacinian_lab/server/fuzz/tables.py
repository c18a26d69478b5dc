"""Results of a flood: tables for a terminal, and the verdicts."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian_lab.solvers.tables import plain_table

if TYPE_CHECKING:
    from rich.table import Table

    from pacinian_lab.server.fuzz.run import Found

MIN_MESSAGES = 1_000_000  # messages
GROWN = 4e6  # maximum growth of a process from an early to a late quarter [bytes]
MAX_ANSWER_TIME = 0.05  # [s] within which 99 % of the requests must be answered
QUANTILES = 0.5, 0.999


class Verdict(NamedTuple):
    """Whether a target is met."""

    aim: str
    found: str
    met: bool


def phases(found: Found) -> Table:
    """Return a table of gaps in the output and of response times, by phase."""
    head = ["", "s", "frames", "gap [ms]\np50", "\np99.9", "\nmax", "over a\ntick, 1/s", "silences"]
    head += ["answer [ms]\np50", "\np99", "\nmax", "\nnone"]
    rows = [
        [phase.name, f"{phase.seconds:.0f}", str(len(phase.gap))]
        + [f"{1e3 * _at(phase.gap, q):.2f}" for q in (*QUANTILES, 1.0)]
        + [f"{phase.over / max(phase.seconds, 1e-9):.2f}", str(phase.silences)]
        + [f"{1e3 * _at(np.array(phase.answers), q):.1f}" for q in (0.5, 0.99, 1.0)]
        + [str(phase.lost)]
        for phase in (found.idle, found.burdened, found.flooded)
    ]
    return plain_table("Output and response times of control, by phase", head, rows)


def _at(values: np.ndarray, share: float) -> float:
    return float(np.quantile(values, share)) if len(values) else float("nan")


def tabulate_sent(found: Found) -> Table:
    """Return a table of the messages sent, by mutation."""
    rows = [[name, f"{count:,}"] for name, count in found.flooded.sent.most_common()]
    total = f"{found.messages:,} in {found.flooded.seconds:.0f} s"
    return plain_table(f"Sent: {total}; {found.flooded.failed:,} could not be sent", ["", ""], rows)


def tabulate_errors(found: Found) -> Table:
    """Return a table of control's counters and of the errors received. A client gets only a few errors per second."""
    rows = [[name, f"{count:,}"] for name, count in sorted(found.counts.items())]
    rows += [[f"error: {code}", f"{n:,}"] for code, n in found.flooded.codes.most_common()]
    return plain_table("Counters of control, and errors received", ["", ""], rows)


def memory(found: Found) -> Table:
    """Return a table of the memory of each process."""
    rows = [
        [name, f"{found.memory[name] / 1e6:.0f}", f"{grown / 1e6:+.2f}"]
        for name, grown in found.growth.items()
    ]
    return plain_table("Memory [MB]", ["", "most", "late - early"], rows)


def verdicts(found: Found) -> list[Verdict]:
    """Return the verdicts."""
    flooded, beside = found.flooded, found.burdened
    grown = max(found.growth.values())
    answer = _at(np.array(flooded.answers), 0.99)
    usual = max(beside.worst(), found.idle.worst()) + 1e-3
    return [
        Verdict(
            "at least 1,000,000 messages", f"{found.messages:,}", found.messages >= MIN_MESSAGES
        ),
        Verdict("no process ended", "the same" if found.same else "others", found.same),
        Verdict(
            "no gap over a tick longer than without the flood",
            f"{1e3 * flooded.worst():.1f} against {1e3 * beside.worst():.1f} ms",
            flooded.worst() <= usual,
        ),
        Verdict(
            "no more silences per second than without the flood",
            f"{flooded.often:.2f} against {beside.often:.2f}",
            flooded.often <= beside.often,
        ),
        Verdict("memory does not grow", f"{grown / 1e6:+.2f} MB", grown < GROWN),
        Verdict(
            "control answers within 50 ms (p99)", f"{1e3 * answer:.1f} ms", answer < MAX_ANSWER_TIME
        ),
        Verdict(
            "no request failed",
            str(found.counts.get("failed", 0)),
            not found.counts.get("failed", 0),
        ),
        Verdict("clean end", f"exit code {found.ended}", found.ended == 0),
    ]


def tabulate_verdicts(found: Found) -> Table:
    """Return a table of the verdicts."""
    rows = [[v.aim, v.found, "met" if v.met else "not met"] for v in verdicts(found)]
    return plain_table("Targets", ["", "found", ""], rows)
