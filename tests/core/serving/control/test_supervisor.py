"""Starting, watching, restarting and ending the other processes."""

from __future__ import annotations

import contextlib
import itertools
import math
import os
import re
import signal
import socket
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import psutil
import pytest

from pacinian.errors import ServerError
from pacinian.serving.control.supervisor import (
    BACKOFF_RESET_TIME,
    MAX_FIRST_HEARTBEAT_TIME,
    MAX_RESTART_DELAY,
    MAX_SOUNDING_START_TIME,
    MIN_RESTART_DELAY,
    SLOW_START_TIME,
    Supervisor,
)
from pacinian.serving.ipc.hang_detection import (
    MAX_CHECK_GAP,
    SOUNDING_HANG_DIVISOR,
    compute_sounding_hang_limit,
)
from pacinian.serving.ipc.logs import flush
from pacinian.testing import ManualClock
from pacinian.wire.connection_file import Connection

from ....waiting import PATIENCE, eventually
from ..processes import runs

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

posix = pytest.mark.skipif(os.name != "posix", reason="signals")
NAMES = "guard", "bus", "render"
UNIT = Path(__file__).parents[4] / "packaging" / "pacinian.service"
LOOK = 0.02  # time between two checks [s]

CHILD = """
import sys, time, threading
from pacinian.serving.ipc import parent_link
from pacinian.serving.ipc.shared_memory import SharedRegister
from pacinian.serving.ipc.messages import BusStatus, DeviceStatus, RendererStatus, pack
from pacinian.wire.replies import Plugin
ended = threading.Event()
parent, name = parent_link.Parent(), sys.argv[1]
told = parent.config
if told.spare:
    parent.wait()
parent.watch(ended.set)
files = {"guard": "device", "bus": "bus_status", "render": "renderer_status"}
with SharedRegister.attach(told.path / files[name]) as file:
    while not ended.is_set():
        now = time.perf_counter()
        file.write(pack({
            "guard": DeviceStatus(1, 0, "", 16, 16, 1e3, None, now, False),
            "bus": BusStatus(now), "render": RendererStatus(now, {}, solvers=(Plugin(name="auto"),)),
        }[name]))
        time.sleep(0.005)
print("ended", name, flush=True)
"""
PARENT = """
import sys
from pacinian.serving.ipc import launched_child
from pacinian.serving.server import serve
from pacinian.serving.settings import Log, Safety, Settings
def start(name, told, pipe):
    process = launched_child.start_command([sys.executable, "-c", sys.argv[2], name], told, pipe)
    name = "spare" if told.spare else name
    print("started", name, process.pid, told.folder, flush=True)
    return process
settings = Settings(connection=sys.argv[1], safety=Safety(hang_timeout=3.0), log=Log(level="error"))
serve(settings, lambda path: print("ready", path, flush=True), start)
"""


class Fake:
    """A process that only has an exit code. log: all calls of all fakes. clock: shows how long they are waited for."""

    pid = 7

    def __init__(
        self, name: str, log: list[tuple[str, str]], clock: ManualClock, stubborn: bool = False
    ) -> None:
        self.name, self.log, self.clock, self.stubborn = name, log, clock, stubborn
        self.held = False  # whether the system keeps it alive even after a kill
        self.late = False  # whether it is still alive when the wait for its end is over
        self.code: int | None = None

    def poll(self) -> int | None:
        return self.code

    def activate(self) -> None:
        self.log.append(("call", self.name))

    def close(self) -> None:
        self.log.append(("close", self.name))

    def kill(self) -> None:
        self.log.append(("kill", self.name))
        self.code = None if self.held else -9

    def wait(self, timeout: float | None = None) -> int:
        self.log.append(("wait", self.name))
        if self.code is None and (self.stubborn or self.held):
            assert timeout is not None, "it would wait for ever"
            self.clock.advance(timeout)
            if self.late and ("kill", self.name) in self.log:
                self.code = -9
            raise subprocess.TimeoutExpired(self.name, timeout)
        self.code = self.code or 0
        return self.code


