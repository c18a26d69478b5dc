"""A lock that ends with the process that holds it."""

from __future__ import annotations

import errno
import os
import stat
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import pytest

from pacinian.errors import ServerError
from pacinian.serving.ipc import file_lock
from pacinian.serving.ipc.file_lock import FileLock, LockHeld

if TYPE_CHECKING:
    from pathlib import Path

HOLDER = """
import sys
from pathlib import Path
from pacinian.serving.ipc.file_lock import FileLock
lock = FileLock(Path(sys.argv[1]))
print("held", flush=True)
sys.stdin.read()
"""


def test_it_is_held_until_it_is_closed(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    with FileLock(path):
        assert os.name != "posix" or stat.S_IMODE(path.stat().st_mode) == 0o600
        with pytest.raises(LockHeld, match=f"process {os.getpid()}") as caught:
            FileLock(path)
        assert caught.value.pid == os.getpid()
    with FileLock(path):
        pass
    assert os.name != "posix" or not path.exists()


def test_it_is_let_go_by_whoever_is_killed(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    with subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline()
        with pytest.raises(LockHeld) as caught:
            FileLock(path)
        assert caught.value.pid == process.pid
        process.kill()
    with FileLock(path):
        assert path.read_text() == str(os.getpid())


def test_of_those_who_want_it_and_remove_it_again_one_has_it_at_a_time(tmp_path: Path) -> None:
    path, inside, most = tmp_path / "lock", [0], [0]
    counting = threading.Lock()

    def want(_: int) -> int:
        try:
            with FileLock(path):
                with counting:
                    inside[0] += 1
                    most[0] = max(most[0], inside[0])
                with counting:
                    inside[0] -= 1
                return 1
        except LockHeld:
            return 0

    with ThreadPoolExecutor(4) as pool:
        had = sum(pool.map(want, range(2000)))
    assert most == [1]
    assert had > 10


def test_what_cannot_be_locked_is_told(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "none" / "lock"):
        with pytest.raises(ServerError, match="cannot be locked") as caught:
            FileLock(path)
        assert str(path) in str(caught.value)


def test_on_a_full_disk_it_is_held_without_the_number_of_its_holder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def write(file: int, data: bytes) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("pacinian.serving.ipc.file_lock.os.write", write)
    path = tmp_path / "lock"
    with FileLock(path), pytest.raises(LockHeld, match="process unknown"):
        FileLock(path)
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(os.name != "posix", reason="links to files")
def test_a_link_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "precious").write_text("all")
    (tmp_path / "lock").symlink_to(tmp_path / "precious")
    with pytest.raises(ServerError, match="cannot be locked"):
        FileLock(tmp_path / "lock")
    assert (tmp_path / "precious").read_text() == "all"


def test_a_holder_that_has_not_written_its_number_yet_is_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "lock"
    with FileLock(path):
        path.write_text("")
        monkeypatch.setattr(file_lock.time, "sleep", lambda _: path.write_text("4321"))
        with pytest.raises(LockHeld) as caught:
            FileLock(path)
    assert caught.value.pid == 4321
