"""What smooth output costs, as ratios within one run.

`extra_info` holds, for the rows of one tick: `fading_over_rounding` and `aligned_over_rounding`, over
what it costs to round the same rows to the device's levels, with and without a limit that binds.
"""

from itertools import cycle
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.rendering.quantiser import Quantiser
from pacinian.rendering.smoothing import GainSmoother, Smoothing

from .medians import measure_medians


@pytest.mark.parametrize("N", [249, 2241])
@pytest.mark.parametrize("K", [1, 2])
def test_what_smooth_output_costs(benchmark: Any, N: int, K: int) -> None:
    rng = np.random.default_rng(1)
    gains = cycle(np.exp(2j * np.pi * rng.random((8, K, N))).astype(np.complex64))
    out = np.empty((K, N), np.complex64)
    limited, free = GainSmoother(Smoothing(), N), GainSmoother(Smoothing(rate=None), N)
    quantiser = Quantiser(pc.Capability(256, 320, 1000.0 * K), K, N)
    seconds = 1e-3 / K
    benchmark(lambda: limited.follow(next(gains), seconds, out))
    assert not limited.settled
    fading, aligned, rounding = measure_medians(
        lambda: limited.follow(next(gains), seconds, out),
        lambda: free.follow(next(gains), seconds, out),
        lambda: quantiser.make_frame(out, 1.0, 0, 0.0),
        repeats=2000,
    )
    assert free.settled
    benchmark.extra_info["fading_over_rounding"] = round(fading / rounding, 2)
    benchmark.extra_info["aligned_over_rounding"] = round(aligned / rounding, 2)
