"""Who may use a device, and who has it: run in the guest."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from . import users
from .device_setup import Playing, until
from .plugged import Plugged

UDEV = (
    "this user may not open it: install the udev rule that `pacinian devices udev` prints, "
    "then unplug it and plug it in again"
)
HOLDER = """
import fcntl, sys
file = open(sys.argv[1], "r+b", buffering=0)
fcntl.ioctl(file, 0x8004550F, bytes(4))  # USBDEVFS_CLAIMINTERFACE: 0
print(flush=True)
sys.stdin.read()
"""


def test_another_process_has_it() -> None:
    with Playing("PUA-1") as it:
        node = users.node(it.places()[0])
        command = [sys.executable, "-I", "-S", "-c", HOLDER, node]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as holder:
            assert holder.stdout is not None
            assert holder.stdout.readline() == b"\n"
            name = Path(f"/proc/{holder.pid}/comm").read_text().strip()
            told = f"it is in use by {name} ({holder.pid}): end that first"
            it.refused(it.open, f"usb-autd PUA-1: opening it: {told}")
            holder.kill()
        it.open()
        it.play()
        assert it.sounding


def test_a_user_without_the_right_to_it_is_told_of_the_rule() -> None:
    with Playing("PUA-1") as it:
        place = it.places()[0]
        assert users.may_open(0, place)
        assert not users.may_open(users.SOMEONE, place)
        title = f"AUTD units, {place}"
        found = {"backend": "usb-autd", "serial": "", "title": title, "problem": UDEV}
        assert users.listed(users.SOMEONE) == (1, [found])


def test_the_rule_gives_the_right_to_who_sits_there_whoever_made_the_device() -> None:
    with users.sitting(users.SOMEONE), Playing("PUA-1", kind={"vendor": 0x16D0}) as it:
        place = it.places()[0]
        told = users.settled(place)
        assert told["ID_USB_INTERFACES"] == ":ff4101:"
        # once, udev had not tagged the device when it was plugged in; the rule's first lines tell users to trigger it
        until(lambda: "uaccess" in users.triggered(place)["TAGS"])
        until(lambda: users.may_open(users.SOMEONE, place))
        assert not users.may_open(users.OTHER, place)
        code, (found,) = users.listed(users.SOMEONE)
        assert (code, found["serial"], found["problem"]) == (0, "PUA-1", "")


def test_the_rule_is_for_our_interface_only() -> None:
    device = Plugged("PUA-1", interface=(0xFF, 0x41, 2))
    with users.sitting(users.SOMEONE):
        device.plug()
        try:
            (place,) = until(lambda: users.plugged("PUA-1"))
            assert "uaccess" not in users.settled(place).get("TAGS", "")
            assert not users.may_open(users.SOMEONE, place)
        finally:
            device.unplug()
