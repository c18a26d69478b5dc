"""Kernels of regions and groups agree with NumPy."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.native import solving as kernels
from pacinian.solving.propagator import Propagator, gram_matrix
from pacinian.solving.region_phases import settle_phases
from pacinian.solving.targets import Targets, number_regions
from pacinian.solving.warm_start import carry_regions

ARRAY = pc.autd()
SEEDS = st.integers(0, 10**6)


def draw(seed, M):
    """Draw points near the array, with regions, amplitudes and given phases (NaN if free)."""
    rng = np.random.default_rng(seed)
    q = np.c_[rng.uniform(-0.04, 0.04, (M, 2)), rng.uniform(0.14, 0.16, M)]
    regions = rng.choice([-2, -1, 0, 3, 7, 2**40], M, p=[0.1, 0.2, 0.3, 0.2, 0.1, 0.1])
    t = np.where(regions == -2, 0.0, rng.uniform(0.0, 50.0, M))
    given = np.full(M, np.nan)
    if seed % 3 == 0:
        given = np.where(rng.random(M) < 0.2, rng.uniform(-3.0, 3.0, M), np.nan)
    return rng, q, regions, t, given


@given(SEEDS, st.integers(0, 40))
def test_regions_are_numbered_as_unique_does(seed, M):
    _, _, regions, _, _ = draw(seed, M)
    number = number_regions(M, regions)
    if (regions == -1).all():
        assert number is None
        return
    assert number is not None
    expected = regions.copy()
    own = regions >= 0
    expected[own] = np.unique(regions[own], return_inverse=True)[1]
    np.testing.assert_array_equal(number, expected)
    assert not number.flags.writeable
    np.testing.assert_array_equal(number, number_regions(M, regions.tolist()))


def settle(propagator, targets, warm, tilt):
    """`settle_phases` in NumPy, without quiet zones, and `converge` for the waves."""
    regions, t, M = targets.regions, targets.amplitudes, len(targets.amplitudes)
    given = ~np.isnan(targets.phases)
    array = propagator.array
    k = propagator.medium.wavenumber(array.transducer.frequency)
    some = array.positions[:: -(-len(array) // 128)].copy()
    wave = np.zeros(M)
    for number in range(regions.max() + 1):
        own, made = regions == number, np.empty((regions == number).sum())
        kernels.converge(
            propagator.points[own], t[own] ** 2, some, array.centre.copy(), k, 0.25, tilt, made
        )
        wave[own] = made
    mapped = np.where(regions == -2, 0, regions)
    own = np.where(mapped == -1, mapped.max() + 1 + np.arange(M), mapped)
    names, group = np.unique(np.where(given, -1, own), return_inverse=True)
    alone = (regions == -1) & ~given
    m = np.arange(M)
    start = np.where(alone, np.pi * m * m / M, wave) if warm is None else warm.asked_phases
    phi = np.where(given, targets.phases, np.where(alone, start, wave))
    p = t / (targets.norm or 1.0) * np.exp(1j * phi)
    z = np.zeros(len(names), complex)
    np.add.at(z, group, t * np.exp(1j * (start - phi)))
    size = np.abs(z)
    z = np.where(size > 1e-12 * t.sum(), z / np.where(size > 0, size, 1), 1)
    if given.any():
        z[0] = 1.0
    rows = np.zeros((len(names), len(array)), np.complex64)
    np.add.at(rows, group, p.conj()[:, None] * propagator.B)
    G = gram_matrix(rows)
    for _ in range((20 if warm is None else 3) if len(names) > 1 else 0):
        made = G @ z
        turned = (np.abs(made) > 0) & ~(given.any() & (np.arange(len(z)) == 0))
        z = np.where(turned, np.abs(z) * made / np.where(np.abs(made) > 0, np.abs(made), 1), z)
    return np.where(given, targets.phases, phi + np.angle(z)[group])


@settings(max_examples=40)
@given(SEEDS, st.integers(1, 24), st.booleans())
def test_phases_are_settled_as_numpy_does(seed, M, warm):
    _, q, regions, t, given = draw(seed, M)
    number = number_regions(M, regions)
    if number is None:
        return
    propagator = Propagator(ARRAY, pc.Air())
    propagator.set_points(q)
    targets = Targets(t, given, regions=number)
    last = None
    if warm:
        session = pc.Session(ARRAY, solver="pseudo-inverse")
        last = session.solve(q, t, regions=regions)
        if last.asked_phases is None:
            return
    made = settle_phases(propagator, targets, last, 0.1)
    expected = settle(propagator, targets, last, 0.1)
    np.testing.assert_allclose(np.exp(1j * made.phases), np.exp(1j * expected), atol=1e-3)
    assert not made.free.any()
    assert made.regions is targets.regions
    assert made.norm == targets.norm


@given(SEEDS, st.integers(1, 30), st.integers(1, 30))
def test_a_point_takes_over_from_the_same_or_the_nearest_of_its_kind(seed, M, K):
    """As NumPy finds them; each region, the isolated points and those beside have moved in their own way."""
    rng, q, now, _, _ = draw(seed, M)
    _, before, were, _, _ = draw(seed + 1, K)
    now, were = number_regions(M, now), number_regions(K, were)
    if now is None or were is None:
        return
    moves = 1.5e-3 * rng.standard_normal((now.max() + 3, 3))
    near = min(M, K) // 2
    before[:near] = q[:near] - moves[now[:near] + 2] + 2e-4 * rng.standard_normal((near, 3))
    asked, made = rng.uniform(-9, 9, K), rng.standard_normal(M) + 1j * rng.standard_normal(M)
    last = rng.standard_normal(K) + 1j * rng.standard_normal(K)
    phases, y = np.empty(M), np.empty(M, complex)
    found = kernels.carry_multipliers(
        q, now, before, were, asked, last, made, 3e-3, 5e-4, phases, y
    )

    expected, multipliers = np.angle(made), np.zeros(M, complex)
    for region in set(now.tolist()):
        own = np.flatnonzero(now == region)
        there = np.flatnonzero(np.minimum(were, 0) == min(region, 0))
        if not len(there):
            continue
        away = np.linalg.norm(q[own, None] - before[there], axis=2)
        close, nearest = away.min(axis=1) < 3e-3, there[away.argmin(axis=1)]
        expected[own[close]] = asked[nearest[close]]
        moved = np.sort((q[own] - before[nearest])[close], axis=0)
        came = q[own] - (moved[len(moved) // 2] if len(moved) else 0.0)
        away = np.linalg.norm(came[:, None] - before[there], axis=2)
        same, which = away.min(axis=1) < 5e-4, there[away.argmin(axis=1)]
        expected[own[same]], multipliers[own[same]] = asked[which[same]], last[which[same]]
    np.testing.assert_allclose(phases, expected, atol=1e-12)
    np.testing.assert_array_equal(y, multipliers)
    assert found == np.count_nonzero(multipliers)


def test_a_solution_is_carried_as_it_is_if_nothing_moved_and_else_point_by_point():
    q = np.c_[0.004 * np.arange(9) - 0.016, np.zeros(9), np.full(9, 0.15)]
    session = pc.Session(ARRAY, solver="lagrange")
    solution = session.solve(q, np.full(9, 10.0), regions=np.zeros(9, int))

    def carry(points):
        session.propagator.set_points(points)
        return carry_regions(session.propagator, solution.targets, solution)

    assert carry(q + 1e-4) is solution
    moved = carry(q + np.array([0.001, 0.0, 0.0]))
    np.testing.assert_array_equal(moved.multipliers, solution.multipliers)
    np.testing.assert_array_equal(moved.asked_phases, solution.asked_phases)
    np.testing.assert_array_equal(moved.sound_pressure, session.propagator.apply(solution.gains))
    assert moved.gains is solution.gains
    assert carry(q + np.array([0.5, 0.0, 0.0])).multipliers is None


@given(SEEDS, st.integers(1, 40), st.integers(0, 5), st.integers(0, 5))
def test_rows_that_change_are_found_as_skin_facing_says(seed, M, C, D):
    rng, q, _, _, _ = draw(seed, M)
    before = np.where(rng.random(M)[:, None] < 0.2, q + 1e-9, q)
    normals = rng.standard_normal((M, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    turned = np.where(rng.random(M)[:, None] < 0.2, -normals, normals)

    def hand(count):
        ends = rng.uniform(-0.05, 0.05, (count, 6))
        ends[:, [2, 5]] += 0.15
        return np.c_[ends, np.full((count, 2), 0.004)]

    capsules = hand(C)
    old = capsules.copy() if C == D else hand(D)
    if C == D and C:
        old[0, 0] += 0.001
    new_facing, old_facing = SkinFacing.of(normals, capsules), SkinFacing.of(turned, old)
    rows = np.empty(M, np.int64)
    count = kernels.changed(q, before, normals, turned, capsules, old, rows)
    expected = new_facing.find_changed(old_facing, q) | (q != before).any(axis=1)
    np.testing.assert_array_equal(rows[:count], np.flatnonzero(expected))
    count = kernels.moved(q, before, rows)
    np.testing.assert_array_equal(rows[:count], np.flatnonzero((q != before).any(axis=1)))


@given(SEEDS, st.sampled_from([np.complex64, np.complex128]))
def test_gains_at_a_limit_are_counted(seed, dtype):
    rng = np.random.default_rng(seed)
    g = (rng.uniform(0, 1.2, 300) * np.exp(1j * rng.uniform(-9, 9, 300))).astype(dtype)
    assert kernels.count_at_limit(g, 0.7) == (np.abs(g) >= 0.7).sum()
    assert kernels.count_at_limit(g, np.inf) == 0
