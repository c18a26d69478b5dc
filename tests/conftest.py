"""Settings, hooks and helpers of all tests."""

from __future__ import annotations

import importlib
import os
import shutil
import signal
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import settings

from . import native

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

BENCHMARKS = Path(__file__).parent / "benchmarks"
PATH = f"{os.environ.get('PATH', '')}{os.pathsep}/usr/sbin"  # QEMU's helpers are in /usr/sbin

# BLAS threads that share their cores with other tests wait for each other, and take ten times as
# long.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

if (
    signal.getsignal(signal.SIGINT) is signal.SIG_IGN
):  # run in the background: programs that we start would ignore it, too
    signal.signal(signal.SIGINT, signal.default_int_handler)

settings.register_profile("fixed", derandomize=True, deadline=None)
settings.register_profile("random", deadline=None, database=None, print_blob=True)


def pytest_configure(config: pytest.Config) -> None:
    """Use random examples in the deep tests and fixed ones in all others. Build the kernels once."""
    if not config.getoption("--hypothesis-profile"):
        settings.load_profile("random" if is_deep(config) else "fixed")
    if config.option.numprocesses and not config.option.collectonly:  # only in the main process
        native.build()


def is_deep(config: pytest.Config) -> bool:
    """Return whether these are the deep tests, `-m deep`."""
    return bool(config.option.markexpr == "deep")


@pytest.hookimpl(tryfirst=True)  # before `-m` selects tests
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Sort tests into tiers. Files whose tests share a slow fixture come first."""
    for item in items:
        if item.path.is_relative_to(BENCHMARKS):
            item.add_marker("benchmark")
        elif is_deep(config) and getattr(getattr(item, "obj", None), "is_hypothesis_test", False):
            item.add_marker("deep")
    first = {item.path for item in items if shares_fixtures(item)}
    items.sort(key=lambda item: item.path not in first)


def shares_fixtures(item: pytest.Item) -> bool:
    """Return whether a test uses a fixture, such as a running server, that the tests of its file share."""
    definitions = getattr(item, "_fixtureinfo").name2fixturedefs.values()  # noqa: B009
    return any(
        each.scope != "function" and each.baseid not in ("", "tests")
        for several in definitions
        for each in several
    )


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip a test whose programs are missing, or fail it if CI is set."""
    for marker in item.iter_markers("deep"):
        if missing := [name for name in marker.args if shutil.which(name, path=PATH) is None]:
            reason = f"not installed: {', '.join(missing)}; `.ci/setup` installs it"
            if os.environ.get("CI"):
                pytest.fail(reason)
            pytest.skip(reason)


@pytest.fixture(scope="session")
def need() -> Callable[..., ModuleType]:
    """Return a function that imports an optional library. If it is missing, the test is skipped, or fails if CI is
    set.
    """

    def load(name: str, package: str | None = None) -> ModuleType:
        try:
            return importlib.import_module(name, package)
        except ImportError as error:
            if os.environ.get("CI"):
                pytest.fail(f"CI must have every library that the tests use: {error}")
            pytest.skip(f"not installed: {error}")

    return load
