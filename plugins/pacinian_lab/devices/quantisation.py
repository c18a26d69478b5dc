"""Measure the error at the control points from quantising to a device's levels, with several kinds of dithering.

Run: `python -m pacinian_lab.devices.quantisation`. All in double precision, with the reference propagator and the
solver `auto`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import click
import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import autd, lattice
from pacinian.acoustics.propagation import field, matrix
from pacinian.plugins.backend import Capability
from pacinian.rendering.quantiser import dither_thresholds
from pacinian.session import solve

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.array import Array
    from pacinian.types import Complexes, Floats, Indices

GOLDEN = (5.0**0.5 - 1.0) / 2.0
SEEDS = 12
LEVELS = 0.05, 0.3, 0.8
HEIGHT, AWAY = 0.2, 0.025  # [m]
ROWS = 2  # frames per tick, at 2 kHz
WIDTHS = np.unique(np.rint(512.0 / np.pi * np.arcsin(np.arange(256) / 255.0)))  # of 512 per period
AUTD3 = tuple(np.sin(np.pi * WIDTHS / 512.0).tolist())
PULSES = tuple(np.sin(0.5 * np.pi * np.arange(65) / 64.0).tolist())
DEVICES = {
    "256 phases, 256 amplitudes": Capability(256, 256),
    "256 phases, AUTD3's 203 amplitudes": Capability(256, AUTD3),
    "640 phases, 320 amplitudes": Capability(640, 320),
    "128 phases, 65 amplitudes": Capability(128, 65),
    "128 phases, OpenMPD's 65 amplitudes": Capability(128, PULSES),
    "16 phases, 16 amplitudes": Capability(16, 16),
    "32 phases, on or off": Capability(32, 2),
}
ARRAYS: dict[str, Callable[[], Array]] = {
    "16 x 16": lambda: lattice(0.1575, 0.1575, 0.0105),
    "1 unit": autd,
    "9 units": lambda: autd(3, 3),
}


def nearest(g: Complexes, B: Complexes, can: Capability) -> Complexes:
    """Round each gain (N,) to its nearest level; return rows (1, N)."""
    return _levels(g, np.full(len(g), 0.5), can)[None]


def fixed(g: Complexes, B: Complexes, can: Capability) -> Complexes:
    """Dither amplitudes with fixed thresholds that differ between transducers, as Pacinian does."""
    return _levels(g, dither_thresholds(len(g)).astype(np.float64), can)[None]


def golden(g: Complexes, B: Complexes, can: Capability) -> Complexes:
    """Dither with fixed low-discrepancy thresholds, which have a pattern."""
    golden: Floats = np.arange(1, len(g) + 1, dtype=np.float64) * GOLDEN % 1.0
    return _levels(g, golden, can)[None]


def random(g: Complexes, B: Complexes, can: Capability) -> Complexes:
    """Dither amplitudes with random thresholds, new in each row."""
    rng = np.random.default_rng(1)
    rows = [_levels(g, rng.uniform(size=len(g)), can) for _ in range(ROWS)]
    return np.array(rows)


def in_time(g: Complexes, B: Complexes, can: Capability) -> Complexes:
    """Feed each transducer's error back into its next row."""
    rows: list[Complexes] = []
    rest = np.zeros_like(g)
    for _ in range(ROWS):
        rows.append(nearest(g + rest, B, can)[0])
        rest = rest + g - rows[-1]
    return np.array(rows)


def in_space(g: Complexes, B: Complexes, can: Capability) -> Complexes:
    """Choose levels one transducer at a time, each to minimise the error at the control points."""
    made, error = np.zeros_like(g), np.zeros(len(B), np.complex128)
    steps = np.exp(2j * np.pi * np.arange(can.phases) / can.phases)
    sizes, below = can.sizes.astype(np.float64), _below(np.abs(g), can)
    for n in range(len(g)):
        phase = round(float(np.angle(g[n])) / (2.0 * np.pi) * can.phases)
        near = sizes[np.clip(np.arange(below[n] - 1, below[n] + 3), 0, len(sizes) - 1)]
        turns = steps[(phase + np.arange(-1, 2)) % can.phases]
        offered = (near[:, None] * turns).ravel()
        left = error[:, None] + B[:, n, None] * (offered - g[n])
        best = int(np.argmin((np.abs(left) ** 2).sum(axis=0)))
        made[n], error = offered[best], left[:, best]
    return made[None]


