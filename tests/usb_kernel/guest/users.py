"""Another user than root, and what udev gives to whoever sits at the machine."""

from __future__ import annotations

import json
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .device_setup import until

if TYPE_CHECKING:
    from collections.abc import Generator

SOMEONE, OTHER = 65534, 65533
# may read all files, so that Python is found wherever it lies, and may write none
CAPABILITIES = "--clear-groups", "--inh-caps=+dac_read_search", "--ambient-caps=+dac_read_search"
RULES = Path(__file__).parents[3] / "packaging" / "72-pacinian.rules"
SEAT_LATE = Path("/lib/udev/rules.d/73-seat-late.rules")  # of systemd, which may be missing
UACCESS = 'TAG=="uaccess", ENV{MAJOR}!="", RUN{builtin}+="uaccess"\n'  # what it does for us


def run(*command: str, user: int = SOMEONE) -> subprocess.CompletedProcess[str]:
    """Run something as that user."""
    drop = "setpriv", f"--reuid={user}", f"--regid={user}", *CAPABILITIES
    return subprocess.run([*drop, *command], capture_output=True, text=True, check=False)


def listed(user: int) -> tuple[int, list[dict[str, Any]]]:
    """What `pacinian devices` says to that user, and its exit code."""
    ask = sys.executable, "-m", "pacinian", "devices", "--backend", "usb-autd", "--json"
    done = run(*ask, user=user)
    assert done.stdout, done.stderr
    return done.returncode, json.loads(done.stdout)["devices"]


def node(place: str) -> str:
    """The file of a device, of `bus B, address A`."""
    bus, address = (int(word.rstrip(",")) for word in place.split()[1::2])
    return f"/dev/bus/usb/{bus:03d}/{address:03d}"


def may_open(user: int, place: str) -> bool:
    """Whether that user may open a device for writing, as its use needs."""
    return run("sh", "-c", 'exec 3<>"$0"', node(place), user=user).returncode == 0


@contextmanager
def sitting(user: int) -> Generator[None]:
    """Have that user sit at the machine, as logind would tell; and udev read the rule that we ship."""
    seats, rules = Path("/run/systemd/seats"), Path("/run/udev/rules.d")
    for folder in (seats, rules):
        folder.mkdir(parents=True, exist_ok=True)
    (seats / "seat0").write_text(f"IS_SEAT0=1\nACTIVE=1\nACTIVE_UID={user}\nUIDS={user}\n")
    (rules / RULES.name).write_text(RULES.read_text())
    if not SEAT_LATE.exists():
        (rules / SEAT_LATE.name).write_text(UACCESS)
    reload()
    try:
        yield
    finally:
        for file in (*rules.iterdir(), *seats.iterdir()):
            file.unlink()
        reload()


def reload() -> None:
    """Have udev read its rules again; ask it until it says that it did (systemd's issue 22686: it may refuse)."""
    said: list[str] = []

    def done() -> bool:
        asked = subprocess.run(
            ["udevadm", "control", "--reload"], capture_output=True, text=True, check=False
        )
        said.append(f"{asked.returncode}: {asked.stdout}{asked.stderr}")
        return asked.returncode == 0

    try:
        until(done)
    finally:
        if len(said) > 1:
            print("udevadm control --reload:", *said)  # noqa: T201


def settled(place: str) -> dict[str, str]:
    """What udev knows of a device, once it has done with it; whatever else it still does."""

    def told() -> dict[str, str]:
        ask = ["udevadm", "info", "--query=property", f"--name={node(place)}"]
        said = subprocess.run(ask, check=False, capture_output=True, text=True)  # no node: nothing
        return dict(line.split("=", 1) for line in said.stdout.splitlines())

    until(lambda: "USEC_INITIALIZED" in told())
    return told()


def triggered(place: str) -> dict[str, str]:
    """What udev knows of a device after it was asked to look again, as the rule's first lines say."""
    ask = ["udevadm", "trigger", "--settle", f"--name-match={node(place)}"]
    subprocess.run(ask, check=False)
    return settled(place)


def plugged(serial: str) -> list[str]:
    """The places of all devices with this serial, whatever they are, by sysfs."""
    found = [
        file.parent
        for file in Path("/sys/bus/usb/devices").glob("*/serial")
        if file.read_text().strip() == serial
    ]
    numbers = [[int((d / name).read_text()) for name in ("busnum", "devnum")] for d in found]
    return [f"bus {bus}, address {address}" for bus, address in sorted(numbers)]
