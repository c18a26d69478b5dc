"""The server from start to end: it creates all resources, and releases them at the end."""

from __future__ import annotations

import contextlib
import functools
import os
import threading
from typing import TYPE_CHECKING

import msgspec
import zmq
from msgspec.structs import replace

from pacinian.errors import SceneFileError, ServerError
from pacinian.scene.config_sections import Device
from pacinian.serving.control.process import ControlLoop
from pacinian.serving.control.sockets import ControlSockets
from pacinian.serving.control.supervisor import GUARD, SPARE, START_ORDER, Supervisor
from pacinian.serving.ipc import launched_child, scheduling, shared_memory, system_setup
from pacinian.serving.ipc.auth import ClientAuthenticator, make_secrets
from pacinian.serving.ipc.child_pipe import ChildPipes
from pacinian.serving.ipc.file_lock import FileLock, LockHeld
from pacinian.serving.ipc.launch_config import LaunchConfig
from pacinian.serving.ipc.logs import configure, flush, log
from pacinian.serving.ipc.messages import (
    CAPACITIES,
    DeviceStatus,
    compute_frame_capacity,
    open_wakes,
)
from pacinian.serving.ipc.ports import find_free_port
from pacinian.serving.ipc.refused_setting import take_refused_setting
from pacinian.serving.settings import METRICS_HOST
from pacinian.wire.connection_file import (
    Connection,
    check_folder,
    check_replaceable,
    locate_connection,
    make_folder,
)
from pacinian.wire.stop_datagram import StopSocket

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from pathlib import Path

    from pacinian.serving.control.supervisor import SupervisedChild
    from pacinian.serving.ipc.child_pipe import ChildPipe
    from pacinian.serving.ipc.shared_memory import SharedRegister
    from pacinian.serving.settings import Network, Settings

# Largest number of child processes: the server's other processes, the spare guard, and one killed process that has not
# ended yet.
MAX_CHILDREN = 5


def serve(
    settings: Settings,
    ready: Callable[[Path], object] = lambda path: None,
    start_child: Callable[
        [str, LaunchConfig, ChildPipe], SupervisedChild
    ] = launched_child.start_child,
    ending: threading.Event | None = None,
    source: str | Path = "settings",
    fork: bool = False,
) -> None:
    """Run the server until SIGTERM, Ctrl-C or `ending`; then always silence the device.

    ready: called with the connection file once clients can connect. start_child: starts another process.
    source: file that the settings are from, for errors. fork: start the first children by fork (Linux only, and only
    if this process has opened no file). The caller must then be small, and its threads idle. Raises ServerError;
    SceneFileError for settings that a solver or a backend refuses.
    """
    ending = ending or threading.Event()
    system_setup.hold_standard_files()
    # A fork would inherit Python objects whose files are closed in it.
    fork = fork and not system_setup.has_open_files()
    path = locate_connection(settings.connection)
    with contextlib.ExitStack() as stack:
        stack.enter_context(_lock_connection_file(path))
        configure(settings.log, "control")
        system_setup.raise_file_limit()
        stack.callback(flush)
        _check_ports(settings)
        stack.enter_context(system_setup.catch_signals(ending))
        pipes = stack.enter_context(ChildPipes(MAX_CHILDREN))
        forked = stack.enter_context(
            launched_child.ForkedChildren((*START_ORDER, GUARD) if fork else (), pipes)
        )
        secrets = make_secrets(settings)
        folder = stack.enter_context(shared_memory.open_folder())
        stack.enter_context(_name_refused_setting(folder, source))
        settings = _copy_description(settings, folder)
        files = stack.enter_context(_create_registers(settings, folder))
        # The stop is answered whatever the others do; ZeroMQ's threads inherit the priority.
        scheduling.raise_priority()
        context: zmq.Context[zmq.Socket[bytes]] = stack.enter_context(zmq.Context())
        authenticator = stack.enter_context(
            ClientAuthenticator(context, secrets, settings.security.keys)
        )
        stop = stack.enter_context(_open_stop_socket(folder / "stop", secrets))
        sockets = stack.enter_context(
            ControlSockets(context, authenticator, settings.network, stop)
        )
        command = settings.network.command or find_free_port(settings.network.host, 0)
        network = replace(
            settings.network, control=sockets.control, command=command, state=sockets.state
        )
        config = LaunchConfig(str(folder), replace(settings, network=network))
        connection = _describe_connection(network, secrets, stop.address)
        supervisor = Supervisor(
            functools.partial(
                _take_or_start_child, start_child, config, secrets, pipes, forked, set[str]()
            ),
            settings.safety.hang_timeout,
            plugins=_name_plugins(settings),
        )
        stack.callback(_end_children, supervisor, files["device"])
        control = ControlLoop(settings, sockets, files, supervisor)
        stack.enter_context(_serve_metrics(settings, control, sockets))
        try:
            while not ending.is_set():
                control.run_round()
                if control.ready and not supervisor.trusted:
                    supervisor.trusted = True
                    connection.write(path)
                    stack.callback(connection.remove, path)
                    _announce_ready(path, ready)
        finally:
            system_setup.notify_systemd("STOPPING=1")
            control.silence_all()
            sockets.close()  # the files of connections are needed to remove the connection file
            log().info("end")


