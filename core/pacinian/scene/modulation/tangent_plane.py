"""The tangent plane of a contact, and directions perpendicular to normals."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Floats

STEEP = 0.1  # an axis gives no direction across a normal if the sine of their angle is smaller than this
THIN = 1e-6  # samples lie on a line if their squared width over their squared length is smaller than this
MIN_EXTENT = 1e-6  # samples lie at one point if their extent is smaller than this [m]


class Plane(NamedTuple):
    """The tangent plane of a contact.

    centre: (3,) [m]. axes: x, y and normal of the plane as rows, (3, 3). normal: of the skin, (3,), or zero.
    """

    centre: Floats
    axes: Floats
    normal: Floats


def compute_weights(samples: Samples) -> Floats:
    """Return each sample's share of the total radiation pressure, (M,); equal shares if that is 0."""
    p = samples.radiation_pressure
    total = float(p.sum())
    return p / total if total > 0.0 else np.full(len(p), 1.0 / len(p))


def fit_plane(samples: Samples, w: Floats, frame: Floats) -> Plane:
    """Return the plane through the mean position, perpendicular to the mean normal, with weights w, (M,).

    If normals are missing or cancel, the plane is fitted to the positions. frame: axes as columns, (3, 3). Its x-axis
    gives the x-axis of the plane; its y-axis replaces x if x is too steep; its z-axis is the normal if no plane fits.
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
    """Return the direction of `first` across the unit vector n, all (3,), or of `second` if `first` is steep."""
    d = first - (first @ n) * n
    if d @ d < STEEP**2:
        d = second - (second @ n) * n
    return np.asarray(d / np.sqrt(d @ d))


def find_tangents(normals: Floats, angle: float, frame: Floats) -> Floats:
    """Return unit vectors perpendicular to normals, (M, 3), rotated by `angle` [rad] from the frame's x-axis.

    frame: as for `fit_plane`. Its z-axis replaces normals that are zero.
    """
    n = np.where(normals.any(axis=1, keepdims=True), normals, frame[:, 2])
    along = n @ frame  # (M, 3): cosines to x, y and z
    steep = 1.0 - along[:, :1] ** 2 < STEEP**2
    d = np.where(steep, frame[:, 1] - along[:, 1:2] * n, frame[:, 0] - along[:, :1] * n)
    d /= np.sqrt((d * d).sum(axis=1, keepdims=True))
    return np.asarray(np.cos(angle) * d + np.sin(angle) * _cross(n, d))


def _cross(a: Floats, b: Floats) -> Floats:
    """Return the cross product. np.cross takes three times as long."""
    return np.asarray(a[..., [1, 2, 0]] * b[..., [2, 0, 1]] - a[..., [2, 0, 1]] * b[..., [1, 2, 0]])


def _fit(d: Floats, frame: Floats) -> Floats:
    """Return the normal of the plane fitted to points d about their centre, (M, 3) [m], on the frame's upper side."""
    x, y, z = frame[:, 0], frame[:, 1], frame[:, 2]
    squares, directions = np.linalg.eigh(d.T @ d)
    if squares[2] < MIN_EXTENT**2:
        return z
    if squares[1] < THIN * squares[2]:
        return across(directions[:, 2], z, y)
    n = directions[:, 0]
    up = next(c for c in (n @ z, n @ y, n @ x) if abs(c) > STEEP)
    return np.asarray(n if up > 0.0 else -n)
