"""One Newton step on the dual.

F changes with y by -(W_y + A W_x A^H) dy, where W_x = dh/dx and W_y = dr/dy are, in real numbers, one
2 x 2 matrix for each transducer and each row. If the power limit is reached, nu changes too, which subtracts
t t^T / ((mu + nu) ||h||^2), where t = A h over the transducers below their own limit. If the strength
s is unknown, there is one more equation, Re(c^H dy) = 0.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np

from pacinian.solving.linalg import blas, lapack
from pacinian.solving.propagator import mean_square
from pacinian_plugins.native import lagrange as kernels

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.types import Complexes, Floats, Reals
    from pacinian_plugins.solvers.lagrange.convex.dual import Dual, Point

# ridge relative to the mean diagonal element
RIDGE = {np.dtype(np.float32): 1e-7, np.dtype(np.float64): 1e-13}
# Twice the share of gains at their limit up to which they are subtracted from A A^H.
SUBTRACTED_SHARE = 1.5
# Mu, relative to the mean square of the rows, from which single precision suffices.
MIN_SINGLE_MU = 1e-7
ARMIJO_SHARE = 1e-4  # least share of the promised ascent that a step must achieve
ROUNDING = 1e-14  # rounding error of D relative to its terms
MIN_STEP = 1e-4  # least length of a step, relative to a full step
OVERSHOT_LENGTH = 0.1  # length of a step below which it has overshot and the doubt grows
# Factors by which the doubt grows then, and decays in other steps.
DOUBT_GROWTH, DOUBT_DECAY = 100.0, 10.0

T = TypeVar("T", bound="Floats | Complexes")


class Slopes(NamedTuple):
    """Derivatives of h along x and across it, and the number of elements of h at their limit."""

    radial: Floats
    tangential: Floats
    saturated_count: int

    @classmethod
    def of(cls, x: Complexes, g: Complexes, weight: Floats, extra: float, limit: Floats) -> Slopes:
        """Compute the slopes at x. g: h as the last step expected it."""
        radial, tangential = np.empty(len(x)), np.empty(len(x))
        saturated_count = kernels.slopes(x, g, weight, extra, limit, radial, tangential)
        return cls(radial, tangential, saturated_count)


class State(NamedTuple):
    """A point of the dual, with the expectation and the outcome of the last step."""

    point: Point
    made: Complexes  # (R,) A h [Pa]
    g: Complexes  # (N,), h as expected
    z: Complexes  # (R,) [Pa], r as expected
    s: float = 0.0  # strength
    promise: float = np.inf  # twice the expected ascent of a full step [Pa^2]
    length: float = 1.0  # of the step taken, relative to a full step
    doubt: float = 0.0  # distrust of the expectations, 0 to 1; a step with doubt 1 always ascends


@dataclass(frozen=True, eq=False)
class Newton:
    """Newton steps on duals of one A. gram: A A^H, (R, R), complex128. room: workspace for (2R, N) numbers."""

    gram: Complexes
    room: Reals

    @classmethod
    def of(cls, A: Complexes, gram: Complexes, mu: float) -> Newton:
        """Choose single precision if mu is so large that rounding does not matter, else double."""
        fine = A.dtype == np.complex128 or mu < MIN_SINGLE_MU * mean_square(gram)
        return cls(gram, np.empty(2 * A.size, np.float64 if fine else np.float32))

    @property
    def fine(self) -> bool:
        """Whether steps are taken in double precision."""
        return self.room.dtype == np.float64

    def finer(self) -> Newton:
        """Return a copy in double precision."""
        return replace(self, room=np.empty(len(self.room)))

    def step(self, dual: Dual, state: State) -> State:
        """Return the next state: the same point with a new expectation if no step ascends."""
        point, rows, weight = state.point, dual.rows, dual.mu + state.point.nu
        doubt = state.doubt / DOUBT_DECAY
        if state.length < OVERSHOT_LENGTH:
            doubt = min(1.0, max(DOUBT_GROWTH * state.doubt, doubt)) if state.doubt else 1.0
        trust = 1.0 - doubt
        ahead = Slopes.of(point.x, trust * state.g, dual.weight, point.nu, dual.limit)
        aside = Slopes.of(point.y, trust * state.z, rows.weight, 0.0, rows.limit)
        F = dual.slope(point, state.made, state.s)
        S = self._matrix(dual, point, ahead)
        t, square = _below(dual, point, ahead)
        if square > 0.0:
            S -= np.outer(_real(t), _real(t) * (trust / (weight * square)))
        d, ds = self._solve(S, point.y, aside, F, dual.along)
        dx = dual.pull(d)
        g, z = np.empty_like(point.h), np.empty_like(point.r)
        shrink = trust * float(np.vdot(t, d).real) / (weight * square) if square > 0.0 else 0.0
        kernels.expect(point.x, dx, point.h, *ahead[:2], dual.limit, shrink, g)
        kernels.expect(point.y, d, point.r, *aside[:2], rows.limit, 0.0, z)
        promise = float(np.vdot(d, F).real)
        new, length = _search(dual, point, d, dx, promise)
        made = dual.make(new.h) if length > 0.0 else state.made
        return State(new, made, g, z, state.s + ds, promise, length, doubt)

    def _matrix(self, dual: Dual, point: Point, slopes: Slopes) -> Floats:
        """Return the upper triangle of A W_x A^H, (2R, 2R); start from A A^H if few gains are at their limit."""
        R, N = dual.A.shape
        free = 1.0 / (dual.mu + point.nu)
        S = np.zeros((2 * R, 2 * R), order="F")
        sign, radial, tangential = 1.0, slopes.radial, slopes.tangential
        if 2 * slopes.saturated_count <= min(N + np.count_nonzero(radial), SUBTRACTED_SHARE * N):
            kernels.real(self.gram, free, S.T)
            if not slopes.saturated_count:
                return S
            sign, radial, tangential = -1.0, free - radial, free - tangential
        syrk = blas.dsyrk if self.fine else blas.ssyrk
        for across, slope in ((False, radial), (True, tangential)):
            count = kernels.columns(dual.A, point.x, slope, across, self.room)
            if count:
                V = self.room[: 2 * R * count].reshape(2 * R, count)
                S += syrk(sign, V.T, trans=1)
        return S

    def _solve(
        self, S: Floats, y: Complexes, slopes: Slopes, F: Complexes, c: Complexes | None
    ) -> tuple[Complexes, float]:
        """Return the direction, (R,), and the change of strength. S: upper triangle, (2R, 2R)."""
        ridge = RIDGE[self.room.dtype] * (float(np.abs(np.diagonal(S)).mean()) or 1.0)
        kernels.add_blocks(y, slopes.radial, slopes.tangential, ridge, S.T)
        L = factor(S, ridge, lapack.dpotrf)
        d = _complex(lapack.dpotrs(L, _real(F), lower=0)[0])
        if c is None:
            return d, 0.0
        e = _complex(lapack.dpotrs(L, _real(c), lower=0)[0])
        ds = -float(np.vdot(c, d).real) / float(np.vdot(c, e).real)
        return d + ds * e, ds


def factor(S: T, ridge: float, potrf: Callable[..., tuple[T, int]]) -> T:
    """Return the Cholesky factor of S; add growing multiples of `ridge` to its diagonal until there is one.

    Raises LinAlgError if S is not finite.
    """
    while np.isfinite(ridge):
        L, info = potrf(S, lower=0, clean=0)
        if info == 0:
            return L
        ridge *= 10.0
        S[np.diag_indices(len(S))] += ridge
    raise np.linalg.LinAlgError("the Newton matrix is not finite")


def _below(dual: Dual, point: Point, slopes: Slopes) -> tuple[Complexes, float]:
    """Return A h over the transducers that only the power limit restricts, and their power."""
    if point.nu == 0.0:
        return point.r, 0.0
    h = np.where(slopes.radial == slopes.tangential, point.h, 0.0)
    return dual.make(h), float(np.vdot(h, h).real)


def _search(
    dual: Dual, point: Point, d: Complexes, dx: Complexes, promise: float
) -> tuple[Point, float]:
    """Backtrack from a full step by halving; return the first point that is high enough, else the same point."""
    noise = ROUNDING * (abs(float(np.vdot(point.y, dual.rows.p).real)) + abs(point.value))
    length = 1.0
    while length > MIN_STEP:
        new = dual.at(point.y + length * d, point.x + length * dx)
        if new.value >= point.value + ARMIJO_SHARE * length * promise - noise:
            return new, length
        length /= 2.0
    return point, 0.0


def _real(z: Complexes) -> Floats:
    v = np.empty(2 * len(z))
    v[: len(z)], v[len(z) :] = z.real, z.imag
    return v


def _complex(v: Floats) -> Complexes:
    z = np.empty(len(v) // 2, np.complex128)
    z.real, z.imag = v[: len(z)], v[len(z) :]
    return z
