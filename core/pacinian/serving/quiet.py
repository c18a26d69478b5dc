"""Quiet zones as points: a ball by its centre and twelve points spread evenly on its surface."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.serving.messages import SetQuiet

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.serving.settings import Zone as OurZone
    from pacinian.types import Floats
    from pacinian.wire.commands import Zone

AROUND = 12
TURN = np.pi * (3.0 - np.sqrt(5.0))  # [rad], the golden angle


def sphere(count: int) -> Floats:
    """Points on the unit sphere, (count, 3): equal steps in z, a golden angle apart."""
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    radius, angle = np.sqrt(1.0 - z * z), TURN * np.arange(count)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)


BALL = np.concatenate([np.zeros((1, 3)), sphere(AROUND)])


def count(zones: Iterable[Zone | OurZone]) -> int:
    """How many points they make."""
    return sum(len(BALL) if zone.radius else 1 for zone in zones)


def quiet(zones: Iterable[Zone | OurZone]) -> SetQuiet:
    """All points and their limits."""
    points: list[Floats] = [np.zeros((0, 3))]
    limits: list[float] = []
    for zone in zones:
        ball = BALL if zone.radius else BALL[:1]
        points.append(np.array(zone.position) + zone.radius * ball)
        limits += [zone.pressure] * len(ball)
    return SetQuiet(
        np.concatenate(points).astype("<f8").tobytes(), np.array(limits, "<f8").tobytes()
    )
