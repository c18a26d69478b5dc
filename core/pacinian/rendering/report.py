"""The render loop's report: counts, times, errors at the samples, what is felt, and faults."""

from __future__ import annotations

from collections import Counter, defaultdict, deque
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from pacinian.errors import PacinianError
from pacinian.notebook import Card, card
from pacinian.rendering.deviation_log import (
    NOTHING,
    PRESSED_BESIDE,
    UNEVEN,
    Deviations,
    describe_totals,
    mark,
)
from pacinian.skip_reasons import split_skips
from pacinian.solving.felt_figures import FeltSums

if TYPE_CHECKING:
    from collections.abc import Collection

    from pacinian.rendering.deviation_log import Reasons
    from pacinian.solving.felt_figures import FeltRegion
    from pacinian.solving.solution_status import Status
    from pacinian.types import Floats

MAX_LISTED = 4  # largest number of objects in a notebook's card
# Stages of a tick; before them, "open".
Stage = Literal["open", "scene", "sample", "solve", "drive", "send", "record", "silence"]

# A measurement at MIN_JUDGED_PLACES or more is a deviation if its force or its rms error is wrong by more than these.
MIN_JUDGED_PLACES, MAX_MEASURED_FORCE_ERROR, MAX_MEASURED_RMS = 16, 0.15, 0.25
# A pressure above this on skin beside the touched skin, over the mean pressure asked for, is a deviation.
MAX_MEASURED_SPILL = 2.0
KEPT_MEASUREMENTS = 1000  # number of recent measurements of the felt pressure that are kept
# Number of recent ticks whose times are kept for the percentiles, and of recent measurements whose errors at the
# samples are kept.
REMEMBERED = 100_000


@dataclass(frozen=True)
class Fault:
    """An error that silenced the output.

    tick: number of the tick. stage: "scene", "sample", "solve", "drive", "send", "record" or "silence"; never "open",
    because `Renderer.open` raises its exceptions. message: text of the exception. error: the exception itself; a report
    keeps it for its last fault only.
    """

    tick: int
    stage: str
    message: str
    error: BaseException | None = field(repr=False, compare=False)

    @property
    def cause(self) -> BaseException:
        """The exception, or a PacinianError with its text."""
        return self.error or PacinianError(self.message)


