from __future__ import annotations

import os
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pacinian.errors import ServerError
from pacinian.serving.ipc.shared_memory import LOCK, SLOTS, SharedRegister, open_folder, remove

from ....waiting import PATIENCE, eventually

if TYPE_CHECKING:
    from collections.abc import Iterator

posix = pytest.mark.skipif(os.name != "posix", reason="users, and links to files")
WRITER = """
import sys
from pathlib import Path
from pacinian.serving.ipc.shared_memory import SharedRegister
memory = SharedRegister.attach(Path(sys.argv[1]))
sys.stdin.readline()
while True:
    number = memory.number + 1
    word = number.to_bytes(8, "little")
    memory.write(word, word * (number * 7919 % 1500))
"""
LIFE = 500  # number of values read, after which the writer is killed


@pytest.fixture
def place() -> Iterator[Path]:
    with open_folder() as made:
        yield made


class Killed(Exception):
    pass


class Mortal:
    """Memory whose writer is killed after a number of stores, in the middle of the last."""

    def __init__(self, inner: Any, lives: list[int]) -> None:
        self.inner, self.lives = inner, lives

    def __getitem__(self, at: Any) -> Any:
        return self.inner[at]

    def __setitem__(self, at: Any, value: Any) -> None:
        self.lives[0] -= 1
        if self.lives[0] >= 0:
            self.inner[at] = value
            return
        if isinstance(at, slice):
            half = len(value) // 2
            self.inner[at.start : at.start + half] = value[:half]
        raise Killed


class Overtaken:
    """Memory that others overwrite while it is copied."""

    def __init__(self, inner: Any, meanwhile: Any) -> None:
        self.inner, self.meanwhile = inner, meanwhile

    def __getitem__(self, at: slice) -> bytes:
        middle = (at.start + at.stop) // 2
        first = self.inner[at.start : middle]
        self.meanwhile()
        return bytes(first + self.inner[middle : at.stop])


def mortal(path: Path, lives: int) -> tuple[SharedRegister, SharedRegister]:
    """Return a writer that will be killed, and the file to close instead of it."""
    writer = SharedRegister.attach(path)
    spare = SharedRegister.attach(path)
    left = [lives]
    writer._words.release()
    writer._map.close()
    writer._words = Mortal(spare._words, left)  # type: ignore[assignment]
    writer._map = Mortal(spare._map, left)  # type: ignore[assignment]
    return writer, spare


@given(st.lists(st.lists(st.binary(max_size=40), max_size=3), max_size=12), st.integers(1, 120))
def test_the_newest_value_is_read_whole_and_once(values: list[list[bytes]], capacity: int) -> None:
    with (
        open_folder() as place,
        SharedRegister.create(place / "value", capacity) as writer,
        SharedRegister.attach(place / "value") as reader,
    ):
        assert reader.capacity == writer.capacity >= capacity
        assert reader.read() is None
        newest, seen = b"", 0
        for parts in values:
            if sum(map(len, parts)) > reader.capacity:
                with pytest.raises(ServerError, match="more than"):
                    writer.write(*parts)
            else:
                newest = b"".join(parts)
                assert writer.write(*parts) == seen + 1
                assert reader.read(seen) == (seen + 1, newest)
                seen += 1
            assert reader.read(seen) is None
            assert reader.number == seen
        if seen:
            assert reader.read() == (seen, newest)


def test_an_array_s_memory_is_a_part(place: Path) -> None:
    levels = np.arange(24, dtype=np.uint16).reshape(2, 3, 4)
    with SharedRegister.create(place / "value", 64) as memory:
        memory.write(b"head", levels.data, levels[:, :0].copy().data)
        read = memory.read()
    assert read == (1, b"head" + levels.tobytes())


@pytest.mark.parametrize("before", range(SLOTS + 2))
@pytest.mark.parametrize("lives", range(8))
def test_a_writer_killed_at_any_store_leaves_the_value_before(
    place: Path, before: int, lives: int
) -> None:
    path = place / "value"
    SharedRegister.create(path, 32).close()
    with SharedRegister.attach(path) as reader:
        with SharedRegister.attach(path) as writer:
            for k in range(before):
                writer.write(bytes([k]) * 20)
        victim, spare = mortal(path, lives)
        with spare:
            finished = True
            try:
                victim.write(b"new " * 4, b"est " * 4)
            except Killed:
                finished = False
        assert finished == (lives >= 7)
        old = (before, bytes([before - 1]) * 20) if before else None
        new = (before + 1, b"new " * 4 + b"est " * 4)
        assert reader.read() == (new if finished else old)
        with SharedRegister.attach(path) as writer:  # after a restart, numbers continue
            number = writer.write(b"after")
        assert number == before + 1 + finished
        assert reader.read(number - 1) == (number, b"after")


@pytest.mark.parametrize("laps", range(1, 3 * SLOTS))
def test_a_reader_that_is_overtaken_gets_a_whole_newer_value(place: Path, laps: int) -> None:
    path = place / "value"
    with SharedRegister.create(path, 64) as writer, SharedRegister.attach(path) as reader:
        writer.write(bytes([1]) * 64)
        times = [2]

        def meanwhile() -> None:
            if times[0]:
                times[0] -= 1
                for _ in range(laps):
                    writer.write(bytes([writer.number + 1]) * 64)

        real = reader._map
        reader._map = Overtaken(real, meanwhile)  # type: ignore[assignment]
        read = reader.read()
        reader._map = real
        assert read is not None
        assert read[1] == bytes([read[0]]) * 64