class Watch:
    """A supervisor of fake processes, on a manual clock."""

    def __init__(
        self, stubborn: tuple[str, ...] = (), plugins: dict[str, str] | None = None
    ) -> None:
        self.clock = ManualClock(50.0)
        self.log: list[tuple[str, str]] = []
        self.started: list[Fake] = []
        self.stubborn = stubborn
        self.error: Exception | None = None  # the error of each start
        self.supervisor = Supervisor(self._start, 1.0, self.clock.now, plugins)
        self.supervisor.trusted = True

    def _start(self, name: str, spare: int) -> Fake:
        if self.error is not None:
            raise self.error
        self.started.append(Fake(name, self.log, self.clock, name in self.stubborn))
        return self.started[-1]

    def check(self, sound: bool = False, **beats: float) -> list[tuple[str, str]]:
        now = self.clock.time
        return self.supervisor.check({**dict.fromkeys(NAMES, now), **beats}, sound)

    def look(self, seconds: float, **beats: float) -> list[tuple[str, str]]:
        """Check for `seconds`; return the processes that ended."""
        ended: list[tuple[str, str]] = []
        for _ in range(round(seconds / LOOK)):
            self.clock.advance(LOOK)
            ended += self.check(**beats)
        return ended

    def newest(self, name: str) -> Fake:
        return next(fake for fake in reversed(self.started) if fake.name == name)


def test_the_guard_is_started_first_and_ended_last() -> None:
    watch = Watch()
    assert [fake.name for fake in watch.started] == ["guard", "bus", "render"]
    assert watch.supervisor.end() == []
    names = "render", "bus", "guard"
    assert watch.log == [(does, name) for name in names for does in ("close", "wait")]


def test_one_that_does_not_end_when_asked_is_killed_and_the_others_are_ended_all_the_same() -> None:
    watch = Watch(stubborn=("render",))
    assert watch.supervisor.end() == ["render"]
    assert ("kill", "render") in watch.log
    assert all(fake.code is not None for fake in watch.started)


def test_one_that_ended_is_told_once_and_started_again_after_a_while() -> None:
    watch = Watch()
    assert watch.check() == []
    watch.newest("bus").code = 3
    assert watch.check() == [("bus", "ended with exit code 3")]
    assert watch.check() == []
    assert not watch.supervisor.is_alive("bus", watch.clock.time)
    watch.clock.advance(MIN_RESTART_DELAY)
    assert watch.check() == []
    assert watch.newest("bus").code is None
    assert watch.supervisor.restarts == {"guard": 0, "bus": 1, "render": 0}
    watch.newest("render").code = -9
    assert watch.check() == [("render", "was killed by signal 9")]


def test_the_waits_grow_and_are_forgotten_once_it_runs_well() -> None:
    watch = Watch()

    def waited() -> float:
        """Return the time from an end to the next start."""
        watch.newest("bus").code = 1
        assert len(watch.check()) == 1
        began = watch.clock.time
        while watch.newest("bus").code is not None:
            watch.clock.advance(0.001)
            watch.check()
        return watch.clock.time - began

    waits = [waited() for _ in range(10)]
    for a, b in itertools.pairwise(waits):
        assert b == pytest.approx(min(MAX_RESTART_DELAY, 2.0 * a), abs=0.003)
    watch.clock.advance(2.0 * BACKOFF_RESET_TIME)
    assert waited() == pytest.approx(MIN_RESTART_DELAY, abs=0.003)


def test_one_without_a_sign_of_life_is_killed() -> None:
    watch = Watch()
    watch.check()
    beat = watch.clock.time
    assert watch.look(0.98, render=beat) == [], "not yet"
    assert watch.look(0.04, render=beat) == [("render", "hung, and was killed")]
    assert watch.log == [("kill", "render")], "and nobody waits for that"