@dataclass
class Report:
    """Counts since the loop started.

    late_ticks: ticks whose frame was sent after the next tick was due. skipped: counts of work that was left out, by
    reason; docs/skipped.md says which reasons are losses. statuses: counts of solves by status. faults: the last ones.
    interrupted: whether Ctrl-C ended the loop. deviations: where and when the output was not what the scene asked for.
    warnings: texts about the scene, from before the first tick.
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
    deviations: Deviations = field(default_factory=Deviations, repr=False)
    warnings: tuple[str, ...] = ()
    stages: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    """Total time of each stage of the ticks [s]."""
    _times: Floats = field(default_factory=lambda: np.zeros(REMEMBERED), repr=False)
    _errors: Floats = field(default_factory=lambda: np.zeros(REMEMBERED), repr=False)
    _measured: int = 0
    _felt: deque[dict[str, FeltSums]] = field(
        default_factory=lambda: deque(maxlen=KEPT_MEASUREMENTS), repr=False
    )
    # labels of objects, and what measurements have found wrong with them since the last tick
    _wrong: list[tuple[str, str]] = field(default_factory=list, repr=False)

    def count_tick(
        self, seconds: float, late: bool, time: float = 0.0, deviations: Reasons = NOTHING
    ) -> None:
        """Count a tick that took `seconds` [s]. time: of the scene [s]. deviations: of this tick, by object."""
        for label, reason in self._wrong:
            deviations = mark(deviations, [label], reason)
        self._wrong = []
        self.deviations.add(self.ticks, time, deviations)
        self._times[self.ticks % REMEMBERED] = seconds
        self.ticks += 1
        self.late_ticks += late

    def count_solve(self, status: Status) -> None:
        """Count a solve."""
        self.solves += 1
        self.statuses[status.name] += 1

    def add_measurement(
        self, error_at_samples: float, felt: dict[str, FeltSums], on_skin: Collection[str] = ()
    ) -> None:
        """Add a measurement of the emitted field, computed from the quantised gains.

        error_at_samples: relative error of the sound pressures there. felt: sums between the samples or on touched
        skin, for each object that has regions. on_skin: labels of those that were measured on skin.
        """
        self._errors[self._measured % REMEMBERED] = error_at_samples
        self._measured += 1
        self._felt.append(felt)
        for name, sums in felt.items():
            if sums.places < MIN_JUDGED_PLACES:
                continue
            if _is_uneven(sums):
                self._wrong.append((name, UNEVEN))
            if name in on_skin and sums.felt.spill > MAX_MEASURED_SPILL:
                self._wrong.append((name, PRESSED_BESIDE))

    def compute_felt(self, measurements: int = KEPT_MEASUREMENTS) -> dict[str, FeltRegion]:
        """Return what was felt of each object that has regions, by label, over the last measurements.

        In free air, it is measured between the samples of solutions. On skin, it is measured at random moments, also
        between two solutions: over all touched skin, against the pressures that the material asks for there, and on
        skin 3 to 30 mm beside. measurements: number of these; the loop makes one every 64 to 79 ticks, at 24 to some
        50 places.
        """
        sums: dict[str, FeltSums] = {}
        for found in list(self._felt)[-measurements:]:
            for name, more in found.items():
                sums[name] = sums.get(name, FeltSums()).plus(more)
        return {name: all_.felt for name, all_ in sums.items()}

    def count_fault(self, fault: Fault) -> None:
        """Count a fault."""
        if self.faults:  # an exception keeps stack frames and long texts in memory
            self.faults[-1] = replace(self.faults[-1], error=None)
        self.faults.append(fault)
        self.fault_count += 1

    def tick_ms(self, percentile: float) -> float:
        """Return a percentile of the tick times kept [ms]; 0 before the first tick."""
        times = self._times[: self.ticks]
        return float(np.percentile(times, percentile)) * 1e3 if self.ticks else 0.0

    def recent(self, count: int) -> Floats:
        """Return the times of the last ticks, at most `count`, oldest first [s]."""
        count = min(count, self.ticks, REMEMBERED)
        return self._times[np.arange(self.ticks - count, self.ticks) % REMEMBERED]

    @property
    def as_asked(self) -> bool:
        """Whether the output was what the scene asked for: no deviation, no late tick, no fault, no warning.

        Losses that skin does not feel are no deviations; `weak_samples.py` has the limits.
        """
        troubles = self.deviations.ticks, self.late_ticks, self.fault_count, len(self.warnings)
        return not any(troubles)

    @property
    def late_share(self) -> float:
        """late_ticks / ticks."""
        return self.late_ticks / max(1, self.ticks)

    @property
    def errors_at_samples(self) -> Floats:
        """Relative errors of the emitted sound pressures at the samples, at each measurement, oldest first."""
        count = min(self._measured, REMEMBERED)
        return self._errors[np.arange(self._measured - count, self._measured) % REMEMBERED]

    @property
    def error_at_samples(self) -> float:
        """Median of `errors_at_samples`; 0 before the first."""
        return float(np.median(self.errors_at_samples)) if self._measured else 0.0

    def summary(self) -> dict[str, Any]:
        """Return the report as plain values, for JSON. `error_at_samples` is None if nothing was measured."""
        return {
            "ticks": self.ticks,
            "late_ticks": self.late_ticks,
            "tick_p50_ms": self.tick_ms(50),
            "tick_p99_ms": self.tick_ms(99),
            "tick_max_ms": self.tick_ms(100),
            "stages_ms": {k: 1e3 * v / max(1, self.ticks) for k, v in self.stages.items()},
            "error_at_samples": self.error_at_samples if self._measured else None,
            "felt": {name: felt._asdict() for name, felt in self.compute_felt().items()},
            "solves": self.solves,
            "frames_sent": self.frames_sent,
            "skipped": dict(self.skipped),
            "statuses": dict(self.statuses),
            "faults": [f"tick {f.tick}, {f.stage}: {f.message}" for f in self.faults],
            "fault_count": self.fault_count,
            "deviations": {
                label: {reason: total._asdict() for reason, total in reasons.items()}
                for label, reasons in self.deviations.totals.items()
            },
            "warnings": list(self.warnings),
            "as_asked": self.as_asked,
            "interrupted": self.interrupted,
        }

    def __repr__(self) -> str:
        if not self.ticks:
            return "<Report: no ticks yet>"
        text = f"{self.ticks:,} ticks, {self.late_share:.1%} late, median {self.tick_ms(50):.2f} ms"
        text += f", error at samples {self.error_at_samples:.2%}" if self._measured else ""
        if self.deviations.ticks:
            text += f", {self.deviations.ticks:,} ticks not as asked"
        text += f", {self.fault_count} faults" if self.fault_count else ""
        if self.faults:
            text += f", the last in {self.faults[-1].stage}: {self.faults[-1].message}"
        return f"<Report: {text}{', interrupted' if self.interrupted else ''}>"

    @card
    def _repr_html_(self) -> Card:
        rows = {
            "late": f"{self.late_ticks} ({self.late_share:.1%})",
            "tick time [ms]": " ".join(f"p{p} {self.tick_ms(p):.3f}" for p in (50, 99, 100)),
            "error at samples": f"{100.0 * self.error_at_samples:.2g} % of the sound pressures asked, as emitted"
            if self._measured
            else "not measured",
            **{
                f"felt of {name}": str(felt)
                for name, felt in list(self.compute_felt().items())[:MAX_LISTED]
            },
            "solves": ", ".join(f"{n} {name}" for name, n in self.statuses.items()) or "none",
            "left out": str(split_skips(self.skipped)),
            **{
                f"{label} not as asked": describe_totals(reasons)
                for label, reasons in list(self.deviations.totals.items())[:MAX_LISTED]
            },
            "faults": self.fault_count,
        }
        if self.faults:
            rows["last fault"] = f"{self.faults[-1].stage}: {self.faults[-1].message}"
        rows |= {"interrupted": "yes"} if self.interrupted else {}
        return Card(f"{self.ticks} ticks", rows, draw=self._draw if self.ticks else None)

    def _draw(self, panel: Any) -> None:
        """Plot a histogram of the tick times."""
        panel.hist(1e3 * self.recent(REMEMBERED), bins=50)
        panel.set(xlabel="tick time [ms]", ylabel="ticks", yscale="log")


def _is_uneven(sums: FeltSums) -> bool:
    """Return whether a measurement shows clearly more or less than the target, or great unevenness."""
    felt = sums.felt
    return abs(felt.force - 1.0) > MAX_MEASURED_FORCE_ERROR or felt.rms > MAX_MEASURED_RMS
