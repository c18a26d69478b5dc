"""What rounding to a device's levels costs at the control points, and what dithering and error feedback win.

Run: `python -m pacinian.bench.levels`. All in double precision, with the reference propagator; the solver is `auto`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import click
import numpy as np

from pacinian.acoustics.array import autd, lattice
from pacinian.acoustics.propagation import field, matrix
from pacinian.rendering.drive import thresholds
from pacinian.session import solve

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.array import Array
    from pacinian.types import Complexes, Floats

GOLDEN = (5.0**0.5 - 1.0) / 2.0
SEEDS = 12
LEVELS = 0.05, 0.3, 0.8
HEIGHT, AWAY = 0.2, 0.025  # [m]
ROWS = 2  # frames a tick, at 2 kHz
DEVICES = {
    "256 phases, 256 amplitudes": (256, 256),
    "256 phases, 320 amplitudes": (256, 320),
    "128 phases, 65 amplitudes": (128, 65),
    "16 phases, 16 amplitudes": (16, 16),
    "32 phases, on or off": (32, 2),
}
ARRAYS: dict[str, Callable[[], Array]] = {
    "16 x 16": lambda: lattice(0.1575, 0.1575, 0.0105),
    "1 unit": autd,
    "9 units": lambda: autd(3, 3),
}


def nearest(g: Complexes, B: Complexes, phases: int, amplitudes: int) -> Complexes:
    """Each gain (N,) to its own nearest level, as (1, N) rows."""
    return _levels(g, np.full(len(g), 0.5), phases, amplitudes)[None]


def fixed(g: Complexes, B: Complexes, phases: int, amplitudes: int) -> Complexes:
    """Amplitudes by thresholds that differ from transducer to transducer, and stay: what is done."""
    return _levels(g, thresholds(len(g)).astype(np.float64), phases, amplitudes)[None]


def golden(g: Complexes, B: Complexes, phases: int, amplitudes: int) -> Complexes:
    """The same with thresholds of low discrepancy, which have a pattern."""
    golden: Floats = np.arange(1, len(g) + 1, dtype=np.float64) * GOLDEN % 1.0
    return _levels(g, golden, phases, amplitudes)[None]


def random(g: Complexes, B: Complexes, phases: int, amplitudes: int) -> Complexes:
    """Amplitudes by random thresholds, new in each row."""
    rng = np.random.default_rng(1)
    rows = [_levels(g, rng.uniform(size=len(g)), phases, amplitudes) for _ in range(ROWS)]
    return np.array(rows)


def in_time(g: Complexes, B: Complexes, phases: int, amplitudes: int) -> Complexes:
    """Each transducer's error is added to what it is asked in the next row."""
    rows: list[Complexes] = []
    rest = np.zeros_like(g)
    for _ in range(ROWS):
        rows.append(nearest(g + rest, B, phases, amplitudes)[0])
        rest = rest + g - rows[-1]
    return np.array(rows)


def in_space(g: Complexes, B: Complexes, phases: int, amplitudes: int) -> Complexes:
    """One transducer after another takes the level that leaves the least error at the control points."""
    made, error = np.zeros_like(g), np.zeros(len(B), np.complex128)
    steps = np.exp(2j * np.pi * np.arange(phases) / phases)
    for n in range(len(g)):
        phase = round(float(np.angle(g[n])) / (2.0 * np.pi) * phases)
        level = int(abs(g[n]) * (amplitudes - 1))
        sizes = np.clip(np.arange(level - 1, level + 3), 0, amplitudes - 1) / (amplitudes - 1)
        turns = steps[(phase + np.arange(-1, 2)) % phases]
        offered = (sizes[:, None] * turns).ravel()
        left = error[:, None] + B[:, n, None] * (offered - g[n])
        best = int(np.argmin((np.abs(left) ** 2).sum(axis=0)))
        made[n], error = offered[best], left[:, best]
    return made[None]


WAYS = {f.__name__: f for f in (nearest, fixed, golden, random, in_time, in_space)}


def _levels(g: Complexes, half: Floats, phases: int, amplitudes: int) -> Complexes:
    turn = np.rint(np.angle(g) / (2.0 * np.pi) * phases) / phases
    size = np.minimum(np.floor(np.abs(g) * (amplitudes - 1) + half), amplitudes - 1)
    return np.asarray(size / (amplitudes - 1) * np.exp(2j * np.pi * turn), np.complex128)


def measured(array: Array, count: int, level: float, seed: int) -> dict[str, Floats]:
    """Device and way to: relative errors of |p| at `count` points, of each row and of the rows' mean; the ghost.

    level: of the strongest that one focus could be, shared by the points. ghost: the loudest place `AWAY` from all
    points, in their plane, over the loudest point.
    """
    rng = np.random.default_rng(seed)
    q = np.c_[rng.uniform(-0.05, 0.05, (count, 2)), np.full(count, HEIGHT)]
    B = matrix(array, q)
    t = rng.uniform(0.5, 1.0, count)
    t *= level * float(np.abs(B).sum(axis=1).mean()) / float(np.linalg.norm(t))
    g = solve(array, q, t).gains.astype(np.complex128)
    p, away = np.abs(B @ g), _away(q)
    found: dict[str, Floats] = {}
    for device, (phases, amplitudes) in DEVICES.items():
        for way, make in WAYS.items():
            rows = make(g, B, phases, amplitudes)
            made = rows @ B.T  # (K, M)
            each = np.linalg.norm(np.abs(made) - p, axis=1).mean() / np.linalg.norm(p)
            mean = np.linalg.norm(np.abs(made.mean(axis=0)) - p) / np.linalg.norm(p)
            ghost = np.abs(field(array, rows[0], away)).max() / p.max()
            found[f"{device}; {way}"] = np.array([100.0 * each, 100.0 * mean, ghost], np.float64)
    return found


def _away(q: Floats) -> Floats:
    """Places of the points' plane that are away from them all."""
    x = np.arange(-0.15, 0.15, 0.004)
    X, Y = np.meshgrid(x, x)
    plane = np.stack([X, Y, np.full_like(X, HEIGHT)], axis=-1).reshape(-1, 3)
    far = (np.linalg.norm(plane[:, None] - q, axis=2) > AWAY).all(axis=1)
    return np.asarray(plane[far], np.float64)


def main() -> None:
    """Print tables in Markdown: medians over problems."""
    cases = [(name, count) for name in ARRAYS for count in (1, 4, 16)]
    for level in LEVELS:
        table = {
            (name, count): [measured(ARRAYS[name](), count, level, s) for s in range(SEEDS)]
            for name, count in cases
        }
        click.echo(f"\nlevel {level:g}: error of a row / of the mean of {ROWS} rows [%] / ghost\n")
        click.echo("| levels; way | " + " | ".join(f"{a}, {m}" for a, m in cases) + " |")
        click.echo("|---|" + "---|" * len(cases))
        for key in table[cases[0]][0]:
            cells = [np.median([run[key] for run in table[case]], axis=0) for case in cases]
            told = " | ".join(f"{a:.2g} / {b:.2g} / {c:.2f}" for a, b, c in cells)
            click.echo(f"| {key} | {told} |")


if __name__ == "__main__":
    main()
