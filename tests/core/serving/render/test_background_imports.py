"""Libraries that an object needs are imported before it is rendered, never in a tick."""

from __future__ import annotations

import subprocess
import sys

import pytest

RENDERED = """
import sys
import numpy as np
import pacinian as pc
from pacinian.plugins.backend import Capability
from pacinian.rendering.renderer import Renderer
from pacinian.rendering.rerender import CaptureBackend, FixedClock
from pacinian.scene.config_sections import Units
from pacinian.serving.render import warmup
from pacinian.serving.render.background_loader import load_object
from pacinian.serving.render.solver_switcher import make_solver

array, medium, solver = Units(1, 1).make(), pc.Air(), make_solver("auto")
warmup.warm_up(array, medium, solver, Capability(rate=1e3), 1e3)
pose = pc.Pose((0.09, 0.07, 0.15))
item = load_object({item})
hand = pc.Hand.open(pose=pc.Pose((0.09, 0.07, 0.16)), time=0.0)
before = set(sys.modules)
renderer = Renderer(
    array, pc.Scene((item,), hands=(hand,)), medium=medium, solver=solver,
    backend=CaptureBackend(Capability(rate=1e3)), clock=FixedClock(),
)
renderer.open()
for tick in range(20):
    renderer.tick(tick / 1e3)
print(sorted(set(sys.modules) - before))
"""
ITEMS = {
    "texture": "pc.Surface(shape=pc.Disc(0.04), pose=pose, radiation_pressure=5.0, texture=pc.grating(0.02))",
    "voxels": """pc.Volume(
        shape=pc.Voxels(values=np.pad(np.ones((6, 6, 6)), 1), pitch=0.005), pose=pose, radiation_pressure=5.0
    )""",
    "polyline": "pc.Path(shape=pc.Polyline(((0.0, 0.0, 0.0), (0.01, 0.0, 0.0))), pose=pose, radiation_pressure=5.0)",
}


@pytest.mark.parametrize("item", ITEMS)
def test_no_tick_loads_a_library(item: str) -> None:
    code = RENDERED.format(item=ITEMS[item])
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "[]\n"), done.stderr
