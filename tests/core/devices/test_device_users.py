"""Which programs have a device open."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

import pytest

from pacinian.devices.device_users import find_users

if TYPE_CHECKING:
    from pathlib import Path

NODE = "/dev/bus/usb/001/002"


def process(proc: Path, pid: int, *open_: str) -> None:
    fds = proc / str(pid) / "fd"
    fds.mkdir(parents=True)
    for number, node in enumerate(open_):
        (fds / str(number)).symlink_to(node)
    (fds.parent / "comm").write_text(f"program{pid}\n")


def test_they_are_told_by_name_and_number_where_that_can_be_known(tmp_path: Path) -> None:
    process(tmp_path, 12, "/dev/null")
    process(tmp_path, 345, "/dev/null", NODE)
    process(tmp_path, 7, NODE, NODE)
    (tmp_path / "99").mkdir()  # a process that has just ended
    (tmp_path / "uptime").write_text("1 1\n")
    assert find_users(NODE, tmp_path) == "program7 (7), program345 (345)"
    assert find_users("/dev/bus/usb/001/003", tmp_path) == ""
    assert find_users(NODE, tmp_path / "none") == ""  # not Linux


def test_a_link_to_the_device_is_the_device(tmp_path: Path) -> None:
    device, name = tmp_path / "ttyUSB0", tmp_path / "by-id"
    device.touch()
    name.symlink_to(device)
    process(tmp_path / "proc", 5, str(device))
    assert find_users(name, tmp_path / "proc") == "program5 (5)"


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells")
def test_a_real_process_is_found_also_this_one(tmp_path: Path) -> None:
    path = tmp_path / "device"
    with path.open("w"):
        assert f"({os.getpid()})" in find_users(path)
    assert find_users(path) == ""