def test_one_that_is_only_slow_is_left_alone() -> None:
    watch = Watch()
    for _ in range(10):
        beat = watch.clock.time
        assert watch.look(0.9, bus=beat, guard=beat, render=beat) == []


@pytest.mark.parametrize("stood", [1.1, 5.0, 1e4])
def test_where_nobody_looked_silence_proves_nothing(stood: float) -> None:
    """If the machine stopped, or did not run control, the other processes did not run either."""
    watch = Watch()
    watch.look(1.0)
    beat = watch.clock.time
    watch.clock.advance(stood)
    assert watch.check(**dict.fromkeys(NAMES, beat)) == []
    assert watch.look(0.8, **dict.fromkeys(NAMES, beat)) == [], "they may be woken later"
    assert watch.look(0.5) == [], "and are well"
    assert watch.log == []


def test_one_that_hangs_is_found_however_late_the_looks_are() -> None:
    watch = Watch()
    watch.look(0.1)
    beat, looks = watch.clock.time, 0
    while not watch.log:
        watch.clock.advance(0.7)
        watch.check(guard=beat)
        looks += 1
    assert watch.log == [("kill", "guard"), ("call", "spare")]
    assert looks <= math.ceil(1.0 / MAX_CHECK_GAP) + 1


def test_one_that_the_system_holds_is_not_waited_for_and_not_replaced_before_it_ends() -> None:
    watch = Watch()
    old = watch.newest("bus")
    old.held = True
    beat = watch.clock.time
    assert watch.look(1.1, bus=beat) == [("bus", "hung, and was killed")]
    watch.clock.advance(MAX_RESTART_DELAY)
    assert watch.check(bus=beat) == []
    assert watch.newest("bus") is old, "its port is not free"
    old.code = -9
    assert watch.check(bus=beat) == []
    assert watch.newest("bus") is not old
    watch.newest("bus").held = True
    assert watch.supervisor.end() == ["bus"]


# the guard's spare


def with_spare(ready: float = 0.0) -> tuple[Watch, Fake, Fake]:
    """Return a supervisor, its guard, and a spare that was started `ready` seconds ago."""
    watch = Watch()
    assert watch.check() == []
    assert watch.look(ready) == []
    return watch, watch.newest("guard"), watch.newest("spare")


def test_a_spare_is_started_once_all_are_trusted_and_the_guard_lives() -> None:
    watch = Watch()
    watch.supervisor.trusted = False
    assert watch.look(1.0) == []
    watch.supervisor.trusted = True
    assert watch.look(0.5, guard=watch.clock.time - 10.0) == []
    assert [fake.name for fake in watch.started] == ["guard", "bus", "render"]
    watch.look(LOOK)
    assert watch.newest("spare").code is None
    assert watch.supervisor.restarts == dict.fromkeys(NAMES, 0)
    watch.look(1.0)
    assert len(watch.started) == 4


def test_the_spare_takes_over_in_the_same_look() -> None:
    watch, guard, spare = with_spare()
    assert not watch.supervisor.ended
    guard.code = -9
    assert watch.supervisor.ended
    assert watch.check() == [("guard", "was killed by signal 9")]
    assert watch.log == [("call", "spare")]
    assert watch.supervisor.children["guard"].process is spare
    assert watch.supervisor.restarts["guard"] == 1
    assert not watch.supervisor.ended
    old = watch.clock.time - LOOK
    assert watch.look(10 * MIN_RESTART_DELAY, guard=old) == []
    assert len(watch.started) == 4, "first it must live"
    watch.look(LOOK)
    assert watch.newest("spare") is not spare
    spare.code = 1
    assert watch.check() == [("guard", "ended with exit code 1")]
    assert watch.supervisor.restarts["guard"] == 2


