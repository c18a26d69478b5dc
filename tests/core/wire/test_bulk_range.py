from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pacinian.wire import bulk
from pacinian.wire.commands import Move

numbers = st.floats(-11.0, 11.0, width=32) | st.just(float("nan")) | st.just(float("inf"))


@settings(max_examples=200)
@given(st.lists(numbers, min_size=7, max_size=7), st.integers(1, 5))
def test_few_numbers_and_many_are_checked_alike(pose: list[float], count: int) -> None:
    """Few are looked at one by one, many all at once."""
    poses = bulk.pack([pose] * count)
    names = tuple("abcde"[:count])
    x = np.array(pose)
    if ((x >= -10.0) & (x <= 10.0)).all():
        assert (
            Move(session=b"k" * 16, sequence=1, time=0.0, names=names, poses=poses).poses == poses
        )
    else:
        with pytest.raises(ValueError, match="from -10 to 10"):
            Move(session=b"k" * 16, sequence=1, time=0.0, names=names, poses=poses)
