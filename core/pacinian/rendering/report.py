"""What the loop did: counts, times, errors, faults."""

from __future__ import annotations

from collections import Counter, defaultdict, deque
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from pacinian.errors import PacinianError
from pacinian.notebook import Card, card
from pacinian.solving.felt_regions import FeltSums

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.solving.felt_regions import FeltRegion
    from pacinian.solving.solution import Status
    from pacinian.types import Floats

SHOWN = 4  # objects in a notebook's card
Stage = Literal["open", "scene", "sample", "solve", "drive", "send", "record", "silence"]

LOOKS = 1000  # between the samples: so many are kept
REMEMBERED = 100_000  # ticks whose times are kept for the percentiles


@dataclass(frozen=True)
class Fault:
    """Something that silenced the output.

    tick: when. stage: "scene", "sample", "solve", "drive", "send", "record" or "silence". message: what was raised.
    error: the exception itself, which a report has of its last fault only.
    """

    tick: int
    stage: str
    message: str
    error: BaseException | None = field(repr=False, compare=False)

    @property
    def cause(self) -> BaseException:
        """The exception, or one with its text."""
        return self.error or PacinianError(self.message)


@dataclass
class Report:
    """Counts since the loop started.

    ticks; late_ticks: those that finished after the next one's due time. skipped: work that was not
    needed, by reason. statuses: how the solves ended. faults: the last ones. interrupted: by Ctrl-C.
    """

    ticks: int = 0
    late_ticks: int = 0
    frames_sent: int = 0
    solves: int = 0
    interrupted: bool = False
    skipped: Counter[str] = field(default_factory=Counter)
    statuses: Counter[str] = field(default_factory=Counter)
    faults: deque[Fault] = field(default_factory=lambda: deque(maxlen=100))
    fault_count: int = 0
    stages: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    """How long each stage of the ticks took in all [s]."""
    _times: Floats = field(default_factory=lambda: np.zeros(REMEMBERED), repr=False)
    _errors: Floats = field(default_factory=lambda: np.zeros(REMEMBERED), repr=False)
    _measured: int = 0
    _felt: deque[dict[str, FeltSums]] = field(
        default_factory=lambda: deque(maxlen=LOOKS), repr=False
    )

    def tick(self, seconds: float, late: bool) -> None:
        """Count a tick that took `seconds` [s]."""
        self._times[self.ticks % REMEMBERED] = seconds
        self.ticks += 1
        self.late_ticks += late

    def staged(self, stage: str, seconds: float) -> None:
        """Add `seconds` [s] to a stage's time."""
        self.stages[stage] += seconds

    def solved(self, status: Status) -> None:
        """Count a solve."""
        self.solves += 1
        self.statuses[status.name] += 1

    def looked(self, error: float, felt: dict[str, FeltSums]) -> None:
        """Keep what a look at the gains as emitted, after quantisation, has found.

        error: of the sound pressures at the samples, relative. felt: between them, of each object that has a region.
        """
        self._errors[self._measured % REMEMBERED] = error
        self._measured += 1
        self._felt.append(felt)

    def felt(self, looks: int = LOOKS) -> dict[str, FeltRegion]:
        """What was felt, as emitted, of each object that has regions, between its samples: of the last looks.

        One every 64 ticks, at some 24 places each.
        """
        sums: dict[str, FeltSums] = {}
        for found in list(self._felt)[-looks:]:
            for name, more in found.items():
                sums[name] = sums.get(name, FeltSums()).plus(more)
        return {name: all_.felt for name, all_ in sums.items()}

    def fault(self, fault: Fault) -> None:
        """Count a fault."""
        if self.faults:  # an exception holds frames, and texts of any length
            self.faults[-1] = replace(self.faults[-1], error=None)
        self.faults.append(fault)
        self.fault_count += 1

    def tick_ms(self, percentile: float) -> float:
        """A percentile of the remembered ticks' times [ms]; 0 before the first."""
        times = self._times[: self.ticks]
        return float(np.percentile(times, percentile)) * 1e3 if self.ticks else 0.0

    def recent(self, count: int) -> Floats:
        """Times of the last ticks, `count` of them at most, in their order [s]."""
        count = min(count, self.ticks, REMEMBERED)
        return self._times[np.arange(self.ticks - count, self.ticks) % REMEMBERED]

    @property
    def late_share(self) -> float:
        """late_ticks / ticks."""
        return self.late_ticks / max(1, self.ticks)

    @property
    def errors(self) -> Floats:
        """Relative errors of the emitted sound pressures, of every 64th solve: the last ones, in their order."""
        count = min(self._measured, REMEMBERED)
        return self._errors[np.arange(self._measured - count, self._measured) % REMEMBERED]

    @property
    def error(self) -> float:
        """Median of `errors`; 0 before the first."""
        return float(np.median(self.errors)) if self._measured else 0.0

    def summary(self) -> dict[str, Any]:
        """All of it as plain numbers, for JSON."""
        return {
            "ticks": self.ticks,
            "late_ticks": self.late_ticks,
            "tick_p50_ms": self.tick_ms(50),
            "tick_p99_ms": self.tick_ms(99),
            "tick_max_ms": self.tick_ms(100),
            "stages_ms": {k: 1e3 * v / max(1, self.ticks) for k, v in self.stages.items()},
            "error_at_samples": self.error,
            "felt": {name: felt._asdict() for name, felt in self.felt().items()},
            "solves": self.solves,
            "frames_sent": self.frames_sent,
            "skipped": dict(self.skipped),
            "statuses": dict(self.statuses),
            "faults": [f"tick {f.tick}, {f.stage}: {f.message}" for f in self.faults],
            "fault_count": self.fault_count,
            "interrupted": self.interrupted,
        }

    @card
    def _repr_html_(self) -> Card:
        rows = {
            "late": f"{self.late_ticks} ({self.late_share:.1%})",
            "tick time [ms]": " ".join(f"p{p} {self.tick_ms(p):.3f}" for p in (50, 99, 100)),
            "error at the samples": f"{100.0 * self.error:.2g} % of the sound pressures asked, as emitted",
            **{f"felt of {name}": str(felt) for name, felt in list(self.felt().items())[:SHOWN]},
            "solves": ", ".join(f"{n} {name}" for name, n in self.statuses.items()) or "none",
            "skipped": ", ".join(f"{n} {name}" for name, n in self.skipped.items() if n)
            or "nothing",
            "faults": self.fault_count,
        }
        if self.faults:
            rows["last fault"] = f"{self.faults[-1].stage}: {self.faults[-1].message}"
        rows |= {"interrupted": "yes"} if self.interrupted else {}
        return Card(f"{self.ticks} ticks", rows, draw=self._draw if self.ticks else None)

    def _draw(self, panel: Any) -> None:
        """How many ticks took how long."""
        panel.hist(1e3 * self.recent(REMEMBERED), bins=50)
        panel.set(xlabel="tick time [ms]", ylabel="ticks", yscale="log")


class StageTimer:
    """Which stage of a tick the loop is in; tells a report how long each took.

    now: the time [s]. report: may be replaced.
    """

    def __init__(self, now: Callable[[], float], report: Report) -> None:
        self.report = report
        self.stage: Stage = "open"
        self._now = now
        self._entered = 0.0  # [s]

    def begin(self, time: float) -> None:
        """A tick begins, at `time` [s], with its scene."""
        self.stage, self._entered = "scene", time

    def enter(self, stage: Stage) -> None:
        """A stage begins: the one before it is over."""
        now = self._now()
        self.report.staged(self.stage, now - self._entered)
        self.stage, self._entered = stage, now