def test_spares_of_a_guard_that_ends_again_and_again_are_started_later_and_later() -> None:
    watch, guard, spare = with_spare()
    waits: list[float] = []
    for _ in range(5):
        guard.code = 1
        assert len(watch.check()) == 1
        began, guard = watch.clock.time, spare
        while (spare := watch.newest("spare")) is guard:
            watch.clock.advance(0.001)
            assert watch.check() == []
        waits.append(watch.clock.time - began)
    assert waits == pytest.approx([2**k * MIN_RESTART_DELAY for k in range(5)], abs=0.003)


@pytest.mark.parametrize("spared", [True, False])
def test_a_guard_that_may_have_sounded_is_replaced_at_once_however_often_it_ends(
    spared: bool,
) -> None:
    watch, guard, spare = with_spare()
    waits: list[float] = []
    for _ in range(5):
        watch.check(sound=True)
        guard.code = 1
        if not spared:
            spare.code = 1
        assert "guard" in dict(watch.check())
        began = watch.clock.time
        while watch.supervisor.children["guard"].process is guard:
            watch.clock.advance(0.001)
            watch.check()
        if not spared:
            waits.append(watch.clock.time - began)
        guard = watch.supervisor.children["guard"].process
        while (spare := watch.newest("spare")).code is not None or spare is guard:
            watch.clock.advance(0.001)
            watch.check()
        if spared:
            waits.append(watch.clock.time - began)
    assert waits == pytest.approx([MIN_RESTART_DELAY] * 5, abs=0.003)


def test_a_spare_that_ends_is_told_and_replaced_and_the_guard_goes_on() -> None:
    watch, guard, spare = with_spare()
    spare.code = -9
    assert watch.check() == [("spare", "was killed by signal 9")]
    assert watch.look(MIN_RESTART_DELAY + LOOK) == []
    assert watch.newest("spare") is not spare
    assert watch.supervisor.children["guard"].process is guard
    assert watch.supervisor.restarts["guard"] == 0


def test_without_a_spare_the_guard_is_started_as_the_others_are() -> None:
    watch, guard, spare = with_spare()
    spare.code = guard.code = -9
    assert [name for name, _ in watch.check()] == ["guard", "spare"]
    assert not watch.log, "one that has ended is not called"
    assert watch.look(MIN_RESTART_DELAY + LOOK) == []
    assert watch.newest("guard") is not guard
    assert watch.supervisor.restarts["guard"] == 1


@pytest.mark.parametrize("sound", [True, False])
def test_a_guard_that_may_sound_has_less_time(sound: bool) -> None:
    watch, guard, _ = with_spare()
    beat, since = watch.clock.time, watch.clock.time
    ended: list[tuple[str, str]] = []
    while not ended:
        watch.clock.advance(LOOK)
        ended = watch.check(sound, guard=beat)
    assert ended == [("guard", "hung, and was killed")]
    assert watch.clock.time - since == pytest.approx(
        1.0 / SOUNDING_HANG_DIVISOR if sound else 1.0, abs=2 * LOOK
    )
    assert guard.code == -9
    assert ("kill", "bus") not in watch.log


def test_no_guard_has_less_time_than_it_takes_to_give_a_sign_of_life() -> None:
    assert compute_sounding_hang_limit(0.1) == 0.1
    assert compute_sounding_hang_limit(2.0) == 0.25


def test_a_guard_that_the_system_holds_is_replaced_as_soon_as_it_ends() -> None:
    """Until then, the device is not opened a second time."""
    watch, guard, _ = with_spare()
    guard.held = True
    beat = watch.clock.time
    assert watch.look(2.0, guard=beat) == [("guard", "hung, and was killed")]
    assert watch.log == [("kill", "guard")]
    assert not watch.supervisor.ended
    guard.code = -9
    assert watch.supervisor.ended
    assert watch.check() == []
    assert watch.log[1:] == [("call", "spare")]


