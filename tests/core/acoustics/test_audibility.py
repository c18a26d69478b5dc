from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.acoustics.audibility import compute_envelope, measure_audible, weigh_a
from pacinian.rendering.smoothing import GainSmoother, Smoothing

bounded = settings(max_examples=30)
FS = 96_000.0
TIMES = np.arange(48_000) / FS
ARRAY = pc.lattice(0.04, 0.04)
POINTS = np.array([[0.0, 0.0, 0.1], [0.03, -0.02, 0.15]])


def wave(frequency: float, depth: float) -> Any:
    return 1.0 + depth * np.sin(2.0 * np.pi * frequency * TIMES)[:, None]


def focused(x: float) -> Any:
    """Gains of a focus at (x, 0, 0.1) m."""
    k = pc.Air().wavenumber(ARRAY.transducer.frequency)
    return np.exp(1j * k * np.linalg.norm(ARRAY.positions - [x, 0.0, 0.1], axis=1))


@given(frequency=st.floats(50.0, 15_000.0), depth=st.floats(1e-3, 1.0))
@bounded
def test_a_sine_has_half_the_square_of_its_depth_and_its_frequencys_weight(
    frequency: float, depth: float
) -> None:
    # A Hann window spreads a sine over bins: its transform, with the weighting of each bin.
    bins = np.arange(20.0, 20_001.0, FS / len(TIMES))
    x = (bins - frequency) * len(TIMES) / FS + 1e-9  # not exactly -1, 0 or 1
    share = (np.sinc(x) / (1.0 - x**2)) ** 2
    weight = 10.0 * np.log10((share * 10.0 ** (weigh_a(bins) / 10.0)).sum() / share.sum())
    energy = depth**2 / 2.0
    expected = 10.0 * np.log10(energy / (1.0 + energy)) + weight
    assert measure_audible(wave(frequency, depth), FS) == pytest.approx(expected, abs=1e-3)


def test_loudness_is_no_matter() -> None:
    e = wave(500.0, 0.3)
    np.testing.assert_allclose(measure_audible(1e6 * e, FS), measure_audible(e, FS))


def test_what_stays_the_same_is_not_heard() -> None:
    assert (measure_audible(np.full((4800, 3), 7.0), FS) == -np.inf).all()
    assert (measure_audible(np.zeros((4800, 1)), FS) == -np.inf).all()


@pytest.mark.parametrize("frequency", [8.0, 30_000.0])
def test_what_is_too_slow_or_too_fast_is_not_heard(frequency: float) -> None:
    # The weighting alone gives -77 or more.
    assert measure_audible(wave(frequency, 1.0), FS)[0] < -200.0


def test_the_weighting_is_the_standards() -> None:
    # IEC 61672-1, third octaves from 12.5 Hz to 20 kHz
    table = [
        -63.4, -56.7, -50.5, -44.7, -39.4, -34.6, -30.2, -26.2, -22.5, -19.1, -16.1, -13.4, -10.9,
        -8.6, -6.6, -4.8, -3.2, -1.9, -0.8, 0.0, 0.6, 1.0, 1.2, 1.3, 1.2, 1.0, 0.5, -0.1, -1.1,
        -2.5, -4.3, -6.6, -9.3,
    ]  # fmt: skip
    exact = 1000.0 * 10.0 ** (np.arange(-19, 14) / 10.0)
    np.testing.assert_allclose(weigh_a(exact), table, atol=0.06)


def test_frames_are_held_where_transducers_follow_at_once() -> None:
    gains = np.array([focused(x) for x in (0.0, 0.01, 0.02)])
    e, sampling = compute_envelope(gains, 1000.0, ARRAY, POINTS, pc.Air(), bandwidth=None)
    assert sampling == FS
    p = gains @ pc.matrix(ARRAY, POINTS, pc.Air()).T
    np.testing.assert_allclose(e, np.repeat(np.abs(p) ** 2, 96, axis=0))


