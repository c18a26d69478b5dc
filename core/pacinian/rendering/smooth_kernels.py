"""The kernel of smooth output: align and fade, in passes that the compiler vectorises."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy import float32 as f4

from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    from pacinian.types import Gains, Singles

SHORT = f4(1.0 - 2.0**-21)  # times a gain: rounding then cannot make it larger than it was
HUGE = f4(1e30)
FORGETS = f4(
    16.0
)  # times as long as a gain takes from 0 to the loudest: what vibrates is as loud as it was at its most


@compiled("b1(c8[:, ::1], f4, i8, f4, b1, b1, f4[::1], c8[::1], c8[:, ::1])", finite=False)
def follow(
    gains: Gains, step: np.float32, span: int, growth: np.float32, align: bool, settled: bool,
    loudest: Singles, last: Gains, out: Gains,
) -> bool:  # fmt: skip
    """Write rows, (K, N), that go from `last`, (N,), towards `gains`, (K, N) or (1, N) for all rows.

    step: how far a gain may move from row to row, over the loudest. span: rows over which the way is spread, at least.
    growth: of what is asked until it is loudest. settled: whether `last` was its gains. loudest: gain of late, (1,),
    forgotten slowly while the gains are reached. `last` becomes the last row; what is not a number becomes 0.
    Returns whether the last row is its gains.
    """
    N, reached = last.size, settled
    before = last
    for k in range(out.shape[0]):
        g, o = gains[min(k, gains.shape[0] - 1)], out[k]
        ur, ui = f4(1.0), f4(0.0)  # the turn that brings g nearest to the row before
        if align:
            re, im = f4(0.0), f4(0.0)  # of the inner product of g and the row before
            for i in range(N):
                re += g[i].real * before[i].real + g[i].imag * before[i].imag
                im += g[i].real * before[i].imag - g[i].imag * before[i].real
            size = max(abs(re), abs(im))
            if f4(1e-30) < size < HUGE:
                re, im = re / size, im / size
                length = f4(1.0) / np.sqrt(re * re + im * im)
                ur, ui = re * length, im * length
        most = f4(1.0)  # share of the way
        if step < HUGE:
            square, here, there = f4(0.0), f4(0.0), f4(0.0)
            for i in range(N):
                dr = g[i].real * ur - g[i].imag * ui - before[i].real
                di = g[i].real * ui + g[i].imag * ur - before[i].imag
                distance = dr * dr + di * di
                now = before[i].real * before[i].real + before[i].imag * before[i].imag
                then = g[i].real * g[i].real + g[i].imag * g[i].imag
                square = distance if distance > square else square
                here = now if now > here else here
                there = then if then > there else there
            here, there = np.sqrt(here), growth * np.sqrt(there)
            size = there if there > here else here
            if reached:
                loudest[0] *= max(f4(1.0) - step / FORGETS, f4(0.0))
            loudest[0] = size if size > loudest[0] else loudest[0]
            far = np.sqrt(square)
            most = step * loudest[0] / far if far > step * loudest[0] else f4(1.0)
        even = f4(1.0) / f4(max(span - k, 1))
        reached = bool(most >= f4(1.0) and even >= f4(1.0))
        part = SHORT if reached else SHORT * min(most, even)
        rest = f4(0.0) if reached else SHORT - part
        for i in range(N):
            re = part * (g[i].real * ur - g[i].imag * ui) + rest * before[i].real
            im = part * (g[i].real * ui + g[i].imag * ur) + rest * before[i].imag
            o[i] = complex(re if abs(re) < HUGE else f4(0.0), im if abs(im) < HUGE else f4(0.0))
        before = o
    last[:] = before
    return reached
