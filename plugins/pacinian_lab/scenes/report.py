"""Results of the scenes benchmark: the verdicts, and everything as one object for JSON."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from pacinian_lab.scenes.run import MAX_LATE_ABOVE_DUMMY, RATE
from pacinian_lab.solvers.report import about

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian_lab.scenes.audibility import Sound
    from pacinian_lab.scenes.growth import Growth
    from pacinian_lab.scenes.run import Row
    from pacinian_lab.scenes.savings import Saving

FAR_BELOW = 0.01  # maximum fraction of linear growth


@dataclass(frozen=True)
class Verdict:
    """A target, whether it is met, and what was found."""

    target: str
    met: bool
    found: str


def verdicts(
    rows: Sequence[Row], savings: Sequence[Saving] = (), growth: Sequence[Growth] = ()
) -> list[Verdict]:
    """Return the verdicts on all targets with measurements."""
    made: list[Verdict] = []
    if rows:
        slow = [row for row in rows if row.p99_ms >= 1e3 / RATE]
        late = [row for row in rows if row.late > row.dummy_late + MAX_LATE_ABOVE_DUMMY]
        made.append(
            _verdict(
                "every scene at 1 kHz: p99 below 1 ms",
                [f"{row.scene} {row.p99_ms:.2f} ms, {row.rate:.0f} Hz held" for row in slow],
                f"at most {max(row.p99_ms for row in rows):.2f} ms",
            )
        )
        made.append(
            _verdict(
                f"every scene: late ticks at most {100 * MAX_LATE_ABOVE_DUMMY:g} percentage points "
                "above a dummy loop's",
                [f"{row.scene} {row.late:.1%}, dummy {row.dummy_late:.1%}" for row in late],
                f"at most {max(row.late for row in rows):.1%}",
            )
        )
    for one in savings:
        if one.limit is not None:
            target = f"{one.what}: at most {one.limit:.0%} of a cold tick"
            made.append(Verdict(target, one.ratio <= one.limit, f"{one.ratio:.1%}"))
    if len(growth) > 1:
        share = growth[-1].linear(growth[0])
        target = f"{growth[-1].objects} objects: at most {FAR_BELOW:.0%} of linear growth"
        made.append(Verdict(target, share <= FAR_BELOW, f"{share:.3%}"))
    return made


def _verdict(target: str, misses: list[str], found: str) -> Verdict:
    return Verdict(target, not misses, "; ".join(misses) or found)


def plain(
    rows: Sequence[Row],
    savings: Sequence[Saving],
    growth: Sequence[Growth],
    sounds: Sequence[Sound] = (),
    **said: Any,
) -> dict[str, Any]:
    """Return all results, in the units that the names give, or else in SI units."""
    return {
        **said,
        **about(),
        "targets": [asdict(verdict) for verdict in verdicts(rows, savings, growth)],
        "rows": [asdict(row) for row in rows],
        "savings": [{**asdict(one), "ratio": one.ratio} for one in savings],
        "growth": [asdict(line) for line in growth],
        "sounds": [asdict(one) for one in sounds],
    }
