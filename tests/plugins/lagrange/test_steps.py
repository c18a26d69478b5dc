"""The kernels of `lagrange` against plain NumPy in double precision."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.native import solving as passes
from pacinian.native.solving import choose_phases
from pacinian.solving.phases import initial_phases
from pacinian_plugins.native import lagrange as kernels
from pacinian_plugins.solvers.lagrange import reference
from pacinian_plugins.solvers.lagrange.gain_limited_newton import GainLimitedNewton

f4 = np.float32


def problem(M: int, N: int, seed: int, level: float = 0.6) -> Any:
    """B, its Gram matrix and targets of which some transducers reach their limit."""
    rng = np.random.default_rng(seed)
    B = (rng.normal(size=(M, N)) + 1j * rng.normal(size=(M, N))).astype(np.complex64)
    t = rng.uniform(0.3, 1.0, M)
    t *= level * np.abs(B).sum(axis=1).mean() / np.linalg.norm(t)
    wide = B.astype(np.complex128)
    G = wide @ wide.conj().T
    return B, G, t * np.exp(2j * np.pi * rng.uniform(size=M))


def planes(z: Any, rows: int = 0) -> Any:
    """A complex vector as real and imaginary parts, padded to `rows`."""
    out = np.zeros((2, max(rows, len(z))), f4)
    out[:, : len(z)] = z.real, z.imag
    return out


sizes = st.tuples(st.integers(1, 9), st.sampled_from([1, 7, 40, 255, 256, 257, 600]))


@given(size=sizes, seed=st.integers(0, 99))
def test_products_with_b(size: tuple[int, int], seed: int) -> None:
    B, _, y = problem(*size, seed)
    M, N = size
    g = np.random.default_rng(seed).normal(size=N) + 0.5j
    tile = np.zeros((2, M + -M % 4, passes.TILE), f4)
    x, p, q, z = np.empty((2, N), f4), np.empty((2, M)), np.empty(M, complex), np.empty(N, "c8")
    passes.adjoint_planar(B, planes(y, M + -M % 4), x, tile)
    passes.apply_planar(B, planes(g), p, tile)
    passes.apply(B, g.astype(np.complex64), q)
    passes.adjoint(B, y, z)
    back, forth = B.conj().T.astype(complex) @ y, B.astype(complex) @ g
    near = {"atol": 3e-6 * max(np.abs(back).max(), np.abs(forth).max())}
    for made, exact in ((x[0] + 1j * x[1], back), (z, back), (p[0] + 1j * p[1], forth), (q, forth)):
        np.testing.assert_allclose(made, exact, **near)


@given(size=sizes, seed=st.integers(0, 99), share=st.sampled_from([0.0, 0.3, 1.0, 1e6]))
def test_what_multipliers_make(size: tuple[int, int], seed: int, share: float) -> None:
    B, _, y = problem(*size, seed)
    M, N = size
    wide = B.astype(np.complex128)
    mu = share * float(np.median(np.abs(wide.conj().T @ y)))
    h, made = np.empty((3, N), f4), np.empty((2, M))
    tile = np.zeros((2, M + -M % 4, passes.TILE), f4)
    cost = kernels.evaluate(B, planes(y, M + -M % 4), f4(mu), h, made, tile)
    if mu == 0.0:
        x = wide.conj().T @ y
        np.testing.assert_allclose(h[0] + 1j * h[1], x / np.abs(x), atol=1e-3)
        return
    exact, length, c = reference.saturate(wide.conj().T @ y, mu)
    np.testing.assert_allclose(h[0] + 1j * h[1], exact, atol=1e-5)
    np.testing.assert_allclose(h[2], length, atol=1e-5 * length.max())
    np.testing.assert_allclose(made[0] + 1j * made[1], wide @ exact, atol=1e-4 * np.abs(y).max())
    assert cost == pytest.approx(c, rel=1e-5)


@given(size=sizes, seed=st.integers(0, 99), few=st.booleans(), share=st.sampled_from([0.5, 1.5]))
def test_the_curvature_is_what_finite_differences_give(
    size: tuple[int, int], seed: int, few: bool, share: float
) -> None:
    B, G, y = problem(*size, seed)
    M, N = size
    wide = B.astype(np.complex128)
    mu = share * float(np.median(np.abs(wide.conj().T @ y)))
    h, made = np.empty((3, N), f4), np.empty((2, M))
    tile = np.zeros((2, M + -M % 4, passes.TILE), f4)
    kernels.evaluate(B, planes(y, M + -M % 4), f4(mu), h, made, tile)
    u = np.exp(1j * np.random.default_rng(seed).uniform(0, 6, M))
    A, V = np.zeros((M + 4, M + 4)), np.zeros((M + 4, 2 * passes.TILE), f4)
    sample, which = np.arange(M), np.empty(passes.TILE, np.int64)
    if few:
        sealed = G.copy()
        sealed.flags.writeable = False
        kernels.rotate_gram(sealed, sample, planes(u), 1.0 / mu, A)
    kernels.curvature(B, sample, planes(u), h, f4(mu), few, A, V, which)
    eps = 1e-6 * np.abs(y).max()
    exact = np.empty((M, M))
    for j in range(M):
        step = np.zeros(M, complex)
        step[j] = eps * u[j]
        up, down = (reference.saturate(wide.conj().T @ (y + s), mu)[0] for s in (step, -step))
        exact[:, j] = ((wide @ (up - down)) * u.conj()).real / (2 * eps)
    np.testing.assert_allclose(np.tril(A[:M, :M]), np.tril(exact), atol=2e-3 * np.abs(exact).max())


@given(K=st.integers(1, 20), negative=st.integers(0, 9), seed=st.integers(0, 99))
def test_the_signed_factor_solves(K: int, negative: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    positive = max(0, K - negative)
    W = rng.normal(size=(K, 2 * K))
    A = W @ W.T  # quasi-definite: S of the first rows, -S^-1 of the others
    A[:positive, :positive] += np.eye(positive)
    A[positive:, positive:] = -A[positive:, positive:] - np.eye(K - positive)
    b = rng.normal(size=K)
    L, x = A.copy(), b.copy()
    assert kernels.factor(L, K, positive) == 0
    kernels.substitute(L, K, positive, x)
    np.testing.assert_allclose(A @ x, b, atol=1e-8)


def test_a_pivot_without_meaning_leaves_its_unknown_at_0() -> None:
    A = np.ones((3, 3)) + np.diag([1.0, 0.0, 0.0])
    b = np.ones(3)
    assert kernels.factor(A, 3, 3) == 1
    kernels.substitute(A, 3, 3, b)
    assert np.isfinite(b).all()
    assert abs(b[2]) < 1e-9


@given(M=st.integers(1, 16), seed=st.integers(0, 99))
def test_the_start_in_one_kernel_is_that_of_lapack(M: int, seed: int) -> None:
    _, G, p = problem(M, 40, seed)
    G = G.copy()
    t, phi = np.abs(p), np.full(M, np.nan)
    phi[: M // 2] = np.angle(p[: M // 2])
    for array in (G, t, phi):
        array.flags.writeable = False
    mu = 1e-6 * float(np.trace(G).real) / M
    w = kernels.Workspace(M, 40)
    first, steps = initial_phases(M, None)
    share = kernels.start(G, t, phi, first, steps, mu, 1e-6, 0.5, w)
    plain, flags = np.empty(M, complex), np.empty(M, bool)
    norm = choose_phases(G, t, phi, first, steps, plain, flags)
    assert share == kernels.scale_for_single(norm / 0.5, 1e-6, mu, 40)
    np.testing.assert_array_equal(w.free, flags)
    np.testing.assert_allclose(w.p, plain * share / 0.5)
    y = mu * np.linalg.solve(G + mu * np.eye(M), w.p)
    np.testing.assert_allclose(w.y, y, rtol=1e-6, atol=1e-12)


@settings(max_examples=40)
@given(
    M=st.integers(1, 8), seed=st.integers(0, 99), level=st.sampled_from([0.2, 0.6, 0.8]),
    fixed=st.integers(0, 3),
)  # fmt: skip
def test_the_steps_are_those_of_double_precision(
    M: int, seed: int, level: float, fixed: int
) -> None:
    B, G, p = problem(M, 150, seed, level)
    free = np.arange(M) >= fixed
    mu = 1e-5 * float(np.trace(G).real) / M
    w = kernels.Workspace(M, 150)
    y = mu * np.linalg.solve(G + mu * np.eye(M), p)
    w.p[:], w.free[:], w.y[:] = p, free, y
    sealed = G.copy()
    sealed.flags.writeable = False
    out = np.empty(150, np.complex64)
    polish = GainLimitedNewton(B, sealed, mu, w, pc.Budget(), 1.0, out)
    end = polish.run()
    exact = reference.solve_newton(B.astype(np.complex128), G, p, free, mu, y, 60)
    made = B.astype(complex) @ exact.h
    missed = np.where(free, np.abs(p) - np.abs(made), np.abs(p - made))
    if np.linalg.norm(missed) < 1e-3 * np.linalg.norm(p):  # the steps converge, also in double
        assert end.error < 2e-3
        assert end.objective == pytest.approx(exact.objective, rel=1e-3)
    size = float(np.linalg.norm(p)) ** 2
    assert end.bound <= end.objective + 1e-5 * size
    assert np.abs(out).max() <= 1.0 + 1e-6


@given(
    M=st.integers(1, 8), seed=st.integers(0, 99), level=st.sampled_from([0.2, 0.4, 0.6]),
    fixed=st.integers(0, 8),
)  # fmt: skip
def test_few_steps_in_double_precision_end_where_their_equations_hold(
    M: int, seed: int, level: float, fixed: int
) -> None:
    """Re(conj(u) (B h(B^H y) + y)) = |p| for the phasors u made; where the phase is given, across too."""
    B, G, p = problem(M, 150, seed, level)
    B, free = B.astype(np.complex128), np.arange(M) >= fixed
    mu = 1e-4 * float(np.trace(G).real) / M
    y = mu * np.linalg.solve(G + mu * np.eye(M), p)
    found = reference.solve_newton(B, G, p, free, mu, y, 8)
    x = B.conj().T @ found.y
    np.testing.assert_allclose(found.h, x / np.maximum(np.abs(x), mu), atol=1e-12)
    made = B @ found.h
    asked = np.where(free, np.abs(p) * np.exp(1j * np.angle(made)), p)
    rest = (asked - made - found.y) * np.exp(-1j * np.angle(asked))
    assert np.linalg.norm(np.where(free, rest.real, rest)) <= 1e-9 * np.linalg.norm(p)


@given(M=st.integers(1, 6), seed=st.integers(0, 99))
def test_the_step_of_the_gains_solves_its_equations(M: int, seed: int) -> None:
    """Against a dense solve of (D + W^T S W) d = v."""
    N = 30
    B = problem(M, N, seed)[0]
    rng = np.random.default_rng(seed)
    h = np.zeros((3, N), f4)
    phase, size = rng.uniform(0, 6, N), np.where(rng.random(N) < 0.6, 1.0, 0.5)
    h[0], h[1] = size * np.cos(phase), size * np.sin(phase)
    y = rng.normal(size=M) + 1j * rng.normal(size=M)
    x = planes(B.conj().T @ y)
    held, D = np.empty(N, bool), np.empty(N, f4)
    kernels.project_gradient(h, f4(0.1), 0.3, x, held, D)
    u = np.exp(1j * rng.uniform(0, 6, M))
    bend = rng.uniform(-0.02, 1.0, M)
    rows = M + -M % 4
    K = 2 * M
    d = np.empty((2, N), f4)
    kernels.newton_step(
        B, planes(u, rows), bend, h, held, D, x, d, np.empty((2, M)), np.zeros((K + 4, K + 4)),
        np.zeros((2, rows, passes.TILE), f4), np.zeros((K + 4, 2 * passes.TILE), f4),
        np.zeros((2, rows), f4),
    )  # fmt: skip
    g = (h[0] + 1j * h[1]).astype(complex)
    columns, diagonal, v, place = [], [], [], []
    for n in range(N):
        for e in (1j * g[n],) if held[n] else (1.0, 1j):
            dp = u.conj() * B[:, n] * e
            columns.append(np.concatenate([dp.real, dp.imag]))
            diagonal.append(D[n])
            v.append(((x[0, n] + 1j * x[1, n]) * np.conj(e)).real)
            place.append((n, e))
    W = np.array(columns).T
    H = np.diag(diagonal) + W.T @ np.diag(np.concatenate([np.ones(M), bend])) @ W
    if np.linalg.eigvalsh(H)[0] < 1e-2 * np.min(diagonal):
        return  # not convex there: rows across u are left out
    exact = np.zeros(N, complex)
    for (n, e), length in zip(place, np.linalg.solve(H, v), strict=True):
        exact[n] += e * length
    np.testing.assert_allclose(d[0] + 1j * d[1], exact, atol=2e-3 * np.abs(exact).max())


@given(seed=st.integers(0, 99))
def test_full_drive_makes_amplitudes_proportional(seed: int) -> None:
    B, _, p = problem(4, 200, seed)
    w = kernels.Workspace(4, 200)
    w.p[:], w.y[:] = p, p
    taken = kernels.equalise(B, 200, w)
    assert taken == -200 or 0 < taken < 200
    np.testing.assert_allclose(np.hypot(*w.made), w.multiple * np.abs(p), rtol=5e-3)
    if taken > 0:  # as many as that, and no more, were needed
        w.y[:] = p
        assert kernels.equalise(B, taken, w) == taken
        w.y[:] = p
        assert kernels.equalise(B, taken - 1, w) == 1 - taken
    np.testing.assert_allclose(np.hypot(w.h[0], w.h[1]), 1.0, atol=1e-5)


def test_a_workspace_of_another_size_is_refused() -> None:
    B, G, _ = problem(3, 40, 0)
    for M, N in ((2, 40), (3, 41)):
        with pytest.raises(ValueError, match="size"):
            kernels.solve_dual(B, G, 1.0, 1, 0.0, kernels.Workspace(M, N), 1.0, np.empty(N, "c8"))


def test_a_nearest_answer_cannot_be_improved_by_small_changes() -> None:
    """At targets out of reach: against random changes of the gains within the limit."""
    B, G, p = problem(6, 120, 3, level=1.4)
    mu = 1e-6 * float(np.trace(G).real) / 6
    w, out = kernels.Workspace(6, 120), np.empty(120, np.complex64)
    w.p[:], w.free[:], w.y[:] = p, True, mu * np.linalg.solve(G, p)
    sealed = G.copy()
    sealed.flags.writeable = False
    GainLimitedNewton(B, sealed, mu, w, pc.Budget(), 1.0, out).run()
    wide, t = B.astype(np.complex128), np.abs(p)

    def cost(g: Any) -> float:
        return float(np.sum((np.abs(wide @ g) - t) ** 2)) + mu * float(np.vdot(g, g).real)

    best, rng = cost(out), np.random.default_rng(0)
    for length in (1e-1, 1e-2, 1e-3):
        for _ in range(50):
            g = out + length * (rng.normal(size=120) + 1j * rng.normal(size=120))
            assert cost(g / np.maximum(np.abs(g), 1.0)) >= best * (1 - 1e-4)
