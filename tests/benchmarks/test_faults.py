"""Each fault once, on real processes: silent within the stated bound and some slack, and well again."""

from __future__ import annotations

import math

import pytest

from pacinian_lab.server.faults.run import FAULTS, Fault, measure

TIMES, SLACK = 3.0, 1.0  # of a bound; [s]
LONG = 60.0  # [s]
WRONG = "stale", "heard", "lives", "left: ", "replaced"  # what a note must not tell


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_silence_and_recovery(fault: Fault) -> None:
    [row] = measure([fault], repeats=1)
    assert not row.failed
    [times] = row.times
    bound = LONG if math.isnan(fault.bound) else TIMES * fault.bound + SLACK
    for seconds in (times.silence, times.gap):
        assert math.isnan(seconds) or 0.0 <= seconds < bound
    assert not any(word in times.note for word in WRONG if not times.note.startswith("nothing"))
