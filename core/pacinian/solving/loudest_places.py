"""Find the loudest places of a quiet zone: look at many places, then climb from the loudest of them."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.propagation import CHUNK, field

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.solving.quiet_zone import Zone
    from pacinian.types import Complexes, Floats, Gains

# Largest number of places from which a thorough search climbs, and number of steps of each climb.
THOROUGH_MAX_CLIMBS, THOROUGH_CLIMB_STEPS = 16, 10
QUICK_MAX_CLIMBS, QUICK_CLIMB_STEPS = 4, 3  # the same for a quick search
FIRST_STEP = 0.25  # length of the first step, relative to the wavelength
# Directions of the steps: the axes and the diagonals of space, unit vectors, (14, 3).
WAYS = np.array(
    [
        way
        for way in itertools.product((-1.0, 0.0, 1.0), repeat=3)
        if sum(map(abs, way)) in (1.0, 3.0)
    ]
)
WAYS /= np.linalg.norm(WAYS, axis=1, keepdims=True)
SPACING = 0.25  # distance of the places of a thorough search on a zone's surface, relative to the wavelength
MIN_PLACES, MAX_PLACES = 2048, 1 << 16  # range of the number of places of a thorough search


def climb(
    measure: Callable[[Floats], Floats], zone: Zone, starts: Floats, length: float, steps: int
) -> tuple[Floats, Floats]:
    """Climb from `starts` to local maxima; return the places, (S, 3) [m], and their loudness, (S,).

    measure: returns the loudness at places, (K, 3) [m], as an array of shape (K,). starts: in the zone, (S, 3) [m].
    length: of the first step [m]; it is halved where no step leads higher. steps: number of steps.
    """
    at, found, lengths = starts, measure(starts), np.full(len(starts), length)
    for _ in range(steps if zone.radius else 0):
        tried = at[:, None] + lengths[:, None, None] * WAYS  # (S, 14, 3)
        tried = zone.move_inside(tried.reshape(-1, 3))
        loud = measure(tried).reshape(len(at), -1)
        way = np.arange(len(at)), loud.argmax(axis=1)
        higher = loud[way] > found
        at = np.where(higher[:, None], tried.reshape(len(at), -1, 3)[way], at)
        found = np.where(higher, loud[way], found)
        lengths = np.where(higher, lengths, lengths / 2.0)
    return at, found


def pick_starts(places: Floats, loud: Floats, count: int) -> Floats:
    """Return the loudest of each of at most `count` parts of `places`, (K, 3) [m], of loudness (K,)."""
    parts = np.array_split(np.arange(len(places)), min(count, len(places)))
    return np.asarray(places[[part[loud[part].argmax()] for part in parts]], np.float64)


def find_peak(array: Array, medium: Air, g: Complexes, zone: Zone, near: Floats) -> float:
    """Return the highest sound pressure [Pa] of gains, (N,), in a zone, by a thorough search in double precision.

    near: points, (M, 3) [m], such as foci: the places of the zone that are nearest to them are looked at, too.
    """

    def measure(q: Floats) -> Floats:
        return np.abs(field(array, g, q, medium))

    wavelength = medium.wavelength(array.transducer.frequency)
    places = spread_thoroughly(zone, wavelength)
    starts = pick_starts(places, measure(places), THOROUGH_MAX_CLIMBS)
    if len(near):
        beside = zone.move_inside(near)
        nearest = pick_starts(beside, measure(beside), THOROUGH_MAX_CLIMBS)
        starts = np.concatenate([starts, nearest])
    at, _ = climb(measure, zone, starts, FIRST_STEP * wavelength, THOROUGH_CLIMB_STEPS)
    return float(np.abs(field(array, g, at, medium, "double")).max())


def find_peak_nearby(
    array: Array, medium: Air, g: Gains, zone: Zone, places: Floats, loud: Floats
) -> float:
    """Return the highest sound pressure [Pa] of gains, (N,), to which a short climb from the loudest places leads.

    places: in the zone, (K, 3) [m]. loud: the loudness there, (K,), in any unit. Evaluates about a hundred
    pressures.
    """
    few = max(1, CHUNK // (2 * len(array)))  # so few that `field` starts no threads

    def measure(q: Floats) -> Floats:
        parts = [field(array, g, q[k : k + few], medium) for k in range(0, len(q), few)]
        return np.asarray(np.abs(np.concatenate(parts)), np.float64)

    length = FIRST_STEP * medium.wavelength(array.transducer.frequency)
    starts = places[np.argsort(-loud)[:QUICK_MAX_CLIMBS]]
    return float(climb(measure, zone, starts, length, QUICK_CLIMB_STEPS)[1].max())


def spread_thoroughly(zone: Zone, wavelength: float) -> Floats:
    """Return places in a zone for a thorough search, (K, 3) [m], half of them on its surface.

    There, they are a quarter of the wavelength [m] apart, but there are at most MAX_PLACES.
    """
    if not zone.radius:
        return zone.spread(0, 1)
    area = 4.0 * math.pi * zone.radius**2
    count = round(min(2.0 * area / (SPACING * wavelength) ** 2, float(MAX_PLACES)))
    return zone.spread(0, max(count, MIN_PLACES))