def test_points_may_move_with_the_frames() -> None:
    gains = np.array([focused(x) for x in (0.0, 0.01, 0.02)])
    path = np.array([[[x, 0.0, 0.1]] for x in (0.0, 0.01, 0.02)])
    e, _ = compute_envelope(gains, 48_000.0, ARRAY, path, pc.Air(), bandwidth=None)
    p = [pc.matrix(ARRAY, q, pc.Air()) @ g for q, g in zip(path, gains, strict=True)]
    np.testing.assert_allclose(e, np.repeat(np.abs(p) ** 2, 2, axis=0))


def test_a_reversed_phase_makes_a_dip_as_long_as_the_transducers_take() -> None:
    g = focused(0.0)
    e, sampling = compute_envelope(np.array([g, -g]), 200.0, ARRAY, POINTS[:1], pc.Air())
    tau = np.sqrt(3.0) / (np.pi * 2000.0)
    t = np.arange(len(e) // 2) / sampling
    expected = (
        np.abs(pc.matrix(ARRAY, POINTS[:1], pc.Air()) @ g) ** 2
        * (2.0 * np.exp(-t / tau) - 1.0) ** 2
    )
    np.testing.assert_allclose(e[len(e) // 2 :, 0], expected, rtol=1e-9, atol=1e-9)


def test_at_the_edge_of_the_bandwidth_transducers_give_half() -> None:
    turning = np.exp(2j * np.pi * 1000.0 * np.arange(2000) / FS)[:, None] * focused(0.0)
    slow, _ = compute_envelope(turning, FS, ARRAY, POINTS[:1], pc.Air(), bandwidth=2000.0)
    quick, _ = compute_envelope(turning, FS, ARRAY, POINTS[:1], pc.Air(), bandwidth=None)
    assert np.sqrt(slow[-1] / quick[-1]) == pytest.approx(0.5, rel=0.02)


def test_jumps_of_the_global_phase_are_heard_and_alignment_silences_them() -> None:
    rng = np.random.default_rng(1)
    gains = np.array([focused(x) for x in 2e-4 * np.sin(np.arange(300) / 30.0)])
    gains *= np.exp(2j * np.pi * rng.random((300, 1)))
    smoother, rows = (
        GainSmoother(Smoothing(), len(ARRAY)),
        np.empty((300, len(ARRAY)), np.complex64),
    )
    smoother.follow(gains.astype(np.complex64), 1e-3, rows)
    ear = np.array([[0.0, -0.5, 0.1]])
    for points in (POINTS[:1], ear):
        jumping, aligned = (
            measure_audible(*compute_envelope(g, 1000.0, ARRAY, points, pc.Air()))[0]
            for g in (gains, rows[10:])
        )
        assert jumping > -15.0
        assert aligned < -50.0
        # |p|^2 does not depend on a global phase; the slow part is the transducers
        instant = measure_audible(
            *compute_envelope(gains, 1000.0, ARRAY, points, pc.Air(), bandwidth=None)
        )[0]
        assert instant < -40.0


@pytest.mark.parametrize(
    ("argument", "change"),
    [
        ("gains", {"gains": np.ones((3, 4))}),
        ("gains", {"gains": np.full((3, len(ARRAY)), np.nan)}),
        ("rate", {"rate": 0.0}),
        ("points", {"points": [[0.0, 0.0]]}),
        ("points", {"points": np.zeros((2, 1, 3))}),
        ("bandwidth", {"bandwidth": -1.0}),
    ],
)
def test_bad_arguments_are_refused_by_name(argument: str, change: dict[str, Any]) -> None:
    good = {"gains": np.ones((3, len(ARRAY))), "rate": 1000.0, "points": POINTS}
    with pytest.raises(pc.ArgumentError, match=f"^`{argument}` "):
        compute_envelope(array=ARRAY, medium=pc.Air(), **(good | change))
