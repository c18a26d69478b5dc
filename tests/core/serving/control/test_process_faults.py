"""Control survives bugs, faults, verbose plug-ins, and crowds of strangers."""

from __future__ import annotations

import contextlib
import struct
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import psutil
import pytest
import zmq
from msgspec.structs import replace

from pacinian.errors import WireError
from pacinian.serving.control import process as control_process
from pacinian.serving.control.process import ControlLoop
from pacinian.serving.control.sockets import ControlSockets
from pacinian.serving.ipc.auth import ClientAuthenticator
from pacinian.serving.ipc.messages import DeviceStatus, RendererStatus, pack
from pacinian.serving.ipc.scheduling import URGENT
from pacinian.serving.settings import Network, Settings
from pacinian.testing import ManualClock
from pacinian.wire.codec import decode_reply, encode
from pacinian.wire.control import Arm, Capabilities, Choice, Hello, Reset, Select, Status, Stop
from pacinian.wire.protocol import MAJOR, MINOR
from pacinian.wire.replies import Error, Ok, Welcome
from pacinian.wire.state import State
from pacinian.wire.stop_datagram import StopSocket

from ....waiting import eventually
from ..processes import PATIENT
from ..test_status import Memory

if TYPE_CHECKING:
    from collections.abc import Iterator

linux = pytest.mark.skipif(sys.platform != "linux", reason="threads of /proc")
CROWD = 2000
STRANGERS = """
import resource, socket, sys
most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
made = [socket.socket() for _ in range(int(sys.argv[2]))]
for one in made:
    one.setblocking(False)
    one.connect_ex(("127.0.0.1", int(sys.argv[1])))
print("all", flush=True)
sys.stdin.read()
"""


# requests


def test_the_longest_selections_can_be_made_together(server: Any) -> None:
    """A restarted renderer receives all selections in one message."""
    wide = "\U0001f44b"
    options = {f"{n:02}{wide * 62}": wide * 200 for n in range(32)}
    game = server.client().hello()
    server.extra["render"] |= {"results": {"solver 1": ""}}
    server.extra["guard"] |= {"results": {"backend 1": ""}}
    for kind, name in (("solver", "gs"), ("backend", "pretended")):
        assert isinstance(game.ask(Select, **{kind: Choice(name=name, options=options)}), Ok)
    assert isinstance(game.ask(Arm), Ok)


