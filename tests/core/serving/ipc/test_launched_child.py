from __future__ import annotations

import json
import os
import secrets
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import psutil
import pytest

from pacinian.errors import ServerError
from pacinian.serving.ipc import launch_config, launched_child
from pacinian.serving.ipc.child_pipe import ChildPipe, ChildPipes
from pacinian.serving.ipc.launch_config import LaunchConfig
from pacinian.serving.settings import Settings

from ....waiting import PATIENCE, eventually
from ..processes import runs

posix = pytest.mark.skipif(os.name != "posix", reason="limits of open files")
linux = pytest.mark.skipif(sys.platform != "linux", reason="the system kills orphans on Linux only")

CHILD = """
import ctypes, sys, threading, time
from pathlib import Path
from pacinian.serving.ipc import parent_link
gone = threading.Event()
parent = parent_link.Parent()
told = parent.config
if told.spare:
    parent.prepare()
    threading.Thread.start = None  # as where the system permits no more threads
    (told.path / "ready").touch()
    parent.wait()
parent.watch(gone.set, kill={kill})
at = told.path
(at / "told").write_text(repr((told.secrets, told.settings.rate, sys.stdin.read())))
{work}
"""
WAITS = "gone.wait(); (at / 'orphaned').touch()"
# PyDLL keeps the interpreter's lock
STUCK = "(at / 'stuck').touch(); ctypes.PyDLL(None).sleep(600)"
PARENT = """
import sys, time
from pacinian.serving.ipc import launch_config, launched_child
from pacinian.serving.settings import Settings
config = launch_config.LaunchConfig(sys.argv[2], Settings())
started = launched_child.start_command([sys.executable, "-c", sys.argv[1]], config)
print(started.pid, flush=True)
time.sleep(600)
"""
FULL = """
import os, resource, subprocess, sys, time
from pathlib import Path
from pacinian.serving.ipc import launch_config, launched_child
from pacinian.serving.ipc.child_pipe import ChildPipes
from pacinian.serving.settings import Settings
told = Path(sys.argv[2]) / "told"
config = launch_config.LaunchConfig(sys.argv[2], Settings(), {"long": "x" * 300_000})
with ChildPipes(1) as pipes:
    resource.setrlimit(resource.RLIMIT_NOFILE, (64, 64))
    for _ in range(3):
        try:
            while True:
                os.open(os.devnull, os.O_RDONLY)
        except OSError:
            print("full")
        command = [sys.executable, "-c", "import time; time.sleep(600)"]  # does not read
        deaf = launched_child.start_command(command, config, pipes.take())
        deaf.kill()
        deaf.wait()
        child = launched_child.start_command([sys.executable, "-c", sys.argv[1]], config, pipes.take())
        while not told.exists():
            time.sleep(0.01)
        print("told")
        child.kill()
        print(child.wait())
        told.unlink()
"""

FORKED = """
import json, os, sys, threading
from pathlib import Path
from pacinian.serving.ipc import launch_config, launched_child, parent_link
from pacinian.serving.ipc.child_pipe import ChildPipes
from pacinian.serving.settings import Settings

def report(parent):
    told = parent.config
    files = [name for name in os.listdir("/dev/fd") if Path(f"/dev/fd/{name}").exists()]
    (told.path / told.secrets["name"]).write_text(json.dumps([
        told.settings.rate, sorted(map(int, files)), os.getsid(0) == os.getpid(), sys.path, threading.active_count(),
        os.environ.get("PYTHONSAFEPATH"),
    ]))
    parent.wait()

def run(name, later):
    report(parent_link.Parent())

launched_child.run_module = run
folder = Path(sys.argv[1])
kept = os.open(folder, os.O_RDONLY)
sys.path.insert(0, str(folder / "beside the program"))
with ChildPipes(3) as pipes, launched_child.ForkedChildren(("guard", "guard"), pipes) as forked:
    config = launch_config.LaunchConfig(str(folder), Settings(rate=500.0), {"name": "first"})
    first = forked.take("guard", config)
    assert forked.take("bus", config) is None
    [(_, second)] = forked._waiting
    print(first.pid, second.pid, flush=True)
    sys.stdin.readline()
    first.close()
    print(first.wait(), second.poll(), flush=True)
print(second.poll(), flush=True)
"""


def source(work: str, *, kill: bool = True) -> str:
    return textwrap.dedent(CHILD).format(work=work, kill=kill)


