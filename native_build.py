"""Compiles the kernels: the C++ of core/ and plugins/, once for each set of instructions.

`python native_build.py` builds what is old, as `pip install` does; `--sanitize address,undefined` into another folder.
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
from typing import NamedTuple

ROOT = Path(__file__).parent
MODULES = (
    Path("core/pacinian/native"),
    Path("plugins/pacinian_plugins/native"),
)  # each with a module.cpp
ZIG = "ziglang>=0.13"  # a C++ compiler from PyPI
NAMES = "c++", "g++", "clang++"
# Sums may be reordered, square roots estimated, and all numbers are finite; but in those sources where they may not be.
FAST = "-O3", "-ffast-math", "-funroll-loops"
SOURCES = {"module.cpp": (), "non_finite.cpp": ("-fno-finite-math-only",)}
SAFE = "-O2", "-fno-fast-math"
COMMON = (
    "-std=c++17", "-fPIC", "-fvisibility=hidden", "-DNDEBUG", "-DNB_COMPACT_ASSERTIONS", "-Wall", "-Wextra",
)  # fmt: skip
# With sanitizers: what one finds ends the process.
SANITIZED = "-fno-sanitize-recover=all", "-fno-omit-frame-pointer", "-g", "-O1"
X86 = {
    "_v4": "v4",
    "_v3": "v3",
    "_plain": "",
}  # AVX-512; AVX2 and FMA; what every such processor has
OTHER = {"_plain": ""}
STAMP = "sources.sha256"  # in build/native: of what the modules were built from
NOTE = "# Made by `python native_build.py --stubs`.\n"
PATIENCE = 900.0  # [s]
TOLD = 4000  # characters of what a compiler says
ADVICE = "install a C++17 compiler (g++ or clang++), or set CXX to one, then install Pacinian again"


class NativeError(Exception):
    """The kernels cannot be compiled; says why, and what to do."""


class Compiler(NamedTuple):
    """A C++ compiler. zig: whether it names instruction sets as Zig does."""

    command: tuple[str, ...]
    zig: bool = False

    def instructions(self, level: str) -> list[str]:
        """Options for a level of x86-64, "" being the lowest."""
        if not x86():
            return []
        if self.zig:
            return [f"-mcpu=x86_64{'_' + level if level else ''}"]
        return [f"-march=x86-64{'-' + level if level else ''}"] + (
            ["-mprefer-vector-width=512"] if level == "v4" else []
        )


def x86() -> bool:
    """Whether this is an x86-64."""
    return platform.machine().lower() in ("x86_64", "amd64")


def system() -> Compiler | None:
    """The system's compiler: CXX, or the first on the path; None if there is none."""
    if given := os.environ.get("CXX", "").split():
        return Compiler(tuple(given))
    found = next(filter(None, map(shutil.which, NAMES)), None)
    return None if found is None else Compiler((found,))


def dependencies(root: Path = ROOT) -> list[str]:
    """What the build needs from PyPI: a compiler, where there is none."""
    del root
    return [] if system() else [ZIG]


