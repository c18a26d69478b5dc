"""What the server loads before clients come."""

from __future__ import annotations

import subprocess
import sys

import pytest

import pacinian as pc
from pacinian.scene.config_sections import Units
from pacinian.serving.render.warmup import warm_up

ONCE_MORE = """
import sys
from pacinian.plugins.backend import Capability
from pacinian.scene.config_sections import Units
from pacinian.serving.render import warmup
from pacinian.serving.render.solver_switcher import make_solver
from pacinian.serving.settings import Settings

settings = Settings(array=Units({side}, {side}))
arguments = settings.array.make(), settings.medium.make(), make_solver("auto"), Capability(rate=1e3), 1e3
warmup.warm_up(*arguments)
before = set(sys.modules)
warmup.TICKS = {ticks}
warmup.warm_up(*arguments)
print(sorted(set(sys.modules) - before))
"""


@pytest.mark.parametrize(
    ("side", "ticks"), [(1, 10), (3, 100)]
)  # one unit needs more time for each
def test_later_ticks_load_nothing_more_whatever_the_array(side: int, ticks: int) -> None:
    code = ONCE_MORE.format(side=side, ticks=ticks)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "[]\n"), done.stderr


@pytest.mark.parametrize("rate", [20.0, 300.0, 1000.0])
def test_nothing_warns_of_objects_that_no_user_made(
    rate: float, caplog: pytest.LogCaptureFixture
) -> None:
    array, can = Units(1, 1).make(), pc.Capability(rate=rate)
    warm_up(array, pc.Air(), pc.solver("auto"), can, rate)
    assert not caplog.records