def test_a_value_is_bound_to_its_number(place: Path) -> None:
    """On a machine that reorders stores, a slot may hold a newer value that still has the old number."""
    with SharedRegister.create(place / "value", 16) as memory:
        memory.write(b"old")
        memory.write(b"new")
        old, new = memory._find_place(1)[0], memory._find_place(2)[0]
        memory._words[old + 1 : old + 4] = memory._words[new + 1 : new + 4]
        memory._words[2] = 1
        assert memory.read() is None


def test_what_is_no_shared_memory_is_refused(place: Path) -> None:
    path = place / "value"
    with pytest.raises(ServerError, match="shared memory"):
        SharedRegister.attach(path)
    for content in (b"", b"x", bytes(7), bytes(24), bytes(4096)):
        path.write_bytes(content)
        with pytest.raises(ServerError, match="shared memory"):
            SharedRegister.attach(path)
    path.unlink()
    SharedRegister.create(path, 100).close()
    with pytest.raises(ServerError, match="shared memory"):
        SharedRegister.create(path, 100)
    path.write_bytes(path.read_bytes()[:-8])
    with pytest.raises(ServerError, match="not shared memory"):
        SharedRegister.attach(path)


def test_only_its_owner_may_read_it(place: Path) -> None:
    SharedRegister.create(place / "value", 100).close()
    if sys.platform != "win32":
        assert (place / "value").stat().st_mode & 0o777 == 0o600
        assert place.stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("deaths", [3, pytest.param(6, marks=pytest.mark.deep)])
def test_a_writer_killed_again_and_again_never_harms_its_reader(place: Path, deaths: int) -> None:
    path = place / "value"
    memory = SharedRegister.create(path, 16_384)

    def started() -> subprocess.Popen[bytes]:
        return subprocess.Popen([sys.executable, "-c", WRITER, str(path)], stdin=subprocess.PIPE)

    def go(process: subprocess.Popen[bytes]) -> None:
        assert process.stdin is not None
        process.stdin.write(b"\n")
        process.stdin.close()

    writers = [started(), started()]
    kills, seen, whole = 0, 0, True
    try:
        go(writers[0])
        for values in range(1, deaths * LIFE + 1):
            number, data = eventually(lambda: memory.read(seen))  # noqa: B023
            word = number.to_bytes(8, "little")
            whole = whole and data == word * (1 + number * 7919 % 1500) and number > seen
            seen = number
            if values % LIFE == 0:
                writers[0].kill()
                writers.pop(0).wait()
                kills += 1
                assert memory.read() is not None
                go(writers[0])
                writers.append(started())
    finally:
        for process in writers:
            process.kill()
            process.wait()
            if process.stdin is not None:
                with suppress(OSError):
                    process.stdin.close()
        memory.close()
    assert whole
    assert kills == deaths


MAKER = """
import sys
from pacinian.serving.ipc.shared_memory import SharedRegister, open_folder
with open_folder() as made, SharedRegister.create(made / "value", 1000):
    print(made, flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def maker() -> Iterator[tuple[subprocess.Popen[str], Path]]:
    """Return a process with shared memory, and its folder."""
    command = [sys.executable, "-c", MAKER]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        yield process, Path(process.stdout.readline().strip())
        process.kill()


def beside(place: Path) -> set[Path]:
    return set(place.parent.glob(f"{place.name}*"))


def test_what_a_killed_process_has_left_is_removed_with_the_next_start_and_nothing_else(
    maker: tuple[subprocess.Popen[str], Path],
) -> None:
    process, place = maker
    with open_folder():
        assert (place / "value").exists(), "its maker lives"
    process.kill()
    process.wait()
    assert len(beside(place)) == 2, "the folder and its lock"
    lying = place.with_name(f"{place.name}x")
    lying.mkdir()  # without a lock, so perhaps of another program
    try:
        with open_folder() as own:
            assert beside(place) == {lying}
            assert own.is_dir()
        assert not beside(own)
    finally:
        lying.rmdir()


@posix
def test_a_link_is_not_followed_and_what_another_user_owns_is_left(
    maker: tuple[subprocess.Popen[str], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    process, place = maker
    process.kill()
    process.wait()
    (tmp_path / "precious").touch()
    links = [place.with_name(f"{place.name}x{suffix}") for suffix in ("", LOCK)]
    try:
        links[0].symlink_to(tmp_path)
        links[1].symlink_to(tmp_path / "precious")
        monkeypatch.setattr(os, "getuid", lambda: 4321)
        with open_folder():
            assert len(beside(place)) == 4, "it is of another user"
        monkeypatch.undo()
        with open_folder():
            assert beside(place) == set(links)
        links[1].unlink()
        links[1].touch()
        with open_folder():
            assert beside(place) == {links[0]}, "the lock is ours, the folder is a link"
        assert (tmp_path / "precious").exists()
    finally:
        for link in links:
            link.unlink(missing_ok=True)


def test_one_is_removed_as_soon_as_its_maker_has_ended(
    maker: tuple[subprocess.Popen[str], Path],
) -> None:
    process, place = maker
    remove(place)
    assert place.exists()
    killer = threading.Thread(target=process.kill)
    killer.start()
    remove(place, PATIENCE)
    killer.join()
    assert not beside(place)
    remove(place)


def test_a_folder_that_cannot_be_removed_keeps_its_lock_so_that_a_later_start_removes_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr("pacinian.serving.ipc.shared_memory.shutil.rmtree", lambda *_, **__: None)
        with open_folder() as place:
            pass
        remove(place)
        assert len(beside(place)) == 2, "the folder and its lock"
    with open_folder():
        assert not beside(place)


def test_a_folder_without_a_lock_is_not_removed(tmp_path: Path) -> None:
    remove(tmp_path)
    assert tmp_path.exists()
