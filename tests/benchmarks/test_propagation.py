"""Ratios within one run: `pytest -m benchmark -n 0`.

Each result's `extra_info` holds the ratio to plain NumPy and the nanoseconds an element of B.
"""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.acoustics.propagation import KernelData


def median(function: Callable[[], object], repeats: int) -> float:
    function()
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        function()
        times.append(time.perf_counter() - begin)
    return float(np.median(times))


@pytest.mark.parametrize("directivity", [pc.omni, pc.t4010a1], ids=["omni", "table"])
@pytest.mark.parametrize("M", [8, 64])
def test_building_b(benchmark: Any, M: int, directivity: Any) -> None:
    array = pc.autd(3, 3, pc.Transducer(pressure=4.386, directivity=directivity))
    rng = np.random.default_rng(0)
    q = np.c_[rng.uniform(-0.1, 0.1, (M, 2)), np.full(M, 0.2)]
    out = np.empty((M, len(array)), dtype=np.complex64)
    wave = KernelData.prepare(array, pc.Air())
    k = pc.Air().wavenumber(40_000.0)

    def numpy_omni() -> Any:
        r = np.sqrt(((q[:, None] - array.positions) ** 2).sum(axis=2))
        return 4.386 / r * np.exp(-1j * k * r)

    plain = median(numpy_omni, 5)
    benchmark(wave.matrix, q, out)
    fused = benchmark.stats.stats.median
    benchmark.extra_info["times_faster_than_numpy_omni"] = round(plain / fused, 1)
    benchmark.extra_info["ns_per_element"] = round(1e9 * fused / out.size, 2)


@pytest.mark.parametrize("M", [4, 16, 24, 64, 256])
def test_the_gram_matrix(benchmark: Any, M: int) -> None:
    from scipy.linalg import blas
    from threadpoolctl import threadpool_limits

    from pacinian.solving.propagator import gram_matrix

    rng = np.random.default_rng(0)
    B = (rng.normal(size=(M, 2241)) + 1j * rng.normal(size=(M, 2241))).astype(np.complex64)
    with threadpool_limits(1):
        library = median(lambda: blas.cherk(1.0, B.T, trans=2), 20)
        benchmark(gram_matrix, B)
    benchmark.extra_info["times_faster_than_blas"] = round(
        library / benchmark.stats.stats.median, 2
    )


def test_the_field_of_a_plane(benchmark: Any) -> None:
    array = pc.autd(3, 3, pc.Transducer(pressure=4.386))
    x, y = np.meshgrid(np.linspace(-0.1, 0.1, 200), np.linspace(-0.1, 0.1, 200))
    q = np.stack([x, y, np.full_like(x, 0.2)], axis=-1)
    g = np.exp(1j * np.random.default_rng(0).uniform(0, 6, len(array)))
    benchmark(pc.field, array, g, q)
    benchmark.extra_info["ns_per_element"] = round(
        1e9 * benchmark.stats.stats.median / (40_000 * len(array)), 2
    )


@pytest.mark.parametrize("M", [4, 16, 64])
@pytest.mark.parametrize("units", [1, 3])
def test_solving(benchmark: Any, units: int, M: int) -> None:
    array = pc.autd(units, units, pc.Transducer(pressure=4.386))
    rng = np.random.default_rng(1)
    q = np.c_[rng.uniform(-0.1, 0.1, (M, 2)), np.full(M, 0.2)]
    t = rng.uniform(0.3, 1.0, M)
    t *= 0.5 * np.abs(pc.matrix(array, q, pc.Air())).sum(axis=1).mean() / np.linalg.norm(t)
    solution = benchmark(pc.solve, array, q, t)
    benchmark.extra_info["error"] = solution.error


def test_the_field_of_a_plane_beside_the_autd3_emulator(
    benchmark: Any, need: Callable[..., Any]
) -> None:
    """200 x 200 points from 9 units; the emulator's own grid, all its threads, recording not counted."""
    need("autd3_emulator")
    from autd3.commands import Pattern, SetSilencer
    from autd3_core import Autd3, Duration, Geometry, Velocity
    from autd3_emulator import Emulator, Grid, RmsRecordOption
    from autd3_pattern import IntensityBuffer, PhaseBuffer

    places = [[192.0 * x, 151.4 * y, 0.0] for y in range(3) for x in range(3)]
    devices = Geometry([Autd3(np.array(place), np.array([1.0, 0, 0, 0])) for place in places])
    period = Duration.from_micros(25)
    full = np.full((9, 249), 255, np.uint8)

    def drive(recorder: Any) -> None:
        recorder.send(SetSilencer.disable())
        phase = PhaseBuffer.from_array(np.zeros((9, 249), np.uint8))
        recorder.send(Pattern(phase, IntensityBuffer.from_array(full)))
        recorder.tick(period)

    record = Emulator(devices).record(drive)
    option = RmsRecordOption(Velocity.from_m_s(340.0))
    array = pc.autd(3, 3, pc.Transducer(pressure=4.3859003539))
    first = array.positions[0]
    side = np.linspace(0.2, 0.4, 200)
    x, y = np.meshgrid(side, side)
    q = np.stack([x, y, np.full_like(x, 0.2)], axis=-1) + first
    g = np.ones(len(array), np.complex64)
    theirs: Any = None

    def emulate() -> None:
        nonlocal theirs
        grid = Grid((200.0, 400.0), (200.0, 400.0), 200.0, 200.0 / 199.0, "xyz")
        theirs = record.sound_field(grid, option).next(period).to_numpy()

    emulated = median(emulate, 3)
    ours = benchmark(pc.field, array, g, q)
    assert np.sort(np.abs(ours).ravel() / np.sqrt(2.0))[-1] == pytest.approx(theirs.max(), rel=1e-3)
    benchmark.extra_info["times_faster_than_autd3_emulator"] = round(
        emulated / benchmark.stats.stats.median, 1
    )
