"""Without the extra `plot`, all that draws raises MissingExtra, and commands end with its text."""

import json
import subprocess
import sys
from pathlib import Path

BLOCK = """
import sys


class Block:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("matplotlib", "pyevtk"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


sys.meta_path.insert(0, Block())
"""
FUNCTIONS = """
import numpy as np
import pacinian as pc
from pacinian import plot
from pacinian.testing import ManualClock
from pacinian.plot.boards import boards

array, air, q = pc.lattice(0.05, 0.05), pc.Air(), np.array([[0.01, 0.0, 0.1]])
gains = np.ones(len(array))
point = pc.Scene((pc.Point(position=(0.0, 0.0, 0.1), radiation_pressure=0.5),))
run = pc.Renderer(array, point, clock=ManualClock())
run.run(0.02)
device = pc.DeviceDescription.load("device.toml")
calls = {
    "animate": lambda: plot.animate(run, "new.gif", duration=0.01),
    "boards": lambda: boards(device),
    "convergence": lambda: plot.convergence(array, q, [1.0], ["gs"], medium=air),
    "drive": lambda: plot.drive(array, gains),
    "export": lambda: plot.export("new.glb", array, gains=gains, medium=air),
    "export, vti": lambda: plot.export("new.vti", array, gains=gains, medium=air),
    "field": lambda: plot.field(array, gains, medium=air),
    "figure": plot.figure,
    "pareto": lambda: plot.pareto(sys.argv[1]),
    "save": lambda: plot.save(None, "new.png"),
    "scene": lambda: plot.scene(array, point, run.samples, gains, medium=air),
    "slices": lambda: plot.slices(array, gains, q, air),
    "spectrogram": lambda: plot.spectrogram(run, q[0], duration=0.01),
    "timeline": lambda: plot.timeline(pc.Report()),
    "waveform": lambda: plot.waveform(run, q[0], duration=0.01),
    "Solution.plot": lambda: pc.solve(array, q, [1.0], medium=air).plot(),
}
assert {name.partition(",")[0] for name in calls} >= set(plot.__all__)
for name, call in calls.items():
    try:
        call()
    except pc.MissingExtra as error:
        assert error.extra == "plot", name
    else:
        raise AssertionError(f"{name} needs no Matplotlib")
"""
COMMANDS = """
import io, json
from contextlib import redirect_stderr, redirect_stdout
from pacinian.cli.main import main

told = []
for words in json.loads(sys.argv[1]):
    sys.argv[1:] = words
    with redirect_stdout(io.StringIO()) as out, redirect_stderr(io.StringIO()) as errors:
        try:
            main()
        except SystemExit as end:
            told.append((end.code, out.getvalue(), errors.getvalue()))
print(json.dumps(told))
"""
WORDS = [
    ["devices", "draw", "device.toml"],
    ["render", "scene.toml", "--seconds", "100", "--out", "scene.png"],
    ["bench", "regions", "--pictures", "pictures"],
    ["bench", "scenes", "--pictures", "pictures"],
    ["soak", "--picture", "soak.png"],
    ["paper"],
]
CELL = (
    '{"cells": [{"p50": 1.0, "error": 0.1, "scale": 1.0, "level": 1.0, "N": 249, "M": 4, '
    '"family": "gs", "solver": "gs", "mode": "cold", "note": ""}]}'
)
DEVICE = '[[boards]]\nserial = "A7"\nlayout = { type = "grid", columns = 2, rows = 2 }\n'
SCENE = """
array = { type = "lattice", width = 0.05, height = 0.05 }

[[objects]]
type = "point"
position = [0.0, 0.0, 0.1]
radiation_pressure = 0.5
"""


def start(code: str, *words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", BLOCK + code, *words]
    return subprocess.run(
        command, cwd=folder, capture_output=True, text=True, timeout=300, check=False
    )


def test_every_function_that_draws_raises_missing_extra(tmp_path: Path) -> None:
    (tmp_path / "bench.json").write_text(CELL)
    (tmp_path / "device.toml").write_text(DEVICE)
    done = start(FUNCTIONS, "bench.json", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert not list(tmp_path.glob("new.*"))


def test_commands_that_must_draw_end_before_they_run(tmp_path: Path) -> None:
    """One process runs all of them, one after the other, because most of the time is for its start."""
    (tmp_path / "device.toml").write_text(DEVICE)
    (tmp_path / "scene.toml").write_text(SCENE)
    done = start(COMMANDS, json.dumps(WORDS), folder=tmp_path)
    assert done.returncode == 0, done.stderr
    for words, (code, out, errors) in zip(WORDS, json.loads(done.stdout), strict=True):
        assert code == 2, (words, out, errors)
        assert errors.startswith("error: matplotlib is not installed: "), words
        assert "[plot]" in errors, words
        assert not out, words
