from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.rendering.smoothing import GainSmoother, Smoothing

seeds = st.integers(0, 2**32 - 1)
N, DT = 37, 0.5e-3
FREE = Smoothing(rate=None)


def drawn(seed: int, *shape: int, top: float = 1.0) -> Any:
    """Draw gains within a disc of radius `top`."""
    rng = np.random.default_rng(seed)
    size = top * np.sqrt(rng.random(shape))
    return (size * np.exp(2j * np.pi * rng.random(shape))).astype(np.complex64)


def at(gains: Any, how: Smoothing = FREE) -> GainSmoother:
    """Return a limiter whose last output is `gains`, (N,)."""
    smoother = GainSmoother(FREE, len(gains))
    smoother.follow(gains[None], DT, np.empty((1, len(gains)), np.complex64))
    smoother.settings = how
    return smoother


def followed(smoother: GainSmoother, gains: Any, rows: int = 1) -> Any:
    out = np.empty((rows, gains.shape[-1]), np.complex64)
    smoother.follow(np.ascontiguousarray(gains).reshape(-1, gains.shape[-1]), DT, out)
    return out


def reference(
    last: Any, g: Any, how: Smoothing, seconds: float, loudest: float
) -> tuple[Any, float, bool]:
    """Return the row from `last` (N,) towards g (N,) in double precision, its allowed error, and whether it reaches g.

    A gain is 2**-21 short, on purpose, and rounded. If an inner product nearly cancels, its angle is uncertain.
    """
    inner = np.vdot(g, last)
    turned = how.align and abs(inner) > 0.0
    target = g * inner / abs(inner) if turned else g
    most = np.abs(target - last).max()
    part = 1.0 if how.rate is None or not most else min(1.0, loudest * how.rate * seconds / most)
    lost = np.abs(g) @ np.abs(last) / abs(inner) if turned else 0.0
    return last + part * (target - last), 2.0**-21 + 16.0 * 2.0**-24 * (1.0 + lost), part >= 1.0


@given(seed=seeds, rate=st.one_of(st.none(), st.floats(1.0, 5000.0)), align=st.booleans())
def test_rows_are_the_definitions(seed: int, rate: float | None, align: bool) -> None:
    before, gains = drawn(seed, N), drawn(seed + 1, 5, N)
    how = Smoothing(rate=rate, align=align)
    smoother = at(before, how)
    before = smoother.gains.copy()
    out = np.empty((5, N), np.complex64)
    smoother.follow(gains, DT, out)
    loudest, reached = 0.0, True
    for g, row in zip(gains, out, strict=True):
        kept = max(0.0, 1.0 - (rate or 0.0) * DT / 16.0) if reached else 1.0
        loudest = max(kept * loudest, np.abs(g).max(), np.abs(before).max())
        asked, last = g.astype(complex), before.astype(complex)
        expected, near, reached = reference(last, asked, how, DT, loudest)
        np.testing.assert_allclose(row, expected, rtol=0.0, atol=near)
        before = row
    np.testing.assert_array_equal(smoother.gains, out[-1])


@given(seed=seeds, turn=st.floats(0.0, 2.0 * math.pi))
def test_a_turn_of_all_phases_is_no_change(seed: int, turn: float) -> None:
    gains = drawn(seed, N)
    smoother = at(gains, Smoothing())
    out = followed(smoother, (gains * np.exp(1j * turn)).astype(np.complex64))
    np.testing.assert_allclose(out[0], gains, atol=2e-6)
    assert smoother.settled


@given(seed=seeds)
def test_no_turn_of_the_gains_is_nearer_to_the_row_before(seed: int) -> None:
    last, gains = drawn(seed, N), drawn(seed + 1, N)
    out = followed(at(last), gains)[0]
    turns = np.exp(2j * np.pi * np.linspace(0.0, 1.0, 99))[:, None]
    nearest = np.linalg.norm(turns * gains - last, axis=1).min()
    assert np.linalg.norm(out - last) <= nearest * (1.0 + 1e-6)


@given(seed=seeds, top=st.floats(1e-3, 30.0), rate=st.floats(1.0, 5000.0), align=st.booleans())
def test_no_ceiling_is_exceeded_and_no_gain_is_too_fast_for_how_loud_it_is(
    seed: int, top: float, rate: float, align: bool
) -> None:
    last, gains = drawn(seed, N, top=top), drawn(seed + 1, 4, N)
    smoother = at(last, Smoothing(rate=rate, align=align))
    out = followed(smoother, gains, rows=4)
    before = np.vstack([at(last).gains[None], out[:-1]])
    size = np.abs(out.astype(complex))
    most = np.maximum(np.abs(before.astype(complex)), np.abs(gains.astype(complex)))
    assert (size <= most).all()
    assert np.abs(out - before).max() <= most.max() * (rate * DT + 3e-6)


