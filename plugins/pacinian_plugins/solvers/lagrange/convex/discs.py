"""Quantities held in discs: gains and sound pressures are treated alike.

A quantity h in a disc of radius `limit` costs weight |h|^2 / 2, and x pulls at it: h(x) = x / weight
where that lies in the disc, else limit x / |x|.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numba
import numpy as np

from pacinian.acoustics.compiled import compiled
from pacinian_plugins.solvers.lagrange.convex.products import NUMBERS, VECTOR

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats

ALIGNED = 0.03  # slope along x, relative to that across it, below which it is left out


@compiled(numba.float64(VECTOR, NUMBERS, numba.float64, NUMBERS, VECTOR), finite=False)
def clip(x: Complexes, weight: Floats, extra: float, limit: Floats, h: Complexes) -> float:
    """Write h(x) for weights `weight` + `extra`; return the sum of max Re(x^* h) - weight |h|^2 / 2."""
    cost = 0.0
    for n in range(x.size):
        w, q = weight[n] + extra, limit[n]
        r = np.sqrt(x[n].real ** 2 + x[n].imag ** 2)
        if r <= w * q:
            h[n] = x[n] / w
            cost += r * r / (2.0 * w)
        else:
            h[n] = x[n] * (q / r)
            cost += q * (r - w * q / 2.0)
    return cost


@compiled(numba.float64(VECTOR, NUMBERS, NUMBERS, numba.float64), finite=False)
def lift(x: Complexes, weight: Floats, limit: Floats, power: float) -> float:
    """The least nu >= 0 that keeps ||h(x)||^2 <= power when added to the weights.

    Newton steps on 1 / ||h||, which is linear in nu while nothing is held, inside a bracket.
    """
    low, high, nu = 0.0, 0.0, 0.0
    for n in range(x.size):
        high += x[n].real ** 2 + x[n].imag ** 2
    high = np.sqrt(high / power)
    for _ in range(100):
        square, slope = 0.0, 0.0
        for n in range(x.size):
            w, q = weight[n] + nu, limit[n]
            size = x[n].real ** 2 + x[n].imag ** 2
            if size <= w * w * q * q:
                square += size / (w * w)
                slope += size / (w * w * w)
            else:
                square += q * q
        if square <= power * (1.0 + 1e-13):
            high = nu
            if nu == 0.0 or square >= power * (1.0 - 1e-13):
                break
        else:
            low = nu
        if slope > 0.0:
            nu += square / slope * (np.sqrt(square / power) - 1.0)
        if slope == 0.0 or not low < nu < high:
            nu = (low + high) / 2.0
        if high - low <= 1e-15 * high:
            break
    return high


@compiled(
    numba.int64(VECTOR, VECTOR, NUMBERS, numba.float64, NUMBERS, NUMBERS, NUMBERS), finite=False
)
def slopes(
    x: Complexes, g: Complexes, weight: Floats, extra: float, limit: Floats,
    radial: Floats, tangential: Floats,
) -> int:  # fmt: skip
    """Write how fast h follows x along it and across it; return how many are held at their limit.

    Those held do not follow along x, strictly. But where the last step expected h to be, at g, says
    how far that can be trusted: their slope along x fades out as g comes to lie along x (Chan, Golub
    and Mulet 1999; Hintermueller and Stadler 2006). This keeps steps from overshooting.
    """
    held = 0
    for n in range(x.size):
        w, q = weight[n] + extra, limit[n]
        r = np.sqrt(x[n].real ** 2 + x[n].imag ** 2)
        if r <= w * q:
            radial[n] = tangential[n] = 1.0 / w
        else:
            held += 1
            along = (g[n].real * x[n].real + g[n].imag * x[n].imag) / (q * r) if q > 0.0 else 1.0
            rest = 1.0 - min(max(along, 0.0), 1.0)
            tangential[n] = q / r
            radial[n] = rest * q / r if rest > ALIGNED else 0.0
    return held


@compiled(
    numba.void(VECTOR, VECTOR, VECTOR, NUMBERS, NUMBERS, NUMBERS, numba.float64, VECTOR),
    finite=False,
)
def expect(
    x: Complexes, dx: Complexes, h: Complexes, radial: Floats, tangential: Floats,
    limit: Floats, shrink: float, g: Complexes,
) -> None:  # fmt: skip
    """Write g, what h is expected to be after a step dx; those not held shrink by a share besides."""
    for n in range(x.size):
        r = np.sqrt(x[n].real ** 2 + x[n].imag ** 2)
        v = x[n] / r if r > 0.0 else complex(1.0, 0.0)
        turned = np.conj(v) * dx[n]
        new = h[n] + v * complex(radial[n] * turned.real, tangential[n] * turned.imag)
        if radial[n] == tangential[n]:
            new -= shrink * h[n]
        size = np.sqrt(new.real**2 + new.imag**2)
        g[n] = new * (limit[n] / size) if size > limit[n] else new


@compiled("UniTuple(f8, 2)(c16[::1], c16[::1], f8[::1], f8[::1], f8, c16[::1])", finite=False)
def judge(
    p: Complexes, made: Complexes, limit: Floats, slack: Floats, s: float, r: Complexes
) -> tuple[float, float]:
    """Write r = s p - made; return how far it is over a limit at most, and the rest's sum of squares.

    Exact ones, of limit 0, may be s times as inexact.
    """
    excess, square = 0.0, 0.0
    for m in range(p.size):
        r[m] = s * p[m] - made[m]
        size = r[m].real ** 2 + r[m].imag ** 2
        if np.isinf(limit[m]):
            square += size
        else:
            allowed = limit[m] + (slack[m] if limit[m] > 0.0 else s * slack[m])
            excess = max(excess, np.sqrt(size) - allowed)
    return excess, square


@compiled(numba.void(VECTOR, NUMBERS, NUMBERS, numba.float64, numba.float64[::1, :]), finite=False)
def add_blocks(y: Complexes, radial: Floats, tangential: Floats, ridge: float, S: Floats) -> None:
    """Add one 2 x 2 matrix for each y to S, (2R, 2R): slopes along and across it, and `ridge`."""
    R = y.size
    for m in range(R):
        size = np.sqrt(y[m].real ** 2 + y[m].imag ** 2)
        a, b = (y[m].real / size, y[m].imag / size) if size > 0.0 else (1.0, 0.0)
        r, t = radial[m], tangential[m]
        S[m, m] += r * a * a + t * b * b + ridge
        S[m, R + m] += (r - t) * a * b
        S[R + m, R + m] += r * b * b + t * a * a + ridge
