"""For any order of events: once control has seen them, it never reports a better output than the real one.

Control, guard, devices and lease are real. They are connected by fake files and a manual clock.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import msgspec
from hypothesis import settings as given_settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

import pacinian as pc
from pacinian.serving.control.process import ControlLoop
from pacinian.serving.guard.device_manager import DeviceManager
from pacinian.serving.guard.output_gate import OutputGate
from pacinian.serving.ipc.messages import (
    BusStatus,
    FrameHead,
    Permit,
    RendererStatus,
    Selections,
    pack,
)
from pacinian.serving.settings import Safety, Settings
from pacinian.testing import ManualClock
from pacinian.wire.control import Arm, Choice, Disarm, Hello, Renew, Reset, Select, Stop
from pacinian.wire.protocol import MAJOR, MINOR
from pacinian.wire.replies import Plugin, Welcome
from pacinian.wire.state import OUTPUTS

if TYPE_CHECKING:
    from collections.abc import Callable

    from msgspec import Struct

    from pacinian.wire.state import Output

SETTINGS = Settings(safety=Safety(lease=1.0, frame_timeout=0.02, session_timeout=3600.0))
ARRAY = SETTINGS.array.make()
N = len(ARRAY)
RANK: dict[Output, int] = {output: rank for rank, output in enumerate(OUTPUTS)}  # worst last
METHODS = "open", "send", "silence", "close"


class Memory:
    """A fake `SharedRegister` in this process."""

    def __init__(self) -> None:
        self.number, self.data = 0, b""

    def write(self, *parts: Any) -> None:
        self.number, self.data = self.number + 1, b"".join(map(bytes, parts))

    def read(self, after: int = 0) -> tuple[int, bytes] | None:
        return (self.number, self.data) if self.number > after else None


class Breaks(pc.Backend):
    """A backend whose methods in `broken` raise."""

    name = "breaks"

    def __init__(self, broken: set[str]) -> None:
        self.broken = broken

    @property
    def capability(self) -> pc.Capability:
        return pc.Capability()

    def _do(self, what: str) -> None:
        if what in self.broken:
            raise pc.BackendError(f"{what} failed")

    def open(self, array: pc.Array) -> None:
        self._do("open")

    def send(self, frame: pc.Frame) -> None:
        self._do("send")

    def silence(self) -> None:
        self._do("silence")

    def close(self) -> None:
        self._do("close")


class Doors:
    def __init__(self) -> None:
        self.replies: list[Any] = []

    def reply(self, peer: bytes, data: bytes) -> bool:
        return True


class Status(RuleBasedStateMachine):
    def __init__(self) -> None:
        super().__init__()
        self.clock, self.broken = ManualClock(1.0), set[str]()
        names = (
            "permit",
            "sessions",
            "selections",
            "renderer_status",
            "device",
            "bus_status",
            "frame",
        )
        self.memory = {name: Memory() for name in names}
        self.threads: list[Callable[[], None]] = []
        self.deaths: list[str] = []
        self.started = 0.0  # when the guard started [s]
        self.renewals = self.sequence = self.reset = 0
        self.halted, self.results = "", dict[str, str]()
        supervisor: Any = SimpleNamespace(
            restarts={}, ended=False, is_alive=self.alive, check=self.check
        )
        memory: Any = self.memory
        doors: Any = Doors()
        self.control = ControlLoop(SETTINGS, doors, memory, supervisor, self.clock.now)
        self.session = b""
        self.begin()
        self.run_threads()
        self.guard_turns()
        self.renderer_tells()
        self.control_checks()
        hello = Hello(id=1, protocol=(MAJOR, MINOR), client="game")
        self.control.sessions.handle(b"game", "", hello, self.clock.now())
        for _, reply in self.control.sessions.take_replies():
            if isinstance(reply, Welcome):
                self.session = reply.session

    def alive(self, name: str, beat: float) -> bool:
        return name != "guard" or (self.guarded and beat >= self.started)

    def check(self, beats: dict[str, float], sound: bool = False) -> list[tuple[str, str]]:
        del beats, sound
        deaths, self.deaths = [(name, "was killed") for name in self.deaths], []
        return deaths

    # the guard, its devices and their threads

    def begin(self) -> None:
        self.guarded, self.started = True, self.clock.now()
        self.gate = OutputGate(N, gain=1.0, frame_timeout=0.02, clock=self.clock.now)
        made: Any = lambda choice: Breaks(self.broken)  # noqa: E731
        self.devices = DeviceManager(
            self.gate, ARRAY, Choice(name="a"), 1000.0, made, self.threads.append
        )
        self.devices.begin(self.selections)

    @property
    def selections(self) -> Selections:
        return msgspec.msgpack.decode(
            self.memory["selections"].data or pack(Selections()),
            type=Selections,
        )

    @rule()
    def guard_turns(self) -> None:
        if not self.guarded:
            return
        self.devices.follow(self.selections)
        self.devices.poll()
        permit = Permit.unpack(self.memory["permit"].data)
        while self.gate.step(permit):
            pass
        self.tell()

    @rule(sounds=st.booleans())
    def frame(self, sounds: bool) -> None:
        """The renderer writes a frame, and the guard reads it."""
        permit = Permit.unpack(self.memory["permit"].data)
        device = self.gate.next_generation or self.gate.generation
        self.sequence += 1
        head = FrameHead(self.sequence, 0.0, permit.epoch, device, 1 if sounds else 0, N).pack()
        levels = b"\1\0" * 2 * N if sounds else b""
        if self.guarded and self.gate.step(permit, head + levels):
            self.gate.step(permit)
        self.tell()

    def tell(self) -> None:
        if self.guarded and (self.gate.backend or self.gate.fault):  # as in the process
            told = self.gate.make_status(self.devices.results, (Plugin(name="a"), Plugin(name="b")))
            self.memory["device"].write(pack(told))
            self.told = self.guard_is

    @property
    def guard_is(self) -> Output:
        guard = self.gate
        if guard.fault or guard.problem or guard.backend is None:
            return "faulted"
        return "sounding" if guard.sounding else "stale" if guard.is_stale else "silent"

    @rule()
    def run_threads(self) -> None:
        while self.threads:
            self.threads.pop(0)()

    @rule(what=st.sampled_from(METHODS))
    def break_or_mend(self, what: str) -> None:
        self.broken ^= {what}

    @precondition(lambda self: self.guarded)
    @rule()
    def guard_dies(self) -> None:
        self.guarded = False
        self.deaths.append("guard")
        self.threads.clear()

    @precondition(lambda self: not self.guarded)
    @rule()
    def guard_comes_back(self) -> None:
        self.clock.advance(0.1)
        self.begin()

    # the renderer

    @rule()
    def renderer_halts(self) -> None:
        self.halted = "solve: RuntimeError: no gains today"
        self.renderer_tells()

    @rule()
    def renderer_tells(self) -> None:
        wanted = self.selections.reset
        device = self.control.statuses.device
        if self.reset != wanted and not device.fault:
            self.reset, self.halted = wanted, ""
            self.results[f"reset {wanted}"] = ""
        report = RendererStatus(
            self.clock.now(), {}, self.results, self.halted, {}, (Plugin(name="auto"),)
        )
        self.memory["renderer_status"].write(pack(report))
        self.memory["bus_status"].write(pack(BusStatus(self.clock.now())))
        self.told_halted = self.halted

    # clients

    def ask(self, message: Struct) -> None:
        self.control._carry_out(b"game", "", message, self.clock.now())  # type: ignore[arg-type]
        self.control._write_changes_and_reply()

    @rule()
    def arm(self) -> None:
        self.renew()
        self.ask(Arm(session=self.session, id=2))

    @rule()
    def renew(self) -> None:
        self.renewals += 1
        now = self.clock.now()
        self.ask(Renew(session=self.session, id=3, sequence=self.renewals, time=now))

    @rule(kind=st.sampled_from([Disarm, Reset, Stop]))
    def ask_for(self, kind: Any) -> None:
        self.ask(kind(id=4) if kind is Stop else kind(session=self.session, id=4))

    @rule(name=st.sampled_from("ab"))
    def select(self, name: str) -> None:
        self.ask(Select(session=self.session, id=5, backend=Choice(name=name)))

    # time, and control

    @rule(seconds=st.sampled_from([0.001, 0.03, 0.5, 1.5, 11.0]))
    def pass_time(self, seconds: float) -> None:
        self.clock.advance(seconds)
        self.control.sessions.pass_time(self.clock.now())
        self.control._write_changes_and_reply()

    @rule()
    def control_checks(self) -> None:
        self.control._check_processes(self.clock.now())
        self.seen = self.told if self.guarded and self.has_told else "faulted"
        self.seen_halted = self.told_halted

    @property
    def has_told(self) -> bool:
        """Return whether the present guard has reported."""
        return self.control.statuses.device.heartbeat >= self.started

    @rule()
    def all_goes_on(self) -> None:
        """Run every part often enough for all effects."""
        self.run_threads()
        self.guard_turns()
        self.renderer_tells()
        self.control_checks()

    @invariant()
    def no_better_is_said_than_what_is(self) -> None:
        if not hasattr(self, "seen"):
            return
        lease = self.control.sessions.lease
        true: set[Output] = {"silent"}
        true |= {"faulted"} if lease.fault or self.seen_halted else set()
        true |= {"stopped"} if lease.permit.stopped else set()
        true |= {self.seen} if self.seen != "stale" or lease.armed else set()
        said = self.control.state_builder.make_state(self.clock.now(), {}).output
        assert said == max(true, key=RANK.__getitem__)

    @invariant()
    def what_a_reset_has_not_mended_holds_the_output(self) -> None:
        """After a reset is answered, a remaining fault is a fault of the lease, so that `arm` is refused."""
        statuses, reset = self.control.statuses, f"reset {self.control.selections.newest.reset}"
        failed = [
            part
            for part, fault in (
                (statuses.device, statuses.device.fault),
                (statuses.renderer_status, statuses.renderer_status.halted),
            )
            if fault and reset in part.results
        ]
        if failed:
            assert self.control.sessions.lease.fault


TestStatus = Status.TestCase
TestStatus.settings = given_settings(max_examples=20, stateful_step_count=30, deadline=None)
