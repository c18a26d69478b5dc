"""Titles are names of files, which may hold any bytes."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from pacinian import plot
from pacinian.devices.description import DeviceDescription
from pacinian.plot.boards import boards
from pacinian.plot.page import make_printable, set_title

DEVICE = '[[boards]]\nserial = "A$\\\\x$7"\nlayout = { type = "grid", columns = 2, rows = 2 }\n'
NO_LOCALE = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("ball.toml", "ball.toml"),
        ("kühl.toml", "kühl.toml"),
        ("k\udcc3\udcbchl.toml", "kühl.toml"),  # UTF-8 in a locale without it
        ("a\udce4b.toml", "a\ufffdb.toml"),  # Latin-1
        ("a\ud800b", "a?b"),
        ("", ""),
    ],
)
def test_text_is_printable(text: str, shown: str) -> None:
    assert make_printable(text) == shown


def test_the_title_of_boards_is_not_cut_off(tmp_path: Path) -> None:
    file = tmp_path / f"{'a long name ' * 30}.toml"[-200:]
    file.write_text(DEVICE)
    page = boards(DeviceDescription.load(file), file.name)
    page.draw_without_rendering()
    (title,) = page.texts
    box = title.get_window_extent()
    assert title.get_text().endswith("4 transducers")
    assert page.bbox.x0 <= box.x0 < box.x1 <= page.bbox.x1


@pytest.mark.parametrize("title", ["a\udce4b.toml", "a\ud800b", r"a$\x$b", "$", "$$", "{\\", "%"])
def test_any_title_can_be_saved(title: str, tmp_path: Path) -> None:
    for kind in ("png", "svg", "pdf"):
        page = plot.figure()
        set_title(page, title)
        plot.save(page, tmp_path / f"page.{kind}")
        assert (tmp_path / f"page.{kind}").stat().st_size > 1000


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are bytes only there")
@pytest.mark.parametrize(
    ("name", "settings"), [(b"a\xe4$\\x$.toml", {}), ("kühl.toml".encode(), NO_LOCALE)], ids=repr
)
def test_a_device_of_any_name_is_drawn(
    name: bytes, settings: dict[str, str], tmp_path: Path
) -> None:
    Path(os.fsdecode(os.path.join(os.fsencode(tmp_path), name))).write_text(DEVICE)
    done = subprocess.run(
        [sys.executable, "-m", "pacinian", "devices", "draw", name],
        cwd=tmp_path, env={**os.environ, **settings}, capture_output=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "device.png").exists()