@given(seed=seeds)
def test_convex_limits_that_both_ends_keep_are_kept_on_the_way(seed: int) -> None:
    last, gains, B = drawn(seed, N), drawn(seed + 1, N), drawn(seed + 2, 6, N).astype(complex)
    smoother = at(last, Smoothing(rate=100.0))
    for row in followed(smoother, gains, rows=50).astype(complex):
        power = max(np.linalg.norm(last), np.linalg.norm(gains))
        assert np.linalg.norm(row) <= power * (1.0 + 1e-6)
        quiet = np.maximum(np.abs(B @ last), np.abs(B @ gains))
        assert (np.abs(B @ row) <= quiet + 1e-5).all()


@given(seed=seeds, rate=st.floats(50.0, 2000.0))
def test_the_output_goes_straight_and_settles_when_the_rate_allows(seed: int, rate: float) -> None:
    last, gains = drawn(seed, N), drawn(seed + 1, N)
    distance = np.abs(followed(at(last), gains)[0] - at(last).gains).max()
    loudest = max(np.abs(last).max(), np.abs(gains).max())
    needed = distance / (loudest * rate * DT)
    smoother, settled = at(last, Smoothing(rate=rate)), False
    rows = 0
    while not settled and rows < 100:
        followed(smoother, gains)
        settled, rows = smoother.settled, rows + 1
    assert needed - 0.01 <= rows <= needed + 1.01


def test_sound_ramps_up_from_silence_in_phase() -> None:
    gains = np.exp(1j * np.arange(N)).astype(np.complex64)
    smoother = GainSmoother(Smoothing(rate=200.0), N)
    rows = followed(smoother, gains, rows=12)
    ramp = np.minimum(0.1 * np.arange(1, 13), 1.0)
    np.testing.assert_allclose(rows, ramp[:, None] * gains, atol=1e-5)
    smoother.reset()
    assert not smoother.settled
    assert not smoother.gains.any()
    np.testing.assert_allclose(followed(smoother, gains)[0], 0.1 * gains, atol=2e-6)


@given(seed=seeds, quieter=st.floats(1e-4, 1.0), rate=st.floats(50.0, 2000.0))
def test_what_is_weak_comes_and_goes_in_the_same_time_and_shape(
    seed: int, quieter: float, rate: float
) -> None:
    gains, silence = drawn(seed, N), np.zeros(N, np.complex64)
    weak = np.float32(quieter) * gains
    rows = []
    for g in (gains, weak):
        smoother = GainSmoother(Smoothing(rate=rate), N)
        rows.append(np.vstack([followed(smoother, to, rows=45) for to in (g, silence)]))
    np.testing.assert_allclose(rows[1], quieter * rows[0], rtol=1e-4, atol=1e-5 * quieter)
    assert not rows[0][-1].any()


@given(seed=seeds, span=st.integers(1, 30), rows=st.integers(1, 7))
def test_a_change_is_spread_evenly_over_its_rows(seed: int, span: int, rows: int) -> None:
    last = drawn(seed, N)
    gains = (np.float32(0.5) * last).astype(np.complex64)
    smoother, made = at(last, Smoothing(rate=1e6)), [last[None]]
    for done in range(0, span, rows):
        out = np.empty((rows, N), np.complex64)
        smoother.follow(gains[None], DT, out, span - done)
        made.append(out)
    expected = 1.0 - 0.5 * np.minimum(np.arange(sum(map(len, made))) / span, 1.0)
    np.testing.assert_allclose(np.vstack(made), expected[:, None] * last, atol=1e-5)
    assert smoother.settled


def test_a_sound_that_is_going_to_be_loud_may_come_faster() -> None:
    for growth, share in ((1.0, 0.1), (3.0, 0.3)):
        smoother, out = GainSmoother(Smoothing(rate=200.0), N), np.empty((1, N), np.complex64)
        smoother.follow(drawn(3, 1, N), DT, out, 1, growth)
        np.testing.assert_allclose(
            np.abs(out[0]), share * np.abs(drawn(3, N)), rtol=0.05, atol=0.05
        )


def test_after_a_rest_a_loud_sound_before_does_not_count() -> None:
    smoother, weak = (
        at(drawn(4, N), Smoothing(rate=200.0)),
        (0.01 * drawn(5, N)).astype(np.complex64),
    )
    followed(smoother, np.zeros(N, np.complex64), rows=20)
    smoother.rest()
    most = np.abs(weak).max()
    assert np.abs(followed(smoother, weak)).max() == pytest.approx(0.1 * most, rel=1e-4)