@contextlib.contextmanager
def _create_registers(settings: Settings, folder: Path) -> Generator[dict[str, SharedRegister]]:
    """Create the shared memory of the processes, by name, for as long as the context lasts."""
    capacities = {**CAPACITIES, "frame": compute_frame_capacity(len(settings.array.make()))}
    with contextlib.ExitStack() as stack:
        yield {
            name: stack.enter_context(
                shared_memory.SharedRegister.create(
                    folder / name, capacity, open_wakes(folder / name)
                )
            )
            for name, capacity in capacities.items()
        }


def _announce_ready(path: Path, ready: Callable[[Path], object]) -> None:
    """Tell the log, systemd and the caller of `serve` that clients can connect; return memory that the start needed."""
    log().info("ready", connection=str(path))
    system_setup.notify_systemd("READY=1")
    ready(path)
    system_setup.trim_memory()


def _take_or_start_child(
    start_child: Callable[[str, LaunchConfig, ChildPipe], SupervisedChild],
    config: LaunchConfig,
    secrets: dict[str, str],
    pipes: ChildPipes,
    forked: launched_child.ForkedChildren,
    started: set[str],
    name: str,
    spare: int,
) -> SupervisedChild:
    """Return another process for `Supervisor`: a forked one, or a new one. The spare guard is a guard that waits.

    started: names of the processes that were started before; gets this one.
    """
    # By the process that is started again. At the first starts, the server ends and names the setting itself.
    if name in started and (refused := take_refused_setting(config.path)):
        log().error("setting refused", key=refused.key, problem=refused.problem)
    started.add(name)
    module = GUARD if name == SPARE else name
    # Only the bus has sockets.
    told = replace(config, spare=spare, secrets=secrets if name == "bus" else {})
    return forked.take(module, told) or start_child(module, told, pipes.take())


@contextlib.contextmanager
def _name_refused_setting(folder: Path, source: str | Path) -> Generator[None]:
    """If a process ended because of a setting, raise SceneFileError, which names it, instead of ServerError."""
    try:
        yield
    except ServerError:
        if refused := take_refused_setting(folder):
            raise SceneFileError(source, f"$.{refused.key}", refused.problem) from None
        raise


def _name_plugins(settings: Settings) -> dict[str, str]:
    """Return the plug-ins that processes start with, by process, for messages."""
    solver, backend = (
        choice if isinstance(choice, str) else choice.name
        for choice in (settings.solver, settings.backend)
    )
    return {"guard": f"the backend {backend!r}", "render": f"the solver {solver!r}"}


def _copy_description(settings: Settings, folder: Path) -> Settings:
    """Give all processes one copy of the device description. The file may change before one of them starts again."""
    if not isinstance(settings.array, Device):
        return settings
    return replace(settings, array=settings.array.copy_to(folder / "array.json"))


def _lock_connection_file(path: Path) -> FileLock:
    """Lock the connection file for this process. Raises ServerError."""
    try:
        make_folder(path.parent)
        check_folder(path.parent)
        lock = FileLock(path.with_name(f"{path.name}.lock"))
    except (OSError, ValueError) as error:  # ValueError: a null byte in the path
        problem = getattr(error, "strerror", None) or error
        raise ServerError(f"{path}: cannot be written: {problem}") from error
    except LockHeld as error:
        raise ServerError(
            f"{path} belongs to a running server (process {error.pid or 'unknown'}): end it, or choose "
            "another file with `--connection`"
        ) from error
    try:
        check_replaceable(path)
    except BaseException:
        lock.close()
        raise
    return lock


def _open_stop_socket(path: Path, secrets: dict[str, str]) -> StopSocket:
    try:
        return StopSocket(path, secrets.get("token") or secrets["secret_key"])
    except OSError as error:
        raise ServerError(
            f"{path}: no socket for emergency stops can be made there: {error.strerror or error}; "
            "make room on that disk, or set TMPDIR to a short path"
        ) from error


def _end_children(supervisor: Supervisor, device: SharedRegister) -> None:
    """End all processes. Raises ServerError if the device may still sound."""

    def has_device(since: float) -> bool:
        read = device.read()
        found = None if read is None else msgspec.msgpack.decode(read[1], type=DeviceStatus)
        return found is not None and found.heartbeat >= since and found.generation > 0

    for name in supervisor.end(has_device):
        log().error("had to be killed", name=name)


def _serve_metrics(
    settings: Settings, control: ControlLoop, sockets: ControlSockets
) -> contextlib.AbstractContextManager[object]:
    if not settings.metrics.port:
        return contextlib.nullcontext()
    from pacinian.serving.control.metrics import Metrics

    return Metrics(
        settings.metrics.port,
        lambda: (control.newest, {**control.counts, **sockets.counts}, control.statuses.bus_status),
    )


def _describe_connection(network: Network, secrets: dict[str, str], stop: str) -> Connection:
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
        stop=stop,
    )


def _check_ports(settings: Settings) -> None:
    """Check that the ports are free, before the slow part of the start. Raises ServerError."""
    network = settings.network
    ports = [(network.host, port) for port in (network.control, network.command, network.state)]
    for host, port in (*ports, (METRICS_HOST, settings.metrics.port)):
        if port:
            find_free_port(host, port)
