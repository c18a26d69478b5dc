"""The server from its start to its end: what it makes, and takes away again."""

from __future__ import annotations

import contextlib
import functools
import os
import shutil
import signal
import socket
import sys
import threading
from typing import TYPE_CHECKING

import zmq
from msgspec.structs import replace

from pacinian.errors import ServerError
from pacinian.serving import child, memory, priority
from pacinian.serving.control import Control
from pacinian.serving.doors import Doors
from pacinian.serving.logs import configure, flush, log
from pacinian.serving.messages import CAPACITIES, frame_capacity
from pacinian.serving.metrics import Metrics
from pacinian.serving.security import Gate, fresh
from pacinian.serving.supervise import GUARD, SPARE, Supervisor
from pacinian.wire.connection import Connection, where

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from pathlib import Path
    from types import FrameType

    from pacinian.serving.settings import Network, Settings
    from pacinian.serving.supervise import Process


def serve(
    settings: Settings,
    ready: Callable[[Path], object] = lambda path: None,
    start: Callable[[str, child.Told], Process] = child.start,
    ending: threading.Event | None = None,
) -> None:
    """Run the server until SIGTERM, Ctrl-C or `ending`; then silence, always.

    ready: called with the connection file once clients may come. start: starts one of the other processes.
    Raises ServerError.
    """
    ending = ending or threading.Event()
    path = where(settings.connection)
    _alone(path)
    configure(settings.log, "control")
    _many_files()
    with contextlib.ExitStack() as stack:
        stack.callback(flush)
        stack.enter_context(_signals(ending))
        secrets = fresh(settings)
        folder = memory.folder()
        stack.callback(shutil.rmtree, folder, ignore_errors=True)
        capacities = {**CAPACITIES, "frame": frame_capacity(len(settings.array.make()))}
        files = {
            name: stack.enter_context(memory.Latest.create(folder / name, capacity))
            for name, capacity in capacities.items()
        }
        priority.urgent()  # a stop is answered whatever the others do; threads of ZeroMQ take it over
        context: zmq.Context[zmq.Socket[bytes]] = stack.enter_context(zmq.Context())
        gate = stack.enter_context(Gate(context, secrets, settings.security.keys))
        doors = stack.enter_context(Doors(context, gate, settings.network))
        command = settings.network.command or _free(settings.network)
        network = replace(
            settings.network, control=doors.control, command=command, state=doors.state
        )
        told = child.Told(str(folder), replace(settings, network=network))
        connection = _connection(network, secrets)

        def begin(name: str, spare: int) -> Process:
            if name == SPARE:
                return start(GUARD, replace(told, spare=spare))
            # the others have no socket
            return start(name, replace(told, secrets=secrets) if name == "bus" else told)

        supervisor = Supervisor(begin, settings.safety.hung)
        stack.callback(_end, supervisor)
        control = Control(settings, doors, files, supervisor)
        stack.enter_context(_metrics(settings, control, doors))
        try:
            while not ending.is_set():
                control.round()
                if control.ready and not supervisor.trusted:
                    supervisor.trusted = True
                    connection.write(path)
                    stack.callback(connection.remove, path)
                    log().info("ready", connection=str(path))
                    notify("READY=1")
                    ready(path)
        finally:
            notify("STOPPING=1")
            control.let_go()
            log().info("end")


def _alone(path: Path) -> None:
    """Refuse to take the connection file from a server that runs."""
    try:
        other = Connection.read(path)
    except ServerError:
        return
    if other.pid != os.getpid():
        raise ServerError(
            f"{path} is of a server that runs (process {other.pid}): end it, or choose another file "
            "with `--connection`; if that process is no server, remove the file"
        )


def _many_files() -> None:
    """Each connection takes a file: let there be as many as the system allows."""
    if sys.platform == "win32":
        return
    import resource

    most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    with contextlib.suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))


def _end(supervisor: Supervisor) -> None:
    for name in supervisor.end():
        log().error("had to be killed", name=name)


def _metrics(
    settings: Settings, control: Control, doors: Doors
) -> contextlib.AbstractContextManager[object]:
    if not settings.metrics.port:
        return contextlib.nullcontext()
    return Metrics(
        settings.metrics.port,
        lambda: (control.newest, {**control.counts, **doors.counts}, control.view.traffic),
    )


def _connection(network: Network, secrets: dict[str, str]) -> Connection:
    at = functools.partial(network.endpoint, local=True)
    return Connection(
        pid=os.getpid(),
        control=at(network.control),
        command=at(network.command),
        state=at(network.state),
        token=secrets.get("token", ""),
        server_key=secrets.get("server_key", ""),
        public_key=secrets.get("public_key", ""),
        secret_key=secrets.get("secret_key", ""),
    )


def _free(network: Network) -> int:
    """A port that nobody listens on, for the bus: the same when it is started again."""
    family = socket.AF_INET6 if ":" in network.host else socket.AF_INET
    try:
        with socket.socket(family) as probe:
            probe.bind((network.host, 0))
            return int(probe.getsockname()[1])
    except OSError as error:
        raise ServerError(f"{network.host} cannot be bound: {error.strerror}") from error


@contextlib.contextmanager
def _signals(ending: threading.Event) -> Generator[None]:
    """SIGTERM and Ctrl-C end the server in order, not where it happens to be."""

    def asked(number: int, frame: FrameType | None) -> None:
        ending.set()

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    names = [getattr(signal, n) for n in ("SIGTERM", "SIGINT", "SIGBREAK") if hasattr(signal, n)]
    before = {name: signal.signal(name, asked) for name in names}
    try:
        yield
    finally:
        for name, handler in before.items():
            signal.signal(name, handler)


def notify(state: str) -> None:
    """Tell systemd, if it wants to know: sd_notify(3)."""
    address = os.environ.get("NOTIFY_SOCKET", "")
    if not address or not hasattr(socket, "AF_UNIX"):
        return
    name = "\0" + address[1:] if address.startswith("@") else address
    with contextlib.suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as to:
        to.sendto(state.encode(), name)
