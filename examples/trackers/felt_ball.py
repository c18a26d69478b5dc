"""A ball of 6 cm above the array, felt by tracked hands: what the tracker examples have in common."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

import pacinian as pc

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

BALL = pc.Volume(
    shape=pc.Sphere(0.03),
    pose=pc.Pose((0.0, 0.0, 0.2)),  # [m] above the middle of the array
    radiation_pressure=8.0,  # [Pa]
    envelope=pc.Sine(150.0),
    name="ball",
)


def feel(read_hands: Callable[[], Sequence[pc.Hand]], seconds: float = math.inf) -> None:
    """Send the hands that `read_hands` returns, 100 times a second or as often as it returns, for `seconds` [s]."""
    with pc.Client(name="tracker") as client:
        client.put(BALL)
        client.arm()
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            client.hands(*read_hands(), wait=False)  # none: nothing is felt
            client.renew()  # while the tracker hangs, this is not called, and the output is silent
            time.sleep(0.01)
