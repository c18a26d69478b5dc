"""What `pacinian doctor` sees of this machine. Each look is on its own: one that fails is a finding, too."""

from __future__ import annotations

import importlib.metadata
import os
import re
import shutil
import socket
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from pacinian.cli import doctor_rules
from pacinian.cli.doctor_rules import Finding
from pacinian.errors import PacinianError, describe_error

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

SLEEPS, SLEEP = 200, 0.001  # how many, [s]
MAX_ANSWER_TIME = 1.0  # [s] for the server's answer
SHARED = Path("/dev/shm")
EXTRAS = "plot", "view", "devices", "study", "autd3"
DEVICES = 2241 * 4  # transducers that shared memory should have room for


def examine(connection: str | None = None) -> list[Finding]:
    """All findings, in the order in which they should be mended."""
    looks: dict[str, Callable[[], Finding]] = {
        "Python": python,
        "libraries": libraries,
        "extras": extras,
        "ZeroMQ": curve,
        "kernels": kernels,
        "processor": processor,
        "plug-ins": plugins,
        "loopback": port,
        "shared memory": memory,
        "clock": clock,
        "USB": usb,
    }
    if sys.platform == "linux":
        looks["USB permissions"] = permissions
    found = [_safely(name, look) for name, look in looks.items()]
    found.append(_safely("connection file", lambda: file(connection)))
    if found[-1].level == "ok" and not found[-1].fix:
        found.append(_safely("server", lambda: server(connection)))
        found.append(_safely("air", lambda: air(connection)))
    return found


def _safely(name: str, look: Callable[[], Finding]) -> Finding:
    try:
        return look()
    except Exception as error:
        why = f"cannot be looked at: {describe_error(error)}"
        return Finding(name, "problem", why, doctor_rules.INSTALL)


def python() -> Finding:
    """The interpreter."""
    return doctor_rules.python(sys.version_info[:3], sys.executable)


def libraries() -> Finding:
    """What the distribution says that it requires, without extras."""
    needed = [r for r in importlib.metadata.requires("pacinian") or () if "extra ==" not in r]
    return doctor_rules.libraries({name: _version(name) for name in map(_name, needed)})


def _name(requirement: str) -> str:
    found = re.match(r"[\w.-]+", requirement)
    return found[0] if found else requirement


def _version(name: str) -> str | None:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None


def extras() -> Finding:
    """Optional libraries: of each extra the first that is not there."""
    missing: dict[str, str] = {}
    for requirement in importlib.metadata.requires("pacinian") or ():
        name = _name(requirement)
        asked = re.search(r"extra == ['\"]([\w-]+)", requirement)
        if asked and asked[1] in EXTRAS and name != "pacinian" and _version(name) is None:
            missing.setdefault(asked[1], name)
    return doctor_rules.extras(missing)


def curve() -> Finding:
    """ZeroMQ's encryption."""
    import zmq

    return doctor_rules.curve(zmq.has("curve"), zmq.zmq_version())


def kernels() -> Finding:
    """The variant of the kernels that runs."""
    from pacinian import native

    return doctor_rules.kernels(native.VARIANT, native.load(native.__name__, "_plain").level())


def processor() -> Finding:
    """Cores."""
    affinity = getattr(os, "sched_getaffinity", None)
    return doctor_rules.processor(len(affinity(0)) if affinity else os.cpu_count() or 1)


def plugins() -> Finding:
    """Solvers and backends; imports them all."""
    from pacinian.plugins.registry import installed

    found = installed()
    found.load()
    return doctor_rules.plugins(
        len(found.offers), [str(e) for e in (*found.failed.values(), *found.clashes.values())]
    )


def port() -> Finding:
    """Whether a port on loopback can be had."""
    try:
        with socket.socket() as listener:
            listener.bind(("127.0.0.1", 0))
            listener.listen()
    except OSError as error:
        return doctor_rules.port(str(error))
    return doctor_rules.port("")


def memory() -> Finding:
    """Where the server's processes would share memory."""
    from pacinian.serving.ipc.messages import CAPACITIES, compute_frame_capacity
    from pacinian.serving.ipc.shared_memory import SLOTS

    folder = SHARED if os.access(SHARED, os.W_OK) else Path(tempfile.gettempdir())
    needed = SLOTS * (sum(CAPACITIES.values()) + compute_frame_capacity(DEVICES))
    free = shutil.disk_usage(folder).free
    return doctor_rules.memory(str(folder), os.access(folder, os.W_OK), free, needed)


def clock() -> Finding:
    """How fine the clock is, and how punctual sleep is, measured for a fifth of a second."""
    return doctor_rules.clock(time.get_clock_info("perf_counter").resolution, list(_late()))


def _late() -> Iterator[float]:
    for _ in range(SLEEPS):
        begin = time.perf_counter()
        time.sleep(SLEEP)
        yield time.perf_counter() - begin - SLEEP


def usb() -> Finding:
    """libusb, through pyusb."""
    from usb.backend import libusb1

    return doctor_rules.usb(libusb1.get_backend() is not None, sys.platform)


def permissions() -> Finding:
    """USB devices' files."""
    files = list(Path("/dev/bus/usb").glob("*/*"))
    return doctor_rules.permissions(len(files), sum(os.access(f, os.W_OK) for f in files))


def file(given: str | None) -> Finding:
    """The connection file."""
    from pacinian.wire.connection import Connection, locate_connection

    path, error = locate_connection(given or ""), ""
    if there := path.exists():
        try:
            Connection.read(path)
        except PacinianError as problem:
            error = str(problem)
    return doctor_rules.connection(str(path), there, error)


def server(given: str | None) -> Finding:
    """The server that the connection file is of."""
    from pacinian.client.client import Client

    try:
        with Client(given, name="pacinian doctor", timeout=MAX_ANSWER_TIME) as client:
            return doctor_rules.server("", client.status().output, client.server)
    except PacinianError as error:
        return doctor_rules.server(str(error), "", "")


def air(given: str | None) -> Finding:
    """The air that the server of the connection file computes with."""
    from pacinian.cli.status import describe_air
    from pacinian.client.client import Client

    try:
        with Client(given, name="pacinian doctor", timeout=MAX_ANSWER_TIME) as client:
            return doctor_rules.air(describe_air(client.capabilities().sound))
    except PacinianError:  # which is a finding already
        return doctor_rules.air("no server tells")