WAYS = {f.__name__: f for f in (nearest, fixed, golden, random, in_time, in_space)}


def _levels(g: Complexes, half: Floats, can: Capability) -> Complexes:
    turn = np.rint(np.angle(g) / (2.0 * np.pi) * can.phases) / can.phases
    size, sizes = np.abs(g), can.sizes.astype(np.float64)
    i = _below(size, can)
    share = (size - sizes[i]) / (sizes[i + 1] - sizes[i])
    level = np.minimum(i + np.floor(share + half), len(sizes) - 1).astype(np.intp)
    return np.asarray(sizes[level] * np.exp(2j * np.pi * turn), np.complex128)


def _below(size: Floats, can: Capability) -> Indices:
    """Return the level below each amplitude, at most the last but one."""
    found = np.searchsorted(can.sizes, size, "right") - 1
    return np.asarray(np.clip(found, 0, len(can.sizes) - 2), np.intp)


def measure_errors(array: Array, count: int, level: float, seed: int) -> dict[str, Floats]:
    """Return errors of |p| at `count` points, by device and way: of a row, of the rows' mean, and the ghost.

    level: relative to the strongest possible single focus, shared by the points. ghost: |p| at the loudest place that
    is `AWAY` from all points, in their plane, relative to the loudest point. The errors are relative [%].
    """
    rng = np.random.default_rng(seed)
    q = np.c_[rng.uniform(-0.05, 0.05, (count, 2)), np.full(count, HEIGHT)]
    B = matrix(array, q, Air())
    t = rng.uniform(0.5, 1.0, count)
    t *= level * float(np.abs(B).sum(axis=1).mean()) / float(np.linalg.norm(t))
    g = solve(array, q, t).gains.astype(np.complex128)
    p, away = np.abs(B @ g), _away(q)
    found: dict[str, Floats] = {}
    for device, can in DEVICES.items():
        for way, make in WAYS.items():
            rows = make(g, B, can)
            made = rows @ B.T  # (K, M)
            each = np.linalg.norm(np.abs(made) - p, axis=1).mean() / np.linalg.norm(p)
            mean = np.linalg.norm(np.abs(made.mean(axis=0)) - p) / np.linalg.norm(p)
            ghost = np.abs(field(array, rows[0], away, medium=Air())).max() / p.max()
            found[f"{device}; {way}"] = np.array([100.0 * each, 100.0 * mean, ghost], np.float64)
    return found


def _away(q: Floats) -> Floats:
    """Return the places of the points' plane that are away from all points."""
    x = np.arange(-0.15, 0.15, 0.004)
    X, Y = np.meshgrid(x, x)
    plane = np.stack([X, Y, np.full_like(X, HEIGHT)], axis=-1).reshape(-1, 3)
    far = (np.linalg.norm(plane[:, None] - q, axis=2) > AWAY).all(axis=1)
    return np.asarray(plane[far], np.float64)


def main() -> None:
    """Print Markdown tables of medians over problems."""
    cases = [(name, count) for name in ARRAYS for count in (1, 4, 16)]
    for level in LEVELS:
        table = {
            (name, count): [measure_errors(ARRAYS[name](), count, level, s) for s in range(SEEDS)]
            for name, count in cases
        }
        click.echo(
            f"\nlevel {level:g}: error of a row [%] / error of the mean of {ROWS} rows [%] / ghost\n"
        )
        click.echo("| levels; way | " + " | ".join(f"{a}, {m}" for a, m in cases) + " |")
        click.echo("|---|" + "---|" * len(cases))
        for key in table[cases[0]][0]:
            cells = [np.median([run[key] for run in table[case]], axis=0) for case in cases]
            text = " | ".join(f"{a:.2g} / {b:.2g} / {c:.2f}" for a, b, c in cells)
            click.echo(f"| {key} | {text} |")


if __name__ == "__main__":
    main()
