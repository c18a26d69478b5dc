"""The compilers that the adapters need, and what they build."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from filelock import FileLock

if TYPE_CHECKING:
    from collections.abc import Iterable

ADAPTERS = Path(__file__).resolve().parents[2] / "adapters"
CORE = ADAPTERS / "unity" / "Runtime" / "Core"
CSHARP = ADAPTERS / "csharp"
SERVER_SIDE = CSHARP / "tests" / "ServerSide"  # reads what a client sends, writes what it receives
CPP = ADAPTERS / "cpp"
LIMIT = 550.0  # [s] for a compiler
# sources compiled together, as Unreal does, all of a library at once, which is faster
JOINED = "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=0"
# programs with threads are built once, and ThreadSanitizer watches them in all tests
RACES = "-DCMAKE_BUILD_TYPE=None", "-DCMAKE_CXX_FLAGS=-O1 -g1 -fsanitize=thread"
WATCHED = {"TSAN_OPTIONS": "exitcode=66"}
WATCHED_LIBZMQ = {
    "TSAN_OPTIONS": f"{WATCHED['TSAN_OPTIONS']} suppressions={CPP / 'tests' / 'client_libzmq.supp'}"
}


def run(*command: str | Path, limit: float = LIMIT, folder: Path | None = None) -> str:
    """Return the output of a command, both streams. Fail the test with it if the command fails or takes too long."""
    words = [str(word) for word in command]
    try:
        done = subprocess.run(
            words, cwd=folder, timeout=limit, check=False, text=True, encoding="utf-8", errors="replace",
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )  # fmt: skip
    except subprocess.TimeoutExpired as error:
        pytest.fail(f"{' '.join(words)}: not ready after {limit:g} s: {error.output!r}")
    assert done.returncode == 0, f"{' '.join(words)}: {done.returncode}\n{done.stdout[-8000:]}"
    return done.stdout


def csharp(
    made: Path, sources: Iterable[Path], *libraries: Path, defines: Iterable[str] = ()
) -> Path:
    """Compile C# without warnings, to a program or a library (.dll) beside the libraries that it needs."""
    made.parent.mkdir(parents=True, exist_ok=True)
    run(
        "mcs", "-nologo", "-langversion:7.2", "-warn:4", "-warnaserror", "-optimize+", "-debug",
        f"-target:{'library' if made.suffix == '.dll' else 'exe'}", f"-out:{made}",
        *(f"-define:{name}" for name in defines),
        *(f"-reference:{library}" for library in libraries),
        *sorted(sources),
    )  # fmt: skip
    return made


def core(folder: Path, more: Iterable[Path] = ()) -> Path:
    """Compile the engine-free core in C# to a library. more: additional sources."""
    made = csharp(folder / "Pacinian.dll", [*CORE.rglob("*.cs"), *more])
    shutil.copy(CSHARP / "Pacinian.dll.config", folder)
    return made


def cmake(kind: str, targets: Iterable[str], *settings: str, source: Path = CPP) -> Path:
    """Build programs, and return their folder; what is built already stays."""
    folder = CPP / "build" / kind
    folder.parent.mkdir(exist_ok=True)
    with FileLock(folder.with_suffix(".lock")):  # another worker may build in it
        run("cmake", "-S", source, "-B", folder, "-G", "Ninja", *settings)
        run("cmake", "--build", folder, "--target", *targets)
    return folder


def watched(*targets: str) -> Path:
    """Return the folder with `play` of the Unreal plugin's stubs; the client's programs are in its folder `core`."""
    return cmake("watched", targets, *RACES, *JOINED, source=CPP / "stubs")


def read_examples(page: Path, language: str, having: str) -> list[str]:
    """Return the examples of a page in a language that contain a text."""
    found = re.findall(rf"```{language}\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    return [example for example in found if having in example]


def environment() -> dict[str, str]:
    """Return an environment in which a watched program ends with an error if its threads race."""
    return {**os.environ, **WATCHED}
