"""Numerical kernels, compiled before there are processes that wait for them: once after an installation.

That takes half a minute, or many on a busy machine. So one process does it, which says how far it is and may take as
long as it needs; the others find what it has kept.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib
import os
import subprocess
import sys
import tempfile
import time
from importlib.metadata import entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import platformdirs

from pacinian.plugins.registry import GROUP
from pacinian.serving.logs import configure, log
from pacinian.serving.settings import Log

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator
    from threading import Event

VARIABLE = "NUMBA_CACHE_DIR"
MARK = "\n@compiled("
PYTHON = f"py{sys.version_info.major}{sys.version_info.minor}"
LOOK = 0.1  # [s] between two looks at the process that compiles


@contextlib.contextmanager
def kept(
    spare: Path, logging: Log, ending: Event, working: Callable[[], object]
) -> Generator[None]:
    """Have the kernels compiled, as far as they are not, for the processes that are started from now on.

    spare: a folder to keep them in where no other can be written. working: called again and again meanwhile.
    """
    with contextlib.ExitStack() as stack:
        if not any(_is_writable(folder) for folder in _folders(Path(__file__))):
            log().warning(
                "compiled kernels cannot be kept: each start takes minutes",
                fix=f"set {VARIABLE} to a folder that can be written",
            )
            stack.enter_context(_variable(str(spare)))
        if stale := find_stale():
            _compile(sorted(stale), logging, ending, working)
        yield


def find_stale() -> dict[str, list[Path]]:
    """The modules with kernels that may have to be compiled, and the files that are kept of them."""
    found: dict[str, list[Path]] = {}
    for name, source in _modules():
        with contextlib.suppress(OSError):  # it was removed just now, or is an editor's broken link
            kernels = source.read_text("utf-8", "replace").count(MARK)
            folders = _folders(source)
            files = [file for f in folders for file in f.glob(f"{source.stem}.*.{PYTHON}.nbi")]
            since = source.stat().st_mtime
            if kernels > sum(file.stat().st_mtime >= since for file in files):
                found[name] = files
    return found


def _modules() -> Iterator[tuple[str, Path]]:
    """Ours and those of plug-ins, none of which is imported: name and source."""
    plugins = {point.module.partition(".")[0] for point in entry_points(group=GROUP)}
    for package in sorted({"pacinian", *plugins}):
        spec = find_spec(package)
        for root in map(Path, spec.submodule_search_locations or () if spec else ()):
            for source in root.rglob("*.py"):
                yield ".".join((package, *source.relative_to(root).with_suffix("").parts)), source


def _folders(source: Path) -> list[Path]:
    """Where Numba may keep what it compiled of a module."""
    place = source.parent.absolute()
    name = f"{place.name}_{hashlib.sha1(str(place).encode(), usedforsecurity=False).hexdigest()}"
    given, user = os.environ.get(VARIABLE), platformdirs.user_cache_path("numba", False)
    return [*([Path(given) / name] if given else []), place / "__pycache__", user / name]


def _is_writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


@contextlib.contextmanager
def _variable(value: str) -> Generator[None]:
    before = os.environ.get(VARIABLE)
    os.environ[VARIABLE] = value
    try:
        yield
    finally:
        del os.environ[VARIABLE]
        if before is not None:
            os.environ[VARIABLE] = before


def _compile(
    modules: list[str], logging: Log, ending: Event, working: Callable[[], object]
) -> None:
    command = [sys.executable, "-m", __name__, logging.format, logging.level, *modules]
    with subprocess.Popen(
        command, stdin=subprocess.DEVNULL, start_new_session=os.name == "posix"
    ) as process:
        while process.poll() is None:
            working()
            if ending.is_set():
                process.kill()
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(LOOK)
    if process.returncode and not ending.is_set():
        log().warning("kernels are not all compiled", code=process.returncode)


def main() -> None:
    """Import the modules that are named, which compiles their kernels, and say how far it is."""
    style, level, *modules = sys.argv[1:]
    configure(Log(style, level), "kernels")  # type: ignore[arg-type]  # they were checked where they come from
    begin = time.monotonic()
    for i, name in enumerate(modules):
        seconds = round(time.monotonic() - begin)
        log().info("compiling kernels", done=f"{i} of {len(modules)}", seconds=seconds, next=name)
        try:
            importlib.import_module(name)
        except Exception as error:  # of a plug-in: whoever needs it tells more
            log().warning("kernels are not compiled", module=name, error=str(error)[:500])
    log().info("kernels are compiled", seconds=round(time.monotonic() - begin))
    for file in (file for files in find_stale().values() for file in files):
        with contextlib.suppress(
            OSError
        ):  # Numba has compared the sources, and keeps what is still right
            file.touch()


if __name__ == "__main__":
    main()
