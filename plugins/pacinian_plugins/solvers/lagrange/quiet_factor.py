"""The quiet factor: how much silence beside a region counts against the errors within it.

Some contacts are finer than the array resolves: the edge of a plate, the rim of a cup. Least squares then meets the
targets with strong gains whose sound cancels within the region, and presses on the skin beside it with many times the
pressure that was asked for. If the skin beside a region gets too much, the weight of silent samples and the
regularisation mu are multiplied by the quiet factor f:

    min 1/2 sum_regions |p - B g|^2 + f (w/2 sum_silent |B g|^2 + mu/2 ||g||^2)

As f grows, the pressure beside the region falls fast, and the error within it rises slowly. Where the skin beside the
regions is quiet enough, f is 1 (decision 92).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.solving.skin_phases import BESIDE_WEIGHT

if TYPE_CHECKING:
    import pacinian as pc

# Highest pressure at silent samples that needs no change, relative to the mean of the nearest region: if no transducer
# is at its limit, and if many are. Such an array lacks force, and a larger f takes more of it.
MAX_LOUDNESS, MAX_LOUDNESS_AT_LIMIT = 0.45, 1.2
# fraction of the transducers at their limit from which the second value holds; between 0 and this, it rises linearly
MAX_SATURATION = 0.075
# Silent samples nearer to a region than this do not count: pressure cannot fall that fast [wavelengths].
NEAR = 0.5
MAX_FACTOR = 32.0
# The factor changes by the ratio of loudness to its limit, to this power.
EXPONENT = 0.8
MIN_CHANGE = 1.3  # smallest change of the factor that is worth further steps, as a ratio
# Largest number of changes in a solve that starts anew, and in one that continues from the last.
MAX_COLD_CHANGES, MAX_WARM_CHANGES = 4, 1


def find_last_factor(warm: pc.Solution | None) -> float:
    """Return the quiet factor of a solution; 1 if it has no silent samples."""
    if warm is None or not warm.targets.beside.any():
        return 1.0
    return min(max(warm.quiet_weight / BESIDE_WEIGHT, 1.0), MAX_FACTOR)


def find_max_loudness(saturation: float) -> float:
    """Return the highest pressure at silent samples, relative to the mean of the nearest region, that needs no change.

    saturation: fraction of the transducers at their limit.
    """
    share = min(saturation / MAX_SATURATION, 1.0)
    return MAX_LOUDNESS + share * (MAX_LOUDNESS_AT_LIMIT - MAX_LOUDNESS)


def adapt_factor(factor: float, loudness: float, saturation: float) -> float:
    """Return the next quiet factor; the same if it is good enough.

    loudness: highest pressure at silent samples, relative to the mean of the nearest region. saturation: fraction of
    the transducers at their limit. Both are at this factor.
    """
    best = factor * (loudness / find_max_loudness(saturation)) ** EXPONENT
    best = min(max(best, 1.0), MAX_FACTOR)
    return best if max(best / factor, factor / best) > MIN_CHANGE else factor
