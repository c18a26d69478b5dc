# Made by `python native_build.py --stubs`.
from pacinian.types import Gains, Levels, Singles


def quantise(g: Gains, phases: int, top: int, highest: int, threshold: Singles, phase: Levels, amplitude: Levels) -> None:
    """
    Round gains, (N,), to levels, phase 0..phases - 1 and amplitude 0..top, evenly spaced; none above `highest`.

    threshold: for each, 0..1, from how far below a level its amplitude is rounded up to it: 0.5 rounds to the nearest,
    0 down. NaN becomes amplitude 0.
    """

def quantise_by(g: Gains, phases: int, size: Singles, slope: Singles, first: Levels, highest: int, threshold: Singles, phase: Levels, amplitude: Levels) -> None:
    """
    As `quantise`, for levels whose amplitudes are `size`: ascending from 0 to 1, then infinity.

    slope: levels per amplitude above each, 0 for the last. first: the level at or below k / K, (K + 1,), K a power of 2:
    from there the level is looked for.
    """

def dequantise(phase: Levels, amplitude: Levels, unit: Gains, size: Singles, out: Gains) -> None:
    """
    Write the gains that levels stand for, (N,); unit, size: what each phase and amplitude level is.
    """

def follow(gains: Gains, step: float, span: int, growth: float, align: bool, settled: bool, loudest: Singles, last: Gains, out: Gains) -> bool:
    """
    Write rows, (K, N), that go from `last`, (N,), towards `gains`, (K, N) or (1, N) for all rows.

    step: how far a gain may move from row to row, over the loudest. span: rows over which the way is spread, at least.
    growth: of what is asked until it is loudest. settled: whether `last` was its gains. loudest: gain of late, (1,),
    forgotten slowly while the gains are reached. `last` becomes the last row; what is not a number becomes 0.
    Returns whether the last row is its gains.
    """
