"""The steps of `solve_dual` in double precision and plain NumPy, for `precision="double"` and as a reference."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import pacinian as pc
    from pacinian.types import Complexes, Flags, Floats

STOP_RESIDUAL = 1e-12  # ||F|| / ||p|| to stop at


def saturate(x: Complexes, mu: float) -> tuple[Complexes, Floats, float]:
    """Return h(x) and |x|, both (N,), and the sum of c(x_n); see `convex.dual`."""
    size = np.abs(x)
    cost = np.where(size <= mu, size * size / (2.0 * mu), size - mu / 2.0).sum()
    return x / np.maximum(size, mu), size, float(cost)


class Refined(NamedTuple):
    """Best step: gains h, (N,), multipliers y, (M,), and the bound and objective that certify them."""

    h: Complexes
    y: Complexes
    bound: float
    objective: float


def refine_certified(
    B: Complexes, p: Complexes, free: Flags, mu: float, y: Complexes, h: Complexes | None = None
) -> Refined:
    """Compute the bound D(y) and the objective of gains h, (N,), for the phases that they make.

    h: h(B^H y) by default.
    """
    own, _, cost = saturate(B.conj().T @ y, mu)
    h = own if h is None else h
    made = B @ h
    target = np.where(free & (made != 0.0), np.abs(p) * np.exp(1j * np.angle(made)), p)
    rest = target - made
    bound = float(np.vdot(y, target).real - np.vdot(y, y).real / 2.0 - cost)
    objective = float(np.vdot(rest, rest).real + mu * np.vdot(h, h).real) / 2.0
    return Refined(h, y, bound, objective)


def solve_newton(
    B: Complexes,
    G: Complexes,
    p: Complexes,
    free: Flags,
    mu: float,
    y: Complexes,
    steps: int,
    budget: pc.Budget | None = None,
) -> Refined:
    """Take Newton steps from multipliers y, (M,), as long as they reduce F.

    B: (M, N), complex128. p: targets, (M,); where `free`, only their size counts.
    """
    sample = np.concatenate([np.arange(len(p)), np.flatnonzero(~free)])  # sample of each equation
    last, best = np.inf, y
    for _ in range(steps + 1):
        h, size, _ = saturate(B.conj().T @ y, mu)
        made = B @ h
        target = np.where(free & (made != 0.0), np.abs(p) * np.exp(1j * np.angle(made)), p)
        u = np.exp(1j * np.angle(target))
        u = np.concatenate([u, 1j * u[~free]])
        F = ((target - made - y)[sample] * u.conj()).real
        short = float(np.linalg.norm(F))
        if not short < last:
            break
        last, best = short, y
        if short <= STOP_RESIDUAL * np.linalg.norm(p) or (budget is not None and budget.spent):
            break
        at_limit = size > mu
        A = (u.conj()[:, None] * G[np.ix_(sample, sample)] * u).real / mu
        C = u.conj()[:, None] * B[np.ix_(sample, np.flatnonzero(at_limit))] * h[at_limit]
        A -= (C.real / mu) @ C.real.T + (C.imag * (1.0 / mu - 1.0 / size[at_limit])) @ C.imag.T
        A[np.diag_indices_from(A)] += 1.0
        y = y.copy()
        np.add.at(y, sample, u * np.linalg.lstsq(A, F, rcond=float(np.finfo(A.dtype).eps))[0])
    return refine_certified(B, p, free, mu, best)
