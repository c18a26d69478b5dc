"""What these tests need: the AUTD3 project's packages, and IPv6 on this machine."""

from __future__ import annotations

import os
import socket
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType


@pytest.fixture(autouse=True, scope="session")
def packages(need: Callable[..., ModuleType]) -> None:
    for name in ("autd3", "autd3_core", "autd3_emulator", "autd3_pattern"):
        need(name)


@pytest.fixture(scope="session")
def loopback() -> None:
    """The units' own software is reached at ::1."""
    try:
        with socket.socket(socket.AF_INET6, socket.SOCK_DGRAM) as one:
            one.bind(("::1", 0))
    except OSError as error:
        if os.environ.get("CI"):
            pytest.fail(f"CI must have IPv6 on the loopback interface: {error}")
        pytest.skip(f"no IPv6 on the loopback interface: {error}")
