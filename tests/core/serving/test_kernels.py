"""Kernels are compiled once, before the server's processes are started."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from typing import TYPE_CHECKING, Any

import pytest

from pacinian.serving import kernels
from pacinian.serving.kernels import VARIABLE, find_stale, kept
from pacinian.serving.settings import Log

if TYPE_CHECKING:
    from pathlib import Path

LATER = 10.0  # [s], of a file's time
KERNEL = """
from pacinian.acoustics.compiled import compiled
@compiled("f8(f8)")
def twice(x):
    return 2.0 * x
"""
HITS = "import toy.kernels; print(sum(toy.kernels.twice.stats.cache_hits.values()))"


class Toy:
    """An installed plug-in with one kernel."""

    def __init__(self, root: Path) -> None:
        self.source = root / "toy" / "kernels.py"
        self.source.parent.mkdir()
        (self.source.parent / "__init__.py").touch()
        self.source.write_text(KERNEL)
        told = root / "toy-1.0.dist-info"
        told.mkdir()
        (told / "METADATA").write_text("Metadata-Version: 2.1\nName: toy\nVersion: 1.0\n")
        (told / "entry_points.txt").write_text("[pacinian]\ntoy = toy.kernels\n")

    @property
    def is_stale(self) -> bool:
        return "toy.kernels" in find_stale()

    def kept(self, spare: Path, ending: threading.Event | None = None) -> Any:
        return kept(spare, Log(), ending or threading.Event(), lambda: None)

    def hits(self) -> int:
        """How many kernels another process finds compiled."""
        command = [sys.executable, "-c", HITS]
        return int(subprocess.run(command, capture_output=True, check=True, text=True).stdout)


@pytest.fixture
def toy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Toy:
    made = Toy(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    path = os.pathsep.join((str(tmp_path), os.environ.get("PYTHONPATH", "")))
    monkeypatch.setenv("PYTHONPATH", path)
    monkeypatch.setattr(
        kernels, "_modules", lambda: iter([("toy.kernels", made.source)])
    )  # those of ours may be old, too, and are others' business
    return made


def test_modules_of_plug_ins_are_found_without_importing_them(
    toy: Toy, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.undo()
    monkeypatch.syspath_prepend(toy.source.parents[1])
    modules = dict(kernels._modules())
    assert modules["toy.kernels"] == toy.source
    assert modules["pacinian.acoustics.kernels"].exists()
    assert any(name.startswith("pacinian_plugins.solvers.") for name in modules)
    assert "toy" not in sys.modules
    toy.source.with_name(".#kernels.py").symlink_to("nobody@nowhere")  # an editor's lock
    assert "toy.kernels" in find_stale()


def test_what_is_missing_or_old_is_compiled_once_and_found_by_the_next_process(
    toy: Toy, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert toy.is_stale
    with toy.kept(tmp_path / "spare"):
        assert not toy.is_stale
        assert toy.hits() == 1
    assert not (tmp_path / "spare").exists()
    later = toy.source.stat().st_mtime + LATER
    os.utime(toy.source, (later, later))
    assert toy.is_stale
    with monkeypatch.context() as patch:
        patch.setattr(kernels, "_compile", lambda modules, *_: compiled.extend(modules))
        compiled: list[str] = []
        with toy.kept(tmp_path / "spare"):
            assert compiled == ["toy.kernels"]
        toy.source.write_text(toy.source.read_text() * 2)
        assert toy.is_stale, "of two kernels one is kept"


def test_where_nothing_can_be_kept_a_spare_folder_is_used_and_that_is_said(
    toy: Toy, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, logged: Any
) -> None:
    (tmp_path / "file").touch()
    assert not kernels._is_writable(tmp_path / "file" / "folder")
    monkeypatch.setenv(VARIABLE, str(tmp_path / "file" / "folder"))
    with monkeypatch.context() as patch:
        patch.setattr(kernels, "_is_writable", lambda _: False)
        with toy.kept(tmp_path / "spare"):
            assert os.environ[VARIABLE] == str(tmp_path / "spare")
            assert list((tmp_path / "spare").rglob("kernels.*.nbi"))
            assert toy.hits() == 1
    assert os.environ[VARIABLE] == str(tmp_path / "file" / "folder")
    logged.wait("cannot be kept", VARIABLE)


def test_it_says_how_far_it_is_and_a_module_that_does_not_load_keeps_no_other_from_it(
    toy: Toy, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    broken = toy.source.with_name("broken.py")
    broken.write_text(f"raise OSError('out of order'){KERNEL}")
    both = [("toy.broken", broken), ("toy.kernels", toy.source)]
    monkeypatch.setattr(kernels, "_modules", lambda: iter(both))
    with toy.kept(tmp_path / "spare"):
        assert toy.hits() == 1
    said = capfd.readouterr().err
    assert "0 of 2" in said
    assert "1 of 2" in said
    assert "out of order" in said
    assert "kernels are compiled" in said


def test_whoever_ends_the_server_does_not_wait_for_it(toy: Toy, tmp_path: Path) -> None:
    toy.source.write_text(
        f"import pathlib, time\npathlib.Path(r'{tmp_path / 'begun'}').touch()\ntime.sleep(1e6){KERNEL}"
    )
    ending, worked = threading.Event(), list[bool]()

    def working() -> None:
        worked.append(True)
        if (tmp_path / "begun").exists():
            ending.set()

    with kept(tmp_path / "spare", Log(), ending, working):
        assert ending.is_set()
    assert worked
