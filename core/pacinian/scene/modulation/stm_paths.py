"""Paths of a single focus that represents all samples of an object in turn."""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from pacinian.native import scene as kernels
from pacinian.scene.modulation.tangent_plane import compute_weights, fit_plane
from pacinian.scene.shapes.arc_length import MIN_LENGTH, Polyline3D

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.scene.sampling.samples import Samples
    from pacinian.scene.shapes.curves import Curve
    from pacinian.types import Floats, Indices

DIGITS = 9  # decimal places to which coordinates are rounded, in metres

Route: TypeAlias = "Callable[[int, int], Samples]"
"""Returns the focus at place i of n on a path."""


def visit_one_by_one(samples: Samples) -> Route:
    """Move from sample to sample on a short tour, which starts at the lowest key, with equal time at each.

    The focus has the radiation pressure of the current sample. If there are more samples than places, some are left
    out.
    """
    by_key = np.argsort(samples.keys, kind="stable")
    order = by_key[_order_through(np.ascontiguousarray(samples.positions[by_key]))]

    @functools.cache
    def stop(m: int) -> Samples:
        return _replace_key(samples.only(order[m : m + 1]))

    return lambda i, n: stop(i * len(order) // n)


def visit_around(samples: Samples, frame: Floats) -> Route:
    """Move around the samples at constant speed, along their convex hull in the tangent plane.

    The path starts in the direction of the plane's x-axis, and goes towards y. frame: as for `fit_plane`. The radiation
    pressure is the mean of the samples, weighted by their pressures, so that samples that hardly press do not count.
    """
    w = compute_weights(samples)
    centre, axes, _ = fit_plane(samples, w, frame)
    flat = (samples.positions - centre) @ axes.T[:, :2]
    corners = _order_around(flat, np.lexsort((flat[:, 1], flat[:, 0])))
    ring = np.concatenate([corners, corners[:1]])
    pieces = Polyline3D(np.concatenate([samples.positions[ring], samples.normals[ring]], axis=1))
    mean, start = _mean(samples, w, np.zeros(3)), _start(flat[ring], pieces.arc)
    length = max(pieces.length, MIN_LENGTH)

    def focus(i: int, n: int) -> Samples:
        here = pieces.at(np.array([(start + length * i / n) % length]))
        position, normal = here[:, :3], here[:, 3:]
        size = np.sqrt((normal * normal).sum())
        return replace(mean, positions=position, normals=normal / size if size else normal)

    return focus


def visit_along(samples: Samples, curve: Curve, frame: Floats) -> Route:
    """Move along a curve in the tangent plane of the samples, around their centre.

    frame: as for `fit_plane`. The radiation pressure is that of `visit_around`.
    """
    w = compute_weights(samples)
    centre, axes, normal = fit_plane(samples, w, frame)
    mean = _mean(samples, w, normal)
    return lambda i, n: replace(mean, positions=centre + curve.at(np.array([i / n])) @ axes)


def _order_through(q: Floats) -> Indices:
    """Return the indices of points q, (M, 3) [m], on a tour from the first one, always to the nearest one left."""
    order = np.empty(len(q), dtype=np.int64)
    kernels.visit_through(q, order)
    return order


def _order_around(q: Floats, order: Indices) -> Indices:
    """Return the indices of the convex hull of points q, (M, 2) [m], anticlockwise; of points on a line, the two ends.

    order: of the points by x, then y, (M,). Andrew's monotone chain: the lower side, then the upper one.
    """
    corners = np.empty(2 * len(q) + 1, dtype=np.int64)
    return corners[: kernels.visit_around(q, order, corners)]


def _replace_key(one: Samples) -> Samples:
    """Return the sample with the key of its object's focus, which never changes and belongs to no other sample."""
    return replace(one, keys=np.asarray(-1 - one.objects, dtype=np.int64))


def _mean(samples: Samples, w: Floats, normal: Floats) -> Samples:
    """Return one sample that represents all, with weights w, (M,), and a normal, (3,)."""
    return replace(
        _replace_key(samples.only(np.zeros(1, dtype=np.intp))),
        radiation_pressure=np.array([w @ samples.radiation_pressure]),
        normals=normal[None],
        area=np.array([w @ samples.area]),
    )


def _start(ring: Floats, arc: Floats) -> float:
    """Return the arc length at which a ring of corners, (C + 1, 2) [m], crosses the x-axis through its middle [m].

    arc: arc length up to each corner, (C + 1,) [m]. Extra corners on a side change neither the result nor the middle.
    """
    d = ring[1:] - ring[:-1]
    sides = np.sqrt((d * d).sum(axis=1))
    middle = sides @ (ring[1:, 1] + ring[:-1, 1]) / (2.0 * max(sides.sum(), MIN_LENGTH))
    y = np.round(ring[:, 1] - middle, DIGITS)
    i = int(((y[:-1] <= 0.0) & (y[1:] > 0.0)).argmax())
    rise = y[i + 1] - y[i]
    return float(arc[i] + (-y[i] / rise if rise > 0.0 else 0.5) * (arc[i + 1] - arc[i]))
