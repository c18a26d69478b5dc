"""Quiet zones: balls in which the sound pressure is limited."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.argument_checks import HEAD_RADIUS, MAX_LENGTH, check_number, check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.acoustics.array import Array
    from pacinian.types import Flags, Floats

# Largest radius of a zone [m]: any plausible length. `serving/settings.py` and `wire/commands.py` allow 1 m, because
# the server is silent while it prepares a zone, and larger zones take longer.
MAX_RADIUS = 10.0
PLACES_PER_BATCH = 2048  # number of places that `Zone.places` yields at a time
# Steps of a low-discrepancy sequence, R3.
R3_STEPS = 1.0 / 1.2207440846057596 ** np.arange(1, 4)


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
        u = np.modf((number[:, None] + 0.5) * R3_STEPS)[0]
        z, angle = 2.0 * u[:, 0] - 1.0, 2.0 * np.pi * u[:, 1]
        across = np.sqrt(1.0 - z * z)
        ways = np.stack([across * np.cos(angle), across * np.sin(angle), z], axis=1)
        away = np.where(number % 2 == 0, 1.0, np.cbrt(u[:, 2]))
        return np.asarray(np.array(self.position) + self.radius * away[:, None] * ways, np.float64)

    def places(self) -> Iterator[Floats]:
        """Yield endless batches of new points in the zone, (K, 3) [m], half of them on its surface."""
        count, k = (PLACES_PER_BATCH if self.radius else 1), 0
        while True:
            yield self.spread(k, count)
            k += count


def check_zone_place(zone: Zone, array: Array, name: str = "zone") -> None:
    """Check that a zone is near an array and contains none of its transducers.

    name: argument that the error names. Raises ArgumentError.
    """
    away = math.dist(array.centre, zone.position)  # [m]
    if away > MAX_LENGTH:
        raise ArgumentError(
            name,
            f"is {away:.4g} m from the array's centre, more than {MAX_LENGTH:g} m: "
            "give metres, not millimetres",
        )
    distances = np.linalg.norm(array.positions - np.array(zone.position), axis=1)  # (N,) [m]
    if (nearest := float(distances.min(initial=np.inf))) <= zone.radius:
        raise ArgumentError(
            name,
            f"must not contain a transducer: the nearest is {nearest:.3g} m from its centre, and its radius is "
            f"{zone.radius:g} m: make the zone smaller, or move it away from the array",
        )
