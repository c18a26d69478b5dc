"""What `pacinian doctor` makes of what it sees: pure, facts are given."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

MAX_STATE_AGE = 3, 11
JITTER = 0.001  # [s] that a sleep may take too long, in 99 of 100
VARIANTS = {"v4": "AVX-512", "v3": "AVX2", "plain": "all processors of its kind"}
X86 = 1  # the least level of an x86-64
RIGHTS = (
    "`pacinian devices udev | sudo tee /etc/udev/rules.d/72-pacinian.rules`, then "
    "`sudo udevadm control --reload && sudo udevadm trigger`, and plug it in again"
)
INSTALL = "`pip install` Pacinian again, in a fresh virtual environment"


@dataclass(frozen=True)
class Finding:
    """What was looked at, how it is, and what to do."""

    name: str
    level: Literal["ok", "warning", "problem"]
    told: str
    fix: str = ""


def python(version: tuple[int, int, int], executable: str) -> Finding:
    """The interpreter."""
    told = f"{'.'.join(map(str, version))}, {executable}"
    if version[:2] < MAX_STATE_AGE:
        return Finding("Python", "problem", told, "install Python 3.11 or newer")
    return Finding("Python", "ok", told)


def libraries(versions: Mapping[str, str | None]) -> Finding:
    """Those that it needs, by name; None where one is missing."""
    missing = [name for name, version in versions.items() if version is None]
    if missing:
        return Finding("libraries", "problem", f"missing: {', '.join(missing)}", INSTALL)
    told = ", ".join(f"{name} {version}" for name, version in versions.items())
    return Finding("libraries", "ok", told)


def extras(missing: Mapping[str, str]) -> Finding:
    """Optional libraries: extra to what is missing of it."""
    if not missing:
        return Finding("extras", "ok", "all installed")
    told = ", ".join(f"{name} without {library}" for name, library in missing.items())
    names = ",".join(missing)
    return Finding("extras", "ok", told, f"if wanted: `pip install 'pacinian[{names}]'`")


def curve(has: bool, version: str) -> Finding:
    """ZeroMQ's encryption."""
    if has:
        return Finding("ZeroMQ", "ok", f"libzmq {version} with CURVE")
    fix = "install pyzmq's own wheel: `pip install --force-reinstall pyzmq`"
    told = f"libzmq {version} without CURVE: only programs on this machine can connect"
    return Finding("ZeroMQ", "warning", told, fix)


def kernels(variant: str, level: int) -> Finding:
    """The compiled kernels. variant: that runs. level: of x86-64 that the processor has, 0 of another one."""
    told = f"compiled for {VARIANTS[variant]}"
    if variant == "plain" and level >= X86:
        fix = "use a processor with AVX2, as those since 2015 have"
        return Finding("kernels", "warning", f"{told}: expect several times longer ticks", fix)
    return Finding("kernels", "ok", told)


def processor(cores: int) -> Finding:
    """Cores that this process may use."""
    told = f"{cores} cores"
    if cores < 2:
        fix = "give it two cores or more: the loop and the device's guard need one each"
        return Finding("processor", "warning", told, fix)
    return Finding("processor", "ok", told)


def plugins(count: int, failed: Sequence[str]) -> Finding:
    """Solvers and backends, and why some do not load."""
    if failed:
        fix = "update or uninstall what ships them"
        return Finding("plug-ins", "problem", "; ".join(failed), fix)
    if not count:
        return Finding("plug-ins", "problem", "none is found", INSTALL)
    return Finding("plug-ins", "ok", f"{count} solvers and backends")


def port(error: str) -> Finding:
    """Whether a socket could be bound on loopback; "" if so."""
    if error:
        fix = "allow local sockets: look at the firewall, container or sandbox"
        return Finding("loopback", "problem", f"no port can be bound: {error}", fix)
    return Finding("loopback", "ok", "a port can be bound on 127.0.0.1")


def connection(path: str, there: bool, error: str) -> Finding:
    """The connection file; error: why it cannot be used, or ""."""
    if not there:
        told = f"{path} is not there: no server runs, or it was told another file"
        return Finding("connection file", "ok", told, "`pacinian serve` starts one")
    if error:
        fix = "end that server if it runs, remove the file, and start `pacinian serve`"
        return Finding("connection file", "problem", error, fix)
    return Finding("connection file", "ok", path)


def server(error: str, output: str, version: str) -> Finding:
    """Whether the server of the connection file answers; error: why not, or ""."""
    if error:
        return Finding("server", "problem", error, "see its log; start `pacinian serve` again")
    told = f"one is running ({version}), its output is {output}: another needs a --connection of its own"
    if output in ("faulted", "stopped"):
        fix = "mend what it tells in `pacinian status`; then a client must `reset()` it"
        return Finding("server", "warning", told, fix)
    return Finding("server", "ok", told)


def air(told: str) -> Finding:
    """The air that a server computes with."""
    fix = (
        "measure the air at the array; if it is another, `pacinian serve --temperature`: 10 degrees of error cost nine "
        "units a third to a half of the pressure at a focus, and move it by 6 mm"
    )
    return Finding("air", "ok", f"computed with: {told}", fix)


def memory(folder: str, writable: bool, free: int, needed: int) -> Finding:
    """Where processes share memory; free, needed: [bytes]."""
    told = f"{folder}, {free / 2**20:.0f} MiB free, {needed / 2**20:.0f} MiB needed"
    if not writable:
        fix = "make it writable, or set TMPDIR to a folder that is"
        return Finding("shared memory", "problem", f"{folder} cannot be written", fix)
    if free < needed:
        fix = "make room there; in a container, start it with --shm-size=256m"
        return Finding("shared memory", "problem", told, fix)
    return Finding("shared memory", "ok", told)


def clock(resolution: float, late: Sequence[float]) -> Finding:
    """The clock's resolution [s], and by how much sleeps of 1 ms were too long [s]."""
    p99 = sorted(late)[math.ceil(0.99 * len(late)) - 1]
    told = (
        f"resolution {1e9 * resolution:.0f} ns; sleeps are late by {1e3 * p99:.2f} ms in 99 %, "
        f"{1e3 * max(late):.2f} ms at most"
    )
    if resolution > 1e-5:
        return Finding("clock", "problem", told, "a clock of 10 microseconds or better is needed")
    if p99 > JITTER:
        fix = "close what else runs; a desktop's power saving or a busy virtual machine can do this"
        return Finding("clock", "warning", told, fix)
    return Finding("clock", "ok", told)


def usb(libusb: bool, platform: str) -> Finding:
    """The library that USB arrays need."""
    if libusb:
        return Finding("USB", "ok", "libusb is found")
    fixes = {
        "linux": "`apt install libusb-1.0-0`, or your distribution's like",
        "darwin": "`brew install libusb`",
        "win32": "`pip install libusb-package`",
    }
    fix = f"if you have a USB array: {fixes.get(platform, 'install libusb 1.0')}"
    return Finding("USB", "warning", "libusb is not found: USB arrays cannot be used", fix)


def permissions(devices: int, usable: int) -> Finding:
    """USB devices that there are, and of those that this user may open, on Linux."""
    told = f"{usable} of {devices} USB devices can be opened by you"
    if devices and not usable:
        return Finding("USB permissions", "warning", told, f"if you have a USB array: {RIGHTS}")
    return Finding("USB permissions", "ok", told)
