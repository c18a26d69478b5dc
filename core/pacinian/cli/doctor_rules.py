"""The rules of `pacinian doctor`: pure functions from observations to findings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from pacinian.errors import suggest_install

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

MAX_LISTED = 8  # items listed in one finding
MIN_PYTHON = 3, 11
# 99th percentile of the lateness of sleeps above which `doctor` warns [s].
MAX_SLEEP_LATENESS = 0.001
VARIANTS = {"v4": "AVX-512", "v3": "AVX2", "plain": "all processors of its kind"}
MIN_X86_LEVEL = 1  # lowest level of an x86-64 processor
UDEV_FIX = (
    "`pacinian devices udev | sudo tee /etc/udev/rules.d/72-pacinian.rules`, then "
    "`sudo udevadm control --reload && sudo udevadm trigger`, and plug it in again"
)
INSTALL_FIX = (
    "in a fresh virtual environment, run `python -m pip install SOURCE`, where SOURCE is the wheel or the "
    "folder"
)

Level = Literal["ok", "warning", "problem"]


@dataclass(frozen=True)
class Finding:
    """A finding: its subject, level, text and remedy."""

    name: str
    level: Level
    text: str
    fix: str = ""


def list_first(items: Sequence[object], gap: str = ", ") -> str:
    """Return the first items as text, with a gap between them, and how many more there are."""
    more = f" and {len(items) - MAX_LISTED} more" if len(items) > MAX_LISTED else ""
    return gap.join(map(str, items[:MAX_LISTED])) + more


def check_python(version: tuple[int, int, int], executable: str) -> Finding:
    """Check the Python version."""
    text = f"{'.'.join(map(str, version))}, {executable}"
    if version[:2] < MIN_PYTHON:
        return Finding("Python", "problem", text, "install Python 3.11 or newer")
    return Finding("Python", "ok", text)


def check_libraries(versions: Mapping[str, str | None]) -> Finding:
    """Check the required libraries: version by name, or None if one is missing."""
    missing = [name for name, version in versions.items() if version is None]
    if missing:
        return Finding("libraries", "problem", f"missing: {', '.join(missing)}", INSTALL_FIX)
    text = ", ".join(f"{name} {version}" for name, version in versions.items())
    return Finding("libraries", "ok", text)


def check_extras(missing: Mapping[str, str]) -> Finding:
    """List the optional libraries. missing: extra to its first missing library."""
    if not missing:
        return Finding("extras", "ok", "all installed")
    text = ", ".join(f"{name} without {library}" for name, library in missing.items())
    names = ",".join(missing)
    return Finding("extras", "ok", text, f"if wanted: {suggest_install(names)}")


def check_encryption(has: bool, version: str) -> Finding:
    """Check that ZeroMQ has encryption."""
    if has:
        return Finding("ZeroMQ", "ok", f"libzmq {version} with CURVE")
    fix = "install pyzmq's own wheel: `pip install --force-reinstall pyzmq`"
    text = f"libzmq {version} without CURVE: only programs on this machine can connect"
    return Finding("ZeroMQ", "warning", text, fix)


def check_kernels(variant: str, level: int) -> Finding:
    """Check the compiled kernels. variant: variant in use. level: x86-64 level of the processor; 0 if it is another."""
    text = f"compiled for {VARIANTS[variant]}"
    if variant == "plain" and level >= MIN_X86_LEVEL:
        fix = "use a processor with AVX2, as most since 2015 have"
        return Finding("kernels", "warning", f"{text}: expect several times longer ticks", fix)
    return Finding("kernels", "ok", text)


def check_processor(cores: int) -> Finding:
    """Check the number of cores that this process may use."""
    text = f"{cores} cores"
    if cores < 2:
        fix = "give it two cores or more: the loop and the device's guard need one each"
        return Finding("processor", "warning", text, fix)
    return Finding("processor", "ok", text)


def check_plugins(count: int, failed: Sequence[str]) -> Finding:
    """Check the solvers and backends. failed: why some plug-ins do not load."""
    if failed:
        fix = "update or uninstall the packages that ship them"
        return Finding("plug-ins", "problem", "; ".join(failed), fix)
    if not count:
        return Finding("plug-ins", "problem", "none found", INSTALL_FIX)
    return Finding("plug-ins", "ok", f"{count} solvers and backends")


def check_loopback(error: str) -> Finding:
    """Check that a socket can be bound on loopback. error: why not, or ""."""
    if error:
        fix = "allow local sockets: check the firewall, container or sandbox"
        return Finding("loopback", "problem", f"no port can be bound: {error}", fix)
    return Finding("loopback", "ok", "a port can be bound on 127.0.0.1")


def check_connection_file(path: str, there: bool, error: str) -> Finding:
    """Check the connection file. error: why it cannot be used, or ""."""
    if not there:
        text = f"{path} does not exist: no server runs, or it uses another file"
        return Finding("connection file", "ok", text, "`pacinian serve` starts one")
    if error:
        fix = "stop that server if it runs, remove the file, and start `pacinian serve`"
        return Finding("connection file", "problem", error, fix)
    return Finding("connection file", "ok", path)


def check_server(error: str, output: str, version: str, why: str = "") -> Finding:
    """Check that the server of the connection file answers. error: why not, or "". why: why it is silent, or ""."""
    if error:
        return Finding("server", "problem", error, "see its log; start `pacinian serve` again")
    text = f"a server runs ({version}), its output is {output}{why and ': '}{why}"
    if output in ("faulted", "stopped"):
        fix = "`pacinian status` lists the faults; then call `reset()` and `arm()` from a client"
        return Finding("server", "warning", text, fix)
    return Finding("server", "ok", f"{text}; another server needs its own --connection")


def report_air(text: str) -> Finding:
    """Report the air that the server assumes."""
    fix = (
        "measure the air at the array; if it differs, use `pacinian serve --temperature`: an error of 10 degrees costs "
        "nine units a third to a half of the pressure at a focus, and moves it by 6 mm"
    )
    return Finding("air", "ok", f"the server assumes: {text}", fix)


def check_shared_memory(folder: str, writable: bool, free: int, needed: int) -> Finding:
    """Check the shared memory. free: free space [bytes]. needed: space that a server needs [bytes]."""
    text = f"{folder}, {free / 2**20:.0f} MiB free, {needed / 2**20:.0f} MiB needed"
    if not writable:
        fix = "make it writable, or set TMPDIR to a folder that is"
        return Finding("shared memory", "problem", f"{folder} cannot be written", fix)
    if free < needed:
        fix = "free space there; start a container with --shm-size=256m"
        return Finding("shared memory", "problem", text, fix)
    return Finding("shared memory", "ok", text)


def check_clock(resolution: float, late: Sequence[float]) -> Finding:
    """Check the clock. resolution: of the clock [s]. late: lateness of sleeps of 1 ms [s]."""
    p99 = sorted(late)[math.ceil(0.99 * len(late)) - 1]
    text = (
        f"resolution {1e9 * resolution:.0f} ns; the machine wakes a process at most {1e3 * p99:.2f} ms late (99 %), "
        f"{1e3 * max(late):.2f} ms at worst"
    )
    if resolution > 1e-5:
        return Finding("clock", "problem", text, "a clock of 10 microseconds or better is needed")
    if p99 > MAX_SLEEP_LATENESS:
        fix = "close other programs; power saving or a busy virtual machine can also cause this"
        return Finding("clock", "warning", text, fix)
    return Finding("clock", "ok", text)


def check_usb(libusb: bool, platform: str) -> Finding:
    """Check the library that USB arrays need."""
    if libusb:
        return Finding("USB", "ok", "libusb is installed")
    fixes = {
        "linux": "`apt install libusb-1.0-0`, or your distribution's equivalent",
        "darwin": "`brew install libusb`",
        "win32": "`pip install libusb-package`",
    }
    fix = f"if you have a USB array: {fixes.get(platform, 'install libusb 1.0')}"
    return Finding("USB", "warning", "libusb is not installed: USB arrays cannot be used", fix)


def check_usb_permissions(devices: int, usable: int) -> Finding:
    """Check how many of the USB devices this user may open (Linux)."""
    if not devices:
        return Finding("USB permissions", "ok", "no USB device")
    text = f"you can open {usable} of {devices} USB devices"
    if not usable:
        return Finding("USB permissions", "warning", text, f"if you have a USB array: {UDEV_FIX}")
    return Finding("USB permissions", "ok", text)
