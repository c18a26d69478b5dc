"""The definition of a quiet zone. `quiet_subspace` keeps it quiet."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.argument_checks import HEAD_RADIUS, check_number, check_numbers

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.types import Flags, Floats

MAX_RADIUS = 10.0  # largest radius of a zone [m]
LOOKED_AT = 2048  # number of points of a zone in one batch
GOLDEN = 1.0 / 1.2207440846057596 ** np.arange(1, 4)  # steps of a low-discrepancy sequence (R3)


@dataclass(frozen=True)
class Zone:
    """A ball in which the sound pressure in free air is at most `pressure` [Pa] everywhere.

    position: its centre [m]. radius: [m]; by default that of a head; 0 for a point, beside which it may be loud.
    Nothing can be felt inside it: a target there is not met, and the status is `infeasible`. Single precision keeps a
    limit of at least 1e-5 of the pressure that the whole array could make in the zone: some 0.2 Pa with 2241
    transducers at 0.4 m. If it is lower, and the zone is louder, `Solution.violations` says so.
    Raises ArgumentError.
    """

    position: tuple[float, float, float]
    _: KW_ONLY
    pressure: float
    radius: float = HEAD_RADIUS

    def __post_init__(self) -> None:
        x, y, z = check_numbers("zone.position", self.position, (3,)).tolist()
        force = object.__setattr__
        force(self, "position", (x, y, z))
        force(self, "radius", check_number("zone.radius", self.radius, low=0.0, high=MAX_RADIUS))
        force(self, "pressure", check_number("zone.pressure", self.pressure, low=0.0, above=True))

    def holds(self, points: Floats) -> Flags:
        """Return whether each of `points`, (M, 3) [m], is in the zone, (M,)."""
        return np.asarray(np.linalg.norm(points - np.array(self.position), axis=1) <= self.radius)

    def move_inside(self, points: Floats) -> Floats:
        """Return the places of the zone that are nearest to `points`, (M, 3) [m]."""
        centre = np.array(self.position)
        away = points - centre
        distance = np.linalg.norm(away, axis=1, keepdims=True)
        return np.asarray(
            centre + away * np.minimum(1.0, self.radius / np.maximum(distance, 1e-30))
        )

    def spread(self, first: int, count: int) -> Floats:
        """Return the places number `first`, `first` + 1, ... of an endless sequence, (count, 3) [m].

        Any part of the sequence is spread evenly over the zone. Half of the places are on its surface.
        """
        number = np.arange(first, first + count)
        u = np.modf((number[:, None] + 0.5) * GOLDEN)[0]
        z, angle = 2.0 * u[:, 0] - 1.0, 2.0 * np.pi * u[:, 1]
        across = np.sqrt(1.0 - z * z)
        ways = np.stack([across * np.cos(angle), across * np.sin(angle), z], axis=1)
        away = np.where(number % 2 == 0, 1.0, np.cbrt(u[:, 2]))
        return np.asarray(np.array(self.position) + self.radius * away[:, None] * ways, np.float64)

    def places(self) -> Iterator[Floats]:
        """Yield endless batches of new points in the zone, (K, 3) [m], half of them on its surface."""
        count, k = (LOOKED_AT if self.radius else 1), 0
        while True:
            yield self.spread(k, count)
            k += count
