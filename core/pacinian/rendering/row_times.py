"""When the rows of a tick sound: a tick has as many as the device takes meanwhile."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.plugins.backend import Capability
    from pacinian.types import Floats

MAX_MISMATCH = 1e-3  # largest relative difference of the rows that a device plays and gets
MAX_ROWS = 1000  # largest number of rows of a tick
MAX_SERVER_ROWS = 64  # the same for the server, whose frames have a fixed size in shared memory


def compute_row_times(capability: Capability, period: float) -> tuple[Floats, float]:
    """Return the times of a tick's rows from its start, (K,) [s], and the interval between them [s].

    Raises ArgumentError.
    """
    rate = 1.0 / period
    if capability.rate < rate * (1.0 - 1e-9):
        raise ArgumentError("rate", f"of {rate:g} Hz is above the backend's {capability.rate:g} Hz")
    count = max(1, round(capability.rate / rate))  # rows per tick
    if count > MAX_ROWS:
        raise ArgumentError(
            "rate", f"of {rate:g} Hz makes {count} rows a tick, more than {MAX_ROWS}"
        )
    gap = period / count
    times: Floats = np.arange(count, dtype=np.float64) * gap
    return times, gap


def check_server_rate(device: float, loop: float) -> None:
    """Check that a device of `device` rows a second suits a server's loop of `loop` ticks a second.

    Raises ArgumentError.
    """
    if not 1.0 - 1e-9 <= device / loop < MAX_SERVER_ROWS + 0.5:
        raise ArgumentError(
            "rate",
            f"must be {device / MAX_SERVER_ROWS:.3g} to {device:g} for this device, which plays {device:g} rows a "
            f"second, 1 to {MAX_SERVER_ROWS} rows a tick; it is {loop:g}",
        )


def describe_mismatch(capability: Capability, period: float) -> str | None:
    """Return a warning if the device's rate is no multiple of the loop's, else None."""
    rate = 1.0 / period
    count = len(compute_row_times(capability, period)[0])
    played = capability.rate / (count * rate)
    if abs(played - 1.0) < MAX_MISMATCH:
        return None
    return (
        f"the device plays {capability.rate:g} rows a second, but the loop sends {count * rate:g}, {count} in each "
        f"tick. Vibrations may be played at {played:.3g} times their frequency. Let the device's rate be a multiple of "
        "the loop's `rate`"
    )
