"""Small studies that all tests of this folder share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

SMALL = """
levels = [0.5, inf]
solvers = ["auto", "gs-pat"]
picture = { side = 0.1, step = 0.005 }
[[layouts]]
type = "lattice"
width = [0.03, 0.05]
[[layouts]]
type = "random"
width = 0.06
count = 30
apart = 0.008
[[patterns]]
type = "focus"
[[patterns]]
type = "random"
count = 3
side = 0.06
[[planes]]
z = 0.1
"""


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str], Path]:
    """Writes a study file."""

    def made(text: str = SMALL, name: str = "study.toml") -> Path:
        path = tmp_path / name
        path.write_text(text)
        return path

    return made


def untimed(table: Any) -> str:
    """A table without what differs from run to run, so that NaN is equal to NaN."""
    from pacinian_lab.study.store import TIMES

    return repr(table.drop_columns(list(TIMES)).to_pylist())


@pytest.fixture(scope="session")
def same() -> Callable[[Any], str]:
    """What two tables must share, bit by bit."""
    return untimed
