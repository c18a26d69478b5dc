"""Newton steps on the gains, towards the nearest pressures that full drive allows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy import float32 as f4

from pacinian.acoustics.compiled import compiled
from pacinian.solving.passes import gather, spread
from pacinian_plugins.solvers.lagrange.tangent import movable, step

if TYPE_CHECKING:
    from pacinian.types import Complexes, Flags, Floats, Gains, Singles

DAMPED, MOST = 1e-3, 1e3  # damping to start with, and to give up at, in units of the mean |x|
SHORTEST = f4(1e-3)  # of a step


@compiled("f8(c16[::1], b1[::1], f8[:, ::1], f4[:, ::1], f4[:, ::1], f8[::1])")
def misfit(p: Complexes, free: Flags, made: Floats, u: Singles, y: Singles, bend: Floats) -> float:
    """Return 1/2 ||p - made||^2 for pressures made, (2, M); a free phase is as made.

    Writes the phasors u along which each is measured, the residual y, both (2, M), and by how much a
    pressure across u counts, (M,): 1 where its phase is fixed, (|p| - t) / |p| where free.
    """
    cost = 0.0
    for m in range(len(p)):
        q, t = complex(made[0, m], made[1, m]), abs(p[m])
        a = abs(q)
        v = p[m] / t if t > 0.0 else 1.0 + 0.0j
        bend[m], rest = 1.0, p[m] - q
        if free[m]:
            v = q / a if a > 0.0 else v
            bend[m], rest = (a - t) / max(a, 1e-3 * t), (t - a) * v
        u[0, m], u[1, m] = v.real, v.imag
        y[0, m], y[1, m] = rest.real, rest.imag
        cost += rest.real**2 + rest.imag**2
    return cost / 2.0


@compiled("f8(f4[:, ::1], f4[:, ::1], f4, f4[:, ::1])")
def shortened(h: Singles, d: Singles, length: np.float32, new: Singles) -> float:
    """Write h + length d, (2, N), brought back within the limit; return the sum of its squares."""
    power = 0.0
    for n in range(d.shape[1]):
        hr, hi = h[0, n] + length * d[0, n], h[1, n] + length * d[1, n]
        square = hr * hr + hi * hi
        shorter = f4(1.0) / np.sqrt(max(square, f4(1.0)))
        new[0, n], new[1, n] = hr * shorter, hi * shorter
        power += min(square, f4(1.0))
    return power


@compiled(
    "i8(c8[:, ::1], c16[::1], b1[::1], f8, i8, f8, f4[:, ::1], f8[:, ::1], f8[:, ::1],"
    "f4[:, :, ::1], f4[:, ::1], f4[:, ::1], b1[::1], f8[::1], f8)"
)
def nearest(
    B: Gains, p: Complexes, free: Flags, mu: float, steps: int, enough: float,
    h: Singles, made: Floats, A: Floats, tile: Singles, V: Singles, W: Singles, held: Flags,
    found: Floats, finished: float,
) -> int:  # fmt: skip
    """Lower 1/2 ||p - B h||^2 + mu/2 ||h||^2 over |h_n| <= 1, from the gains h, (3, N), in place.

    made: B h, (2, M), of the gains given. enough: ||p - made|| / ||p|| to stop at. A, tile, V: as in
    `tangent.step`. W, held: room, (7, N) and (N,). found: that error, the damping (1) and how many steps
    in a row did little (4), to go on with. finished: two steps that lower the cost by a smaller share
    are the last.
    Returns the number of steps, negative if more may help.
    """
    M, N = B.shape
    rows = tile.shape[1]
    u, y, bend = np.zeros((2, rows), f4), np.zeros((2, rows), f4), np.zeros(M)
    spare, q = np.zeros((2, rows), f4), np.zeros((2, M))
    x, d, new, D = W[0:2], W[2:4], W[4:6], W[6]
    size, power = 0.0, 0.0
    for m in range(M):
        size += p[m].real ** 2 + p[m].imag ** 2
    for n in range(N):
        power += h[0, n] ** 2 + h[1, n] ** 2
    cost = misfit(p, free, made, u, y, bend)
    best = cost + mu / 2.0 * power
    damping = found[1] if found[1] > 0.0 else DAMPED
    taken, idle = 0, found[4]
    while 2.0 * cost > enough * enough * size and idle < 2 and damping <= MOST:
        if taken == steps:
            taken = -taken
            break
        taken += 1
        spread(B, y, x, tile)
        movable(h, f4(mu), damping, x, held, D)
        step(B, u, bend, h, held, D, x, d, q, A, tile, V, spare)
        length, now = f4(1.0), np.inf
        while not now < best and length > SHORTEST:
            power = shortened(h, d, length, new)
            gather(B, new, q, tile)
            cost = misfit(p, free, q, u, y, bend)
            now = cost + mu / 2.0 * power
            length *= f4(0.5)
        if not now < best:
            cost = misfit(p, free, made, u, y, bend)
            damping *= 10.0
            continue
        idle = idle + 1.0 if best - now < finished * best else 0.0
        damping *= 3.0 if length < f4(0.5) else 0.25
        best = now
        h[0], h[1] = new[0], new[1]
        made[:] = q
    found[0], found[1], found[4] = np.sqrt(2.0 * cost / size), damping, idle
    return taken
