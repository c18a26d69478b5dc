"""Arrangements in a plane: positions of transducers [m], (N, 2), about the origin."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.types import Flags, Floats

GOLDEN = math.pi * (3.0 - math.sqrt(5.0))  # [rad], the golden angle
DARTS = 1000  # darts thrown at once


def hexagonal(width: float, height: float, pitch: float) -> Floats:
    """Return rows along x that are pitch sqrt(3) / 2 apart, with every other one shifted by half a pitch."""
    rise = pitch * math.sqrt(3.0) / 2.0
    below = math.floor(height / 2.0 / rise + 1e-9)
    rows: list[Floats] = []
    for j in range(-below, below + 1):
        shift = pitch / 2.0 if j % 2 else 0.0
        beside = math.floor((width / 2.0 - shift) / pitch + 1e-9)
        x = shift + pitch * np.arange(-beside - (1 if j % 2 else 0), beside + 1)
        rows.append(np.column_stack([x, np.full(len(x), j * rise)]).astype(np.float64))
    return np.concatenate(rows)


def sunflower(count: int, diameter: float) -> Floats:
    """Return Fermat's spiral: number n at radius (diameter / 2) sqrt((n + 1/2) / count) and at n golden angles.

    A single place is the origin.
    """
    if count == 1:
        return np.zeros((1, 2))
    n = np.arange(count)
    radius, angle = diameter / 2.0 * np.sqrt((n + 0.5) / count), n * GOLDEN
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def rings(diameter: float, pitch: float) -> Floats:
    """Return concentric rings: ring k has the radius k pitch, and as many places as fit at this pitch."""
    places = [np.zeros((1, 2))]
    for k in range(1, math.floor(diameter / 2.0 / pitch + 1e-9) + 1):
        count = math.floor(2.0 * math.pi * k)
        angle = 2.0 * math.pi / count * np.arange(count)
        places.append(k * pitch * np.column_stack([np.cos(angle), np.sin(angle)]))
    return np.concatenate(places)


def scatter_points(
    width: float, height: float, count: int, apart: float, rng: np.random.Generator
) -> Floats:
    """Throw darts at a rectangle, and reject those nearer than `apart` [m] to an earlier one.

    Raises ArgumentError if none of `DARTS` darts finds room.
    """
    half = np.array([width, height]) / 2.0
    places = np.empty((0, 2))
    while len(places) < count:
        darts = rng.uniform(-half, half, (DARTS, 2))
        if len(places):
            darts = darts[cKDTree(places).query(darts)[0] >= apart]
        if not len(darts):
            raise ArgumentError(
                "apart",
                f"of {apart:g} m leaves room for {len(places)} of {count}: lower it, or the count",
            )
        places = np.concatenate([places, darts[_first(darts, apart)]])
    return places[:count]


def _first(darts: Floats, apart: float) -> Flags:
    """Return which darts are not near an earlier accepted one, (K,)."""
    landed = np.ones(len(darts), dtype=np.bool_)
    pairs = cKDTree(darts).query_pairs(apart, output_type="ndarray")
    for i, j in pairs[np.argsort(pairs[:, 0], kind="stable")].tolist():
        landed[j] &= not landed[i]
    return landed
