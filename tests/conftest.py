"""Settings, hooks and helpers of all tests."""

from __future__ import annotations

import gc
import importlib
import os
import shutil
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import settings

from . import native

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from types import ModuleType

BENCHMARKS = Path(__file__).parent / "benchmarks"
PATH = f"{os.environ.get('PATH', '')}{os.pathsep}/usr/sbin"  # QEMU's helpers are in /usr/sbin

# BLAS threads that share their cores with other tests wait for each other, and take ten times as
# long.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# The processes that tests start would compile all of Pacinian, each time that one starts.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

# In the background, or under `nohup`, these signals are ignored. Programs that the tests start would ignore them, too.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)

settings.register_profile("fixed", derandomize=True, deadline=None)
settings.register_profile("random", deadline=None, database=None, print_blob=True)
# One in so many examples of a property is tried: in the deep tests, where each commit has others, and otherwise.
DEEP_EXAMPLES_TRIED, EXAMPLES_TRIED = 2, 4
FEWEST = 5
SETTINGS = "_hypothesis_internal_use_settings"  # of a property; it has no public name


def pytest_configure(config: pytest.Config) -> None:
    """Use random examples in the deep tests, and a few fixed ones in all others. Build the kernels once."""
    if not config.getoption("--hypothesis-profile"):
        settings.load_profile("random" if is_deep(config) else "fixed")
    if config.option.numprocesses and not config.option.collectonly:  # only in the main process
        native.build()


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Leave what is collected out of garbage collections: each would take 0.3 s, and each run of a renderer has one.

    What the tests' own renderers freeze and unfreeze would undo that.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.collect()
        gc.freeze()
        gc.freeze = gc.unfreeze = lambda: None


def pytest_xdist_auto_num_workers() -> int:
    """Return more than there are cores: while some tests wait for servers, others run."""
    if told := os.environ.get("PYTEST_XDIST_AUTO_NUM_WORKERS"):
        return int(told)
    allowed = getattr(os, "sched_getaffinity", None)
    cores = len(allowed(0)) if allowed else os.cpu_count() or 1
    return round(1.5 * cores)


def is_deep(config: pytest.Config) -> bool:
    """Return whether these are the deep tests, `-m deep`."""
    return bool(config.option.markexpr == "deep")


@pytest.hookimpl(tryfirst=True)  # before `-m` selects tests
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Sort tests into tiers. Files whose tests take longest come first, then those that share a slow fixture.

    Otherwise, one process would still work at the end, while all others have nothing left to do.
    """
    properties = set()
    for item in items:
        test = getattr(item, "obj", None)
        if item.path.is_relative_to(BENCHMARKS):
            item.add_marker("benchmark")
        elif getattr(test, "is_hypothesis_test", False):
            properties.add(test)
            if is_deep(config):
                item.add_marker("deep")
    if not config.getoption("--hypothesis-profile"):
        one_in = DEEP_EXAMPLES_TRIED if is_deep(config) else EXAMPLES_TRIED
        for test in properties:
            try_fewer_examples(test, one_in)
    limits: dict[Path, float] = {}  # longest time limit of a test in each file [s]
    for item in items:
        limits[item.path] = max(limits.get(item.path, 0.0), find_time_limit(item))
    shared = {item.path for item in items if shares_fixtures(item)}
    items.sort(key=lambda item: (-limits[item.path], item.path not in shared))


def find_time_limit(item: pytest.Item) -> float:
    """Return a test's own time limit [s]; 0 if it has none. Only tests that take long have one."""
    marker = item.get_closest_marker("timeout")
    return 0.0 if marker is None else float(marker.args[0])


def try_fewer_examples(test: Any, one_in: int) -> None:
    """Try one in so many examples of a property. State machines, which are classes, keep theirs."""
    own = getattr(test, SETTINGS, None)
    if own is not None:
        fewer = max(own.max_examples // one_in, min(own.max_examples, FEWEST))
        setattr(test, SETTINGS, settings(own, max_examples=fewer))


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
