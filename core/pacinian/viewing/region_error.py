"""The error of what is felt on regions, for a slice: radiation pressure made minus asked, also between the samples."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np

if TYPE_CHECKING:
    from scipy.spatial import KDTree

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import Flags, Floats, Gains, Indices
    from pacinian.wire.state import State

NEAR = 0.005  # [m] from a point of the slice to a sample of a region, at most
BESIDE = 0.003  # [m] from the samples, at least: at a rim pressure has to fall
CLOSE = 1.7  # times the distance of neighbours: as far are samples that surround a place
NEIGHBOURS = 4  # samples whose height a point is moved to
AROUND = 12  # samples that are looked at around each place
SAME = 1e-4  # [m]: no farther apart is in one place
STRAIGHT = np.pi + 1e-3  # [rad]: a larger angle without a neighbour is of a place outside
PAIRS = 1 << 21  # of places and transducers at a time
JOINTS = 26  # of a hand


class Regions(NamedTuple):
    """Samples as a state has them, (M, ...) each: bytes, so that they can be compared.

    points, normals: (M, 3) float32 [m]. asked: radiation pressure, float32 [Pa]. objects: which, int32; -1 of
    samples that are isolated. hands: joints, (hands, 26, 3) float32 [m]; with any, sound counts along the normals.
    """

    points: bytes
    normals: bytes
    asked: bytes
    objects: bytes
    hands: bytes

    @classmethod
    def of(cls, state: State) -> Self | None:
        """None where nothing is known to be a region. Raises ValueError, IndexError of a damaged state."""
        known = np.isfinite(np.frombuffer(state.felt, "<f4").reshape(-1, 4)[:, 0])
        if not known.any():
            return None
        index = np.frombuffer(state.index, "<i4")
        index = np.where(known[index], index, -1).astype("<i4")
        rows = len(index)
        if not len(state.points) == len(state.normals) == 12 * rows == 3 * len(state.asked):
            raise ValueError(f"not as many points, normals and pressures as samples: {rows}")
        if len(state.hands) % (12 * JOINTS):
            raise ValueError(f"hands must be of {JOINTS} joints each")
        for each in (state.points, state.normals, state.asked, state.hands):
            if not np.isfinite(np.frombuffer(each, "<f4")).all():
                raise ValueError("not all numbers of samples and hands are finite")
        return cls(state.points, state.normals, state.asked, index.tobytes(), state.hands)


class Places(NamedTuple):
    """Places on regions, or beside them. rows: of which points. points, normals: (K, 3). asked: (K,) [Pa], 0 beside."""

    rows: Indices
    points: Floats
    normals: Floats
    asked: Floats


def compute_error(
    array: Array, medium: Air, gains: Gains, at: Floats, across: Floats, regions: Regions
) -> Floats:
    """Radiation pressure made minus asked, at the place of a region that is nearest to each point, (P,) [Pa].

    gains: of the frames whose mean is felt, (K, N). at: points, (P, 3) [m]. across: direction that surfaces face
    whose samples have no normal, (3,). NaN of a point that is more than 5 mm from the samples of any region, and of one
    beside a region and less than 3 mm from its samples: `Solution.felt` counts no such places either. Also NaN near
    transducers. With hands, sound counts along the normals and is hidden by hands of an adult's size: the state does
    not tell how large they are.
    """
    places = nearest_places(at, across, regions)
    found = np.full(len(at), np.nan)
    found[places.rows] = compute_felt(array, medium, gains, places, regions) - places.asked
    return found


def felt_and_asked(
    array: Array, medium: Air, gains: Gains, at: Floats, across: Floats, regions: Regions
) -> tuple[Floats, Floats]:
    """Return the radiation pressure on the skin, or on a surface in the air, and the target there, (P,) [Pa] each.

    As `compute_error`, but each point first moves along `across` to the height of its nearest samples, so that a plane
    before a curved contact shows all of the contact.
    """
    places = nearest_places(lift_off(at, across, regions), across, regions, beside=0.0)
    felt, asked = np.full(len(at), np.nan), np.full(len(at), np.nan)
    felt[places.rows] = compute_felt(array, medium, gains, places, regions)
    asked[places.rows] = places.asked
    return felt, asked


def lift_off(at: Floats, across: Floats, regions: Regions) -> Floats:
    """Points, (P, 3), at the height of the samples that are nearest to them beside a direction, (P, 3) [m]."""
    from scipy.spatial import KDTree

    q = np.frombuffer(regions.points, "<f4").reshape(-1, 3).astype(np.float64)
    q = q[np.frombuffer(regions.objects, "<i4") >= 0]
    up = across / np.linalg.norm(across)

    def flat(points: Floats) -> Floats:
        return np.asarray(points - (points @ up)[:, None] * up)

    tree = KDTree(flat(q))
    away, which = _nearest(tree, flat(at), min(NEIGHBOURS, len(q)))
    weight = 1.0 / (away * away + SAME * SAME)
    height = (weight * (q @ up)[which]).sum(axis=1) / weight.sum(axis=1)
    return np.asarray(flat(at) + height[:, None] * up)


def compute_felt(
    array: Array, medium: Air, gains: Gains, places: Places, regions: Regions
) -> Floats:
    """Radiation pressure at places, (K,) [Pa]; NaN near transducers. With hands as `compute_error` says."""
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
    for k in range(0, len(places.rows), step := max(1, PAIRS // len(array))):
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


def nearest_places(at: Floats, across: Floats, regions: Regions, beside: float = BESIDE) -> Places:
    """Of points `at`, (P, 3) [m], those with a region near, moved to the nearest place of its surface.

    The surface is the plane through the nearest sample. A place is inside where samples surround it, and is then
    asked for their mean, weighted by the inverse square of the distance. beside: [m] from the samples, at least, of a
    place that is not inside.
    """
    from scipy.spatial import KDTree

    q = np.frombuffer(regions.points, "<f4").reshape(-1, 3).astype(np.float64)
    n = np.frombuffer(regions.normals, "<f4").reshape(-1, 3).astype(np.float64)
    P, index = np.frombuffer(regions.asked, "<f4"), np.frombuffer(regions.objects, "<i4")
    up = np.where((n * n).sum(axis=1, keepdims=True) < 0.5, across, n)
    up = up / np.linalg.norm(up, axis=1, keepdims=True)
    tree = KDTree(q)
    away, around = _nearest(tree, at, 1)
    rows = np.flatnonzero((away[:, 0] <= NEAR) & (index[around[:, 0]] >= 0))
    m = around[rows, 0]
    x = at[rows] - np.einsum("pk,pk->p", at[rows] - q[m], up[m])[:, None] * up[m]

    away, around = _nearest(tree, x, AROUND)
    limit = CLOSE * _spacing(tree, index)[m]
    own = (index[around] == index[m][:, None]) & (away <= limit[:, None])
    inside = _surrounded(x, up[m], q[around], own) | (own & (away <= SAME)).any(axis=1)
    weight = own / (away * away + SAME * SAME)
    asked = np.where(inside, (weight * P[around]).sum(axis=1), 0.0)
    asked /= np.where(inside, weight.sum(axis=1), 1.0)
    kept = inside | ((away[:, 0] >= beside) & (away[:, 0] <= NEAR))
    return Places(rows[kept], x[kept], n[m][kept], asked[kept])


def _spacing(tree: KDTree, index: Indices) -> Floats:
    """How far from each sample its neighbours are from theirs, in the median, (M,) [m]; 0 of one without any."""
    away, around = _nearest(tree, np.asarray(tree.data), AROUND)
    own = (index[around] == index[:, None]) & np.isfinite(away)
    nearest = np.where(own & (away > SAME), away, np.inf).min(axis=1)
    every = np.sort(np.where(own, nearest[around], np.inf), axis=1)  # of others nothing counts
    middle = (np.maximum(own.sum(axis=1), 1) - 1) // 2
    found = np.take_along_axis(every, middle[:, None], axis=1)[:, 0]
    return np.where(np.isfinite(found), found, 0.0)


def _nearest(tree: KDTree, x: Floats, count: int) -> tuple[Floats, Indices]:
    """How far the nearest samples are from each place, (K, count) [m], and which; infinite where there are fewer."""
    away, which = tree.query(x, np.arange(1, count + 1))
    return np.asarray(away), np.minimum(which, tree.n - 1)


def _surrounded(x: Floats, n: Floats, q: Floats, own: Flags) -> Flags:
    """Whether those of the samples q, (K, A, 3), that are the place's `own`, (K, A), lie on all sides of x, (K, 3)."""
    other = np.where(np.abs(n[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[0.0, 1.0, 0.0]])
    u = np.cross(other, n)
    v = np.cross(n, u)
    away = q - x[:, None]
    turn = np.arctan2(np.einsum("kas,ks->ka", away, v), np.einsum("kas,ks->ka", away, u))
    first = np.take_along_axis(turn, own.argmax(axis=1)[:, None], axis=1)
    turn = np.sort(np.where(own, turn, first), axis=1)
    gaps = np.diff(turn, axis=1, append=turn[:, :1] + 2.0 * np.pi)
    return np.asarray(own.any(axis=1) & (gaps.max(axis=1) <= STRAIGHT))