def test_a_spare_that_does_not_begin_when_it_is_called_is_killed_and_another_started() -> None:
    """The spare may be stopped, too."""
    watch, guard, spare = with_spare(BACKOFF_RESET_TIME + 1.0)
    guard.code = -9
    watch.check()
    beat = watch.clock.time - LOOK
    assert watch.look(1.1, guard=beat) == [("guard", "did not start, and was killed")]
    assert watch.look(2 * MIN_RESTART_DELAY + LOOK) == []
    assert watch.newest("guard") is not guard
    watch, guard, spare = with_spare()
    guard.code = -9
    watch.check()
    beat = watch.clock.time - LOOK
    assert watch.look(2.0, guard=beat) == [], "one that has just been started may be on its way"
    assert spare.code is None


def test_at_the_end_the_spare_goes_last_because_it_may_be_needed() -> None:
    watch, _, _ = with_spare()
    watch.log.clear()
    watch.supervisor.end()
    assert watch.log[-3:] == [("wait", "guard"), ("kill", "spare"), ("wait", "spare")]


@pytest.mark.parametrize("how", ["hangs", "is killed", "ends by itself"])
@pytest.mark.parametrize("spare", [True, False])
def test_at_the_end_another_guard_opens_the_device_of_one_that_did_not_end_in_order(
    how: str, spare: bool
) -> None:
    watch, guard, other = with_spare()
    guard.stubborn = how == "hangs"
    guard.code = {"hangs": None, "is killed": -9, "ends by itself": 1}[how]
    if not spare:
        other.code = 1
    seen: list[float] = []

    def has_device(since: float) -> bool:
        seen.append(since)
        watch.clock.advance(0.01)
        return len(seen) > 3

    watch.log.clear()
    watch.supervisor.end(has_device)
    new = watch.started[-1]
    assert (new is other) is spare
    assert ("call", "spare") in watch.log or not spare
    assert watch.log.index(("close", new.name), 2) > 2 + spare
    assert new.code == 0
    assert seen == [seen[0]] * 4
    assert all(fake.code is not None for fake in watch.started)


@pytest.mark.parametrize(
    "why", ["it opens nothing", "it ends", "it cannot be started", "the guard stays"]
)
def test_if_the_device_may_still_sound_at_the_end_that_is_an_error(why: str) -> None:
    watch, guard, spare = with_spare()
    guard.stubborn, guard.held = True, why == "the guard stays"

    def has_device(_: float) -> bool:
        watch.clock.advance(1.0)
        if why == "it ends":
            spare.code = 1
        return False

    if why == "it cannot be started":
        spare.code, watch.error = 1, OSError("no memory")
    with pytest.raises(ServerError, match="may still sound"):
        watch.supervisor.end(has_device)
    assert all(fake.code is not None for fake in watch.started if fake is not guard)


def read_unit(key: str) -> float:
    """Return a time of the systemd unit [s]."""
    found = re.search(rf"^{key}=(\d+)$", UNIT.read_text(), re.MULTILINE)
    assert found is not None
    return float(found[1])


@pytest.mark.parametrize("late", [False, True])
def test_systemd_waits_until_the_server_has_ended_its_processes(late: bool) -> None:
    watch, guard, _ = with_spare()
    for fake in watch.started:
        fake.stubborn = fake.held = True
    guard.late = late  # then the spare has to open the device

    def has_device(_: float) -> bool:
        watch.clock.advance(1.0)
        return False

    begin = watch.clock.time
    with pytest.raises(ServerError, match="may still sound"):
        watch.supervisor.end(has_device)
    assert watch.log.count(("kill", "spare")) == 1
    assert watch.clock.time - begin <= 0.75 * read_unit("TimeoutStopSec")


