"""Check and test the page's sources with their own tools; find the page in the built wheel and archive."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from typing import TYPE_CHECKING

import pytest

from .browser import ROOT, hook

if TYPE_CHECKING:
    from pathlib import Path

PAGE = "pacinian/viewing/page"
FILES = {"index.html", "page.js", "style.css", "icon.svg", "LICENSES.txt"}
LIMIT = 300.0  # [s]


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Make a minimal project with a page: pyproject.toml, build hook, the page's sources, a package."""
    for name in ("pyproject.toml", "hatch_build.py", "native_build.py", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, tmp_path / name)
    shutil.copytree(
        ROOT / "viewer", tmp_path / "viewer", ignore=shutil.ignore_patterns("node_modules")
    )
    for folder in ("core/pacinian/viewing", "plugins/pacinian_plugins"):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "__init__.py").touch()
    (tmp_path / ".gitignore").write_text("node_modules/\n/core/pacinian/viewing/page/\n")
    return tmp_path


def _build(project: Path, kind: str, **environment: str) -> tuple[Path, str]:
    """Build with hatchling; return the file and the output."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", "out"]
    made = subprocess.run(
        command, cwd=project, env={**os.environ, **environment}, timeout=LIMIT, check=True, text=True,
        capture_output=True,
    )  # fmt: skip
    (file,) = (project / "out").iterdir()
    return file, made.stdout + made.stderr


def _named(names: list[str]) -> set[str]:
    return {name.split(f"{PAGE}/")[1] for name in names if f"{PAGE}/" in name}


@pytest.mark.deep("npm")
def test_wheel_and_source_archive_hold_the_page_and_three_s_licence(project: Path) -> None:
    if (ROOT / "viewer/node_modules/.package-lock.json").exists():  # saves the download by npm
        shutil.copytree(
            ROOT / "viewer/node_modules", project / "viewer/node_modules", symlinks=True
        )
    file, _ = _build(project, "wheel")
    with zipfile.ZipFile(file) as wheel:
        assert _named(wheel.namelist()) >= FILES
        licences = wheel.read(f"{PAGE}/LICENSES.txt").decode()
        script = wheel.read(f"{PAGE}/page.js").decode()
        page = wheel.read(f"{PAGE}/index.html").decode()
    for name in (
        "three 0.",
        "three-bvh-csg",
        "three-mesh-bvh",
        "@msgpack/msgpack",
        "uplot",
        "d3-scale",
    ):
        assert name in licences
    assert "Copyright © 2010-" in licences
    assert "https://cdn" not in script
    assert "//" not in page.replace("<!doctype html>", "").replace("http://www.w3.org", "")
    file.unlink()
    file, said = _build(project, "sdist")
    assert "is built" not in said  # the page was built for the wheel
    with tarfile.open(file) as archive:
        names = archive.getnames()
    assert _named(names) >= FILES
    assert any(name.endswith("/viewer/src/main.ts") for name in names)
    assert any(name.endswith("/hatch_build.py") for name in names)
    assert not any("node_modules" in name for name in names)


def test_without_npm_all_but_the_page_is_installed(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = hook()
    monkeypatch.setattr(made.importlib.util, "find_spec", lambda name: None)
    monkeypatch.setenv("PATH", str(project))
    assert made.find_tools() is None
    with pytest.raises(FileNotFoundError, match="npm"):
        made.build(project)
    monkeypatch.undo()
    broken = project / "npm"
    broken.write_text("#!/bin/sh\necho the registry does not answer >&2\nexit 1\n")
    broken.chmod(0o755)
    (project / "node").symlink_to(broken)
    file, said = _build(project, "wheel", PATH=f"{project}{os.pathsep}{os.environ['PATH']}")
    assert "the viewer's page is not built" in said
    assert "the registry does not answer" in said
    assert "install Node.js" in said
    with zipfile.ZipFile(file) as wheel:
        assert not _named(wheel.namelist())
    assert made.is_stale(project)


def test_a_page_of_other_sources_is_built_again(project: Path) -> None:
    made = hook()
    page = project / "core/pacinian/viewing/page"
    page.mkdir()
    (page / made.STAMP).write_text(made.hash_sources(project / "viewer"), encoding="ascii")
    assert not made.is_stale(project)
    source = project / "viewer/index.html"
    source.write_bytes(source.read_bytes().replace(b"\n", b"\r\n"))
    assert not made.is_stale(project)
    source.write_bytes(source.read_bytes() + b"<!-- -->")
    assert made.is_stale(project)
    shutil.rmtree(project / "viewer")
    assert not made.is_stale(project)  # as in a source archive, which has no sources of the page


@pytest.mark.deep("npm")
def test_the_sources_pass_their_own_checks_and_tests() -> None:
    npm = shutil.which("npm") or "npm"
    folder = ROOT / "viewer"
    if not (folder / "node_modules/typescript").exists():
        subprocess.run([npm, "ci", "--ignore-scripts"], cwd=folder, check=True, timeout=LIMIT)
    for task in ("check", "test"):
        told = subprocess.run(
            [npm, "run", task],
            cwd=folder,
            timeout=LIMIT,
            text=True,
            capture_output=True,
            check=False,
        )
        assert told.returncode == 0, told.stdout + told.stderr


def test_the_lock_names_no_registry() -> None:
    lock = (ROOT / "viewer/package-lock.json").read_text(encoding="utf-8")
    assert "http" not in lock
    assert '"integrity"' in lock