def launched(work: str, folder: Path, **given: str) -> launched_child.LaunchedChild:
    told = LaunchConfig(str(folder), Settings(rate=500.0), given)
    return launched_child.start_command([sys.executable, "-c", source(work)], told)


def test_a_child_is_told_and_ends_when_its_standard_input_does(tmp_path: Path) -> None:
    token = secrets.token_hex()  # a word may be in the environment by chance
    process = launched(WAITS, tmp_path, token=token)
    eventually((tmp_path / "told").exists)
    assert process.poll() is None
    known = psutil.Process(process.pid)
    assert token not in " ".join([*known.cmdline(), *known.environ().values()])
    if os.name == "posix":  # so that only the parent handles Ctrl-C
        assert os.getpgid(process.pid) != os.getpgid(0)
    assert launched_child.end_child(process, PATIENCE) == 0
    assert (tmp_path / "orphaned").exists()
    # so that a plug-in in the child finds nothing to read there
    assert (tmp_path / "told").read_text() == repr(({"token": token}, 500.0, ""))


@linux
def test_a_child_that_does_not_end_is_killed(tmp_path: Path) -> None:
    process = launched(STUCK, tmp_path)
    eventually((tmp_path / "stuck").exists)
    assert launched_child.end_child(process, 0.05) == -signal.SIGKILL


def test_a_child_that_dies_at_once_is_no_error_of_its_parent(tmp_path: Path) -> None:
    told = LaunchConfig(str(tmp_path), Settings(), {"long": "x" * 500_000})
    process = launched_child.start_command([sys.executable, "-c", "raise SystemExit(3)"], told)
    assert launched_child.end_child(process, PATIENCE) == 3


def test_a_child_that_reads_nothing_does_not_hold_up_its_parent(tmp_path: Path) -> None:
    told = LaunchConfig(
        str(tmp_path), Settings(), {"long": "x" * 900_000}
    )  # more than a pipe holds
    process = launched_child.start_command(
        [sys.executable, "-c", "import time; time.sleep(600)"], told
    )
    assert process.poll() is None, "it went on only once the child had ended"
    process.kill()
    launched_child.end_child(process, PATIENCE)


def test_a_spare_waits_until_it_is_called(tmp_path: Path) -> None:
    told = LaunchConfig(str(tmp_path), Settings(rate=500.0), spare=1)
    process = launched_child.start_command([sys.executable, "-c", source(WAITS)], told)
    eventually((tmp_path / "ready").exists)
    process.activate()
    eventually((tmp_path / "told").exists)
    assert launched_child.end_child(process, PATIENCE) == 0
    assert (tmp_path / "orphaned").exists()


def test_a_spare_that_is_not_called_ends_with_its_parent(tmp_path: Path) -> None:
    told = LaunchConfig(str(tmp_path), Settings(), spare=1)
    process = launched_child.start_command([sys.executable, "-c", source(WAITS)], told)
    eventually((tmp_path / "ready").exists)
    assert launched_child.end_child(process, PATIENCE) == 0
    assert not (tmp_path / "told").exists()


def test_what_a_child_is_told_arrives_in_order_and_holds_up_nobody(tmp_path: Path) -> None:
    """Send more than a pipe holds at once."""
    told = LaunchConfig(str(tmp_path), Settings(rate=500.0), {"long": "x" * 900_000}, spare=1)
    process = launched_child.start_command([sys.executable, "-c", source(WAITS)], told)
    process.activate()
    eventually((tmp_path / "told").exists)
    assert launched_child.end_child(process, PATIENCE) == 0


