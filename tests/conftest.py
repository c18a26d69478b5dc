"""What all tests share."""

from __future__ import annotations

import importlib
import os
import signal
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import settings

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

ROOT = Path(__file__).parent
PLAIN = (
    *(ROOT / "core").glob("test_*.py"),
    *(
        ROOT / "core" / name
        for name in (
            "acoustics", "devices", "paper", "plot", "plugins", "rendering", "scene", "solving", "stress", "wire",
        )
    ),
    ROOT / "plugins",
    ROOT / "wire",
)  # fmt: skip

if (
    signal.getsignal(signal.SIGINT) is signal.SIG_IGN
):  # run in the background: programs that we start would ignore it, too
    signal.signal(signal.SIGINT, signal.default_int_handler)

settings.register_profile("fixed", derandomize=True, deadline=None)
settings.register_profile(
    "random", deadline=None, max_examples=1000, database=None, print_blob=True
)
settings.load_profile("fixed")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark those that need no servers, devices or browsers: they may run beside each other."""
    for item in items:
        if any(item.path.is_relative_to(place) for place in PLAIN):
            item.add_marker("plain")


@pytest.fixture(scope="session")
def need() -> Callable[..., ModuleType]:
    """Import an optional library: absent, it skips the test, but fails it where CI is set."""

    def load(name: str, package: str | None = None) -> ModuleType:
        try:
            return importlib.import_module(name, package)
        except ImportError as error:
            if os.environ.get("CI"):
                pytest.fail(f"CI must have every library that the tests use: {error}")
            pytest.skip(f"not installed: {error}")

    return load
