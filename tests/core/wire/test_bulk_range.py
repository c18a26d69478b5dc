from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pacinian.wire import binary_arrays
from pacinian.wire.commands import Field, HandFrame, Move
from pacinian.wire.modulation import Wave
from pacinian.wire.objects import Particles, Texture
from pacinian.wire.replies import Shown
from pacinian.wire.shapes import HeightMap, Mesh, Polyline, Voxels

if TYPE_CHECKING:
    from collections.abc import Callable

numbers = st.floats(-11.0, 11.0, width=32) | st.just(float("nan")) | st.just(float("inf"))


@settings(max_examples=200)
@given(st.lists(numbers, min_size=7, max_size=7), st.integers(1, 5))
def test_few_numbers_and_many_are_checked_alike(pose: list[float], count: int) -> None:
    """A few numbers are checked one by one, many together."""
    poses = binary_arrays.pack([pose] * count)
    names = tuple("abcde"[:count])
    x = np.array(pose)
    if ((x >= -10.0) & (x <= 10.0)).all():
        assert (
            Move(session=b"k" * 16, sequence=1, time=0.0, names=names, poses=poses).poses == poses
        )
    else:
        with pytest.raises(ValueError, match="from -10 to 10"):
            Move(session=b"k" * 16, sequence=1, time=0.0, names=names, poses=poses)


HEAD: dict[str, Any] = {"session": b"k" * 16, "sequence": 1, "time": 0.0}
SHOWN: dict[str, Any] = {"scene": "a", "version": 1, "names": ("a",) * 3, "objects": {}}
STILL = binary_arrays.pack(np.zeros((3, 7)))
FACE = binary_arrays.pack_indices([0, 1, 2])
# owner of the numbers, their count, the numbers [m, m/s, rad/s, 0..1 or as scaled], and their range
BOUNDED: dict[str, tuple[Callable[[bytes], object], int, float, float]] = {
    "poses": (lambda x: Move(**HEAD, names=("a",) * 3, poses=x), 21, -10.0, 10.0),
    "velocities": (
        lambda x: Move(**HEAD, names=("a",) * 3, poses=STILL, velocities=x), 18, -100.0, 100.0,
    ),
    "points": (lambda x: Field(**HEAD, points=x), 12, -10.0, 10.0),
    "positions": (lambda x: Particles(positions=x), 24, -10.0, 10.0),
    "a polyline's points": (Polyline, 6, -10.0, 10.0),
    "samples": (lambda x: Wave(samples=x, rate=1e3), 30, -10.0, 10.0),
    "poses shown": (lambda x: Shown(**SHOWN, poses=x), 21, -10.0, 10.0),
    "vertices": (lambda x: Mesh(vertices=x, faces=FACE), 9, -1e6, 1e6),
    "heights": (
        lambda x: HeightMap(heights=x, grid=(3, 5), width=0.1, height=0.1), 15, -1e6, 1e6,
    ),
    "a texture's values": (
        lambda x: Texture(values=x, grid=(3, 5), size=(0.1, 0.1)), 15, 0.0, 1.0,
    ),
    "voxels": (lambda x: Voxels(values=x, grid=(2, 2, 3), pitch=0.01), 12, 0.0, 1.0),
}  # fmt: skip


@pytest.mark.parametrize("what", BOUNDED)
def test_bulk_numbers_may_be_all_that_the_bounds_hold_and_nothing_beyond(what: str) -> None:
    make, count, low, high = BOUNDED[what]
    inside = np.linspace(low, high, count, dtype=np.float32)
    assert (inside[0], inside[-1]) == (low, high)
    make(binary_arrays.pack(inside))
    for end, beyond in ((low, -math.inf), (high, math.inf)):
        for place in (0, count // 2, count - 1):
            outside = inside.copy()
            outside[place] = np.nextafter(np.float32(end), np.float32(beyond))
            with pytest.raises(ValueError, match="must be from"):
                make(binary_arrays.pack(outside))


@pytest.mark.parametrize(
    ("name", "width", "counts"),
    [("joints", 3, {26}), ("radii", 1, {26}), ("velocities", 3, {1, 26})],
)
def test_a_hand_has_a_row_for_each_joint_or_none_or_one_velocity_for_all(
    name: str, width: int, counts: set[int]
) -> None:
    for count in range(30):
        given: dict[str, Any] = {name: binary_arrays.pack(np.full((count, width), np.nan))}
        if count in counts | {0}:  # NaN is a lost hand
            assert getattr(HandFrame(**given), name) == given[name]
        else:
            with pytest.raises(ValueError, match=f"`{name}` must be 26 rows of {width} float32"):
                HandFrame(**given)
