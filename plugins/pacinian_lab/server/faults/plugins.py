"""The devices and the solver as an installed distribution, in a folder for PYTHONPATH."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from pacinian_lab.server.faults.logging_device import FOLDER

if TYPE_CHECKING:
    from pathlib import Path

POINTS = """[pacinian]
probe = pacinian_lab.server.faults.logging_device
probe-other = pacinian_lab.server.faults.logging_device
probe-simulated = pacinian_lab.server.faults.logged_backends
probe-usb-autd = pacinian_lab.server.faults.logged_backends
stuck = pacinian_lab.server.faults.hanging_solver
"""


def install(folder: Path) -> dict[str, str]:
    """Write the distribution into `folder`. Returns the environment for processes that use it."""
    made = folder / "pacinian_faults-1.dist-info"
    made.mkdir()
    made.joinpath("METADATA").write_text(
        "Metadata-Version: 2.1\nName: pacinian-faults\nVersion: 1\n", encoding="utf-8"
    )
    made.joinpath("entry_points.txt").write_text(POINTS, encoding="utf-8")
    paths = [str(folder), *filter(None, [os.environ.get("PYTHONPATH")])]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(paths), FOLDER: str(folder)}
