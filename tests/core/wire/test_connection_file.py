"""The connection file."""

from __future__ import annotations

import os
import re
import stat
import subprocess
import sys
from pathlib import Path
from typing import Any

import msgspec
import pytest

from pacinian.errors import ServerError
from pacinian.wire.connection_file import (
    VARIABLE,
    Connection,
    check_folder,
    check_replaceable,
    locate_connection,
)

posix = pytest.mark.skipif(os.name != "posix", reason="file permissions")


def connection(**fields: Any) -> Connection:
    ports = {"control": "tcp://127.0.0.1:1", "command": "tcp://127.0.0.1:2"}
    return Connection(
        **{"pid": os.getpid(), "state": "tcp://127.0.0.1:3", "token": "secret"} | ports | fields
    )


def test_it_is_read_as_it_was_written(tmp_path: Path) -> None:
    path = tmp_path / "deep" / "connection.json"
    assert connection().write(path) == path
    assert Connection.read(path) == connection()
    assert list(path.parent.iterdir()) == [path], "nothing else is left"


@posix
def test_only_its_user_can_read_it_whatever_the_umask(tmp_path: Path) -> None:
    path = tmp_path / "connection.json"
    before = os.umask(0)
    try:
        path.write_text("an old one that all can read")
        connection().write(path)
    finally:
        os.umask(before)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600


@posix
@pytest.mark.parametrize("mode", [0o640, 0o604, 0o620, 0o666])
def test_one_that_others_can_read_or_write_is_refused_with_the_fix(
    tmp_path: Path, mode: int
) -> None:
    path = connection().write(tmp_path / "connection.json")
    path.chmod(mode)
    with pytest.raises(ServerError, match="chmod 600"):
        Connection.read(path)


def test_a_reader_never_sees_half_of_it(tmp_path: Path) -> None:
    path = connection().write(tmp_path / "connection.json")
    with path.open("rb") as held:
        connection(token="b" * 5000).write(path)
        assert msgspec.json.decode(held.read(), type=Connection).token == "secret"
    assert Connection.read(path).token == "b" * 5000


def test_one_of_a_server_that_has_gone_is_refused(tmp_path: Path) -> None:
    with subprocess.Popen([sys.executable, "-c", ""]) as gone:
        pass
    path = connection(pid=gone.pid).write(tmp_path / "connection.json")
    with pytest.raises(ServerError, match=f"process {gone.pid}.*pacinian serve"):
        Connection.read(path)


def test_one_of_another_machine_is_read(tmp_path: Path) -> None:
    path = connection(pid=0).write(tmp_path / "connection.json")
    assert Connection.read(path).pid == 0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is no connection file"),
        ("{}", "pid"),
        ('{"format": "jupyter"}', "format"),
        ('{"format": "pacinian connection", "version": 2}', "version"),
        ("[" * 100_000, "is no connection file"),
        ("\xff", "is no connection file"),
    ],
)
def test_one_that_cannot_be_meant_is_refused(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "connection.json"
    path.write_bytes(text.encode("latin-1"))
    path.chmod(0o600)
    with pytest.raises(ServerError) as caught:
        Connection.read(path)
    assert words in str(caught.value)
    assert str(path) in str(caught.value)


def test_no_file_and_no_folder_are_told_with_the_fix(tmp_path: Path) -> None:
    with pytest.raises(ServerError, match="pacinian serve"):
        Connection.read(tmp_path / "none.json")
    with pytest.raises(ServerError, match="cannot be read"):
        Connection.read(tmp_path)
    (tmp_path / "file").touch()
    with pytest.raises(ServerError, match="cannot be written"):
        connection().write(tmp_path / "file" / "connection.json")


@posix
def test_a_pipe_in_its_place_holds_nobody_up(tmp_path: Path) -> None:
    path = tmp_path / "connection.json"
    os.mkfifo(path)
    for read in (Connection.read, check_replaceable):
        with pytest.raises(ServerError, match="not a file"):
            read(path)


@posix
def test_a_folder_in_which_others_could_replace_it_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "all" / "mine"
    folder.mkdir(parents=True)
    check_folder(folder)
    folder.parent.chmod(0o1777)  # users may remove only their own files, as in /tmp
    check_folder(folder)
    folder.parent.chmod(0o777)
    link = tmp_path / "link"
    link.symlink_to(folder)
    for path in (folder, link):
        with pytest.raises(ServerError, match=r"every user.*--connection"):
            check_folder(path)
    folder.parent.chmod(0o700)
    if os.getuid() == 0:
        os.chown(folder.parent, 1, 1)
    else:
        monkeypatch.setattr(os, "getuid", lambda: tmp_path.stat().st_uid + 1)
    with pytest.raises(ServerError, match=r"another user.*--connection"):
        check_folder(folder)


def test_only_its_own_file_is_removed(tmp_path: Path) -> None:
    path = tmp_path / "connection.json"
    mine, others = connection(), connection(token="other")
    others.write(path)
    mine.remove(path)
    assert path.exists()
    mine.write(path)
    mine.remove(path)
    assert not path.exists()
    mine.remove(path)


def test_where_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "a.json"))
    assert locate_connection() == tmp_path / "a.json"
    assert locate_connection(tmp_path / "b.json") == tmp_path / "b.json"
    monkeypatch.delenv(VARIABLE)
    assert locate_connection().name == "connection.json"
    assert "pacinian" in str(locate_connection())


def test_secrets_are_not_shown() -> None:
    shown = repr(connection(secret_key="hidden"))
    assert "secret" not in shown
    assert "hidden" not in shown


def test_the_container_image_makes_a_folder_that_is_accepted(tmp_path: Path) -> None:
    image = (Path(__file__).parents[3] / "packaging" / "Containerfile").read_text()
    mode = re.search(r"install -d -o pacinian -m (\d+) /run/pacinian", image)
    assert mode is not None
    tmp_path.chmod(int(mode[1], 8))
    check_folder(tmp_path)
