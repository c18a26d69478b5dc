"""Drive and error of a feed file before a time, so that the charts are filled at once."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from pacinian.viewing.messages import WRONG, History
from pacinian.wire.codec import decode_state
from pacinian.wire.state import FrameState

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.viewing.array_model import ArrayModel
    from pacinian.viewing.feed_file import Entry, FeedFile

CHART_SPAN = 30.0  # time that the charts show [s]; also in viewer/src/panels/chart-series.ts
MAX_MESSAGES = 240  # maximum number of messages that are read, per kind


def collect_history(recorded: FeedFile, before: Sequence[Entry], model: ArrayModel) -> History:
    """Collect the last `CHART_SPAN` seconds of the entries `before` a time. Damaged messages are skipped."""
    begin = before[-1].at - CHART_SPAN if before else 0.0
    late = [entry for entry in before if entry.at >= begin]
    rows: dict[float, list[float]] = {}
    for kind in ("frame", "state"):
        some = [entry for entry in late if entry.kind == kind]
        for entry in some[:: 1 + len(some) // MAX_MESSAGES]:
            with suppress(*WRONG):
                message = decode_state(recorded.data(entry))
                row = rows.setdefault(message.time, [np.nan, np.nan, np.nan])
                if isinstance(message, FrameState):
                    size = np.abs(np.frombuffer(model.gains(message) or bytes(8), np.complex64))
                    row[:2] = float(size.mean()), float(size.max())
                elif message.asked:
                    row[2] = message.error
    times = sorted(rows)
    values = np.array([rows[time] for time in times], np.float32).reshape(-1, 3)
    return History(
        times=np.array(times, "<f8").tobytes(),
        drive_mean=values[:, 0].tobytes(),
        drive_max=values[:, 1].tobytes(),
        error=values[:, 2].tobytes(),
    )