@posix
def test_where_no_more_files_are_permitted_children_are_started(tmp_path: Path) -> None:
    """And again after each end, whatever the one before has not read."""
    command = [sys.executable, "-c", FULL, source(WAITS), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert done.stdout.split() == ["full", "told", "-9"] * 3, done.stderr


def test_a_pipe_has_one_child_at_a_time(tmp_path: Path) -> None:
    told = LaunchConfig(str(tmp_path), Settings(rate=500.0))
    with ChildPipes(1) as pipes:
        first = launched_child.start_command(
            [sys.executable, "-c", source(WAITS)], told, pipes.take()
        )
        with pytest.raises(ServerError, match="not ended yet"):
            pipes.take()
        first.kill()
        first.wait(PATIENCE)
        (tmp_path / "told").unlink(missing_ok=True)
        second = launched_child.start_command(
            [sys.executable, "-c", source(WAITS)], told, pipes.take()
        )
        eventually((tmp_path / "told").exists)
        assert launched_child.end_child(second, PATIENCE) == 0
    assert (tmp_path / "orphaned").exists()


def test_what_is_told_after_the_end_closes_no_other_file() -> None:
    pipe = ChildPipe()
    pipe.close()
    with Path(__file__).open("rb") as other:  # it gets the number of one of the ends
        for _ in range(3):
            pipe.write(b"!")
        assert other.read(1)
    pipe.close()


def test_nothing_is_imported_from_the_folder_of_the_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It may be another user's."""
    (tmp_path / "msgspec.py").write_text("import pathlib; pathlib.Path('imported').touch()")
    monkeypatch.chdir(tmp_path)
    child = launched_child.start_child("guard", LaunchConfig(str(tmp_path / "none"), Settings()))
    assert child.wait(PATIENCE) == 1
    child.close()
    assert not (tmp_path / "imported").exists()


@posix
def test_a_child_does_not_inherit_the_files_of_its_parent(tmp_path: Path) -> None:
    ends = os.pipe()
    os.set_inheritable(ends[1], True)  # as the shell may have left it
    with ChildPipes(1) as pipes:
        told = LaunchConfig(str(tmp_path), Settings())
        child = launched_child.start_command(
            [sys.executable, "-c", source(WAITS)], told, pipes.take()
        )
        os.close(ends[1])
        assert os.read(ends[0], 1) == b"", "the child holds the other end"
        os.close(ends[0])
        child.kill()
        child.wait(PATIENCE)


def test_where_no_more_threads_are_permitted_no_child_is_left(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spare = launched(WAITS, tmp_path)
    monkeypatch.setattr("threading.Thread.start", refuse_thread)
    before = set(psutil.Process().children())
    with pytest.raises(ServerError, match="did not receive"):
        launched(WAITS, tmp_path)
    assert set(psutil.Process().children()) == before
    spare.activate()
    monkeypatch.undo()
    spare.activate()
    assert launched_child.end_child(spare, PATIENCE) == 0


def refuse_thread(_: object) -> None:
    raise RuntimeError("can't start new thread")


def test_secrets_are_not_shown() -> None:
    assert "hidden" not in repr(LaunchConfig("folder", Settings(), {"token": "hidden"}))


def test_more_than_a_child_reads_is_not_sent(tmp_path: Path) -> None:
    told = LaunchConfig(str(tmp_path), Settings(), {"long": "x" * launch_config.MAX_CONFIG_BYTES})
    with pytest.raises(ServerError, match="more than"):
        launched_child.start_command(["nothing"], told)


def test_a_path_that_is_not_unicode_is_named(tmp_path: Path) -> None:
    told = LaunchConfig(str(tmp_path), Settings(connection="/tmp/caf\udce9.json"))
    with pytest.raises(ServerError, match=r"caf.*rename that file or folder"):
        launched_child.start_command(["nothing"], told)


@pytest.mark.parametrize("data", [b"", b"\x05\0\0\0{", b"\x02\0\0\0{}", b"\xff\xff\xff\xff{}"])
def test_a_child_that_is_told_nonsense_ends(data: bytes, tmp_path: Path) -> None:
    command = [sys.executable, "-c", source(WAITS)]
    done = subprocess.run(command, input=data, capture_output=True, check=False, timeout=PATIENCE)
    assert done.returncode == 1
    assert b"no valid launch configuration" in done.stderr


@linux
def test_a_forked_child_has_only_what_a_spawned_one_has(tmp_path: Path) -> None:
    command = [sys.executable, "-c", FORKED, str(tmp_path)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as parent:
        assert parent.stdin is not None
        assert parent.stdout is not None
        first, second = map(int, parent.stdout.readline().split())
        eventually(lambda: (tmp_path / "first").exists() and (tmp_path / "first").read_text())
        rate, files, own, path, threads, safe = json.loads((tmp_path / "first").read_text())
        assert rate == 500.0
        assert len(files) == 4, "standard files and the pipe"
        assert own
        assert not any("beside the program" in folder for folder in path)
        assert (threads, safe) == (1, "1")
        assert "pacinian.serving.guard.process" in " ".join(psutil.Process(first).cmdline())
        assert runs(second)
        parent.stdin.write("\n")
        parent.stdin.flush()
        assert parent.stdout.readline().split() == ["0", "None"]
        # one that was never configured is ended
        assert parent.stdout.readline().split() == [str(-signal.SIGKILL)]
        assert parent.wait(PATIENCE) == 0


FORK = """
import atexit, os, signal, sys, threading, time
from pacinian.serving.ipc.processes import fork_process
source, sink = os.pipe()
signal.signal(signal.SIGTERM, lambda *_: None)
"""


@linux
@pytest.mark.parametrize(
    ("work", "code", "said"),
    [
        ("None", 0, ""),
        ("sys.exit()", 0, ""),
        ("sys.exit(3)", 3, ""),
        ("sys.exit(1 << 70)", 0, ""),
        ("sys.exit('why')", 1, "why"),
        ("1 / 0", 1, "ZeroDivisionError"),
        ("os.kill(os.getpid(), 9)", -9, ""),
        ("(os.kill(os.getpid(), 15), time.sleep(600))", -15, ""),
    ],
)
def test_a_forked_process_ends_as_a_program_does(work: str, code: int, said: str) -> None:
    program = f"""{FORK}
print("once", end="")
print(fork_process(lambda: {work}, ["child"], source).wait())
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert done.stdout == f"once{code}\n"
    assert said in done.stderr
    assert bool(done.stderr) == bool(said)


@linux
def test_a_forked_process_waits_for_its_threads_and_does_what_it_has_registered() -> None:
    program = f"""{FORK}
def run():
    atexit.register(print, "registered")
    threading.Thread(target=lambda: (time.sleep(0.05), print("thread"))).start()
print(fork_process(run, ["child"], source).wait())
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert done.stdout.split() == ["thread", "registered", "0"]


@linux
@pytest.mark.parametrize("closed", ["", "sys.stdout = None", "sys.stderr = None"])
@pytest.mark.parametrize("work", ["None", "1 / 0", "sys.exit('why')"])
def test_a_copy_never_goes_on_as_its_parent_would(closed: str, work: str) -> None:
    program = f"""{FORK}
parent = os.getpid()
{closed}
try:
    code = fork_process(lambda: {work}, ["child"], source).wait()
finally:
    os.write(1, b"cleaned up\\n")
os._exit(code)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert done.stdout == "cleaned up\n"
    assert done.returncode == int(work != "None")


@linux
def test_a_child_that_waits_ends_silently_with_its_parent() -> None:
    program = """
import os, signal
from pacinian.serving.ipc.child_pipe import ChildPipes
from pacinian.serving.ipc.launched_child import ForkedChildren
forked = ForkedChildren(("guard", "bus"), ChildPipes(2))
print(*(process.pid for _, process in forked._waiting), flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    eventually(lambda: not any(runs(int(pid)) for pid in done.stdout.split()))
    assert done.stderr == ""


@linux
def test_where_no_more_can_be_forked_the_others_are_spawned() -> None:
    program = """
import errno, os
from pacinian.serving.ipc import launched_child
from pacinian.serving.ipc.child_pipe import ChildPipes
fork, made = os.fork, []
def limited():
    if made:
        raise OSError(errno.EAGAIN, "no more")
    made.append(1)
    return fork()
os.fork = limited
with ChildPipes(2) as pipes, launched_child.ForkedChildren(("guard", "bus"), pipes) as forked:
    print([name for name, _ in forked._waiting], pipes.take() is not None)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False
    )
    assert (done.stdout, done.stderr) == ("['guard'] True\n", "")


def orphan(folder: Path, code: str, mark: str) -> int:
    """Start a child whose parent is then killed; return the child's process id."""
    command = [sys.executable, "-c", PARENT, code, str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as parent:
        assert parent.stdout is not None
        number = int(parent.stdout.readline())
        eventually((folder / mark).exists)
        assert runs(number)
        parent.kill()
    return number


@linux
def test_a_child_that_holds_the_interpreter_lock_ends_with_its_parent(tmp_path: Path) -> None:
    number = orphan(tmp_path, source(STUCK), "stuck")
    eventually(lambda: not runs(number))


def test_one_that_may_not_be_killed_is_told_that_its_parent_has_gone(tmp_path: Path) -> None:
    number = orphan(tmp_path, source(WAITS, kill=False), "told")
    eventually(lambda: not runs(number))
    assert (tmp_path / "orphaned").exists()