def test_silence_follows_silence() -> None:
    smoother = GainSmoother(Smoothing(), N)
    assert not followed(smoother, np.zeros(N, np.complex64), rows=2).any()
    assert smoother.settled


def test_sound_fades_to_silence() -> None:
    smoother = at(drawn(1, N), Smoothing(rate=100.0))
    rows = np.abs(followed(smoother, np.zeros(N, np.complex64), rows=25))
    assert (np.diff(rows, axis=0) <= 0.0).all()
    assert not rows[-1].any()


@pytest.mark.parametrize("scale", [1e-25, 1e-12, 1.0, 1e6])
def test_gains_of_any_size_are_finite(scale: float) -> None:
    gains = (scale * drawn(2, 4, N)).astype(np.complex64)
    out = followed(at(gains[0], Smoothing()), gains, rows=4)
    assert np.isfinite(out).all()


def test_what_is_not_a_number_is_silent_and_leaves_no_trace() -> None:
    good = drawn(5, N)
    bad = good.copy()
    bad[3], bad[7] = np.nan, complex(0.0, np.inf)
    smoother = at(good)
    out = followed(smoother, bad)[0]
    assert np.isfinite(out).all()
    assert out[3] == out[7] == 0.0
    np.testing.assert_allclose(np.abs(followed(smoother, good)[0]), np.abs(good), atol=2e-6)


def test_rows_at_once_are_rows_one_by_one_bit_for_bit() -> None:
    gains, at_once, one_by_one = drawn(6, 20, N), at(drawn(7, N)), at(drawn(7, N))
    at_once.settings = one_by_one.settings = Smoothing()
    rows = followed(at_once, gains, rows=20)
    single = np.vstack([followed(one_by_one, g) for g in gains])
    assert rows.tobytes() == single.tobytes()
    assert at_once.settled == one_by_one.settled


def test_one_row_of_gains_stands_for_all() -> None:
    gains = drawn(8, 1, N)
    a, b = (at(drawn(9, N), Smoothing()) for _ in range(2))
    repeated = np.repeat(gains, 3, axis=0)
    assert followed(a, gains, rows=3).tobytes() == followed(b, repeated, rows=3).tobytes()


@pytest.mark.parametrize("units", [1, 3])
def test_a_focus_at_1_m_s_is_followed_without_lag_and_one_at_4_m_s_is_not(units: int) -> None:
    array = pc.autd(units, units)
    k = pc.Air().wavenumber(array.transducer.frequency)
    for speed, followed_at_once in ((1.0, True), (4.0, False)):
        smoother, settled = None, True
        for x in speed * DT * np.arange(50):
            away = np.linalg.norm(array.positions - [x, 0.0, 0.2], axis=1)
            gains = np.exp(1j * k * away).astype(np.complex64)
            smoother = smoother or at(gains, Smoothing())
            followed(smoother, gains)
            settled &= smoother.settled
        assert settled == followed_at_once


def test_a_vibration_of_200_hz_in_the_solved_gains_passes() -> None:
    full = np.exp(1j * np.arange(N)).astype(np.complex64)
    smoother = at(full, Smoothing())
    for t in DT * np.arange(5, 200):
        gains = (abs(math.sin(math.pi * 200.0 * t)) * full).astype(np.complex64)
        np.testing.assert_allclose(np.abs(followed(smoother, gains)[0]), np.abs(gains), atol=2e-6)


@pytest.mark.parametrize("bad", [0.0, -1.0, 1e10, math.nan, math.inf, "fast"])
def test_a_bad_rate_is_refused_by_name(bad: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=r"^`rate` "):
        Smoothing(rate=bad)


def test_other_bad_arguments_are_refused_by_name() -> None:
    with pytest.raises(pc.ArgumentError, match=r"^`align` "):
        Smoothing(align="yes")
    with pytest.raises(pc.ArgumentError, match=r"^`columns` "):
        GainSmoother(Smoothing(), 0)
    with pytest.raises(pc.ArgumentError, match=r"^`settings` "):
        GainSmoother(750.0, N)
    smoother = GainSmoother(Smoothing(), N)
    for gains, out in (((1, N + 1), (1, N)), ((3, N), (2, N)), ((1, 5), (1, 5)), ((1, N), (0, N))):
        with pytest.raises(pc.ArgumentError, match=r"^`gains` "):
            smoother.follow(np.zeros(gains, np.complex64), DT, np.zeros(out, np.complex64))
