"""Hands of a Leap Motion Controller, through Ultraleap's leapc-python-bindings. Start `pacinian serve` first."""

# pyright: basic, reportMissingImports=false
from __future__ import annotations

import math
from typing import Literal

import leap
import numpy as np

import pacinian as pc

# The controller's place in the array's frame: 15 cm in front of the middle. It has y up and the array has z up.
PLACE = pc.Pose((0.0, -0.15, 0.0)).rotate("x", math.pi / 2.0)
MM = 1e-3


class HandReader(leap.Listener):  # type: ignore[misc]
    """Keeps the hands of the newest frame. Ultraleap's thread calls `on_tracking_event`."""

    def __init__(self) -> None:
        super().__init__()
        self.hands: list[pc.Hand] = []

    def on_tracking_event(self, event: leap.events.TrackingEvent) -> None:
        """Keep the hands of a frame."""
        self.hands = [make_hand(hand) for hand in event.hands]

    def read(self) -> list[pc.Hand]:
        """Return the tracked hands, in the array's frame."""
        return self.hands


def make_hand(hand: leap.datatypes.Hand) -> pc.Hand:
    """Return a hand from the layout of LeapC."""
    bones = [
        [[list(bone.prev_joint), list(bone.next_joint)] for bone in digit.bones]
        for digit in hand.digits
    ]
    widths = [[bone.width for bone in digit.bones] for digit in hand.digits]
    wrist = list(hand.arm.next_joint)
    side: Literal["left", "right"] = "left" if hand.type == leap.HandType.Left else "right"
    return pc.Hand.leap(
        MM * np.array(bones), MM * np.array(widths), MM * np.array(wrist), side
    ).transform(PLACE)


if __name__ == "__main__":
    from felt_ball import feel

    reader, connection = HandReader(), leap.Connection()
    connection.add_listener(reader)
    with connection.open():
        connection.set_tracking_mode(leap.TrackingMode.Desktop)
        feel(reader.read)
