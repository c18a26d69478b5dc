"""The tangent plane of a contact, and directions across normals."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Floats

STEEP = 0.1  # sine of the angle to a normal below which an axis gives no direction across it
THIN = 1e-6  # squared width over squared length below which samples lie on a line
MIN_EXTENT = 1e-6  # [m] across which they are at one place


class Plane(NamedTuple):
    """Where a contact lies.

    centre: (3,) [m]. axes: its x, y and normal as rows, (3, 3). normal: of the skin, (3,), or zero.
    """

    centre: Floats
    axes: Floats
    normal: Floats


def compute_weights(samples: Samples) -> Floats:
    """Each sample's share of the radiation pressure, (M,); where there is none, equal ones."""
    p = samples.radiation_pressure
    total = float(p.sum())
    return p / total if total > 0.0 else np.full(len(p), 1.0 / len(p))


def fit_plane(samples: Samples, w: Floats, frame: Floats) -> Plane:
    """The plane across the mean normal at the mean position, with weights w, (M,).

    Where normals are missing or cancel, the one that fits the positions. frame: axes as columns, (3, 3);
    its x-axis gives the plane's, y stands in where x is steep, and z where there is no plane.
    """
    centre, normal = w @ samples.positions, w @ samples.normals
    size = float(np.sqrt(normal @ normal))
    if size > STEEP:
        n = normal = normal / size
    else:
        n, normal = _fit(samples.positions - centre, frame), np.zeros(3)
    x = across(n, frame[:, 0], frame[:, 1])
    return Plane(centre, np.array([x, _cross(n, x), n]), normal)


def across(n: Floats, first: Floats, second: Floats) -> Floats:
    """The direction of `first` across the unit vector n, all (3,); of `second` where that is steep."""
    d = first - (first @ n) * n
    if d @ d < STEEP**2:
        d = second - (second @ n) * n
    return np.asarray(d / np.sqrt(d @ d))


def find_tangents(normals: Floats, angle: float, frame: Floats) -> Floats:
    """Unit directions across normals, (M, 3), at `angle` [rad] from the frame's x-axis about them.

    frame: as for `fit_plane`; its z-axis stands in for normals that are zero.
    """
    n = np.where(normals.any(axis=1, keepdims=True), normals, frame[:, 2])
    along = n @ frame  # (M, 3): cosines to x, y and z
    steep = 1.0 - along[:, :1] ** 2 < STEEP**2
    d = np.where(steep, frame[:, 1] - along[:, 1:2] * n, frame[:, 0] - along[:, :1] * n)
    d /= np.sqrt((d * d).sum(axis=1, keepdims=True))
    return np.asarray(np.cos(angle) * d + np.sin(angle) * _cross(n, d))


def _cross(a: Floats, b: Floats) -> Floats:
    """As np.cross, which takes three times as long."""
    return np.asarray(a[..., [1, 2, 0]] * b[..., [2, 0, 1]] - a[..., [2, 0, 1]] * b[..., [1, 2, 0]])


def _fit(d: Floats, frame: Floats) -> Floats:
    """Normal of the plane that fits points d about their centre, (M, 3) [m], on the frame's upper side."""
    x, y, z = frame[:, 0], frame[:, 1], frame[:, 2]
    squares, directions = np.linalg.eigh(d.T @ d)
    if squares[2] < MIN_EXTENT**2:
        return z
    if squares[1] < THIN * squares[2]:
        return across(directions[:, 2], z, y)
    n = directions[:, 0]
    up = next(c for c in (n @ z, n @ y, n @ x) if abs(c) > STEEP)
    return np.asarray(n if up > 0.0 else -n)
