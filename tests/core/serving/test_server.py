"""The server's start and end: one server for each connection file, free ports, and nothing left behind."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import pacinian as pc
from pacinian.errors import ArgumentError, ServerError
from pacinian.scene.config_sections import Device, Units
from pacinian.serving.ipc import logs, shared_memory
from pacinian.serving.ipc.shared_memory import LOCK, PREFIX
from pacinian.serving.ipc.system_setup import MIN_FILE_LIMIT
from pacinian.serving.server import serve
from pacinian.serving.settings import Log, Metrics, Network, Settings
from pacinian.testing import run_server
from pacinian.wire.connection_file import Connection, make_folder

from ...waiting import PATIENCE, eventually
from .control.test_supervisor import CHILD, PARENT
from .processes import runs

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    Launch = Callable[[Path], subprocess.Popen[str]]

posix = pytest.mark.skipif(os.name != "posix", reason="signals, and modes of files")
PROCESSES = "control", "guard", "bus", "render"


@pytest.fixture
def launch() -> Iterator[Launch]:
    """Start a server whose other processes only send heartbeats. Its output contains what it prints and logs."""
    with contextlib.ExitStack() as stack:

        def start(connection: Path) -> subprocess.Popen[str]:
            process = subprocess.Popen(
                [sys.executable, "-c", PARENT, str(connection), CHILD],
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            )  # fmt: skip
            stack.enter_context(process)
            stack.callback(process.kill)
            return process

        yield start


def ready(process: subprocess.Popen[str]) -> str:
    """Return the output of the server until it is ready or has ended."""
    assert process.stdout is not None
    lines: list[str] = []
    for line in process.stdout:
        lines.append(line)
        if line.startswith("ready"):
            break
    return "".join(lines)


def refused(settings: Settings) -> str:
    """Return why a server does not start; it must not have started another process."""

    def start(*_: object) -> Any:
        raise AssertionError("a process was started")

    with pytest.raises(ServerError) as caught:
        serve(settings, start_child=start)
    return str(caught.value)


# one server for each connection file


def test_of_servers_that_start_at_the_same_moment_one_has_the_connection_file(
    launch: Launch, tmp_path: Path
) -> None:
    path = tmp_path / "connection.json"
    both = [launch(path), launch(path)]
    said = [ready(process) for process in both]
    (first,) = (process for process, text in zip(both, said, strict=True) if "ready" in text)
    (other,) = (process for process in both if process is not first)
    assert other.wait(PATIENCE) == 1
    assert any(f"{path} belongs to a running server (process {first.pid})" in text for text in said)
    assert Connection.read(path).pid == first.pid


@posix
def test_too_few_open_files_are_told_before_anything_starts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("resource.getrlimit", lambda _: (40, 40))
    monkeypatch.setattr("resource.setrlimit", lambda *_: None)
    said = refused(Settings(connection=str(tmp_path / "connection.json")))
    assert f"40 files, and a server needs {MIN_FILE_LIMIT}: run `ulimit" in said
    assert not list(tmp_path.iterdir())


def test_a_path_that_no_system_allows_is_refused() -> None:
    assert "cannot be written" in refused(Settings(connection="a\0b"))


@posix
@pytest.mark.parametrize("mode", [0o644, 0o600])
def test_while_a_server_runs_its_file_is_not_replaced_whatever_its_mode(
    launch: Launch, tmp_path: Path, mode: int
) -> None:
    path = tmp_path / "connection.json"
    first = launch(path)
    ready(first)
    path.chmod(mode)
    before = path.read_bytes()
    assert f"process {first.pid}" in refused(Settings(connection=str(path)))
    assert path.read_bytes() == before
    first.kill()
    first.wait()
    assert "ready" in ready(launch(path)), "the one that wrote it has gone"
    assert path.stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize("text", ['{"pid": 0}', "[network]\nport = 7001", "\xff"])
def test_what_no_server_of_this_machine_has_written_is_not_replaced(
    tmp_path: Path, text: str
) -> None:
    path = tmp_path / "connection.json"
    remote = Connection(pid=0, control="tcp://a:1", command="tcp://a:2", state="tcp://a:3")
    if text == '{"pid": 0}':
        remote.write(path)
    else:
        path.write_text(text, "latin-1")
    before = path.read_bytes()
    assert str(path) in refused(Settings(connection=str(path)))
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


@posix
def test_a_file_where_nothing_can_be_written_is_told_at_once(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    assert "cannot be" in refused(Settings(connection=str(tmp_path / "file" / "connection.json")))


# ports


@pytest.mark.parametrize("name", ["control", "command", "state", "metrics"])
def test_a_port_that_is_taken_is_told_before_any_process_is_started(
    tmp_path: Path, name: str
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        network = Network() if name == "metrics" else Network(**{name: port})
        metrics = Metrics(port if name == "metrics" else 0)
        path = str(tmp_path / "connection.json")
        why = refused(Settings(network=network, metrics=metrics, connection=path))
    assert f"127.0.0.1:{port} cannot be bound" in why
    assert "\n" not in why


@posix
@pytest.mark.parametrize("name", ["command", "metrics"])
def test_a_port_of_which_connections_linger_is_free(tmp_path: Path, name: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
        with socket.create_connection(("127.0.0.1", port)), listener.accept()[0] as accepted:
            accepted.shutdown(
                socket.SHUT_RDWR
            )  # the side that closes first keeps the port for a minute
    network = Network(command=port) if name == "command" else Network()
    metrics = Metrics(port if name == "metrics" else 0)
    with pytest.raises(AssertionError, match="process was started"):
        refused(
            Settings(network=network, metrics=metrics, connection=str(tmp_path / "connection.json"))
        )


def test_two_sockets_with_one_port_are_refused() -> None:
    with pytest.raises(ArgumentError, match="7001 twice"):
        Settings(network=Network(command=7001), metrics=Metrics(7001))


# what is left


def folder_of(pid: int) -> Path:
    """Return the folder of a server's shared memory, by its first process."""
    locks = Path("/dev/shm").glob(f"{PREFIX}*{LOCK}")
    (lock,) = (lock for lock in locks if lock.read_text() == str(pid))
    return lock.with_suffix("")