def test_systemd_waits_until_a_process_that_starts_too_slowly_is_named() -> None:
    watch = Watch(stubborn=NAMES)
    watch.supervisor.trusted = False
    begin = watch.clock.time
    with pytest.raises(ServerError, match="did not start"):
        watch.look(1.1 * MAX_FIRST_HEARTBEAT_TIME, **dict.fromkeys(NAMES, 0.0))
    for fake in watch.started:
        fake.held = True
    watch.supervisor.end()
    loading = 20.0  # of the server's own modules [s]
    assert loading + watch.clock.time - begin <= read_unit("TimeoutStartSec")


def test_a_young_spare_that_takes_over_sound_has_not_long_to_begin() -> None:
    watch, guard, spare = with_spare()
    watch.check(sound=True)
    guard.code = -9
    watch.check(sound=True)
    beat = watch.clock.time - 1.0
    assert watch.look(MAX_SOUNDING_START_TIME - 0.1, guard=beat) == []
    assert ("guard", "did not start, and was killed") in watch.look(0.3, guard=beat)
    assert spare.code is not None


@pytest.mark.parametrize("error", [OSError("no memory"), ServerError("too long")])
def test_a_spare_that_cannot_be_started_is_told(error: Exception) -> None:
    watch = Watch()
    watch.error = error
    assert watch.check() == [("spare", f"could not be started: {error}")]
    assert watch.look(MIN_RESTART_DELAY - LOOK) == []
    watch.error = None
    assert watch.look(4 * MIN_RESTART_DELAY) == []
    assert watch.newest("spare").code is None


@pytest.mark.parametrize("error", [OSError("no memory"), ServerError("too long")])
def test_one_that_cannot_be_started_again_is_tried_again_less_and_less_often(
    error: Exception,
) -> None:
    watch = Watch()
    watch.newest("bus").code = 1
    assert len(watch.check()) == 1
    watch.error = error
    tries: list[float] = []
    while len(tries) < 4:
        watch.clock.advance(0.001)
        if ended := watch.check():
            assert ended == [("bus", f"could not be started: {error}")]
            tries.append(watch.clock.time)
    waits = [b - a for a, b in itertools.pairwise(tries)]
    assert waits == pytest.approx(
        [2 * MIN_RESTART_DELAY, 4 * MIN_RESTART_DELAY, 8 * MIN_RESTART_DELAY], abs=0.003
    )
    watch.error = None
    watch.clock.advance(MAX_RESTART_DELAY)
    assert watch.check() == []
    assert watch.newest("bus").code is None
    assert watch.supervisor.restarts["bus"] == 1


def test_one_that_starts_has_more_time_and_an_old_sign_of_life_does_not_count() -> None:
    watch = Watch()
    old = watch.clock.time - 1.0
    assert watch.look(MAX_FIRST_HEARTBEAT_TIME - 1.0, render=old) == []
    assert not watch.supervisor.is_alive("render", old)
    assert watch.look(1.1, render=old) == [("render", "did not start, and was killed")]
    assert watch.look(MIN_RESTART_DELAY + LOOK) == []
    new = watch.clock.time
    assert watch.look(2.0, render=old) == [], "nor that of one before it"
    watch.look(LOOK, render=new)
    assert watch.look(1.1, render=new) == [("render", "hung, and was killed")]


def test_before_all_were_ready_an_end_is_an_error() -> None:
    watch = Watch()
    watch.supervisor.trusted = False
    watch.newest("guard").code = 2
    with pytest.raises(ServerError, match="'guard' ended with exit code 2"):
        watch.check()


def test_before_all_were_ready_an_end_names_the_plug_in() -> None:
    watch = Watch(plugins={"render": "the solver 'odd'"})
    watch.supervisor.trusted = False
    watch.newest("render").code = 3
    words = "'render', which starts the solver 'odd', ended with exit code 3"
    with pytest.raises(ServerError, match=words):
        watch.check()


