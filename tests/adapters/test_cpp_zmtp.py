"""ZMTP in C++ under sanitizers: byte vectors, and all tests of the C# one."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING

import pytest

from ..waiting import PATIENCE
from . import test_csharp_zmtp, tools
from .game import Game
from .mutations import WIRE
from .test_csharp_zmtp import bind

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    Start = Callable[..., Game]

pytestmark = pytest.mark.deep("cmake", "ninja", "g++", "pkg-config")

__all__ = ["bind"]  # a fixture

PURE = "zmtp_vectors", "zmtp_limits", "zmtp_standstill"
FUZZED = 1000  # conversations for each seed

# below, another fuzzer replaces that of C#
globals().update(
    {
        name: test
        for name, test in vars(test_csharp_zmtp).items()
        if name.startswith("test_") and inspect.isfunction(test)
    }
)


@pytest.fixture(scope="module")
def programs() -> Path:
    """Return the folder of the programs, which abort at invalid addresses and undefined behaviour."""
    targets = [*PURE, "zmtp_fuzz", "zmtp_answers"]
    return tools.cmake("sanitized", targets, "-DPACINIAN_SANITIZE=ON", *tools.JOINED)


@pytest.fixture
def start(programs: Path) -> Start:
    def started(
        kind: str, address: str, token: str = "", ping: float = 0.0, timeout: float = PATIENCE, *,
        again: bool = False, handshake: float = PATIENCE,
    ) -> Game:  # fmt: skip
        often = "again" if again else "once"
        words = [kind, address, token, str(ping), str(timeout), str(handshake), often]
        return Game([programs / "zmtp_answers", *words])

    return started


@pytest.fixture
def watchers() -> int:
    """Return 0: the thread that owns a socket waits for its bytes."""
    return 0


@pytest.mark.parametrize("name", PURE)
def test_a_program_that_tests_itself(programs: Path, name: str) -> None:
    tools.run(programs / name, WIRE)


@pytest.mark.parametrize("seed", range(2))
def test_whatever_a_peer_sends(programs: Path, seed: int) -> None:
    said = tools.run(programs / "zmtp_fuzz", str(seed), str(FUZZED)).splitlines()
    assert said[-1] == f"{FUZZED} conversations"
    assert {"gone after messages", "foreign in the handshake", "foreign after messages"} <= {
        line.partition(" ")[2] for line in said
    }
