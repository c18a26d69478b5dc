"""The probes of `pacinian doctor`. They are independent, and a probe that fails is a finding, too."""

from __future__ import annotations

import importlib.metadata
import os
import re
import shutil
import socket
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING

from pacinian.cli import doctor_rules
from pacinian.cli.doctor_rules import Finding
from pacinian.errors import PacinianError, describe_error

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

SLEEPS, SLEEP = 200, 0.001  # number and duration of the sleeps that are measured [s]
MAX_ANSWER_TIME = 1.0  # time for the server's answer [s]
MAX_IMPORT_TIME = 30.0  # time to import all plug-ins [s]
EXTRAS = "plot", "view", "devices", "study", "autd3"
DEVICES = 2241 * 4  # transducers for which shared memory should have room


def examine(connection: str | None) -> list[Finding]:
    """Return all findings, in the order in which they should be fixed."""
    probes: dict[str, Callable[[], Finding]] = {
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
        probes["USB permissions"] = permissions
    found = [_safely(name, probe) for name, probe in probes.items()]
    found.append(_safely("connection file", lambda: file(connection)))
    if found[-1].level == "ok" and not found[-1].fix:
        found.append(_safely("server", lambda: server(connection)))
        found.append(_safely("air", lambda: air(connection)))
    return found


def _safely(name: str, look: Callable[[], Finding]) -> Finding:
    try:
        return look()
    except Exception as error:
        why = f"cannot be checked: {describe_error(error)}"
        return Finding(name, "problem", why, doctor_rules.INSTALL_FIX)


def python() -> Finding:
    """Probe the interpreter."""
    return doctor_rules.check_python(sys.version_info[:3], sys.executable)


def libraries() -> Finding:
    """Probe the libraries that the distribution requires, without extras."""
    needed = [r for r in importlib.metadata.requires("pacinian") or () if "extra ==" not in r]
    return doctor_rules.check_libraries({name: _version(name) for name in map(_name, needed)})


def _name(requirement: str) -> str:
    found = re.match(r"[\w.-]+", requirement)
    return found[0] if found else requirement


def _version(name: str) -> str | None:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None


def extras() -> Finding:
    """Probe the optional libraries: the first missing one of each extra."""
    missing: dict[str, str] = {}
    for requirement in importlib.metadata.requires("pacinian") or ():
        name = _name(requirement)
        asked = re.search(r"extra == ['\"]([\w-]+)", requirement)
        if asked and asked[1] in EXTRAS and name != "pacinian" and _version(name) is None:
            missing.setdefault(asked[1], name)
    return doctor_rules.check_extras(missing)


def curve() -> Finding:
    """Probe ZeroMQ's encryption."""
    import zmq

    return doctor_rules.check_encryption(zmq.has("curve"), zmq.zmq_version())


def kernels() -> Finding:
    """Probe the variant of the kernels in use."""
    from pacinian import native

    return doctor_rules.check_kernels(
        native.VARIANT, native.load(native.__name__, "_plain").level()
    )


def processor() -> Finding:
    """Probe the number of cores."""
    affinity = getattr(os, "sched_getaffinity", None)
    return doctor_rules.check_processor(len(affinity(0)) if affinity else os.cpu_count() or 1)


def plugins() -> Finding:
    """Probe the solvers and backends. Imports all of them."""
    from pacinian.plugins.registry import discover_plugins

    found = discover_plugins()
    thread = threading.Thread(target=found.load, name="plug-ins", daemon=True)
    thread.start()
    thread.join(MAX_IMPORT_TIME)
    failed = [str(error) for error in found.problems.values()]
    if thread.is_alive():
        late = f"has not been imported in {MAX_IMPORT_TIME:g} s"
        failed.append(f"plug-in {found.importing!r} {late}")
    return doctor_rules.check_plugins(len(found.offers), failed)


def port() -> Finding:
    """Probe whether a port can be bound on loopback."""
    try:
        with socket.socket() as listener:
            listener.bind(("127.0.0.1", 0))
            listener.listen()
    except OSError as error:
        return doctor_rules.check_loopback(str(error))
    return doctor_rules.check_loopback("")


def memory() -> Finding:
    """Probe the folder in which the server's processes would share memory."""
    from pacinian.serving.ipc.messages import CAPACITIES, compute_frame_capacity
    from pacinian.serving.ipc.shared_memory import SLOTS, find_root

    folder = find_root()
    needed = SLOTS * (sum(CAPACITIES.values()) + compute_frame_capacity(DEVICES))
    free = shutil.disk_usage(folder).free
    return doctor_rules.check_shared_memory(str(folder), os.access(folder, os.W_OK), free, needed)


def clock() -> Finding:
    """Probe the resolution of the clock and the lateness of sleeps. Takes a fifth of a second."""
    return doctor_rules.check_clock(time.get_clock_info("perf_counter").resolution, list(_late()))


def _late() -> Iterator[float]:
    for _ in range(SLEEPS):
        begin = time.perf_counter()
        time.sleep(SLEEP)
        yield time.perf_counter() - begin - SLEEP


def usb() -> Finding:
    """Probe libusb through pyusb."""
    from usb.backend import libusb1

    return doctor_rules.check_usb(libusb1.get_backend() is not None, sys.platform)


def permissions() -> Finding:
    """Probe the permissions of the USB devices' files."""
    files = list(Path("/dev/bus/usb").glob("*/*"))
    return doctor_rules.check_usb_permissions(len(files), sum(os.access(f, os.W_OK) for f in files))


def file(given: str | None) -> Finding:
    """Probe the connection file."""
    from pacinian.wire.connection_file import Connection, locate_connection

    path, error = locate_connection(given or ""), ""
    if there := path.exists():
        try:
            Connection.read(path)
        except PacinianError as problem:
            error = str(problem)
    return doctor_rules.check_connection_file(str(path), there, error)


def server(given: str | None) -> Finding:
    """Probe the server of the connection file."""
    from pacinian.client.client import Client

    try:
        with Client(given, name="pacinian doctor", timeout=MAX_ANSWER_TIME) as client:
            state = client.status()
            why = client.explain_silence(state)
            return doctor_rules.check_server("", state.output, client.server, str(why or ""))
    except PacinianError as error:
        return doctor_rules.check_server(str(error), "", "")


def air(given: str | None) -> Finding:
    """Probe the air that the server of the connection file assumes."""
    from pacinian.cli.status import describe_air
    from pacinian.client.client import Client

    try:
        with Client(given, name="pacinian doctor", timeout=MAX_ANSWER_TIME) as client:
            return doctor_rules.report_air(describe_air(client.capabilities().sound))
    except PacinianError:  # `server` has reported it already
        return doctor_rules.report_air("not reported")
