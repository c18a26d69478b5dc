"""The emulator's own field of what we send is ours."""

from __future__ import annotations

import pytest

from .fields import GRIDS, POINTS, compared


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("points", POINTS)
def test_the_emulators_field_of_a_solution_is_ours(grid: str, points: str) -> None:
    it = compared(grid, points, "omni", resolution=4e-3)
    assert it.theirs.max() > 100.0  # [Pa]
    assert it.sent < 2e-5  # of the levels that were sent: single precision on both sides
    assert it.rounded < 6e-3  # and with what levels lose
    assert it.points < (1e-4 if points == "1 point" else 5e-3)


def test_with_our_directivity_it_differs_where_transducers_are_seen_from_the_side() -> None:
    narrow, wide = (compared(grid, "1 point", "T4010A1", resolution=8e-3) for grid in GRIDS)
    assert 5e-3 < narrow.points < 0.02  # the emulator's transducers are omnidirectional
    assert 0.3 < wide.points < 0.6
    assert narrow.at_points > narrow.asked
