"""A lower bound of the error over all gains and phases, from the dual of a semidefinite relaxation.

If phases are free, ||t - |B g||| is the minimum of ||D u - B g|| over u with |u_m| = 1, where D = diag(t). Its square
is a quadratic form of z = (u, g). The Lagrange dual of this minimum under |u_m|^2 = 1 and |g_n|^2 <= 1 is also the dual
of the relaxation in which z z^H is replaced by any matrix >= 0:

    maximise  sum a - sum b   subject to  K = [D^2 - diag(a), -D B; -B^H D, B^H B + diag(b)] >= 0,  b >= 0.

For b > 0, K >= 0 is equivalent to S = D P^-1 D >= diag(a) with P = I + B diag(1/b) B^H, matrices of only M rows. Newton
steps with the barriers tau (log det K + log b) find the maximum. The proof does not depend on them, because any a and
any b > 0 give a valid bound.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats

MAX_POINTS = 16  # largest number of points M; a step handles M^2 columns and takes some 10 ms
# Largest number of Newton steps; smallest share of a step that is tried.
MAX_STEPS, MIN_STEP = 150, 1e-6
# Tau, the weight of the barriers, is divided by TAU_DIVISOR once a Newton step is at most MAX_CENTRED_STEP long.
MAX_CENTRED_STEP, TAU_DIVISOR = 0.25, 8.0
# Largest relative gap at which to stop, and smallest bound to which the gap is relative.
MAX_GAP, MIN_BOUND = 1e-2, 1e-6
INITIAL_B = 0.2  # initial b, relative to ||B|| / sqrt(N)


def least_error(B: Complexes, t: Floats) -> float:
    """Return a lower bound of ||t - |B g||| / ||t|| over all g with |g_n| <= 1.

    B: (M, N), complex128, for gains in units of the limit. t: target amplitudes, (M,), not all 0.
    """
    size = float(np.linalg.norm(t))
    B, t = B[:, B.any(axis=0)] / size, t / size
    M, N = B.shape
    if not N:
        return 1.0
    b = np.full(N, INITIAL_B * float(np.linalg.norm(B)) / math.sqrt(N))
    tau = float(b[0]) / 2.0
    a = np.full(M, float(np.linalg.eigvalsh(_schur(B, t, b)[0])[0]) - tau)
    value = _barrier(B, t, a, b, tau)
    for _ in range(MAX_STEPS):
        da, db, length = _step(B, t, a, b, tau)
        share = 1.0
        while share > MIN_STEP:
            new = a + share * da, b * np.exp(share * db)
            if (higher := _barrier(B, t, *new, tau)) >= value:
                (a, b), value = new, higher
                break
            share /= 2.0
        if length <= MAX_CENTRED_STEP or share <= MIN_STEP:
            if tau * (M + 2 * N) <= MAX_GAP * max(float(a.sum() - b.sum()), MIN_BOUND):
                break
            tau /= TAU_DIVISOR
            value = _barrier(B, t, a, b, tau)
    return math.sqrt(max(prove_bound(B, t, a, b), 0.0))


def prove_bound(B: Complexes, t: Floats, a: Floats, b: Floats) -> float:
    """Return the lower bound of ||t - |B g|||^2 over |g_n| <= 1 that multipliers a, (M,), and b > 0, (N,), prove.

    An upper bound of the rounding is subtracted. For any Y, S >= D Y + Y^H D - Y^H P Y, where errors of Y count only
    with their square. This expression is computed in extended precision, if the machine has it. If diag(a) exceeds it,
    a is lowered by the excess.
    """
    M, N = B.shape
    wide = B.astype(np.clongdouble)
    P = np.eye(M) + (wide / b) @ wide.conj().T
    Y = np.linalg.solve(P.astype(np.complex128), np.diag(t).astype(np.complex128))
    DY = t[:, None] * Y.astype(np.clongdouble)
    least = DY + DY.conj().T - Y.conj().T @ (P @ Y.astype(np.clongdouble))
    H = least.astype(np.complex128) - np.diag(a)
    sizes = np.abs(Y).T @ ((np.eye(M) + (np.abs(B) / b) @ np.abs(B).T) @ np.abs(Y))
    rounding = 4.0 * (N + 3 * M) * float(np.finfo(np.longdouble).eps) * float(sizes.sum())
    eps = 8.0 * (M + N) * float(np.finfo(np.float64).eps)
    rounding += eps * (1.0 + float(np.abs(H).sum()))
    short = max(rounding - float(np.linalg.eigvalsh(H)[0]), 0.0)
    total = float(a.sum()) - float(b.sum()) - M * short
    return float(total - eps * (np.abs(a).sum() + b.sum()))


def _schur(B: Complexes, t: Floats, b: Floats) -> tuple[Complexes, Complexes, Complexes]:
    """Return S, P^-1 D and P, each (M, M)."""
    P: Complexes = np.eye(len(t)) + (B / b) @ B.conj().T
    W: Complexes = np.linalg.solve(P, np.diag(t).astype(np.complex128))
    S: Complexes = t[:, None] * W
    return (S + S.conj().T) / 2.0, W, P


def _barrier(B: Complexes, t: Floats, a: Floats, b: Floats, tau: float) -> float:
    """Return (sum a - sum b) / tau + log det K + sum log b; minus infinity if K is not positive definite."""
    S, _, P = _schur(B, t, b)
    try:
        inside, outside = (np.linalg.cholesky(A).diagonal().real for A in (S - np.diag(a), P))
    except np.linalg.LinAlgError:
        return -math.inf
    logs = float(np.log(inside).sum() + np.log(outside).sum() + np.log(b).sum())
    return float(a.sum() - b.sum()) / tau + 2.0 * logs


def _step(
    B: Complexes, t: Floats, a: Floats, b: Floats, tau: float
) -> tuple[Floats, Floats, float]:
    """Return the Newton step for `_barrier` in a and log b, and its length in the norm of the Hessian.

    K^-1 = [X, .; ., diag(1/b) - A R A^H] with A = diag(1/b) B^H. The negative Hessian of log det K consists of the
    squared magnitudes of the elements of K^-1. For b, this is a diagonal plus M^2 columns F, so that no N x N system
    needs to be solved.
    """
    M = len(t)
    S, W, P = _schur(B, t, b)
    X = np.linalg.inv(S - np.diag(a))
    R = np.linalg.inv(P) - W @ X @ W.conj().T
    weight, vectors = np.linalg.eigh((R + R.conj().T) / 2.0)
    A = B.conj().T / np.sqrt(b)[:, None]  # in log b: scaled by the root of b
    Z = A @ vectors
    i, j = np.triu_indices(M)
    pairs, apart = Z[:, i] * Z[:, j].conj(), i != j
    F = np.concatenate([pairs.real, pairs.imag[:, apart]], axis=1)
    C = weight[i] * weight[j] * np.where(apart, 2.0, 1.0)
    C = np.concatenate([C, C[apart]])[:, None]
    own = 1.0 - (np.abs(Z) ** 2) @ weight  # b_n (K^-1)_nn
    along, rise = 1.0 / tau - X.diagonal().real, own + 1.0 - b / tau
    d = (2.0 * own + np.maximum(-rise, 0.0))[:, None]  # log b adds -rise, if positive
    E = np.abs(A @ (W @ X)) ** 2  # (N, M)
    right = np.concatenate([rise[:, None], E], axis=1) / d
    inner = np.eye(len(C)) + C * (F.T @ (F / d))
    right -= F @ np.linalg.solve(inner, C * (F.T @ right)) / d
    da = np.linalg.solve(np.abs(X) ** 2 - E.T @ right[:, 1:], along + E.T @ right[:, 0])
    db = np.asarray(right[:, 0] + right[:, 1:] @ da, np.float64)
    da = np.asarray(da, np.float64)
    return da, db, math.sqrt(max(float(along @ da + rise @ db), 0.0))
