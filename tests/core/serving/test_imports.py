"""The modules that each process of the server imports before clients can connect."""

from __future__ import annotations

import subprocess
import sys

import pytest

NOWHERE = {
    "PIL", "asyncio", "click", "html", "igl", "pygments", "rich", "scipy", "ssl", "structlog", "trimesh"
}  # fmt: skip
OPENSSL = {"hashlib", "secrets"}
SOLVES = {"pacinian.session", "pacinian.solving", "pacinian_plugins.native"}
RENDERS = {"pacinian.rendering.renderer", "pacinian.scene.sampling.sampler"}
SCENES = {"pacinian.scene.hands", "pacinian.scene.objects", "pacinian.scene.scene"}
GUARD = """
from pacinian.serving.guard import process
from pacinian.serving.ipc.plugin_list import find_plugin, list_offers
find_plugin("backend", "simulated")
list_offers("backend")
"""
BUS = """
from pacinian.serving.bus import process
from pacinian.serving.settings import Settings
settings = Settings()
process.warm_up(settings.array.make(), settings.medium.make())
"""
RENDER = """
from pacinian.plugins.backend import Capability
from pacinian.serving.ipc.plugin_list import list_offers
from pacinian.serving.render import process
from pacinian.serving.settings import Settings
settings = Settings()
solver = process.make_solver(settings.solver)
process.warm_up(settings.array.make(), settings.medium.make(), solver, Capability(rate=1e3), 1e3)
list_offers("solver")
"""
FORBIDDEN = {
    "control": (
        "import pacinian.serving.server",
        NOWHERE | SOLVES | RENDERS | SCENES | {"prometheus_client"},
    ),
    "guard": (GUARD, NOWHERE | OPENSSL | SOLVES | RENDERS | SCENES | {"pacinian.native", "zmq"}),
    "bus": (BUS, NOWHERE | OPENSSL | SOLVES | RENDERS | {"pacinian_plugins"}),
    "render": (RENDER, NOWHERE | {"zmq"}),
}
ALONE = {"scipy.linalg._fblas", "scipy.linalg._flapack"}  # pacinian.solving.linalg


@pytest.mark.parametrize("process", FORBIDDEN)
def test_a_process_loads_only_what_it_needs(process: str) -> None:
    code, forbidden = FORBIDDEN[process]
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\nimport sys\nprint(*sys.modules)"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    loaded = set(done.stdout.split()) - ALONE
    wrong = {
        name for name in loaded for root in forbidden if name == root or name.startswith(f"{root}.")
    }
    assert not wrong