def remains(folder: Path) -> list[Path]:
    """Return what is left of a server's shared memory."""
    return list(folder.parent.glob(f"{folder.name}*"))


@posix
@pytest.mark.parametrize("killed", [("control",), ("control", "guard"), PROCESSES], ids="-".join)
def test_whoever_is_killed_with_control_nothing_is_left_after_the_next_start(
    launch: Launch, tmp_path: Path, killed: tuple[str, ...]
) -> None:
    process = launch(tmp_path / "connection.json")
    words = [line.split() for line in ready(process).splitlines()]
    pids = {w[1]: int(w[2]) for w in words if w[0] == "started"} | {"control": process.pid}
    (folder,) = {Path(w[3]) for w in words if w[0] == "started"}
    for name in killed:
        os.kill(pids[name], signal.SIGKILL)
    process.wait()
    eventually(lambda: not any(map(runs, pids.values())))
    # nobody was there to remove it, but the start of another test's server may do so at any time

    def is_removed_by_the_next_start() -> bool:
        with shared_memory.open_folder():
            return not remains(folder)

    eventually(is_removed_by_the_next_start)  # a spare that began after that may still be ending


CONTROL, *OTHERS = PROCESSES
KILLED = [(name,) for name in PROCESSES]
KILLED += [(CONTROL, name) for name in OTHERS] + [tuple(OTHERS), PROCESSES]


@posix
@pytest.mark.deep
@pytest.mark.parametrize("killed", KILLED, ids="-".join)
def test_whichever_processes_are_killed_nothing_is_left_after_the_next_start(
    killed: tuple[str, ...],
) -> None:
    with run_server(Settings(array=Units(1, 1))) as server:
        pids, folder = server.pids, folder_of(server.process.pid)
        assert set(pids) == set(PROCESSES)
        for name in killed:
            os.kill(pids[name], signal.SIGKILL)
        if "control" in killed:
            server.process.wait()
    eventually(lambda: not any(map(runs, pids.values())))
    with shared_memory.open_folder():
        assert not remains(folder)


