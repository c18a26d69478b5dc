"""Whether the ticks of a run were on time, in words; if not, why, and what to do."""

from __future__ import annotations

import os
import time
from typing import Any

from pacinian.skip_reasons import MISSED_TICKS

TIMELY_SHARE = 0.95  # share of ticks on time from which a run, or a server, counts as on time
# share of all processors from which other programs count as the cause of late ticks
OTHERS_SHARE = 0.25
ENDED_EARLY_SHARE = 0.5  # share of the solves from which it is said that they ended early


class ProcessorMeter:
    """Measures which share of all processors other programs take."""

    def __init__(self) -> None:
        self._begin = self._read()

    def _read(self) -> tuple[float, float, float]:
        """Return the time of the clock, of this process and of all programs on the processors [s]."""
        import psutil

        times = psutil.cpu_times()._asdict()
        idle = ("idle", "iowait", "guest", "guest_nice")  # guests' time is part of user's
        busy = sum(spent for name, spent in times.items() if name not in idle)
        return time.perf_counter(), time.process_time(), busy

    def measure_others(self) -> float:
        """Return the share since the start, 0 to 1."""
        wall, own, busy = (
            end - begin for end, begin in zip(self._read(), self._begin, strict=True)
        )
        everything = (os.cpu_count() or 1) * wall
        return min(1.0, max(0.0, (busy - own) / everything)) if everything else 0.0


def judge_pace(figures: dict[str, Any], remedy: str) -> str:
    """Return in words whether the ticks of a run were on time; if not, why, and what to do.

    figures: a summary. remedy: what helps if the machine is too slow for the scene.
    """
    planned, timely = _count_ticks(figures)
    if not planned:
        return ""
    on_time = f"{timely / planned:.0%} of the {planned:,} planned ticks were on time"
    if timely >= TIMELY_SHARE * planned:
        return f"{on_time}.{_describe_early(figures)}"
    took, others, due = figures["tick_p50_ms"], figures["others_share"], 1e3 / figures["rate"]
    text = (
        f"{on_time}. A tick has {due:g} ms; the median took {took:.1f} ms, "
        f"the slowest 1% took {figures['tick_p99_ms']:.1f} ms or more."
    )
    if figures["tick_p99_ms"] < due:
        text += " Many began late."
    text += _describe_early(figures)
    if others is not None and others >= OTHERS_SHARE:
        return (
            f"{text} Other programs took {others:.0%} of the processors: close them, or {remedy}."
        )
    if took >= due:
        return f"{text} This machine is too slow for this scene at this rate: {remedy}."
    return f"{text} To improve this, {remedy}."


def describe_success(figures: dict[str, Any]) -> str:
    """Return one sentence for a newcomer who asks only whether it worked; "" after a fault or an interruption."""
    planned, timely = _count_ticks(figures)
    if figures["fault_count"] or figures["interrupted"] or not timely:
        return ""
    if timely >= TIMELY_SHARE * planned:
        return "It works."
    return f"It works; this machine was too slow for {1.0 - timely / planned:.0%} of the ticks."


def _count_ticks(figures: dict[str, Any]) -> tuple[int, int]:
    """Return the number of ticks of a run that were planned, and of those on time."""
    planned = figures["ticks"] + figures["skipped"].get(MISSED_TICKS, 0)
    return planned, figures["ticks"] - figures["late_ticks"]


def _describe_early(figures: dict[str, Any]) -> str:
    """Say how many solves ended early, if many did."""
    solves = sum(figures["statuses"].values())
    early = figures["statuses"].get("deadline", 0)
    if early < ENDED_EARLY_SHARE * solves or not early:
        return ""
    return f" {early:,} of {solves:,} solves ran out of time, which makes the pressure weaker or less even."
