"""Compile the kernels: the C++ of core/ and plugins/, once for each set of instructions.

`python native_build.py` builds what is out of date, as `pip install` does; with `--sanitize address,undefined`, into
another folder.
"""

from __future__ import annotations

import argparse
import hashlib
import importlib
import os
import platform
import re
import shutil
import subprocess
import sys
import sysconfig
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

ROOT = Path(__file__).parent
# Folders of the modules, each with a module.cpp.
MODULES = (
    Path("core/pacinian/native"),
    Path("plugins/pacinian_plugins/native"),
)
ZIG = "ziglang>=0.13"  # a C++ compiler from PyPI
COMPILERS = "c++", "g++", "clang++"
# These options let the compiler reorder sums, estimate square roots, and assume finite numbers. `non_finite.cpp` is
# compiled without that last assumption.
FAST = "-O3", "-ffast-math", "-funroll-loops"
SOURCES = {"module.cpp": (), "non_finite.cpp": ("-fno-finite-math-only",)}
SAFE = "-O2", "-fno-fast-math"
COMMON = (
    "-std=c++17", "-fPIC", "-fvisibility=hidden", "-DNDEBUG", "-DNB_COMPACT_ASSERTIONS", "-Wall", "-Wextra",
)  # fmt: skip
# With sanitizers. What one finds ends the process, with the lines that led there: for these, -g1 is enough.
LINES = "-g1"
SANITIZED = (
    "-fno-sanitize-recover=all",
    "-fno-omit-frame-pointer",
    LINES,
    "-O1",
    "-fno-unroll-loops",
)
# Modules by their set of instructions: AVX-512; AVX2 and FMA; what every x86-64 processor has.
X86_LEVELS = {"_v4": "v4", "_v3": "v3", "_plain": ""}
OTHER_LEVELS = {"_plain": ""}
STAMP = "sources.sha256"  # file in build/native with the hash of what the modules were built from
NOTE = "# Made by `python native_build.py --stubs`.\n"
MAX_COMPILE_TIME = 900.0  # longest run of the compiler [s]
MAX_ERROR_CHARACTERS = 4000  # largest part of a compiler's messages that is shown
ADVICE = "install a C++17 compiler (g++ or clang++), or set CXX to one, then install Pacinian again"


class NativeError(Exception):
    """The kernels cannot be compiled; says why, and what to do."""


class Compiler(NamedTuple):
    """A C++ compiler. command: to run it. zig: whether it names instruction sets as Zig does."""

    command: tuple[str, ...]
    zig: bool = False

    def list_instruction_options(self, level: str) -> list[str]:
        """Return the options for a level of x86-64; "" is the lowest."""
        if not is_x86():
            return []
        if self.zig:
            return [f"-mcpu=x86_64{'_' + level if level else ''}"]
        return [f"-march=x86-64{'-' + level if level else ''}"] + (
            ["-mprefer-vector-width=512"] if level == "v4" else []
        )


def is_x86() -> bool:
    """Return whether this machine's processor is an x86-64."""
    return platform.machine().lower() in ("x86_64", "amd64")


def find_system_compiler() -> Compiler | None:
    """Return the system's compiler: CXX, or the first on the path; None if there is none."""
    if given := os.environ.get("CXX", "").split():
        return Compiler(tuple(given))
    found = next(filter(None, map(shutil.which, COMPILERS)), None)
    return None if found is None else Compiler((found,))


def list_dependencies() -> list[str]:
    """Return what the build needs from PyPI: a compiler, if the system has none."""
    return [] if find_system_compiler() else [ZIG]


def build(root: Path = ROOT, sanitize: str = "") -> list[Path]:
    """Compile and link what is out of date; return the modules' files. Raises NativeError.

    sanitize: checks that GCC or Clang compile in, such as "address,undefined". Then only the lowest variant is built,
    into build/native-address-undefined, where only `tests/sanitized.py` finds it.
    """
    compiler = find_system_compiler() or Compiler(
        (sys.executable, "-m", "ziglang", "c++"), zig=True
    )
    folder = root / "build" / ("native-" + sanitize.replace(",", "-") if sanitize else "native")
    folder.mkdir(parents=True, exist_ok=True)
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    levels = X86_LEVELS if is_x86() and not sanitize else OTHER_LEVELS
    targets = {
        (where, name): (folder / where if sanitize else root / where) / f"{name}{suffix}"
        for where in MODULES
        if (root / where / "module.cpp").is_file()
        for name in levels
    }
    if not targets:
        return []
    stamp, now = folder / STAMP, hash_sources(root, compiler)
    if (
        stamp.is_file()
        and stamp.read_text("ascii") == now
        and all(t.is_file() for t in targets.values())
    ):
        return list(targets.values())
    stamp.unlink(missing_ok=True)
    extra = [f"-fsanitize={sanitize}", *SANITIZED] if sanitize else []
    libraries = _link_libraries(folder)
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        shared = pool.submit(
            _compile, compiler, root, libraries, libraries[0] / "src/nb_combined.cpp", folder / "nanobind.o",
            # without these options, Zig would use all instructions of this machine
            [*SAFE, *compiler.list_instruction_options("")],
        )  # fmt: skip
        objects = {
            (where, name, source): pool.submit(
                _compile, compiler, root, libraries, root / where / source,
                folder / f"{where.parts[0]}{name}-{source}.o",
                [*FAST, *options, *extra, f"-DMODULE={name}", *compiler.list_instruction_options(levels[name])],
            )
            for where, name in targets
            for source, options in SOURCES.items()
            if (root / where / source).is_file()
        }  # fmt: skip
        for key, target in targets.items():
            own = [made.result() for name, made in objects.items() if name[:2] == key]
            options = [*compiler.list_instruction_options(""), *extra]
            _link(compiler, [*own, shared.result()], target, options)
    stamp.write_text(now, encoding="ascii")
    return list(targets.values())