def build(root: Path = ROOT, sanitize: str = "") -> list[Path]:
    """Compile and link what is old; the modules' files. Raises NativeError.

    sanitize: checks of GCC's and Clang's that are compiled in, such as "address,undefined"; then only the lowest
    variant is built, into build/native-address-undefined, where nobody but `tests/sanitized.py` finds it.
    """
    compiler = system() or Compiler((sys.executable, "-m", "ziglang", "c++"), zig=True)
    folder = root / "build" / ("native-" + sanitize.replace(",", "-") if sanitize else "native")
    folder.mkdir(parents=True, exist_ok=True)
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    levels = X86 if x86() and not sanitize else OTHER
    targets = {
        (where, name): (folder / where if sanitize else root / where) / f"{name}{suffix}"
        for where in MODULES
        if (root / where / "module.cpp").is_file()
        for name in levels
    }
    if not targets:
        return []
    stamp, now = folder / STAMP, digest(root, compiler)
    if (
        stamp.is_file()
        and stamp.read_text("ascii") == now
        and all(t.is_file() for t in targets.values())
    ):
        return list(targets.values())
    stamp.unlink(missing_ok=True)
    extra = [f"-fsanitize={sanitize}", *SANITIZED] if sanitize else []
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        shared = pool.submit(
            _compile,
            compiler,
            root,
            _nanobind() / "src/nb_combined.cpp",
            folder / "nanobind.o",
            [*SAFE, *compiler.instructions("")],  # Zig would take all that this machine has
        )
        objects = {
            (where, name, source): pool.submit(
                _compile, compiler, root, root / where / source, folder / f"{where.parts[0]}{name}-{source}.o",
                [*FAST, *options, *extra, f"-DMODULE={name}", *compiler.instructions(levels[name])],
            )
            for where, name in targets
            for source, options in SOURCES.items()
            if (root / where / source).is_file()
        }  # fmt: skip
        for key, target in targets.items():
            own = [made.result() for name, made in objects.items() if name[:2] == key]
            _link(compiler, [*own, shared.result()], target, [*compiler.instructions(""), *extra])
    stamp.write_text(now, encoding="ascii")
    return list(targets.values())


def digest(root: Path, compiler: Compiler) -> str:
    """Of all that the modules are built from: sources, compiler, libraries, this file."""
    import nanobind

    made = hashlib.sha256(
        repr([compiler, nanobind.__version__, sys.version, platform.machine()]).encode()
    )
    sources = [path for part in ("core", "plugins") for path in (root / part).rglob("*.[hc]pp")]
    for file in sorted([*sources, root / Path(__file__).name]):
        made.update(file.relative_to(root).as_posix().encode() + b"\0")
        made.update(file.read_bytes().replace(b"\r\n", b"\n") + b"\0")
    return made.hexdigest()


def _nanobind() -> Path:
    import nanobind

    return Path(nanobind.include_dir()).parent


def _compile(
    compiler: Compiler, root: Path, source: Path, made: Path, options: list[str] | tuple[str, ...]
) -> Path:
    import numpy as np

    includes = [
        root / "core", root / "plugins", _nanobind() / "include", _nanobind() / "ext/robin_map/include",
        np.get_include(), sysconfig.get_path("include"),
    ]  # fmt: skip
    _run(
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
    """Into place at once: whoever has the old file goes on with it."""
    made = target.with_name(f"{target.name}.{os.getpid()}")
    target.parent.mkdir(parents=True, exist_ok=True)
    strip = ["-undefined", "dynamic_lookup"] if sys.platform == "darwin" else ["-s"]
    strip = [] if "-g" in options else strip
    try:
        _run([*compiler.command, "-shared", *strip, *options, *objects, "-o", made])
        made.replace(target)
    finally:
        made.unlink(missing_ok=True)


def _run(command: list[str | Path]) -> None:
    try:
        subprocess.run(
            [str(each) for each in command], timeout=PATIENCE, check=True, stdin=subprocess.DEVNULL,
            capture_output=True, text=True, encoding="utf-8", errors="replace",
        )  # fmt: skip
    except (OSError, subprocess.SubprocessError) as error:
        said = (getattr(error, "stderr", "") or str(error))[-TOLD:].strip()
        raise NativeError(
            f"the kernels cannot be compiled with {command[0]}: {said}\n{ADVICE}"
        ) from error


def stubs(root: Path = ROOT) -> dict[Path, str]:
    """Type stubs of the groups of kernels, made of what the modules say of themselves: file to text."""
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
    """Build, and print what there is."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sanitize", default="")
    parser.add_argument("--stubs", action="store_true", help="write the type stubs, too")
    asked = parser.parse_args()
    for path in build(sanitize=asked.sanitize):
        print(path)
    for path, text in stubs().items() if asked.stubs else ():
        path.write_text(text, encoding="utf-8")
        print(path)


if __name__ == "__main__":
    main()
