"""What all tests share."""

from __future__ import annotations

import importlib
import os
from typing import TYPE_CHECKING

import pytest
from hypothesis import settings

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

settings.register_profile("fixed", derandomize=True, deadline=None)
settings.load_profile("fixed")


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