@posix
@pytest.mark.parametrize("name", ["guard", "render"])
def test_a_process_starts_again_with_the_description_that_the_server_began_with(
    name: str, tmp_path: Path
) -> None:
    """Here, the file has gone. Another array in one process would get gains that are made for the old one."""
    file = tmp_path / "array.toml"
    file.write_text("[[boards]]\ndead = [3]\n", encoding="utf-8")
    with run_server(Settings(array=Device(str(file)))) as server:
        file.unlink()
        with pc.Client(server.connection, timeout=PATIENCE) as client:
            client.put(pc.Point(name="focus", position=(0.09, 0.07, 0.2), radiation_pressure=2.0))
            os.kill(server.pids[name], signal.SIGKILL)
            eventually(lambda: client.status().restarts[name])

            def play() -> None:
                with contextlib.suppress(pc.PacinianError):  # tells of the fault
                    client.reset()
                    client.arm()
                client.renew()

            eventually(lambda: client.status().output == "sounding", play)
            assert client.status().restarts[name] == 1


@pytest.mark.skipif(sys.platform != "linux", reason="processes are forked on Linux only")
@pytest.mark.parametrize("name", ["SIGTERM", "SIGINT"])
def test_a_signal_while_processes_are_forked_ends_the_server(name: str, tmp_path: Path) -> None:
    program = f"""
import os, signal
fork = os.fork
def fork_then_ask():
    pid = fork()
    if pid:
        os.kill(os.getpid(), signal.{name})
    return pid
os.fork = fork_then_ask
from pacinian.cli.main import main
main()
"""
    file = tmp_path / "connection.json"
    done = subprocess.run(
        [sys.executable, "-c", program, "serve", "--connection", str(file)],
        capture_output=True, text=True, check=False, timeout=PATIENCE,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    assert "Exception" not in done.stderr
    assert not file.exists()


@pytest.mark.skipif(sys.platform != "linux", reason="processes are forked on Linux only")
@pytest.mark.parametrize("keeps_file", [False, True])
def test_nothing_is_forked_that_would_lose_its_files(keeps_file: bool, tmp_path: Path) -> None:
    """A plug-in, or Python's own start, may have opened some: a copy's numbers would belong to other files."""
    program = f"""
import os
kept = open(os.devnull) if {keeps_file} else None
fork, made = os.fork, []
def counted():
    pid = fork()
    made.append(pid)
    return pid
os.fork = counted
import threading
from pacinian.serving.server import serve
from pacinian.serving.settings import Log, Settings
ending = threading.Event()
settings = Settings(connection={str(tmp_path / "here.json")!r}, log=Log(level="error"))
serve(settings, lambda path: ending.set(), ending=ending, fork=True)
print(len(made))
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert done.stdout.split() == ["0" if keeps_file else "4"], done.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="processes are forked on Linux only")
def test_a_forked_process_imports_nothing_from_the_folder_of_the_start(tmp_path: Path) -> None:
    """`python -m` puts that folder first."""
    (tmp_path / "setproctitle.py").write_text("raise SystemExit('imported')")
    program = "from pacinian.cli.main import main; main()"
    with subprocess.Popen(
        [sys.executable, "-c", program, "serve", "--connection", str(tmp_path / "here.json")],
        cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    ) as server:  # fmt: skip
        assert server.stdout is not None
        assert server.stdout.readline().startswith("ready")
        server.terminate()
        _, said = server.communicate(timeout=PATIENCE)
    assert "imported" not in said
    assert server.returncode == 0


@posix
@pytest.mark.parametrize("name", ["SIGTERM", "SIGINT", "SIGHUP"])
def test_a_signal_ends_the_server_in_order(launch: Launch, tmp_path: Path, name: str) -> None:
    """SIGHUP comes when the terminal is closed."""
    connection = tmp_path / "c.json"
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)  # ignored under nohup
    try:
        process = launch(connection)
    finally:
        signal.signal(signal.SIGHUP, before)
    eventually(connection.exists)
    process.send_signal(getattr(signal, name))
    process.communicate(timeout=PATIENCE)
    assert process.returncode == 0
    assert not connection.exists()


@posix
def test_no_file_gets_the_number_of_a_standard_file_that_was_closed(tmp_path: Path) -> None:
    """Otherwise what a library prints goes into that file, or to a device."""
    code = (
        "import os, sys; from pacinian.serving.ipc.system_setup import hold_standard_files; hold_standard_files();"
        "file = os.open(sys.argv[1], os.O_CREAT | os.O_WRONLY); os.write(file, str(file).encode());"
        "os.system('echo heard >&1; echo heard >&2')"
    )
    command = ["sh", "-c", 'exec "$0" -c "$1" "$2" <&- >&- 2>&-', sys.executable, code]
    subprocess.run([*command, str(tmp_path / "a")], check=False, timeout=PATIENCE)
    assert int((tmp_path / "a").read_text()) > 2


def test_a_log_without_standard_error_loses_lines_only(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stderr", None)
    logs.configure(Log(), "control")
    logs.log().error("nobody hears this")
    logs.flush()


@posix
@pytest.mark.parametrize("what", ["a pipe", "another user's"])
def test_a_lock_that_is_not_a_file_of_this_user_is_refused(
    tmp_path: Path, what: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    lock = tmp_path / "connection.json.lock"
    if what == "a pipe":
        os.mkfifo(lock)
    else:
        lock.touch()
        monkeypatch.setattr("os.geteuid", lambda: 4321)
    said = refused(Settings(connection=str(tmp_path / "connection.json")))
    assert f"{lock} is not a file of this user: remove it, or choose another" in said


@posix
def test_missing_folders_are_made_for_this_user_only(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        make_folder(tmp_path / "a" / "b")
    finally:
        os.umask(before)
    assert [path.stat().st_mode & 0o777 for path in (tmp_path / "a", tmp_path / "a" / "b")] == [
        0o700
    ] * 2


@posix
def test_a_folder_that_a_group_can_change_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tmp_path.chmod(0o770)
    settings = Settings(connection=str(tmp_path / "connection.json"))
    monkeypatch.setattr("os.getgid", lambda: 4321)
    if tmp_path.stat().st_gid == 0:
        os.chown(tmp_path, -1, 1234)
    assert "can be changed by a group of users" in refused(settings)


def test_without_a_folder_for_the_connection_file_it_says_what_to_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def bad(_: str) -> Path:
        raise PermissionError("/tmp/runtime-1 belongs to another user")

    monkeypatch.delenv("PACINIAN_CONNECTION", raising=False)
    monkeypatch.setattr("platformdirs.user_runtime_path", bad)
    said = refused(Settings())
    assert "/tmp/runtime-1 belongs to another user" in said
    assert "`--connection`" in said


def test_without_room_for_the_stop_socket_it_says_what_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def bad(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pacinian.serving.server.StopSocket", bad)
    said = refused(Settings(connection=str(tmp_path / "connection.json")))
    assert (
        "stop: no socket for emergency stops can be made there: No space left on device; make"
        in said
    )


GUARD_ENDS_FIRST = """
import sys, time
from pacinian.serving.ipc.launched_child import start_child
from pacinian.serving.server import serve
from pacinian.serving.settings import Settings

def start(name, config, pipe):
    child = start_child(name, config, pipe)
    while name == "guard" and child.poll() is None:
        time.sleep(0.01)
    return child

serve(Settings(connection=sys.argv[1], rate=15.0), start_child=start, source="server.toml")
"""


@pytest.mark.deep
def test_a_refused_setting_is_named_although_its_process_ends_before_others_start(
    tmp_path: Path,
) -> None:
    """On a busy machine, the error then named the process, and not the setting."""
    command = [sys.executable, "-c", GUARD_ENDS_FIRST, str(tmp_path / "c.json")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert "SceneFileError: server.toml: $.rate: " in done.stderr
    assert "setting refused" not in done.stderr
    assert done.returncode == 1