def test_a_mistake_of_ours_ends_a_request_only(
    server: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    game = server.client().hello()

    def broken(message: Any) -> bytes:
        if isinstance(message, Ok):
            raise WireError("a mistake")
        return encode(message)

    with monkeypatch.context() as patch:
        patch.setattr(control_process, "encode", broken)
        assert game.ask(Stop).code == "fault"
        assert server.permit().stopped == 1, "it was done all the same"
    assert isinstance(game.ask(Stop), Ok)


# the other processes


def test_while_the_renderer_starts_again_its_solvers_stay_known(server: Any) -> None:
    game = server.client().hello()
    before = game.ask(Capabilities).solvers
    not_listed_yet = {"solvers": (), "state": {"ticks": 7}, "results": {"solver 1": ""}}
    server.extra["render"] |= not_listed_yet
    server.processes["render"][-1].code = -9
    eventually(lambda: game.ask(Status).ticks == 7)
    assert game.ask(Capabilities).solvers == before
    assert isinstance(game.ask(Select, solver=Choice(name="gs")), Ok)


def test_nothing_is_armed_while_the_bus_is_started_again(server: Any) -> None:
    game = server.client().hello()
    server.silent.add("bus")
    server.processes["bus"][0].code = 1
    reply = eventually(lambda: isinstance(said := game.hear(), Error) and said)
    assert reply.code == "session"
    assert game.ask(Arm).code == "session", "of a session that is over, that is told first"
    game.hello()
    assert game.ask(Arm).code == "fault"
    assert server.permit().armed == 0
    eventually(lambda: len(server.processes["bus"]) == 2)
    assert game.ask(Arm).code == "fault", "it gives no sign of life yet"
    server.processes["bus"][1].silent = False
    eventually(lambda: isinstance(game.ask(Arm), Ok))


def test_a_spare_of_the_guard_takes_over_and_another_is_started(server: Any) -> None:
    game = server.client().hello()
    assert isinstance(game.ask(Arm), Ok)
    eventually(lambda: server.spares)
    spare = server.spares[0]
    server.processes["guard"][0].code = -9
    assert eventually(lambda: isinstance(said := game.hear(), Error) and said).code == "fault"
    assert server.processes["guard"][1] is spare
    assert server.permit().armed == 0, "nothing sounds before it is armed again"
    eventually(lambda: len(server.spares) == 2)
    assert game.ask(Status).restarts["guard"] == 1
    server.end()
    assert server.spares[1].killed


def test_a_spare_that_is_lost_is_replaced_and_disturbs_nobody(server: Any, logged: Any) -> None:
    game = server.client().hello()
    assert isinstance(game.ask(Arm), Ok)
    eventually(lambda: server.spares)
    server.spares[0].code = 1
    eventually(lambda: len(server.spares) == 2)
    logged.wait("spare guard lost")
    assert server.permit().armed == 1
    assert game.ask(Status).restarts["guard"] == 0


@pytest.mark.parametrize("sounds", [True, False])
def test_a_guard_that_may_sound_is_given_less_time(start_server: Any, sounds: bool) -> None:
    server = start_server(replace(PATIENT, safety=replace(PATIENT.safety, hang_timeout=2.0)))
    game = server.client().hello()
    guard = server.processes["guard"][0]
    if sounds:
        assert isinstance(game.ask(Arm), Ok)
        eventually(lambda: game.ask(Status).output == "sounding")
    guard.silent = True
    began = time.perf_counter()
    eventually(lambda: guard.killed)
    # only time that control has observed counts, which is never more than the real time
    assert time.perf_counter() - began >= (0.2 if sounds else 1.9)


def test_only_the_bus_is_told_secrets(server: Any) -> None:
    told = {name: made[0].told.secrets for name, made in server.processes.items()}
    assert told == {"guard": {}, "render": {}, "bus": {"token": server.connection.token}}


@pytest.mark.parametrize(
    ("process", "told"),
    [
        ("guard", {"name": "long" * 1000}),
        (
            "render",
            {"state": {"solver": "auto", "faults": ["long" * 1000] * 20, "fault_count": 20}},
        ),
        ("render", {"state": {"solver": 7, "points": "x", "error": "much", "faults": 7}}),
        ("render", {"state": {"solver": "auto", "fault_count": "many"}}),
    ],
)
def test_what_they_tell_is_published_as_far_as_it_can_be(
    server: Any, process: str, told: dict[str, Any]
) -> None:
    game, next_state = server.client().hello(), server.states()
    before = next_state()
    server.extra[process] |= told
    state = eventually(lambda: (s := next_state()).sequence > before.sequence + 6 and s)
    assert len(state.backend) <= 200
    assert max(map(len, state.faults), default=0) <= 500
    assert isinstance(game.ask(Status), State)


def test_an_object_that_the_renderer_refuses_is_named(server: Any) -> None:
    game, next_state = server.client().hello(), server.states()
    server.extra["render"] |= {"refused": {"stone": "`mesh` must be closed", "": "2 were damaged"}}
    eventually(lambda: len(next_state().faults) == 2)
    told = game.ask(Status)
    assert told.faults == ("stone: `mesh` must be closed", "changes: 2 were damaged")
    assert told.output != "faulted"
    assert any("not be put" in value for value in told.summarise().values())


def test_a_state_that_is_too_long_is_not_published(server: Any) -> None:
    game, next_state = server.client().hello(), server.states()
    long = {"state": {"solver": "long", "points": bytes(1_500_000)}}
    server.extra["render"] |= long
    eventually(lambda: isinstance(game.ask(Status), Error))
    assert isinstance(game.ask(Arm), Ok)
    server.extra["render"]["state"] = {"solver": "short"}
    eventually(lambda: next_state().solver == "short")


# faults and resets


class Bench:
    """A control loop with fake files, whose processes report what a test says. armed: whether the owner is."""

    def __init__(self) -> None:
        self.clock, self.alive = ManualClock(1.0), {"guard", "bus", "render"}
        self.deaths: list[tuple[str, str]] = []
        names = "permit", "sessions", "selections", "renderer_status", "device", "bus_status"
        self.files = {name: Memory() for name in names}
        self.sent: list[Any] = []
        stop = SimpleNamespace(confirm=lambda confirmed: None)
        sockets: Any = SimpleNamespace(reply=self.note_reply, stop=stop)
        supervisor: Any = SimpleNamespace(
            is_alive=lambda name, heartbeat: name in self.alive, check=self.take_deaths
        )
        files: Any = self.files
        self.loop = ControlLoop(Settings(), sockets, files, supervisor, self.clock.now)
        self.report()
        hello = self.ask(Hello(id=1, protocol=(MAJOR, MINOR), client="game"))
        assert isinstance(hello, Welcome)
        self.key = hello.session
        self.ask(Arm(id=2, session=self.key))

    def note_reply(self, peer: bytes, data: bytes) -> bool:
        del peer
        self.sent.append(decode_reply(data))
        return True

    def take_deaths(self, *_: object) -> list[tuple[str, str]]:
        deaths, self.deaths = self.deaths, []
        return deaths

    def ask(self, message: Any) -> Any:
        self.loop._carry_out(b"game", "", message, self.clock.now())
        self.loop._write_changes_and_reply()
        return self.sent[-1]

    def reset_and_arm(self) -> None:
        assert isinstance(self.ask(Reset(id=3, session=self.key)), Ok)
        assert isinstance(self.ask(Arm(id=4, session=self.key)), Ok)

    def report(
        self, fault: str = "", halted: str = "", *, guard: int = 0, render: int = 0, device: int = 1
    ) -> None:
        """Let the guard and the renderer report. guard, render: the last reset that each has carried out."""
        now = self.clock.now()
        self.report_device(fault, device, {f"reset {guard}": ""})
        self.files["renderer_status"].write(
            pack(RendererStatus(now, {}, {f"reset {render}": ""}, halted))
        )
        self.loop._check_processes(now)

    def report_device(self, fault: str, generation: int, results: dict[str, str]) -> None:
        now = self.clock.now()
        told = DeviceStatus(generation, 0, "a", 2, 2, 1.0, None, now, sounding=False, fault=fault)
        self.files["device"].write(pack(replace(told, results=results)))

    def end_process(self, name: str) -> None:
        self.alive.remove(name)
        self.deaths.append((name, "was killed"))
        self.loop._check_processes(self.clock.now())

    @property
    def armed(self) -> bool:
        return self.loop.sessions.lease.armed

    @property
    def why(self) -> str:
        return self.loop.state_builder.make_state(self.clock.now(), {}).why


@pytest.fixture
def bench(logged: Any) -> Bench:
    """Return a bench whose log does not disturb the output of the tests."""
    return Bench()


def test_a_renderer_that_meets_the_devices_fault_after_a_reset_has_no_fault_of_its_own(
    bench: Bench,
) -> None:
    """It cannot send until the guard has carried out the reset."""
    bench.report("is loud")
    assert not bench.armed
    bench.reset_and_arm()
    bench.report("is loud", "send: is loud")
    bench.report("", "send: is loud", guard=1)
    assert bench.armed
    assert "carrying out a reset. Sound returns when that is done" in bench.why
    bench.report(guard=1, render=1)
    assert bench.armed
    assert bench.loop.state_builder.faults == ["device: is loud"]


def test_a_renderer_that_is_halted_after_it_has_carried_out_the_reset_has_a_new_fault(
    bench: Bench,
) -> None:
    bench.report("is loud")
    bench.reset_and_arm()
    bench.report("", "send: is loud", guard=1, render=1)
    assert not bench.armed
    assert "fault: renderer: send: is loud. Remove its cause, then reset" in bench.why


def test_a_renderer_that_never_carries_out_the_reset_has_a_fault(bench: Bench) -> None:
    bench.report(halted="solve: broken")
    bench.reset_and_arm()
    bench.report(halted="solve: broken")
    assert bench.armed
    bench.clock.advance(control_process.FAULT_CLEAR_TIMEOUT)
    bench.report(halted="solve: broken")
    assert "fault: renderer: solve: broken" in bench.why


@pytest.mark.parametrize("dies_first", [True, False])
@pytest.mark.parametrize("name", ["guard", "render"])
def test_the_last_report_of_a_process_that_ended_is_no_news_after_a_reset(
    bench: Bench, name: str, dies_first: bool
) -> None:
    faults = ("is loud", "") if name == "guard" else ("", "solve: broken")
    bench.report(*faults)
    if dies_first:
        bench.end_process(name)
        bench.reset_and_arm()
    else:
        bench.reset_and_arm()
        bench.end_process(name)
    bench.report(*faults)
    assert not bench.loop.sessions.lease.fault
    bench.alive.add(name)
    bench.report(*faults)
    assert bench.loop.sessions.lease.fault, "this is the report of the process that replaced it"


def test_a_fault_that_is_seen_when_a_stop_is_confirmed_needs_a_reset(bench: Bench) -> None:
    """Otherwise, a reset before the next check would reset a fault that nobody was told of."""
    bench.report_device("is loud", 1, {})
    bench.loop.sessions.lease.stop()
    bench.loop._confirm_stops(bench.clock.now())
    assert bench.loop.state_builder.faults == ["device: is loud"]
    assert "fault: device: is loud. Remove its cause, then reset" in bench.why


def test_while_a_new_guard_opens_the_device_no_reset_is_needed(bench: Bench) -> None:
    bench.report("was loud")
    bench.reset_and_arm()
    bench.report(guard=1, render=1)
    bench.end_process("guard")
    assert "arm again" in bench.sent[-1].advice
    for _ in ("it starts", "it has reported, without a device"):
        assert "the device is being opened" in bench.why
        assert "the game must arm the output" in bench.why
        assert "reset" not in bench.why
        bench.alive.add("guard")
        bench.report(device=0, guard=1, render=1)
    assert isinstance(bench.ask(Arm(id=9, session=bench.key)), Ok)
    assert bench.why.endswith("Sound returns when that is done")
    bench.loop.sessions.lease.stop()
    assert "reset the server, then arm again" in bench.why


def test_after_the_end_of_the_bus_a_client_must_say_hello(bench: Bench) -> None:
    bench.end_process("bus")
    told = [each for each in bench.sent if isinstance(each, Error)]
    assert [error.code for error in told] == ["fault", "session"]
    assert all("say hello" in error.advice for error in told)


# strangers


@pytest.fixture
def few_files() -> Iterator[int]:
    """Set a low soft limit of open files, which the process may raise."""
    resource = pytest.importorskip("resource")
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard != resource.RLIM_INFINITY and hard < 2 * CROWD:
        pytest.skip("the system allows too few files")
    few = psutil.Process().num_fds() + 200
    resource.setrlimit(resource.RLIMIT_NOFILE, (few, hard))
    yield few
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def test_a_crowd_that_only_connects_keeps_nobody_from_being_answered(
    few_files: int, start_server: Any
) -> None:
    server = start_server()
    game = server.client().hello()
    port = server.connection.control.rpartition(":")[2]
    command = [sys.executable, "-c", STRANGERS, port, str(CROWD)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as crowd:
        try:

            def crowded() -> bool:
                assert isinstance(game.ask(Status), State), "answered, and its session lives"
                return psutil.Process().num_fds() > few_files

            eventually(crowded)
            assert isinstance(server.client().hello("late").ask(Stop), Ok)
        finally:
            crowd.kill()
    assert isinstance(game.ask(Status), State)
    assert server.error is None


def test_news_of_a_crowd_do_not_pile_up(tmp_path: Path) -> None:
    """If the events are not fetched, ZeroMQ's own thread blocks, and with it all heartbeats."""
    with (
        zmq.Context() as context,
        ClientAuthenticator(context, {"token": "x"}) as gate,
        StopSocket(tmp_path / "stop", "x") as stop,
        ControlSockets(context, gate, Network(), stop) as doors,
        context.socket(zmq.PAIR) as news,
        context.socket(zmq.PAIR) as monitor,
    ):
        news.bind("inproc://news")
        monitor.connect("inproc://news")
        for _ in range(1000):
            news.send_multipart([struct.pack("=HI", zmq.EVENT_ACCEPTED, 0), b"somewhere"])
        doors._monitors = [monitor]
        doors.take_refusals()
        assert doors.counts["connections"] == doors.watchers == 1000
        for _ in range(1000):
            news.send_multipart([struct.pack("=HI", zmq.EVENT_DISCONNECTED, 0), b"somewhere"])
        doors.take_refusals()
        assert doors.watchers == 0


@linux
def test_the_threads_of_its_sockets_are_as_urgent_as_it_is(server: Any) -> None:
    (own,) = (t.native_id for t in threading.enumerate() if t is server._thread)

    def read_nice() -> dict[int, tuple[str, int]]:
        nice = {}
        for stat in Path("/proc/self/task").glob("*/stat"):
            with contextlib.suppress(OSError):  # it has just ended
                name, _, rest = stat.read_text().partition("(")[2].rpartition(")")
                nice[int(stat.parent.name)] = name, int(rest.split()[16])
        return nice

    if read_nice()[own][1] != -URGENT:
        pytest.skip("may not be urgent here")
    # A new thread is named "python" until it runs.
    eventually(lambda: ("ZMQbg/IO/0", -URGENT) in read_nice().values())
