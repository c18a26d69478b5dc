"""The error of the radiation pressure on regions, for a slice: delivered minus target, also between the samples."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np

if TYPE_CHECKING:
    from scipy.spatial import KDTree

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import Flags, Floats, Gains, Indices
    from pacinian.wire.state import State

# maximum distance of a point of the slice from a sample of a region [m]
MAX_SAMPLE_DISTANCE = 0.005
# Minimum distance of outside places from samples [m]; closer, pressure still falls.
MIN_OUTSIDE_DISTANCE = 0.003
CLOSE = 1.7  # radius of the samples that can surround a place, over the spacing of samples
NEIGHBOURS = 4  # number of samples that set the height of a point
AROUND = 12  # number of nearest samples examined for each place
MERGE_DISTANCE = 1e-4  # distance below which two places are the same [m]
MAX_INSIDE_ANGLE = np.pi + 1e-3  # maximum angle between neighbours of an inside place [rad]
MAX_PAIRS = 1 << 21  # maximum number of place-transducer pairs per batch
JOINTS = 26  # joints of a hand


class Regions(NamedTuple):
    """The samples of a state, (M, ...) each, as bytes so that they can be compared.

    points: (M, 3) float32 [m]. normals: (M, 3) float32. asked: target radiation pressure, mean over the modulation,
    (M,) float32 [Pa]. objects: index of each sample's object, (M,) int32; -1 if it has no region. hands: joints,
    (hands, 26, 3) float32 [m]; if there are hands, only sound along the normals counts.
    """

    points: bytes
    normals: bytes
    asked: bytes
    objects: bytes
    hands: bytes

    @classmethod
    def of(cls, state: State, strengths: Floats) -> Self | None:
        """Read the samples; return None if no object has a region. Raises ValueError or IndexError if damaged.

        strengths: mean strength of each object over its modulation, 0..1.
        """
        known = np.isfinite(np.frombuffer(state.felt, "<f4").reshape(-1, 4)[:, 0])
        if not known.any():
            return None
        index = np.frombuffer(state.index, "<i4")
        own = np.where(known[index], index, -1).astype("<i4")
        rows = len(index)
        if not len(state.points) == len(state.normals) == 12 * rows == 3 * len(state.asked):
            raise ValueError(f"not as many points, normals and pressures as samples: {rows}")
        if len(state.hands) % (12 * JOINTS):
            raise ValueError(f"hands must be of {JOINTS} joints each")
        for each in (state.points, state.normals, state.asked, state.hands):
            if not np.isfinite(np.frombuffer(each, "<f4")).all():
                raise ValueError("not all numbers of samples and hands are finite")
        asked = np.frombuffer(state.asked, "<f4") * strengths[index].astype("<f4")
        return cls(state.points, state.normals, asked.tobytes(), own.tobytes(), state.hands)


class Places(NamedTuple):
    """Places on or beside regions. rows: indices of the points, (K,). points, normals: (K, 3). asked: targets [Pa]."""

    rows: Indices
    points: Floats
    normals: Floats
    asked: Floats


def compute_error(
    array: Array, medium: Air, gains: Gains, at: Floats, across: Floats, regions: Regions
) -> Floats:
    """Return the radiation pressure minus its target, at the place of a region nearest to each point, (P,) [Pa].

    gains: gains of the frames that are averaged, (K, N). at: points, (P, 3) [m]. across: normal of samples that have
    none, (3,). The result is NaN for points more than 5 mm from the samples of all regions, for points beside a region
    but less than 3 mm from its samples (`Solution.felt` ignores these, too), and near transducers. With hands, only
    sound along the normals counts, and adult-sized hands occlude it, because the state does not contain their size.
    """
    places = nearest_places(at, across, regions)
    found = np.full(len(at), np.nan)
    found[places.rows] = compute_felt(array, medium, gains, places, regions) - places.asked
    return found


def compute_felt_and_asked(
    array: Array, medium: Air, gains: Gains, at: Floats, across: Floats, regions: Regions
) -> tuple[Floats, Floats]:
    """Return the radiation pressure on the skin, or on a surface in the air, and the target there, (P,) [Pa] each.

    As `compute_error`, but each point first moves along `across` to the height of its nearest samples, so that a plane
    before a curved contact shows the whole contact.
    """
    places = nearest_places(lift_off(at, across, regions), across, regions, beside=0.0)
    felt, asked = np.full(len(at), np.nan), np.full(len(at), np.nan)
    felt[places.rows] = compute_felt(array, medium, gains, places, regions)
    asked[places.rows] = places.asked
    return felt, asked


def lift_off(at: Floats, across: Floats, regions: Regions) -> Floats:
    """Move points along `across` to the height of the samples nearest to them in the plane across it, (P, 3) [m]."""
    from scipy.spatial import KDTree

    q = np.frombuffer(regions.points, "<f4").reshape(-1, 3).astype(np.float64)
    q = q[np.frombuffer(regions.objects, "<i4") >= 0]
    up = across / np.linalg.norm(across)

    def flat(points: Floats) -> Floats:
        return np.asarray(points - (points @ up)[:, None] * up)

    tree = KDTree(flat(q))
    away, which = _nearest(tree, flat(at), min(NEIGHBOURS, len(q)))
    weight = 1.0 / (away * away + MERGE_DISTANCE * MERGE_DISTANCE)
    height = (weight * (q @ up)[which]).sum(axis=1) / weight.sum(axis=1)
    return np.asarray(flat(at) + height[:, None] * up)


def compute_felt(
    array: Array, medium: Air, gains: Gains, places: Places, regions: Regions
) -> Floats:
    """Return the radiation pressure at places, (K,) [Pa]; NaN near transducers. Hands count as in `compute_error`."""
    from pacinian.acoustics.pressure import radiation_pressure
    from pacinian.acoustics.skin_facing import SkinFacing
    from pacinian.errors import PointOnTransducer
    from pacinian.scene.hands.capsules import make_capsules
    from pacinian.scene.hands.hand import Hand
    from pacinian.solving.propagator import Propagator

    found = np.full(len(places.rows), np.nan)
    joints = np.frombuffer(regions.hands, "<f4").reshape(-1, JOINTS, 3).astype(np.float64)
    flesh = [make_capsules(Hand(each)) for each in joints]
    propagator = Propagator(array, medium)
    for k in range(0, len(places.rows), step := max(1, MAX_PAIRS // len(array))):
        part = slice(k, k + step)
        facing = SkinFacing(places.normals[part], np.concatenate(flesh)) if flesh else None
        try:
            propagator.set_points(places.points[part], facing)
        except PointOnTransducer:
            continue
        made = np.zeros(len(places.asked[part]))
        for g in gains:
            made += radiation_pressure(propagator.apply(g), medium) / len(gains)
        found[part] = made
    return found


def nearest_places(
    at: Floats, across: Floats, regions: Regions, beside: float = MIN_OUTSIDE_DISTANCE
) -> Places:
    """Select the points `at`, (P, 3) [m], that are near a region, and move each to the region's surface.

    The surface is the plane through the nearest sample. A place is inside the region if samples surround it. Its target
    is then their mean, weighted by the inverse square of the distance; the target of an outside place is 0. beside:
    minimum distance of outside places from the samples [m].
    """
    from scipy.spatial import KDTree

    q = np.frombuffer(regions.points, "<f4").reshape(-1, 3).astype(np.float64)
    n = np.frombuffer(regions.normals, "<f4").reshape(-1, 3).astype(np.float64)
    P, index = np.frombuffer(regions.asked, "<f4"), np.frombuffer(regions.objects, "<i4")
    up = np.where((n * n).sum(axis=1, keepdims=True) < 0.5, across, n)
    up = up / np.linalg.norm(up, axis=1, keepdims=True)
    tree = KDTree(q)
    away, around = _nearest(tree, at, 1)
    rows = np.flatnonzero((away[:, 0] <= MAX_SAMPLE_DISTANCE) & (index[around[:, 0]] >= 0))
    m = around[rows, 0]
    x = at[rows] - np.einsum("pk,pk->p", at[rows] - q[m], up[m])[:, None] * up[m]

    away, around = _nearest(tree, x, AROUND)
    limit = CLOSE * _compute_spacing(tree, index)[m]
    own = (index[around] == index[m][:, None]) & (away <= limit[:, None])
    inside = _are_surrounded(x, up[m], q[around], own) | (own & (away <= MERGE_DISTANCE)).any(
        axis=1
    )
    weight = own / (away * away + MERGE_DISTANCE * MERGE_DISTANCE)
    asked = np.where(inside, (weight * P[around]).sum(axis=1), 0.0)
    asked /= np.where(inside, weight.sum(axis=1), 1.0)
    kept = inside | ((away[:, 0] >= beside) & (away[:, 0] <= MAX_SAMPLE_DISTANCE))
    return Places(rows[kept], x[kept], n[m][kept], asked[kept])


def _compute_spacing(tree: KDTree, index: Indices) -> Floats:
    """Return the local spacing: the median nearest-neighbour distance around each sample, (M,) [m]; 0 if alone."""
    away, around = _nearest(tree, np.asarray(tree.data), AROUND)
    own = (index[around] == index[:, None]) & np.isfinite(away)
    nearest = np.where(own & (away > MERGE_DISTANCE), away, np.inf).min(axis=1)
    every = np.sort(np.where(own, nearest[around], np.inf), axis=1)  # own samples only
    middle = (np.maximum(own.sum(axis=1), 1) - 1) // 2
    found = np.take_along_axis(every, middle[:, None], axis=1)[:, 0]
    return np.where(np.isfinite(found), found, 0.0)


def _nearest(tree: KDTree, x: Floats, count: int) -> tuple[Floats, Indices]:
    """Return distances to the nearest samples, (K, count) [m], inf if there are fewer, and the samples' indices."""
    away, which = tree.query(x, np.arange(1, count + 1))
    return np.asarray(away), np.minimum(which, tree.n - 1)


def _are_surrounded(x: Floats, n: Floats, q: Floats, own: Flags) -> Flags:
    """Whether the samples q, (K, A, 3), selected by `own`, (K, A), lie on all sides of each place x, (K, 3)."""
    other = np.where(np.abs(n[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[0.0, 1.0, 0.0]])
    u = np.cross(other, n)
    v = np.cross(n, u)
    away = q - x[:, None]
    turn = np.arctan2(np.einsum("kas,ks->ka", away, v), np.einsum("kas,ks->ka", away, u))
    first = np.take_along_axis(turn, own.argmax(axis=1)[:, None], axis=1)
    turn = np.sort(np.where(own, turn, first), axis=1)
    gaps = np.diff(turn, axis=1, append=turn[:, :1] + 2.0 * np.pi)
    return np.asarray(own.any(axis=1) & (gaps.max(axis=1) <= MAX_INSIDE_ANGLE))
