# Made by `python native_build.py --stubs`.
from pacinian.types import Floats, Gains, Levels, Longs, Singles


def quantise(g: Gains, phases: int, top: int, highest: int, threshold: Singles, phase: Levels, amplitude: Levels) -> None:
    """
    Round gains, (N,), to levels, phase 0..phases - 1 and amplitude 0..top, evenly spaced; none above `highest`.

    threshold: for each, 0..1, from how far below a level its amplitude is rounded up to it: 0.5 rounds to the nearest,
    0 down. NaN becomes amplitude 0.
    """

def quantise_by(g: Gains, phases: int, size: Singles, slope: Singles, first: Levels, highest: int, threshold: Singles, phase: Levels, amplitude: Levels) -> None:
    """
    As `quantise`, for levels whose amplitudes are `size`: ascending from 0 to 1, then infinity.

    slope: levels per amplitude above each level, 0 for the last. first: the level at or below each k / K, (K + 1,), where the
    search for a level begins; K is a power of 2.
    """

def dequantise(phase: Levels, amplitude: Levels, unit: Gains, size: Singles, out: Gains) -> None:
    """
    Write the gains that levels stand for, (N,); unit, size: what each phase and amplitude level is.
    """

LARGEST: float = 1000000.0

SIDE: int = 2000003

def locate(q: Floats, origin: Floats, extent: Floats, farthest: float) -> int:
    """
    Return 1 if any point q, (M, 3) [m], is farther than `farthest` [m] from the origin along an axis, plus 2 if any is
    within `extent`, (3,) [m], along all axes.
    """

def look_up(q: Floats, size: float, cells: Longs, known: Floats, out: Floats, missing: Longs) -> int:
    """
    Write the value of the cell of each point q, (M, 3) [m], to `out`, (M,); return the number of points without one.

    size: of a cell [m]. cells: numbers of those known, ascending, with the values `known`. missing: numbers of the cells
    without a value, (M,): ((x + LARGEST) SIDE + y + LARGEST) SIDE + z + LARGEST for the cell (x, y, z).
    """

def follow(gains: Gains, step: float, span: int, growth: float, align: bool, phases: int, settled: bool, loudest: Singles, last: Gains, out: Gains) -> bool:
    """
    Write rows, (K, N), that go from `last`, (N,), towards `gains`, (K, N) or (1, N) for all rows.

    step: largest movement of a gain from row to row, over `loudest`. span: least number of rows for the whole way.
    growth: factor by which the gains will still grow while they fade in. align: whether to turn the gains towards `last`: by
    whole levels of phase if `phases` is their number, by any angle if it is 0. settled: whether `last` had reached its gains.
    loudest: largest recent gain, (1,), which decays while the gains are reached. `last` becomes the last row. A number that
    is not finite becomes 0. Returns whether the last row has reached its gains.
    """

def find_factors(r: Singles, turns: float, exponent: float, centre: Singles, place: Singles, most: float, out: Gains) -> None:
    """
    Write the factors on the gains that move the field around `centre` to `place`, (3,) [m]: (N,).

    r: positions of the transducers, (3, N) [m], with the same origin. turns: k / 2 pi [1/m]. exponent: of the distance in
    the amplitude, 0 or 1. most: largest factor on an amplitude, and 1 over the smallest.
    """
