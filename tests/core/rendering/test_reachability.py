"""The reachability filter: its kernels agree with NumPy, and its powers with those of the cells."""

from collections import Counter

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.native import rendering as kernels
from pacinian.rendering.reachability import CELL_SIZE, ReachabilityFilter

ARRAY = pc.autd()


@given(st.integers(0, 10**6), st.integers(0, 30), st.sampled_from([0.1, 1.0, 1e5]))
def test_points_are_located_as_numpy_does(seed, M, far):
    rng = np.random.default_rng(seed)
    q, origin, extent = rng.uniform(-far, far, (M, 3)), rng.uniform(-1, 1, 3), rng.uniform(0, 1, 3)
    d = np.abs(q - origin)
    expected = int((d > 50.0).any()) + 2 * int((d <= extent).all(axis=1).any())
    assert kernels.locate(q, origin, extent, 50.0) == expected


@given(st.integers(0, 10**6), st.integers(1, 40))
def test_cells_are_looked_up_by_their_numbers(seed, M):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-0.2, 0.2, (M, 3))
    place = np.floor(q / CELL_SIZE).astype(np.int64) + int(kernels.LARGEST)
    cell = (place[:, 0] * kernels.SIDE + place[:, 1]) * kernels.SIDE + place[:, 2]
    known = np.unique(cell[rng.random(M) < 0.5])
    values, out, missing = rng.random(len(known)), np.full(M, np.nan), np.empty(M, np.int64)
    count = kernels.look_up(q, CELL_SIZE, known, values, out, missing)
    there = np.isin(cell, known)
    np.testing.assert_array_equal(missing[:count], cell[~there])
    np.testing.assert_array_equal(out[there], values[np.searchsorted(known, cell[there])])


def test_powers_are_those_at_the_middles_of_the_cells_however_they_are_asked():
    rng = np.random.default_rng(5)
    session = pc.Session(ARRAY)
    reach = ReachabilityFilter(session.propagator)
    q = np.c_[rng.uniform(-0.1, 0.1, (200, 2)), rng.uniform(0.05, 0.3, 200)]
    pieces = np.concatenate([reach._free(part) for part in np.array_split(q, 7)])
    middles = CELL_SIZE * (np.floor(q / CELL_SIZE) + 0.5)
    some = reach._some
    B = pc.matrix(some, middles, session.medium)
    expected = len(ARRAY) / len(some) * (np.abs(B) ** 2).sum(axis=1)
    np.testing.assert_allclose(pieces, expected, rtol=1e-12)
    np.testing.assert_array_equal(reach._free(q), pieces)


def test_points_far_away_and_on_transducers_are_left_out():
    skipped = Counter()
    reach = ReachabilityFilter(pc.Session(ARRAY).propagator)
    q = np.array([[0.0, 0.0, 0.2], [1e6, 0.0, 0.0], ARRAY.positions[7]])
    assert reach.find_reachable(q, skipped).tolist() == [True, False, False]
    assert skipped == {"samples too far from the array": 1, "samples on a transducer": 1}