def test_the_log_names_a_process_that_starts_slowly_once(logged: Any) -> None:
    watch = Watch(plugins={"render": "the solver 'odd'"})
    watch.supervisor.trusted = False
    watch.look(SLOW_START_TIME, render=0.0)
    assert not logged.getvalue()
    watch.look(3.0 * SLOW_START_TIME, render=0.0)
    flush()
    (line,) = logged.getvalue().splitlines()
    for part in ("a process starts slowly", "render", "the solver 'odd'", "limit='120 s'"):
        assert part in line
    watch.newest("render").code = 1
    watch.supervisor.trusted = True
    watch.look(MIN_RESTART_DELAY + SLOW_START_TIME + 1.0, render=0.0)
    flush()
    assert len(logged.getvalue().splitlines()) == 2, "the process that replaces it is named, too"


def test_if_one_cannot_be_started_those_before_are_ended() -> None:
    log: list[tuple[str, str]] = []

    def start(name: str, spare: int) -> Fake:
        if name == "render":
            raise OSError("no memory")
        return Fake(name, log, ManualClock())

    with pytest.raises(OSError, match="no memory"):
        Supervisor(start, 1.0)
    assert log == [(does, name) for name in ("bus", "guard") for does in ("close", "wait")]


# real processes


class Running:
    """A server in its own process, with children that only send heartbeats."""

    def __init__(self, folder: Path, **env: str) -> None:
        self.path, self.log = folder / "connection.json", folder / "log"
        with self.log.open("wb") as out:
            self.process = subprocess.Popen(
                [sys.executable, "-c", PARENT, str(self.path), CHILD],
                stdout=out,
                env={**os.environ, **env},
            )
        eventually(lambda: "ready" in self.log.read_text())

    @property
    def started(self) -> list[tuple[str, int, Path]]:
        complete, _, _ = self.log.read_text().rpartition("\n")
        words = [line.split() for line in complete.splitlines()]
        return [(w[1], int(w[2]), Path(w[3])) for w in words if w[0] == "started"]


@pytest.fixture
def running(tmp_path: Path) -> Iterator[Callable[..., Running]]:
    made: list[Running] = []

    def start(**env: str) -> Running:
        made.append(Running(tmp_path, **env))
        return made[-1]

    yield start
    for one in made:
        one.process.kill()
        one.process.wait()
        for _, pid, _ in one.started:
            with contextlib.suppress(psutil.Error):
                psutil.Process(pid).kill()


@posix
def test_one_that_stands_still_is_replaced_and_sigterm_ends_all_in_order(
    running: Callable[..., Running], tmp_path: Path
) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.bind(str(tmp_path / "notify"))
        manager.settimeout(PATIENCE)
        server = running(NOTIFY_SOCKET=str(tmp_path / "notify"))
        assert manager.recv(100) == b"READY=1"
        assert Connection.read(server.path).pid == server.process.pid
        (pid,) = (pid for name, pid, _ in server.started if name == "render")
        os.kill(pid, signal.SIGSTOP)
        eventually(lambda: [name for name, _, _ in server.started].count("render") == 2)
        assert not psutil.pid_exists(pid)
        server.process.send_signal(signal.SIGTERM)
        assert manager.recv(100) == b"STOPPING=1"
    assert server.process.wait(PATIENCE) == 0
    ended = [line.split()[1] for line in server.log.read_text().splitlines() if "ended" in line]
    # the new renderer may end before it can log that
    assert [name for name in ended if name != "render"] == ["bus", "guard"]
    assert ended in (["bus", "guard"], ["render", "bus", "guard"])
    assert not server.path.exists()
    assert not any(folder.exists() for _, _, folder in server.started)
    assert not any(psutil.pid_exists(pid) for _, pid, _ in server.started)


@posix
def test_when_the_parent_is_killed_all_end_by_themselves(running: Callable[..., Running]) -> None:
    server = running()
    server.process.kill()
    server.process.wait()
    eventually(lambda: not any(map(runs, (pid for _, pid, _ in server.started))))
