"""Each fault once, on real processes: silent within the stated bound and some slack, and well again.

How long it really takes is measured by `pacinian bench faults`; here the machine may be busy with other things.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from pacinian.bench.faults import parts
from pacinian.bench.faults.run import FAULTS, STALE, Fault

if TYPE_CHECKING:
    from pacinian.bench.faults.stage import Stage

TIMES, SLACK = 3.0, 1.0  # of a bound; [s]
LONG = 60.0  # [s]
LATER = (  # other tests show the same, here, in tests/core/serving or test_client.py; and these take long
    "state is never read",
    "thousands of topics",
    "solver never returns",
    "renderer killed -9",
    "renderer stopped",
    "guard stopped",
    "control killed -9",
    "server killed and restarted",
    "SIGTERM of the server",
)
WRONG = "stale", "heard", "lives", "left: ", "replaced"  # what a note must not tell


@pytest.fixture(scope="module")
def settings() -> str:
    """The usual lease: it is what bounds some faults."""
    return ""


@pytest.mark.parametrize(
    "fault", [f for f in FAULTS if f.name not in LATER], ids=lambda fault: fault.name
)
def test_silence_and_recovery(stage: Stage, fault: Fault) -> None:
    times = fault.do(stage)
    bound = LONG if math.isnan(fault.bound) else TIMES * fault.bound + SLACK
    for seconds in (times.silence, times.gap):
        assert math.isnan(seconds) or 0.0 <= seconds < bound
    assert not any(word in times.note for word in WRONG if not times.note.startswith("nothing"))
    stage.sounding()


def test_a_killed_renderer_is_replaced_and_the_game_is_told(stage: Stage) -> None:
    times = parts.render_killed(stage)
    assert 0.0 <= times.silence < TIMES * STALE + SLACK
    assert 0.0 < times.recovery < LONG
    assert times.note == "told: fault"
    assert stage.onlooker.ask("status")["restarts"]["render"] > 0
