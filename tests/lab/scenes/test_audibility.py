from __future__ import annotations

import numpy as np
import pytest

import pacinian as pc
from pacinian_lab.scenes import audibility as sounds


@pytest.mark.deep
def test_a_focus_that_stays_is_not_disturbed_and_the_room_is_quieter_with_ramps(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A quarter of a second has all five hops, and two blinks."""
    monkeypatch.setattr(sounds, "TICKS", sounds.WARM + 250)
    found = sounds.measure(pc.autd())
    assert [one.what for one in found] == list(sounds.CASES)
    for one in found:
        assert np.isfinite([*one.focus, *one.ear]).all()
        assert max(one.focus) < -60.0
    _, blinks, hops = found
    assert blinks.ear[2] < blinks.ear[0] - 0.5  # [dB]; of one unit its levels are heard, too
    assert hops.ear[2] < hops.ear[0] - 2.0
