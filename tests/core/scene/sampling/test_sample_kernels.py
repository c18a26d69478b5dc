"""Kernels that make samples and ramp their pressures agree with NumPy."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from pacinian.native import scene as kernels
from pacinian.scene.hands.hand import Hand
from pacinian.scene.sampling.posed_skin import PosedSkin

JUMP = 0.02  # [m]
SEEDS = st.integers(0, 10**6)
SKIN = PosedSkin(Hand.open())


def draw(rng, count):
    """Draw samples: keys, positions, regions, areas, pressures and their maxima."""
    keys = rng.permutation(40)[:count].astype(np.int64)
    base = np.random.default_rng(0).uniform(-0.03, 0.03, (40, 3))
    q = base[keys] + rng.choice([0.0, 1e-4, 0.03], (count, 1), p=[0.5, 0.4, 0.1])
    regions = rng.choice([-2, -1, 5, 9], count)
    most = rng.uniform(1.0, 10.0, count)
    P = most * rng.choice([0.0, 1.0, 0.3], count)
    return keys, q, regions, rng.uniform(1e-5, 3e-4, count), P, most


def advance(P, most, share):
    if not share:
        return P
    way = np.arcsin(np.sqrt(np.minimum(P / np.maximum(most, 1e-300), 1.0))) / (np.pi / 2)
    return most * np.sin(np.pi / 2 * np.clip(way + share, 0.0, 1.0)) ** 2


def beneath(samples, which, others):
    """Return, for each of `which`, the nearest other sample of its region on whose area it lies; else -1."""
    found = []
    for m in which:
        there = np.flatnonzero(others[2] == samples[2][m])
        away = np.linalg.norm(others[1][there] - samples[1][m], axis=1)
        near = there[away.argmin()] if len(there) else -1
        found.append(near if len(there) and away.min() ** 2 <= others[3][near] else -1)
    return np.array(found, dtype=int)


def ramp(asked, last, share):
    keys, q, regions, _, P, most = asked
    M, L = len(keys), len(last[0])
    was, top = np.zeros(M), np.zeros(M)
    gone, jumped, fresh = np.ones(L, bool), np.zeros(L, bool), []
    for m in range(M):
        same = np.flatnonzero(last[0] == keys[m])
        if not len(same):
            fresh += [m] if regions[m] >= 0 else []
        elif np.linalg.norm(q[m] - last[1][same[0]]) <= JUMP:
            was[m], top[m], gone[same[0]] = last[4][same[0]], last[5][same[0]], False
        else:
            jumped[same[0]] = True
    for m, i in zip(fresh, beneath(asked, fresh, last), strict=True):
        if i >= 0:
            was[m] = top[m] = min(P[m], last[4][i])
    left = np.flatnonzero(gone & ~jumped & (last[2] >= 0))
    gone[left[beneath(last, left, asked) >= 0]] = False
    top = np.maximum(most, np.where(was > P, top, was))
    now = np.minimum(np.maximum(P, advance(was, top, -share)), advance(was, top, share))
    fading = advance(last[4], np.maximum(last[5], last[4]), -share)
    going = np.flatnonzero(gone & (fading > 0.0))
    return now, top, going, fading[going], jumped[going]


@settings(max_examples=60)
@given(SEEDS, st.integers(0, 30), st.integers(0, 30), st.sampled_from([0.0, 0.2, 1.000001]))
def test_pressures_ramp_as_in_numpy(seed, M, L, share):
    rng = np.random.default_rng(seed)
    asked, last = draw(rng, M), draw(rng, L)
    if seed % 3 == 0:
        last = draw(rng, M)
        last = (asked[0], *last[1:])
    made = compute(asked, last, share)
    for one, other in zip(made, ramp(asked, last, share), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-9)


def compute(asked, last, share):
    M, L = len(asked[0]), len(last[0])
    now, top = np.empty(M), np.empty(M)
    going, fading, jumped = np.empty(L, np.int64), np.empty(L), np.empty(L, bool)
    count = kernels.ramp(*asked, *last, share, JUMP, now, top, going, fading, jumped)
    return now, top, going[:count], fading[:count], jumped[:count]


@given(SEEDS)
def test_a_ramp_that_ends_is_exactly_at_its_target(seed):
    rng = np.random.default_rng(seed)
    asked = draw(rng, 20)
    last = (*asked[:4], 0.9 * asked[4], asked[5])
    np.testing.assert_array_equal(compute(asked, last, 1.000001)[0], asked[4])


@given(SEEDS, st.integers(0, 4), st.sampled_from([True, False]))
def test_nodes_of_a_level_are_kept_with_their_pressure(seed, level, flesh):
    rng, skin = np.random.default_rng(seed), SKIN.skin
    touched = np.sort(rng.permutation(len(skin))[:300])
    force = rng.uniform(0.0, 1e-3, len(touched))
    capsules = SKIN.capsules if flesh else np.empty((0, 8))
    nodes, pressed, extent = np.empty_like(touched), np.empty(300), np.empty(300)
    count = kernels.thin(
        touched, force, skin.counts[level], skin.node_area[level], skin.area, SKIN.area, SKIN.points,
        capsules, skin.bone, skin.slack, nodes, pressed, extent,
    )  # fmt: skip
    own = touched < skin.counts[level]
    if flesh:
        own &= SKIN.find_exposed(touched)
    kept = touched[own]
    stretch = skin.node_area[level][kept] / skin.area[kept]
    np.testing.assert_array_equal(nodes[:count], kept)
    np.testing.assert_allclose(pressed[:count], force[own] * stretch, rtol=1e-12)
    np.testing.assert_allclose(extent[:count], SKIN.area[kept] * stretch, rtol=1e-12)


@given(SEEDS, st.integers(0, 60))
def test_samples_lie_on_nodes_and_are_felt(seed, count):
    rng = np.random.default_rng(seed)
    nodes = rng.permutation(len(SKIN.points))[:count]
    force, extent = rng.uniform(0, 1e-3, count), rng.uniform(1e-5, 1e-4, count)
    P, area, keys = np.empty(count), np.empty(count), np.empty(count, np.int64)
    points, normals = np.empty((count, 3)), np.empty((count, 3))
    kept = kernels.press_on(
        nodes, force, extent, 5.0, SKIN.points, SKIN.normals, 77, P, area, points, normals, keys
    )
    felt = force / extent >= 5.0
    np.testing.assert_allclose(P[:kept], (force / extent)[felt], rtol=1e-12)
    np.testing.assert_array_equal(area[:kept], extent[felt])
    np.testing.assert_array_equal(points[:kept], SKIN.points[nodes[felt]])
    np.testing.assert_array_equal(normals[:kept], SKIN.normals[nodes[felt]])
    np.testing.assert_array_equal(keys[:kept], (77 << 31) + nodes[felt])


@settings(max_examples=30)
@given(SEEDS, st.integers(1, 50))
def test_nodes_around_a_region_are_those_outside_other_flesh(seed, most):
    rng = np.random.default_rng(seed)
    q = SKIN.points[rng.permutation(500)[:20]].copy()
    centre, skin = np.array([0.0, 0.0, -1.0]), SKIN.skin

    def around(capsules, most):
        which, nearest = np.empty(800, np.int64), np.empty(800, np.int64)
        found = kernels.around(
            SKIN.points, SKIN.normals, 800, q, centre, 0.002, 0.008, capsules, skin.bone, skin.slack,
            most, which, nearest,
        )  # fmt: skip
        return which[:found], nearest[:found]

    every, nearest = around(np.empty((0, 8)), 800)
    shown = SKIN.find_exposed(every)
    away = np.linalg.norm(SKIN.points[every][:, None] - q, axis=2)
    np.testing.assert_array_equal(away.argmin(axis=1), nearest)
    assert ((away.min(axis=1) >= 0.002) & (away.min(axis=1) <= 0.008)).all()
    kept, nearest_kept = around(SKIN.capsules, most)
    np.testing.assert_array_equal(kept, every[shown][:most])
    np.testing.assert_array_equal(nearest_kept, nearest[shown][:most])
