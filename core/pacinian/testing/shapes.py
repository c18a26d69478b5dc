"""Samples of flat, curved and nested surfaces, for problems with regions."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import ArrayLike, Floats, Longs

HEIGHT = 0.1  # height of the samples [m]
SPACING = 0.003  # distance of samples, 0.35 wavelengths [m]


class Shape(NamedTuple):
    """Samples (M, 3) [m] and the region of each, (M,). The targets of samples beside regions are 0."""

    points: Floats
    regions: Longs


def make_points(x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Floats:
    """Return points (M, 3) [m] from their coordinates."""
    made: Floats = np.stack(np.broadcast_arrays(x, y, z), axis=1).astype(np.float64)
    return made


def make_line(count: int, spacing: float = SPACING) -> Floats:
    """Return samples in a row, (count, 3)."""
    x = np.asarray(spacing * (np.arange(count) - (count - 1) / 2.0))
    return make_points(x, 0.001, HEIGHT)


def make_square(count: int, x: float = 0.0, z: float = HEIGHT, spacing: float = SPACING) -> Floats:
    """Return a square of samples, (count^2, 3), centred on `x`."""
    side = spacing * (np.arange(count) - (count - 1) / 2.0)
    X, Y = np.meshgrid(x + side, side)
    return make_points(X.ravel(), Y.ravel(), z)


def make_ring(inner: float, outer: float) -> Floats:
    """Return samples on concentric rings with radii from `inner` to `outer` [m], inclusive."""
    made: list[Floats] = []
    for r in np.linspace(inner, outer, 1 + max(1, round((outer - inner) / SPACING))):
        count = max(1, round(2.0 * np.pi * float(r) / SPACING))
        angle = 2.0 * np.pi * np.arange(count) / count
        made.append(make_points(r * np.cos(angle), r * np.sin(angle), HEIGHT))
    return np.concatenate(made)


def make_finger() -> Floats:
    """Return samples of half a cylinder along y, 16 mm wide and 15 mm long, which faces the array."""
    radius, length = 0.008, 0.015
    angle = np.linspace(-np.pi / 2.0, np.pi / 2.0, round(np.pi * radius / SPACING) + 1)
    y = np.linspace(-length / 2.0, length / 2.0, round(length / SPACING) + 1)
    A, Y = (each.ravel() for each in np.meshgrid(angle, y))
    return make_points(radius * np.sin(A), Y, HEIGHT - radius * np.cos(A))


def of(*parts: Floats) -> Shape:
    """Make each part a region."""
    return Shape(np.concatenate(parts), np.repeat(np.arange(len(parts)), [len(q) for q in parts]))
