"""Every row sounds as requested, and rows that the units can repeat by themselves are not sent."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.rendering.smoothing import Smoothing
from pacinian_plugins.backends.autd3.levels import INTENSITY, LEVELS, WIDTHS
from pacinian_plugins.backends.autd3.repeat_detector import RepeatDetector

from .emulated_backend import Emulated

if TYPE_CHECKING:
    from collections.abc import Sequence

KINDS = 6
CHANCE = np.random.default_rng(0)
PHASES = CHANCE.integers(0, 256, (KINDS, 249))
AMPLITUDES = CHANCE.integers(0, LEVELS, (KINDS, 249))
PERIODS = 40  # of the ultrasound in a tick of 1 ms


def played(it: Emulated, rows: Sequence[int | None], per_tick: int = 1) -> list[int]:
    """Send rows of these kinds, `per_tick` each millisecond, and check that they sound.

    A tick whose first row is None is left out. Returns the number of messages of each tick.
    """
    sent: list[int] = []
    begin, periods = it.clock.time, PERIODS // per_tick
    for first in range(0, len(rows), per_tick):
        these = [kind for kind in rows[first : first + per_tick] if kind is not None]
        if rows[first] is not None:
            sent.append(it.send(PHASES[these], AMPLITUDES[these]))
        it.clock.advance(1e-3)
    phases, widths = it.recorded(it.clock.time - begin)  # the last of which has just begun
    for k, kind in enumerate(rows):
        if kind is not None and rows[k - k % per_tick] is not None:
            at, sounds = periods * k + periods // 2 - 1, AMPLITUDES[kind] > 0
            np.testing.assert_array_equal(widths[:, at], WIDTHS[INTENSITY[AMPLITUDES[kind]]])
            np.testing.assert_array_equal(phases[sounds, at], (-PHASES[kind] % 256)[sounds])
    return sent


motifs = st.tuples(st.lists(st.integers(0, KINDS - 1), min_size=1, max_size=7), st.integers(1, 8))


@settings(max_examples=15)
@given(
    st.lists(motifs, min_size=1, max_size=3),
    st.sampled_from([1, 2, 4]),
    st.sets(st.integers(0, 60), max_size=8),
)
@example([([0, 1, 2, 1], 8), ([0, 1, 2, 3], 8)], 1, {9, 17})
@example([([0, 0, 1, 1], 12)], 2, set())
@example([([0, 1, 2], 12), ([4], 9), ([0, 1, 2], 12)], 4, set())
def test_every_row_sounds_however_rows_repeat(
    parts: list[tuple[list[int], int]], per_tick: int, left_out: set[int]
) -> None:
    rows: list[int | None] = [kind for motif, times in parts for kind in times * motif]
    rows += [0] * (-len(rows) % per_tick)
    for tick in left_out:
        rows[tick * per_tick : tick * per_tick + 1] = [None] * (tick * per_tick < len(rows))
    played(Emulated(rate=1000 * per_tick), rows, per_tick)


def test_a_row_that_sounds_is_not_sent_again() -> None:
    sent = played(Emulated(), [0] * 20 + [1] * 20)
    assert (sent[0], sent[20], sum(sent)) == (1, 1, 2)


def test_a_cycle_is_found_written_as_it_comes_by_and_then_played_by_the_units() -> None:
    it = Emulated()
    sent = played(it, [0, 1, 2, 3, 4] * 8)
    assert sent[:9] == [1] * 9  # seen twice
    assert sum(sent[9:14]) == 5 * 2 + 2  # each row once more, for the cycle, then: play it
    assert not any(sent[14:])
    before = it.line.messages
    played(it, [3, 3, 0, 1])  # the next row would have been 0
    assert it.line.messages - before == 3


def test_a_cycle_goes_on_where_frames_are_left_out() -> None:
    it = Emulated()
    played(it, [0, 1, 2, 3] * 6)
    it.clock.advance(7e-3)
    assert sum(played(it, [3, 0, 1, 2, 3])) == 0


def test_a_cycle_is_found_where_ticks_are_left_out() -> None:
    it, chance = Emulated(), np.random.default_rng(1)
    rows = [None if chance.random() < 0.2 else k % 5 for k in range(100)]
    assert not any(played(it, rows)[-40:])


def test_a_silence_forgets_the_cycle() -> None:
    it = Emulated()
    played(it, [0, 1, 2] * 8)
    it.backend.silence()
    assert not it.line.gains().any()
    assert played(it, [0, 1, 2] * 3) == [
        2,
        2,
        4,
        *[0] * 6,
    ]  # the cycle is still known, but the units no longer hold it


def test_rows_of_a_tick_are_spread_over_it_and_come_ahead_by_the_lead() -> None:
    it = Emulated(rate=4000, lead=0.002)
    it.clock.time = 0.01
    it.send(PHASES[:4], AMPLITUDES[:4])
    it.clock.advance(0.004)
    widths = it.recorded(0.004)[1]
    expected = [np.zeros(249, int)] * 79
    for kind, periods in ((0, 10), (1, 10), (2, 10), (3, 51)):
        expected += [WIDTHS[INTENSITY[AMPLITUDES[kind]]]] * periods
    np.testing.assert_array_equal(widths.T, expected)


def test_more_rows_than_the_units_have_room_for_are_refused() -> None:
    it = Emulated(rate=10_000)
    with pytest.raises(pc.BackendError, match="run the loop at 1667 Hz or more, or lower `rate`"):
        it.send(PHASES[[0] * 7], AMPLITUDES[[0] * 7])


def scene(**options: Any) -> pc.Scene:
    return pc.Scene((pc.Point(position=(0.0, 0.0, 0.2), radiation_pressure=20.0, **options),))


SCENES: dict[str, tuple[pc.Scene, Smoothing, int]] = {
    "steady": (scene(), Smoothing(), 10),
    "200 Hz": (scene(envelope=pc.Sine(200.0)), Smoothing(), 30),
    "round a circle, 100 Hz": (
        scene(technique=pc.STM(100.0, along=pc.Circle(0.015))),
        Smoothing(align=False),
        50,
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_what_the_loop_renders_again_and_again_is_soon_not_sent_any_more(name: str) -> None:
    shown, smoothing, most = SCENES[name]
    it = Emulated()
    renderer = pc.Renderer(
        it.array, shown, backend=it.backend, clock=it.clock, smoothing=smoothing, adaptive=False
    )
    with renderer:
        for _ in range(150):
            renderer.tick(it.clock.time)
            heard, meant = it.line.gains(), renderer.last_frame.gains(it.backend.capability)[-1]
            np.testing.assert_allclose(heard, meant, atol=1e-6)
            it.clock.advance(1e-3)
        assert 0 < it.line.messages <= most


# ------------------------------------------------------------------ the search alone


@given(st.lists(st.integers(0, 2), max_size=4), st.lists(st.integers(0, 2), max_size=12))
def test_the_shortest_period_is_found_that_was_just_seen_twice(
    before: list[int], motif: list[int]
) -> None:
    cycles, rows = RepeatDetector(8), before + motif * 3
    for index, digest in enumerate(rows):
        cycles.see(index, digest)
        seen = rows[: index + 1]
        periods = [
            p
            for p in range(2, 9)
            if len(seen) >= 2 * p
            and seen[-p:] == seen[-2 * p : -p]
            and len(set(seen[-p - 1 :])) > 1
        ]
        assert cycles.found() == (periods[0] if periods else 0)


@given(st.lists(st.integers(0, 1 << 40), min_size=1, max_size=60, unique=True))
def test_rows_that_never_come_again_are_no_cycle(rows: list[int]) -> None:
    cycles = RepeatDetector(32)
    for index, digest in enumerate(rows):
        cycles.see(index, digest)
        assert not cycles.found()


def test_a_longer_gap_than_a_cycle_ends_what_was_seen() -> None:
    cycles = RepeatDetector(8)
    for index in (0, 1, 2, 3):
        cycles.see(index, index % 2)
    assert cycles.found() == 2
    for index in (12, 13, 3, 4):
        cycles.see(index, index % 2)
        assert not cycles.found()
