from __future__ import annotations

import os
import subprocess
import sys
from typing import NamedTuple

import psutil
import pytest
from msgspec.structs import replace

from pacinian.scene.config_sections import Units
from pacinian.serving.ipc import scheduling
from pacinian.testing import run_server

from ....waiting import PATIENCE
from ..processes import PATIENT

linux = pytest.mark.skipif(
    sys.platform != "linux", reason="only Linux lets a thread choose so much"
)


def told(code: str, *, alone: bool = False) -> list[str]:
    """Run code in another process; return the words that it prints. alone: in its own session."""
    command = [
        sys.executable,
        "-c",
        f"import os\nfrom pacinian.serving.ipc import scheduling\n{code}",
    ]
    done = subprocess.run(
        command,
        capture_output=True,
        check=True,
        text=True,
        timeout=PATIENCE,
        start_new_session=alone,
    )
    if "may not" in done.stdout:
        pytest.skip("may not be urgent here")
    return done.stdout.split()


@linux
def test_threads_are_as_urgent_as_what_made_them_was_then() -> None:
    """Niceness belongs to a thread and is inherited, for example by ZeroMQ's threads."""
    code = """
import zmq
from pathlib import Path

def nice():
    stats = [task.read_text() for task in Path("/proc/self/task").glob("*/stat")]
    return len(stats), {int(stat.rpartition(")")[2].split()[16]) for stat in stats}

try:
    os.setpriority(os.PRIO_PROCESS, 0, -5)
except OSError:
    print("may not")
else:
    scheduling.raise_priority(0)
    before, _ = nice()
    with zmq.Context() as context, context.socket(zmq.PUB):
        after, levels = nice()
        print(after > before, levels)
"""
    assert told(code) == ["True", "{0}"]


@pytest.mark.skipif(
    not scheduling.AUTOGROUP.exists(), reason="only Linux shares time out by session"
)
def test_a_child_is_urgent_among_sessions_too() -> None:
    """Niceness counts only within a session (autogroup), and each child has its own."""
    code = """
def nice():  # nothing is told of what no session was ever made for
    return (scheduling.AUTOGROUP.read_text().split() or ["none"])[-1]

before = nice()
scheduling.raise_priority(3)
print(before, nice())
"""
    for alone, nice in ((True, "-3"), (False, "0")):
        before, after = told(code, alone=alone)
        if alone and after == before:
            pytest.skip("may not be urgent here")
        assert after == (nice if alone else before)


@pytest.mark.skipif(
    not scheduling.AUTOGROUP.exists(), reason="only Linux shares time out by session"
)
def test_a_child_starts_eagerly_among_sessions_too() -> None:
    """Otherwise the start of a guard, or of its spare, would take seconds on a busy machine."""
    code = """
def nice():
    return (scheduling.AUTOGROUP.read_text().split() or ["none"])[-1]

try:
    os.setpriority(os.PRIO_PROCESS, 0, -15)
    if {alone}:
        scheduling.AUTOGROUP.write_text("-1")
except OSError:
    print("may not") or exit()
before = nice()
scheduling.lower_child_priority(os.getpid())
print(before, nice())
"""
    before, after = told(code.format(alone=False))
    assert after == before, "the session of another process is left alone"
    before, after = told(code.format(alone=True), alone=True)
    assert (before, after) == ("-1", f"-{scheduling.EAGER}")


@linux
@pytest.mark.parametrize(("limit", "nice"), [(0, 0), (20, 0), (21, -1), (30, -10), (40, -15)])
def test_who_may_not_be_as_urgent_is_as_urgent_as_may_be(limit: int, nice: int) -> None:
    """RLIMIT_NICE is 20 minus the niceness (setrlimit(2)). It is faked, because it does not bind root."""
    code = f"""
import resource
kept = []

def setpriority(which, who, nice):
    if nice < 20 - {limit}:
        raise PermissionError
    kept.append(nice)

os.setpriority, resource.getrlimit = setpriority, lambda which: ({limit}, {limit})
scheduling.raise_priority()
print(*kept or [0])
"""
    assert told(code) == [str(nice)]


@linux
def test_who_may_ask_for_nothing_keeps_what_was_given() -> None:
    """Like a process that was started by `nice -n -5` and then lost its rights."""
    code = """
import resource
try:
    os.setpriority(os.PRIO_PROCESS, 0, -5)
except OSError:
    print("may not") or exit()
allowed = os.setpriority

def setpriority(which, who, nice):
    if nice < -5:
        raise PermissionError
    allowed(which, who, nice)

os.setpriority, resource.getrlimit = setpriority, lambda which: (0, 0)
scheduling.raise_priority()
print(os.getpriority(os.PRIO_PROCESS, 0))
"""
    assert told(code) == ["-5"]


@linux
def test_a_child_is_less_urgent_until_it_asks() -> None:
    """This holds for any niceness of control, which the child inherits."""
    code = """
try:
    os.setpriority(os.PRIO_PROCESS, 0, -scheduling.URGENT)
except OSError:
    print("may not") or exit()
scheduling.lower_child_priority(os.getpid())
print(os.getpriority(os.PRIO_PROCESS, 0))
scheduling.raise_priority()
print(os.getpriority(os.PRIO_PROCESS, 0))
os.setpriority(os.PRIO_PROCESS, 0, 3)
scheduling.lower_child_priority(os.getpid())
print(os.getpriority(os.PRIO_PROCESS, 0))
"""
    assert told(code) == ["-5", "-15", "3"]


