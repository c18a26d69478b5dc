"""The kernel `solve_region`: its numbers are those of NumPy in double precision, and it stops when the time is up."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.testing import ManualClock
from pacinian_plugins.native.lagrange import RegionWorkspace
from pacinian_plugins.solvers.lagrange.regions import (
    MAX_BLOCK_SIZE,
    MAX_BLOCK_WIDTH,
    MAX_SINGLE_BLOCK_SIZE,
    MAX_STRIDE,
    MIN_COLUMNS,
    Ascent,
    divide_samples,
)

from ..problems import ARRAY

MU = 5e-3


def problem(seed, M, level, array=ARRAY):
    """B, targets, D and mu in units of the limit; `level` 1 is about as much as the array can make."""
    rng = np.random.default_rng(seed)
    q = np.c_[rng.uniform(-0.02, 0.02, (M, 2)), np.full(M, 0.15)]
    q[:, :2] += array.centre[:2] - ARRAY.centre[:2]
    B = pc.matrix(array, q, pc.Air()).astype(np.complex64)
    p = level * np.abs(B).sum(axis=1).mean() / 3 * rng.uniform(0.5, 1.0, M)
    silent = rng.random(M) < 0.2
    silent[0] = False
    p = np.where(silent, 0.0, p) * np.exp(1j * pc.joint_phases(array, q, pc.Air()))
    mu = MU * float((np.abs(B) ** 2).sum()) / M
    return B, p, np.where(silent, 50.0, 1.0), mu


def run(B, p, D, mu, y, budget=None, blocks=None):
    M, N = B.shape
    blocks = [np.arange(M)] if blocks is None else blocks
    sizes = np.array([len(block) for block in blocks])
    workspace = RegionWorkspace(M, N, sizes, min(max(1, N // MIN_COLUMNS), MAX_STRIDE))
    workspace.order[:] = np.concatenate(blocks)
    ascent = Ascent(B, p, D, y, mu, 0.25, workspace, budget or pc.Budget())
    ascent.run()
    return ascent, ascent.workspace


def gains(B, y, mu):
    """h(B^H y) and |B^H y|."""
    x = B.astype(complex).conj().T @ y
    return x / np.maximum(np.abs(x), mu), np.abs(x)


def factors(space, sizes):
    """The Cholesky factors of blocks of these sizes."""
    found, flat = [], space.factor
    for size in sizes:
        K = size + size % 2
        re, im = flat[: 2 * K * K].reshape(2, K, K)
        found.append(np.tril(re + 1j * im)[:size, :size].astype(complex))
        flat = flat[2 * K * K :]
    assert not len(flat)
    return found


class Counts(pc.Budget):
    """A budget without end that counts how often it is asked."""

    asked = 0

    @property
    def spent(self):
        Counts.asked += 1
        return False


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.sampled_from([2, 3, 31, 64]), st.floats(0.02, 1.5))
def test_results_are_those_of_numpy(seed, M, level):
    B, p, D, mu = problem(seed, M, level)
    ascent, space = run(B, p, D, mu, np.zeros(M, complex))
    h, size = gains(B, ascent.y, mu)
    made = B.astype(complex) @ h
    missed = np.linalg.norm(p - D * ascent.y - made) / np.linalg.norm(p)
    cost = np.where(size <= mu, size**2 / (2 * mu), size - mu / 2).sum()
    dual = np.vdot(ascent.y, p).real - np.vdot(ascent.y, D * ascent.y).real / 2 - cost
    primal = (np.vdot(p - made, (p - made) / D).real + mu * np.vdot(h, h).real) / 2
    whole = np.linalg.norm(p) ** 2
    assert space.met == (missed < 5e-3) or missed == pytest.approx(5e-3, rel=0.02)
    np.testing.assert_allclose(
        space.made[0] + 1j * space.made[1], made, atol=2e-4 * abs(made).max()
    )
    assert (space.bound, space.objective) == pytest.approx((dual, primal), abs=2e-4 * whole)
    assert abs(space.held - (np.abs(h) > 1 - 1e-5).sum()) <= 0.01 * B.shape[1]


@pytest.mark.parametrize(("array", "stride"), [(ARRAY, 1), (pc.autd(3, 3), 4)])
@pytest.mark.parametrize("M", [2, 3, 50, 63])
def test_preconditioner_is_the_cholesky_factor_for_some_transducers(M, array, stride):
    B, p, D, mu = problem(1, M, 0.5, array)
    budget = pc.Budget.until(0.0, ManualClock().now)
    y = np.zeros(M, complex)
    if M > 10:  # so few samples need no second step
        y = run(B, p, D, mu, y, budget)[0].y
    _, size = gains(B, y, mu)
    some, size = B[:, ::stride].astype(complex), size[::stride]
    weight = np.where(size > mu, 0.5 / np.maximum(size, mu), 1 / mu)
    whole = np.diag(D) + (some * (weight * B.shape[1] / len(size))) @ some.conj().T
    _, space = run(B, p, D, mu, y.copy())
    (factor,) = factors(space, [M])
    difference = factor @ factor.conj().T - whole
    assert np.abs(difference).max() < 1e-4 * np.abs(whole).max()


def test_each_block_is_factored_for_itself():
    B, p, D, mu = problem(1, 45, 0.5)
    blocks = [np.arange(1, 44, 2), np.array([44]), np.arange(0, 43, 2)]
    one_step = pc.Budget.until(0.0, ManualClock().now)
    _, space = run(B, p, D, mu, np.zeros(45, complex), one_step, blocks)
    whole = np.diag(D) + B.astype(complex) @ B.conj().T / mu
    for L, own in zip(factors(space, map(len, blocks)), blocks, strict=True):
        difference = L @ L.conj().T - whole[np.ix_(own, own)]
        assert np.abs(difference).max() < 1e-4 * np.abs(whole).max()


@given(
    st.integers(0, 10**6), st.integers(1, 1500), st.sampled_from([0.0, 0.02, 0.3]),
    st.sampled_from([0.01, 0.075, math.inf]),
)  # fmt: skip
def test_blocks_hold_each_sample_once_and_are_small(seed, M, size, width):
    q = size * np.random.default_rng(seed).random((M, 3)) * [1.0, 0.4, 0.1]
    blocks = divide_samples(q, width)
    assert sorted(np.concatenate(blocks)) == list(range(M))
    assert max(map(len, blocks)) <= (MAX_SINGLE_BLOCK_SIZE if len(blocks) == 1 else MAX_BLOCK_SIZE)
    assert all(np.ptp(q[block], axis=0).max() <= width for block in blocks)


def test_a_sample_far_away_has_a_block_of_its_own():
    q = 0.05 * np.random.default_rng(0).random((200, 3))
    q[17] = 1.0
    assert sorted(map(len, divide_samples(q, MAX_BLOCK_WIDTH))) == [1, 199]


def test_blocks_that_do_not_hold_the_samples_are_refused():
    with pytest.raises(ValueError, match="hold all samples"):
        RegionWorkspace(10, 249, np.array([4, 4]), 1)
    with pytest.raises(ValueError, match="is empty"):
        RegionWorkspace(10, 249, np.array([10, 0]), 1)
    B, p, D, mu = problem(1, 3, 0.5)
    with pytest.raises(ValueError, match="does not exist"):
        run(B, p, D, mu, np.zeros(3, complex), blocks=[np.array([0, 1, 3])])


def test_a_wide_region_takes_fewer_products_with_blocks():
    """Every fourth transducer couples samples far apart that all of them do not couple."""
    array = pc.autd(3, 3)
    q = np.stack(
        np.meshgrid(np.arange(-0.09, 0.091, 0.006), np.arange(-0.03, 0.031, 0.006), [0.2]), -1
    )
    q = q.reshape(-1, 3)
    B = pc.matrix(array, q, pc.Air()).astype(np.complex64)
    M = len(q)
    p = 0.01 * np.abs(B).sum(axis=1).mean() * np.exp(1j * pc.joint_phases(array, q, pc.Air()))
    mu, asked = MU * float((np.abs(B) ** 2).sum()) / M, []
    for width in (math.inf, MAX_BLOCK_WIDTH):
        Counts.asked = 0
        blocks = divide_samples(q, width)
        _, space = run(B, p, np.ones(M), mu, np.zeros(M, complex), Counts(), blocks)
        assert space.met
        asked.append(Counts.asked)
    assert asked[1] < 0.5 * asked[0]


def test_without_time_it_takes_one_step_and_the_next_call_goes_on():
    B, p, D, mu = problem(2, 40, 1.0)
    clock = ManualClock()
    budget = pc.Budget.until(0.0, clock.now)
    whole, end = run(B, p, D, mu, np.zeros(40, complex))
    ascent, space = run(B, p, D, mu, np.zeros(40, complex), budget)
    assert ascent.steps == 1 < whole.steps
    for _ in range(20):
        ascent, space = run(B, p, D, mu, ascent.y, budget)
    assert space.met
    assert space.bound == pytest.approx(end.bound, rel=0.01)


def test_it_asks_for_the_time_as_often_in_each_run():
    B, p, D, mu = problem(3, 40, 1.0)
    counts = []
    for _ in range(2):
        Counts.asked = 0
        run(B, p, D, mu, np.zeros(40, complex), Counts())
        counts.append(Counts.asked)
    assert counts[0] == counts[1] > 0


def test_what_a_clock_raises_ends_the_call():
    B, p, D, mu = problem(4, 40, 1.0)

    class Fails(pc.Budget):
        @property
        def spent(self):
            raise RuntimeError("no clock")

    with pytest.raises(RuntimeError, match="no clock"):
        run(B, p, D, mu, np.zeros(40, complex), Fails())
