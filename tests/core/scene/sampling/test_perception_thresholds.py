from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.scene.sampling.perception_thresholds import (
    FELT_MARGIN,
    MIN_THRESHOLD,
    THRESHOLDS,
    lowest_threshold,
    threshold,
)

frequencies = st.floats(0.0, 1e5)


def test_the_level_is_the_measured_force_on_the_measured_area() -> None:
    assert threshold(200.0) == pytest.approx(0.4e-3 / 1.8e-4, rel=0.02)  # Dalecki et al. 1995


def test_single_pulses_are_felt_at_ten_times_that_and_nothing_needs_more() -> None:
    assert max(threshold(f) for f in np.geomspace(0.1, 1e5, 500)) == pytest.approx(
        10.0 * MIN_THRESHOLD
    )


def test_the_rows_of_the_table_are_met() -> None:
    for frequency, pressure in THRESHOLDS:
        assert threshold(frequency) == pytest.approx(pressure)


@pytest.mark.parametrize(("f", "slope"), [(20.0, 0.0), (55.0, -12.0), (120.0, 0.0), (400.0, 9.0)])
def test_an_octave_changes_it_by_the_published_decibels(f: float, slope: float) -> None:
    octave = 20.0 * math.log10(threshold(math.sqrt(2.0) * f) / threshold(f / math.sqrt(2.0)))
    assert octave == pytest.approx(slope, abs=0.5)


@given(f=frequencies, kind=st.sampled_from([pc.Sine, pc.Square]))
def test_a_tenth_of_the_threshold_counts_as_felt(f: float, kind: Any) -> None:
    assert threshold(f) >= MIN_THRESHOLD * (1.0 - 1e-12)
    assert (
        MIN_THRESHOLD / FELT_MARGIN * 0.99
        < lowest_threshold(kind(f))
        < 1.01 * threshold(f) / FELT_MARGIN
    )


def test_a_bad_frequency_is_refused_by_name() -> None:
    with pytest.raises(pc.ArgumentError, match=r"^`frequency` "):
        threshold(-1.0)


def test_a_slow_vibration_needs_more_than_a_quick_one() -> None:
    assert (
        lowest_threshold(pc.Sine(20.0))
        > 2.0 * MIN_THRESHOLD / FELT_MARGIN
        > lowest_threshold(pc.Sine(200.0))
    )


@pytest.mark.parametrize(
    "envelope",
    [None, pc.Constant(), pc.Function(lambda t: t), pc.Sine(0.0), pc.Sine(1990.0), "buzzing"],
)
def test_all_others_count_where_the_skin_is_most_sensitive(envelope: Any) -> None:
    assert lowest_threshold(envelope) == MIN_THRESHOLD / FELT_MARGIN
