"""Kernels that round gains to a device's levels of phase and amplitude, and tell what levels stand for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy import float32 as f4
from numpy import uint32 as u4

from pacinian.acoustics.compiled import compiled

if TYPE_CHECKING:
    from pacinian.types import Gains, Levels, Singles

TILE = 256


@compiled("f4(f4, f4, f4)", finite=False)
def phase_level(re: f4, im: f4, phases: f4) -> f4:
    """The nearest phase level, 0..phases - 1, of re + j im; 0 of what has none."""
    a: f4 = abs(re)
    b: f4 = abs(im)
    t = min(a, b) / max(max(a, b), f4(1e-30))  # arctan(t) / 2 pi on 0..1
    u = t * t
    turn = t * (f4(0.15915482) + u * (f4(-0.05304561) + u * (f4(0.0317404) + u * (f4(-0.02210987)
        + u * (f4(0.01528151) + u * (f4(-0.00881427) + u * (f4(0.0034233) + u * f4(-0.00063029))))))))  # fmt: skip
    turn = f4(0.25) - turn if b > a else turn
    turn = f4(0.5) - turn if re < f4(0.0) else turn
    turn = f4(1.0) - turn if im < f4(0.0) else turn
    level = np.rint(turn * phases)
    level = level if level < phases else f4(0.0)
    return level if level > f4(0.0) else f4(0.0)


@compiled("void(c8[::1], i8, i8, i8, f4[::1], u2[::1], u2[::1])", finite=False)
def quantise(
    g: Gains, phases: int, top: int, highest: int, threshold: Singles,
    phase: Levels, amplitude: Levels,
) -> None:  # fmt: skip
    """Round gains to levels, phase 0..phases - 1 and amplitude 0..top, evenly spaced; none above `highest`.

    threshold: for each, 0..1, from how far below a level its amplitude is rounded up to it: 0.5 rounds to the
    nearest, 0 down. NaN becomes amplitude 0.
    """
    for n in range(g.size):
        re, im = g[n].real, g[n].imag
        phase[n] = np.uint16(phase_level(re, im, f4(phases)))
        level = min(np.floor(np.sqrt(re * re + im * im) * f4(top) + threshold[n]), f4(highest))
        amplitude[n] = np.uint16(level if level > f4(0.0) else f4(0.0))


@compiled(
    "void(c8[::1], i8, f4[::1], f4[::1], u2[::1], i8, f4[::1], u2[::1], u2[::1])", finite=False
)
def quantise_by(
    g: Gains, phases: int, size: Singles, slope: Singles, first: Levels, highest: int,
    threshold: Singles, phase: Levels, amplitude: Levels,
) -> None:  # fmt: skip
    """As `quantise`, for levels whose amplitudes are `size`: ascending from 0 to 1, then infinity.

    slope: levels per amplitude above each, 0 for the last. first: the level at or below k / K, (K + 1,), K a power
    of 2: from there the level is looked for.
    """
    K = f4(first.size - 1)
    tile, place = np.empty(TILE, np.float32), np.empty(TILE, np.uint32)
    for start in range(0, g.size, TILE):  # in passes: only the one that looks up is not vectorised
        count = min(TILE, g.size - start)
        part, ours = g[start : start + count], threshold[start : start + count]
        turns, levels = phase[start : start + count], amplitude[start : start + count]
        for n in range(count):
            re, im = part[n].real, part[n].imag
            turns[n] = np.uint16(phase_level(re, im, f4(phases)))
            a = np.sqrt(re * re + im * im)
            a = a if a > f4(0.0) else f4(0.0)
            tile[n] = a if a < f4(1.0) else f4(1.0)
            place[n] = u4(np.int32(tile[n] * K))
        for n in range(count):
            i, a = u4(first[place[n]]), tile[n]
            while a >= size[i + u4(1)]:
                i += u4(1)
            tile[n] = f4(np.int32(i)) + (a - size[i]) * slope[i]
        for n in range(count):
            levels[n] = np.uint16(min(np.floor(tile[n] + ours[n]), f4(highest)))


@compiled("void(u2[::1], u2[::1], c8[::1], f4[::1], c8[::1])")
def dequantise(phase: Levels, amplitude: Levels, unit: Gains, size: Singles, out: Gains) -> None:
    """Write the gains that levels stand for, (N,); unit, size: what each phase and amplitude level is."""
    for n in range(out.size):
        out[n] = size[amplitude[n]] * unit[phase[n]]
