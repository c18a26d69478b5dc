"""`pacinian view` and `pacinian serve --view`, as processes."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from typing import TYPE_CHECKING

import msgspec
import psutil
import pytest
from click.testing import CliRunner

from pacinian.cli.view import view
from pacinian.viewing import browser

from .conftest import SETTINGS
from .watching import LIMIT, Page

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

PACINIAN = sys.executable, "-m", "pacinian"


def said(log: Path, what: str) -> str:
    """Return the first match in the output of a process, as soon as it is there."""
    end = time.monotonic() + LIMIT
    while not (found := re.search(what, log.read_text(encoding="utf-8"))):
        assert time.monotonic() < end, log.read_text(encoding="utf-8")
        time.sleep(0.02)
    return found[0]


@pytest.mark.skipif(os.name != "posix", reason="signals are of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_it_prints_its_address_and_ends_when_it_is_told_to(tmp_path: Path, number: int) -> None:
    log = tmp_path / "log"
    command = [*PACINIAN, "view", "--no-browser", "--connection", str(tmp_path / "none")]
    with log.open("wb") as out:
        process = subprocess.Popen(command, stdout=out, stderr=out, start_new_session=True)
    try:
        with Page(said(log, r"http://\S+")) as page:
            page.next("lost")
            process.send_signal(number)
            assert process.wait(LIMIT) == 0
    finally:
        process.kill()
        process.wait()
    assert log.read_text(encoding="utf-8").count("\n") == 1


def test_beside_a_server_it_begins_and_ends_with_it(tmp_path: Path) -> None:
    log, file = tmp_path / "log", tmp_path / "c.json"
    config = tmp_path / "server.json"
    made = msgspec.structs.replace(SETTINGS, connection=str(file))
    config.write_bytes(msgspec.json.encode(made))
    command = [*PACINIAN, "serve", "--view", "--connection", str(file), str(config)]
    environment = {k: v for k, v in os.environ.items() if "DISPLAY" not in k}
    with log.open("wb") as out:
        process = subprocess.Popen(
            command, stdout=out, stderr=out, env=environment, start_new_session=os.name == "posix"
        )
    try:
        with Page(said(log, r"http://\S+")) as page:
            page.next("state")
        children = psutil.Process(process.pid).children(recursive=True)
        assert any("view" in child.cmdline() for child in children)
        process.terminate()
        assert process.wait(LIMIT) == (0 if os.name == "posix" else 1)
        assert not psutil.wait_procs(children, LIMIT)[1]
    finally:
        process.kill()
        process.wait()


def test_a_file_that_is_no_recording_and_a_wide_host_are_refused(tmp_path: Path) -> None:
    (tmp_path / "x").write_bytes(b"hello")
    for arguments, problem in (
        ([str(tmp_path / "x")], "is no recording"),
        (["--host", "0.0.0.0"], "this machine alone"),
    ):
        result = CliRunner().invoke(view, [*arguments, "--no-browser"])
        assert result.exception is not None
        assert problem in str(result.exception)


def test_samples_are_made_of_a_file_only() -> None:
    result = CliRunner().invoke(view, ["--samples", "--no-browser"])
    assert result.exit_code == 2
    assert "needs a FILE" in result.output


def test_without_its_libraries_it_says_which_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in sys.modules if name.startswith("pacinian.viewing.")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "starlette.applications", None)
    result = CliRunner().invoke(view, ["--no-browser"])
    assert '[view]"' in str(result.exception)


def test_a_browser_is_told_the_address_by_a_file_that_only_the_user_can_read(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    opened: list[str] = []
    keep: Callable[[str], object] = opened.append
    monkeypatch.setattr(browser.webbrowser, "open", keep)
    monkeypatch.setenv("DISPLAY", ":0")
    url = "http://127.0.0.1:5/?token=secret&x=<y>"
    file = browser.open_browser(url)
    assert file is not None
    try:
        assert opened == [file.as_uri()]
        assert "secret" not in opened[0]
        assert 'url=http://127.0.0.1:5/?token=secret&amp;x=&lt;y&gt;"' in file.read_text("utf-8")
        if os.name == "posix":
            assert file.stat().st_mode & 0o777 == 0o600
    finally:
        file.unlink()


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere there is always a screen")
def test_without_a_screen_no_browser_is_started(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setattr(browser.webbrowser, "open", lambda url: pytest.fail("opened"))
    assert browser.open_browser("http://127.0.0.1:5/") is None
