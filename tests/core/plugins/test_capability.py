"""The capability that a device reports."""

from __future__ import annotations

import dataclasses
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc

PULSES = np.sin(np.pi / 2.0 * np.arange(65) / 64.0)  # amplitudes of OpenMPD


@given(st.integers(2, 1 << 16))
def test_a_count_is_of_evenly_spaced_levels(count: int) -> None:
    can = pc.Capability(16, count)
    assert can.uniform
    assert can.amplitudes == count
    np.testing.assert_array_equal(can.sizes, np.linspace(0.0, 1.0, count).astype(np.float32))


@pytest.mark.parametrize("kind", [tuple, list, np.array])
def test_a_table_is_kept_in_single_precision_and_cannot_be_changed(kind: Any) -> None:
    can, again = pc.Capability(128, kind(PULSES.tolist())), pc.Capability(128, tuple(PULSES))
    assert not can.uniform
    np.testing.assert_array_equal(can.sizes, PULSES.astype(np.float32))
    assert can == again
    assert hash(can) == hash(again)
    assert can != pc.Capability(128, 65)
    assert can == pc.Capability(128, tuple(can.sizes.tolist()))
    assert dataclasses.replace(can, watchdog=0.1).amplitudes == can.amplitudes
    assert str(can) == "128 phases, 65 uneven amplitudes, 1000 Hz"
    with pytest.raises(ValueError, match="read-only"):
        can.sizes[0] = 1.0


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ((), "2 to 65536 levels, not 0"),
        ((0.0,), "2 to 65536 levels, not 1"),
        (np.linspace(0.0, 1.0, (1 << 16) + 1), "2 to 65536 levels, not 65537"),
        ((0.0, 0.5, 0.5, 1.0), "ascend: level 1 is 0.5, the next 0.5"),
        ((0.0, 0.5, 0.4, 1.0), "ascend: level 1 is 0.5, the next 0.4"),
        ((0.0, 1e-9, 1.0), "ascend: level 0"),
        ((0.0, 1.0 - 1e-9, 1.0), "ascend: level 1"),
        ((1.0, 0.0), "ascend"),
        ((0.1, 1.0), "from 0, silence, to 1, full drive, not 0.1"),
        ((0.0, 0.9), "from 0, silence, to 1, full drive, not 0 to 0.9"),
        ((0.0, np.nan, 1.0), "finite"),
        (((0.0, 1.0),), "shape"),
        (("a", "b"), "numbers"),
        ("65", "whole number"),
        (1, "whole number"),
        (65537, "at most 65536"),
    ],
)
def test_amplitudes_that_no_device_has_are_refused(table: Any, told: str) -> None:
    with pytest.raises(pc.ArgumentError, match=f"amplitudes.*{told}"):
        pc.Capability(128, table)


@pytest.mark.parametrize("amplitudes", [2, 65, 256, 4096, tuple(PULSES)])
def test_the_highest_level_is_the_last_within_the_limit(amplitudes: Any) -> None:
    can = pc.Capability(128, amplitudes)
    sizes = can.sizes.astype(float)
    assert [can.highest(size) for size in sizes] == list(range(len(sizes)))
    for gain in np.random.default_rng(0).uniform(0.0, 1.0, 200):
        level = can.highest(gain)
        assert sizes[level] <= gain + 1e-3
        assert level == np.flatnonzero(sizes <= gain)[-1] or sizes[level] - gain < 1e-5
    assert can.highest(0.0) == 0
    assert can.highest(1.0) == len(sizes) - 1


def test_a_frame_s_gains_are_of_the_table() -> None:
    level = np.arange(65, dtype=np.uint16)
    frame = pc.Frame(0, 0.0, (2 * level)[None] % 128, level[None])
    made = frame.gains(pc.Capability(128, tuple(PULSES)))[0]
    np.testing.assert_allclose(made, PULSES * np.exp(2j * np.pi * level / 64.0), atol=1e-6)
    with pytest.raises(IndexError):
        frame.gains(pc.Capability(128, 64))


@pytest.mark.parametrize("count", [int, float, np.int64, np.float64, np.uint16])
@pytest.mark.parametrize("real", [int, np.int64, np.float32, np.float64, np.uint16])
def test_numbers_of_any_type_are_stored_as_plain_ones(count: Any, real: Any) -> None:
    can = pc.Capability(count(16), count(32), real(2000), real(1))
    assert can == pc.Capability(16, 32, 2000.0, 1.0)
    assert [type(value) for value in dataclasses.astuple(can)] == [int, int, float, float]
    assert msgspec.msgpack.encode(dataclasses.astuple(can))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("rate", "x"),
        ("rate", None),
        ("rate", np.nan),
        ("rate", 0.5),
        ("rate", 1e7),
        ("watchdog", "x"),
        ("watchdog", -1.0),
        ("watchdog", 0.0),
        ("watchdog", np.float32(np.nan)),
        ("watchdog", np.inf),
        ("watchdog", 1j),
        ("phases", 16.5),
        ("phases", True),
    ],
)
def test_a_number_that_no_device_has_is_refused_by_its_name(name: str, value: Any) -> None:
    with pytest.raises(pc.ArgumentError, match=f"`{name}` must be") as raised:
        pc.Capability(**{name: value})
    assert raised.value.argument == name