@linux
@pytest.mark.parametrize(("limit", "after"), [(20, -10), (34, -10), (35, -5), (40, -5)])
def test_who_could_not_ask_again_gives_nothing_back(limit: int, after: int) -> None:
    """Like a process that was started by `nice -n -10` and then lost its rights. The limit is as above."""
    code = f"""
import resource
now = -10

def setpriority(which, who, nice):
    global now
    if nice < min(now, 20 - {limit}):
        raise PermissionError
    now = nice

os.setpriority, resource.getrlimit = setpriority, lambda which: ({limit}, {limit})
os.getpriority = lambda which, who: now
scheduling.lower_child_priority(os.getpid())
print(now)
"""
    assert told(code) == [str(after)]


@linux
def test_what_an_urgent_process_starts_is_not_urgent() -> None:
    asks = "import os; print(os.sched_getscheduler(0) in (os.SCHED_RR, os.SCHED_RR | os.SCHED_RESET_ON_FORK))"
    code = f"""
import subprocess, sys
scheduling.use_realtime_class()
{asks}
sys.stdout.flush()
subprocess.run([sys.executable, "-c", {asks!r}])
"""
    itself, other = told(code)
    assert itself in ("True", "False")  # either, by its rights
    assert other == "False"


@linux
def test_one_that_may_not_go_first_keeps_to_no_processor() -> None:
    code = """
def refused(*_):
    raise PermissionError

before, os.sched_setscheduler = os.sched_getaffinity(0), refused
print(scheduling.use_realtime_class() == scheduling.ANY_CORE, os.sched_getaffinity(0) == before)
scheduling.avoid_cores(scheduling.ANY_CORE)
print(os.sched_getaffinity(0) == before)
"""
    assert told(code) == ["True"] * 3


@linux
def test_the_only_processor_is_shared() -> None:
    code = """
only = max(os.sched_getaffinity(0))
os.sched_setaffinity(0, {only})
import importlib
importlib.reload(scheduling)
print(scheduling.use_realtime_class() == scheduling.ANY_CORE)
scheduling.avoid_cores(only)
print(os.sched_getaffinity(0) == {only})
"""
    assert told(code) == ["True"] * 2


@linux
@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason="wants two processors")
def test_work_beside_runs_on_all_processors_again() -> None:
    code = """
import threading
everywhere, done = os.sched_getaffinity(0), threading.Event()
if len(everywhere) < 2:
    print("may not")
else:
    scheduling.avoid_cores(min(everywhere))
    print(os.sched_getaffinity(0) == everywhere - {min(everywhere)})
    scheduling.start_background_thread(lambda: print(os.sched_getaffinity(0) == everywhere) or done.set(), "work")
    done.wait()
"""
    assert told(code) == ["True"] * 2


@linux
def test_work_beside_is_less_urgent_than_what_goes_on() -> None:
    code = """
import threading
try:
    os.setpriority(os.PRIO_PROCESS, 0, -15)
except OSError:
    print("may not") or exit()
for nice in (-15, 3):
    os.setpriority(os.PRIO_PROCESS, 0, nice)
    done = threading.Event()
    scheduling.start_background_thread(lambda: print(os.getpriority(os.PRIO_PROCESS, 0)) or done.set(), "work")
    done.wait()
    print(os.getpriority(os.PRIO_PROCESS, 0))
"""
    assert told(code) == ["-5", "-15", "3", "3"]


class Thread(NamedTuple):
    """A thread of a server's process."""

    process: str
    main: bool
    nice: int
    processors: frozenset[int]


@pytest.fixture(scope="module")
def threads() -> tuple[list[Thread], bool]:
    """Return the threads of a running server, and whether its guard has a real-time class."""
    with run_server(replace(PATIENT, array=Units(1, 1))) as server:
        found = [
            Thread(
                name, thread.id == pid, os.getpriority(os.PRIO_PROCESS, thread.id),
                frozenset(os.sched_getaffinity(thread.id)),
            )
            for name, pid in server.pids.items()
            for thread in psutil.Process(pid).threads()
        ]  # fmt: skip
        return found, os.sched_getscheduler(server.pids["guard"]) != os.SCHED_OTHER


@linux
def test_only_the_loop_and_control_go_before_all(threads: tuple[list[Thread], bool]) -> None:
    """Threads that load data for the loop, and the bus, must not take a whole processor from games."""
    before = os.getpriority(os.PRIO_PROCESS, 0)
    try:
        os.setpriority(os.PRIO_PROCESS, 0, before - 1)
    except OSError:
        pytest.skip("may not be urgent here")
    os.setpriority(os.PRIO_PROCESS, 0, before)
    for thread in threads[0]:
        if thread.main and thread.process in ("control", "render"):
            assert thread.nice == -15
        elif thread.process in ("render", "bus"):
            assert thread.nice >= -5


@linux
@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason="wants two processors")
def test_the_guard_and_the_loop_keep_to_different_processors(
    threads: tuple[list[Thread], bool],
) -> None:
    """No other thread of the server is bound to a processor."""
    everywhere, (found, first) = os.sched_getaffinity(0), threads
    guard, loop = (
        next(t.processors for t in found if t.main and t.process == name)
        for name in ("guard", "render")
    )
    rest = [t for t in found if not (t.main and t.process in ("guard", "render"))]
    assert all(thread.processors == everywhere for thread in rest)
    assert {thread.process for thread in rest} == {"control", "bus", "render", "guard"}
    if not first or len(everywhere) < 2:
        assert guard == loop == everywhere
        pytest.skip("may not go first here")
    assert len(guard) == 1
    assert loop == everywhere - guard