def hash_sources(root: Path, compiler: Compiler) -> str:
    """Return a hash of all that the modules are built from: sources, compiler, libraries, this file."""
    import nanobind

    made = hashlib.sha256(
        repr([compiler, nanobind.__version__, sys.version, platform.machine()]).encode()
    )
    sources = [path for part in ("core", "plugins") for path in (root / part).rglob("*.[hc]pp")]
    for file in sorted([*sources, root / Path(__file__).name]):
        made.update(file.relative_to(root).as_posix().encode() + b"\0")
        made.update(file.read_bytes().replace(b"\r\n", b"\n") + b"\0")
    return made.hexdigest()


def _link_libraries(folder: Path) -> tuple[Path, Path]:
    """Return the folders of nanobind and of NumPy's headers, as links in `folder`.

    Each isolated build has its libraries at another place. By the links, a compiler cache knows their headers again.
    Where nobody may make links, returns the folders themselves.
    """
    import nanobind
    import numpy as np

    places = Path(nanobind.include_dir()).parent, Path(np.get_include())
    links = folder / "nanobind", folder / "numpy"
    try:
        for link, place in zip(links, places, strict=True):
            link.unlink(missing_ok=True)
            link.symlink_to(place, target_is_directory=True)
    except OSError:
        return places
    return links


def _compile(
    compiler: Compiler, root: Path, libraries: tuple[Path, Path], source: Path, made: Path, options: list[str]
) -> Path:  # fmt: skip
    """Compile a source to the object file `made`, and return that. libraries: from `_link_libraries`."""
    nanobind, numpy = libraries
    includes = [
        root / "core", root / "plugins", nanobind / "include", nanobind / "ext/robin_map/include", numpy,
        sysconfig.get_path("include"),
    ]  # fmt: skip
    _run_compiler(
        [
            *compiler.command,
            *COMMON,
            *options,
            *(f"-I{path}" for path in includes),
            "-c",
            source,
            "-o",
            made,
        ]
    )
    return made


def _link(compiler: Compiler, objects: list[Path], target: Path, options: list[str]) -> None:
    """Link to a temporary file and rename it, so that a process that has the old file keeps it."""
    made = target.with_name(f"{target.name}.{os.getpid()}")
    target.parent.mkdir(parents=True, exist_ok=True)
    strip = ["-undefined", "dynamic_lookup"] if sys.platform == "darwin" else ["-s"]
    strip = [] if LINES in options else strip
    try:
        _run_compiler([*compiler.command, "-shared", *strip, *options, *objects, "-o", made])
        made.replace(target)
    finally:
        made.unlink(missing_ok=True)


def _run_compiler(command: list[str | Path]) -> None:
    """Run the compiler. Raises NativeError."""
    try:
        run_tool([str(each) for each in command], MAX_COMPILE_TIME)
    except (OSError, subprocess.SubprocessError) as error:
        output = get_error_output(error, MAX_ERROR_CHARACTERS)
        message = output or str(error)[-MAX_ERROR_CHARACTERS:].strip()
        raise NativeError(
            f"the kernels cannot be compiled with {command[0]}: {message}\n{ADVICE}"
        ) from error


def run_tool(
    command: Sequence[str], time_limit: float, folder: Path | None = None, path: str | None = None
) -> None:
    """Run a program without input, and wait for it. Raises OSError, SubprocessError.

    time_limit: [s]. folder: to run it in. path: instead of the environment's PATH.
    """
    environment = None if path is None else {**os.environ, "PATH": path}
    subprocess.run(
        command, cwd=folder, env=environment, timeout=time_limit, check=True, stdin=subprocess.DEVNULL,
        capture_output=True, text=True, encoding="utf-8", errors="replace",
    )  # fmt: skip


def get_error_output(error: Exception, count: int) -> str:
    """Return the last `count` characters of what a failed program wrote as errors; empty if there are none."""
    output = error.stderr if isinstance(error, subprocess.CalledProcessError) else None
    return (output or "")[-count:].strip()


def make_stubs(root: Path = ROOT) -> dict[Path, str]:
    """Return type stubs of the groups of kernels, by file, from the signatures in the modules."""
    from nanobind.stubgen import StubGen

    made = {}
    for where in MODULES:
        module = importlib.import_module(".".join([*where.parts[1:], "_plain"]))
        for name, group in vars(module).items():
            if isinstance(group, ModuleType):
                stub = StubGen(group)
                stub.put(group)
                used = sorted(set(re.findall(r"\bpacinian\.types\.(\w+)", stub.get())))
                text = re.sub(r"\bpacinian\.types\.", "", stub.get())
                head = f"from pacinian.types import {', '.join(used)}" if used else ""
                made[root / where / f"{name}.pyi"] = (
                    NOTE + text.replace("import pacinian.types", head).strip() + "\n"
                )
    return made


def main() -> None:
    """Build the modules, and print their files."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sanitize", default="")
    parser.add_argument("--stubs", action="store_true", help="write the type stubs, too")
    asked = parser.parse_args()
    for path in build(sanitize=asked.sanitize):
        print(path)
    for path, text in make_stubs().items() if asked.stubs else ():
        path.write_text(text, encoding="utf-8")
        print(path)


if __name__ == "__main__":
    main()
