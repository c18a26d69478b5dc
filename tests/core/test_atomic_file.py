"""Files that are replaced as a whole."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NoReturn

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pacinian.atomic_file import replace_file

if TYPE_CHECKING:
    from pathlib import Path

posix = pytest.mark.skipif(os.name != "posix", reason="links and special files")


@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=50
)
@given(old=st.none() | st.binary(), parts=st.lists(st.binary()), fails=st.booleans())
def test_the_file_is_the_old_one_or_the_new_one(
    old: bytes | None, parts: list[bytes], fails: bool, tmp_path: Path
) -> None:
    path = tmp_path / "file"
    path.unlink(missing_ok=True)
    if old is not None:
        path.write_bytes(old)

    def write() -> None:
        with replace_file(path) as file:
            for part in parts:
                file.write(part)
                file.flush()
                assert (path.read_bytes() if path.exists() else None) == old
            if fails:
                raise OSError("No space left on device")

    if fails:
        with pytest.raises(OSError, match="No space"):
            write()
    else:
        write()
    expected = old if fails else b"".join(parts)
    assert (path.read_bytes() if path.exists() else None) == expected
    assert list(tmp_path.iterdir()) == ([] if expected is None else [path]), "and nothing beside it"


def test_bytes_that_do_not_reach_the_disk_replace_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"old")

    def fail(file: int) -> NoReturn:
        raise OSError("Input/output error")

    monkeypatch.setattr("os.fsync", fail)
    with pytest.raises(OSError, match="Input"), replace_file(path) as file:
        file.write(b"new")
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("name", ["file", "none/file"])
def test_an_error_names_the_file(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    with pytest.raises(OSError, match=r"\[Errno \d+\]") as caught, replace_file(path):
        raise OSError(27, "File too large")
    assert caught.value.filename == str(path)
    assert not list(tmp_path.iterdir())


@posix
def test_a_link_and_a_device_stay_what_they_are(tmp_path: Path) -> None:
    target, link = tmp_path / "target", tmp_path / "link"
    link.symlink_to(target)
    with replace_file(link) as file:
        file.write(b"new")
    assert link.is_symlink()
    assert target.read_bytes() == b"new"
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        with replace_file(pipe) as file:
            file.write(b"new")
        assert os.read(reader, 8) == b"new"
    finally:
        os.close(reader)
    assert pipe.is_fifo()
