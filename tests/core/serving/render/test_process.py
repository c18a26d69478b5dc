"""The render process: its loop on a manual clock, then a real process."""

import math
import os
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, ClassVar

import msgspec
import numpy as np
import pytest

import pacinian as pc
from pacinian.plugins import registry
from pacinian.plugins.registry import Offer
from pacinian.scene.config_sections import Units
from pacinian.serving.control.explain_silence import find_cause
from pacinian.serving.ipc import launch_config, launched_child, messages, parent_link
from pacinian.serving.ipc.messages import (
    AnyChange,
    Changes,
    ChangesAck,
    DeviceStatus,
    FrameHead,
    HandInfo,
    Permit,
    PutObject,
    RemoveObject,
    RendererStatus,
    ResetScene,
    Selections,
    SetHands,
    SetQuiet,
)
from pacinian.serving.ipc.shared_memory import SharedRegister
from pacinian.serving.render import process
from pacinian.serving.render.background_loader import BackgroundLoader
from pacinian.serving.render.render_loop import FADE_LEAD, FILES, RenderLoop
from pacinian.serving.render.solver_switcher import SolverSwitcher, make_solver
from pacinian.serving.settings import Safety, Settings, Zone
from pacinian.testing import ManualClock
from pacinian.wire.control import Choice
from pacinian.wire.modulation import AM, STM
from pacinian.wire.shapes import Polyline
from pacinian.wire.state import ClientState, State

from ....waiting import PATIENCE, eventually
from ...rendering.manual_background import solve_beside

ARRAY, AIR = pc.autd(), pc.Air()
N = len(ARRAY)
POINT = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0)
HEAD = messages.compute_frame_capacity(0)
NOWHERE = STM(frequency=100.0, along=Polyline(points=bytes(24)))  # a route that goes nowhere


class Moody(pc.Solver):
    """A solver that raises, or takes long, when the test says so."""

    name: ClassVar[str] = "moody"
    mood: ClassVar[Callable[[], object]] = staticmethod(lambda: None)
    gain: ClassVar[float] = 0.5

    def solve(
        self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
    ) -> pc.Result:
        Moody.mood()
        out[:] = Moody.gain
        return pc.Result()


class Server:
    """The environment of a loop, on a manual clock."""

    def __init__(self, folder: Path, settings: Settings, solver: str = "auto") -> None:
        sizes = {**messages.CAPACITIES, "frame": messages.compute_frame_capacity(N)}
        self.files = {name: SharedRegister.create(folder / name, sizes[name]) for name in FILES}
        self.clock = ManualClock(500.0)
        self.device = DeviceStatus(1, 0, "fake", 256, 256, 1000.0, None, 0.0, False)
        self.tell("device", self.device)
        self.threads: list[Callable[[], None]] = []
        solvers = SolverSwitcher(make_solver(solver), ARRAY, AIR, thread=self.threads.append)
        self.loader = BackgroundLoader(lambda _: None)
        self.loop = RenderLoop(self.files, settings, ARRAY, AIR, solvers, self.loader, self.clock)
        self.number = 0
        self.run = 11

    def tell(self, name: str, value: Any) -> None:
        self.files[name].write(messages.pack(value))

    def arm(self, epoch: int = 1, armed: int = 1, until: float = 1e9, stopped: int = 0) -> None:
        self.files["permit"].write(Permit(armed, until, epoch, stopped).pack())

    def change(self, *changes: AnyChange) -> None:
        self.number += 1
        self.tell("changes", Changes(self.number, self.run, changes))

    def put(self, item: Any = POINT, name: str = "a") -> None:
        self.change(PutObject(name, msgspec.msgpack.encode(item), False))

    def tick(self, count: int = 1) -> None:
        for _ in range(count):
            self.loop.renderer.tick()
            self.loop.run_between()
            self.clock.advance(0.001)

    @property
    def frame(self) -> tuple[FrameHead, bool]:
        """Return the head of the newest frame, and whether the frame sounds."""
        found = self.files["frame"].read()
        assert found is not None
        head = FrameHead.unpack(found[1])
        levels = np.frombuffer(found[1][HEAD:], "<u2")
        return head, bool(levels[len(levels) // 2 :].any())

    @property
    def sounds(self) -> bool:
        return self.frame[1]

    @property
    def report(self) -> RendererStatus:
        self.clock.advance(0.1)  # the next one is due
        self.loop.run_between()
        found = self.files["renderer_status"].read()
        assert found is not None
        return msgspec.msgpack.decode(found[1], type=RendererStatus)

    @property
    def taken(self) -> ChangesAck:
        found = self.files["changes_ack"].read()
        assert found is not None
        return msgspec.msgpack.decode(found[1], type=ChangesAck)

    def close(self) -> None:
        self.loop.close()
        for file in self.files.values():
            file.close()


@pytest.fixture
def make(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., Server]]:
    registry.discover_plugins().load()
    offer = Offer("solver", Moody, "moody", "tests")
    monkeypatch.setitem(registry.discover_plugins().offers, ("solver", "moody"), offer)
    monkeypatch.setattr(Moody, "mood", staticmethod(lambda: None))
    servers: list[Server] = []

    def started(settings: Settings | None = None, solver: str = "auto") -> Server:
        folder = tmp_path / str(len(servers))
        folder.mkdir()
        servers.append(Server(folder, settings or Settings(), solver))
        servers[-1].loop.open()
        return servers[-1]

    yield started
    for server in servers:
        server.close()


@pytest.fixture
def server(make: Callable[..., Server]) -> Server:
    return make()


def test_without_a_permit_it_is_silent_and_takes_what_is_told(server: Server) -> None:
    server.put()
    server.tick(10)
    head, sounds = server.frame
    assert not sounds
    assert (head.rows, head.columns, head.device, head.epoch) == (1, N, 1, 0)
    assert server.taken == ChangesAck(1, server.loop.run, server.run)


def test_while_permitted_it_sounds_with_the_permits_epoch(server: Server) -> None:
    server.put()
    server.arm(epoch=5)
    server.tick(10)
    head, sounds = server.frame
    assert sounds
    assert head.epoch == 5
    server.arm(epoch=6)
    server.tick()
    assert server.frame[0].epoch == 6


@pytest.mark.parametrize("beside", [False, True])
def test_what_an_earlier_permit_began_is_not_heard_under_a_later_one(
    server: Server, beside: bool
) -> None:
    """Neither the fade nor a running solve of the earlier scene is heard. The next owner's scene is empty."""
    server.put()
    server.files["permit"].write(Permit(1, 1e9, 1).pack())
    server.tick(10)
    assert server.sounds
    server.loop.renderer.schedule.in_background = beside
    server.put(pc.Point(position=(0.02, 0.0, 0.15), radiation_pressure=5.0))
    server.tick(2)
    assert server.sounds
    server.files["permit"].write(Permit(1, 1e9, 2, scene=7).pack())
    for _ in range(30):
        server.tick()
        assert server.frame[0].epoch == 2
        assert not server.sounds


def test_a_scene_that_is_not_permitted_is_not_heard(server: Server) -> None:
    server.change(ResetScene(7), PutObject("a", msgspec.msgpack.encode(POINT), False))
    server.arm()  # for scene 0
    server.tick(20)
    assert not server.sounds
    server.files["permit"].write(Permit(1, 1e9, 2, 0, scene=7).pack())
    server.tick(20)
    assert server.sounds


def test_it_rests_in_silence_without_a_permit_until_there_is_something_to_do(
    make: Callable[..., Server],
) -> None:
    server = make()
    loop = server.loop
    assert not loop.rests  # nothing has been sent yet
    noise = pc.Noise(low_frequency=50.0, high_frequency=200.0)
    slow = msgspec.structs.replace(POINT, envelope=noise)
    selections = Selections(solver=(1, Choice(name="gs-pat")))
    rouse: dict[str, Callable[[], object]] = {
        "a change": server.put,
        "a permit": server.arm,
        "a slow object": lambda: server.put(slow),
        "a solver": lambda: server.tell("selections", selections),
        "a device": lambda: server.tell(
            "device", msgspec.structs.replace(server.device, next_generation=2)
        ),
        "a zone": lambda: server.change(zones(ZONE)),
    }

    def work() -> None:
        server.tick()
        for job in (*server.threads, *len(server.loader) * [server.loader._load_next]):
            job()
        server.threads.clear()

    for what, happens in rouse.items():
        eventually(lambda: loop.rests, work)
        happens()
        loop.run_between()
        assert not loop.rests, what
        server.tick(3)
        if what == "a permit":
            assert server.sounds
            server.arm(armed=0)
            assert not loop.rests
            server.tick()
            assert server.sounds  # while it fades
            assert not loop.rests
        assert what != "a device" or server.frame[0].device == 2


@pytest.mark.parametrize("end", ["closing", "stopped", "expiry", "none"])
def test_it_lets_go_softly(server: Server, end: str) -> None:
    server.put()
    server.arm(until=server.clock.now() + 0.1)
    server.tick(20)
    assert server.sounds
    if end == "closing":
        server.arm(armed=2, until=server.clock.now() + 0.02)
    elif end == "stopped":
        server.arm(stopped=1)
    elif end == "none":
        server.arm(armed=0)
    else:
        server.tick(59)  # until 20 ms before the end
    assert server.sounds
    server.tick()
    fading = [server.sounds]
    for _ in range(10):
        server.tick()
        fading.append(server.sounds)
    assert fading[0]
    assert not fading[-1]
    assert sorted(fading, reverse=True) == fading


def test_the_input_is_of_the_hands_that_are_played(server: Server) -> None:
    joints = pc.Hand.open(pose=pc.Pose((0.0, 0.0, 0.16))).joints
    assert joints is not None
    ball = pc.Volume(shape=pc.Sphere(0.03), pose=pc.Pose((0, 0, 0.15)), radiation_pressure=3.0)

    def move(k: int) -> None:
        moved = (joints + np.array([1e-3 * k, 0.0, 0.0])).astype("<f4").tobytes()
        info = HandInfo("right", "a", moved, b"", b"", server.clock.now())
        server.change(SetHands((info,), True, k, 0.1 * k, 0.2 * k))

    server.put(ball)
    move(0)  # a hand that is new could be answered by silence first
    server.arm()
    server.tick(3)
    played = []
    for k in range(1, 9):
        if k == 5:
            background = solve_beside(server.loop.renderer)
        if k >= 5:
            background.ready = k % 2 == 1
        move(k)
        server.loop.renderer.tick()
        server.clock.advance(0.001)
        head = server.frame[0]
        assert (head.sent, head.received) == pytest.approx((0.1 * head.input, 0.2 * head.input))
        played.append(head.input)
    # from the fifth on, solves run in the background: each begins in one tick and is sent two ticks later
    assert played == [1, 2, 3, 4, 4, 4, 5, 5]


def test_what_was_told_to_the_one_before_is_not_applied_and_another_bus_begins_anew(
    make: Callable[..., Server],
) -> None:
    server = make()
    server.put(name="old")
    again = RenderLoop(
        server.files, Settings(), ARRAY, AIR, SolverSwitcher(make_solver("auto"), ARRAY, AIR),
        server.loader, server.clock,
    )  # fmt: skip
    again.open()
    assert server.taken == ChangesAck(0, again.run, 0)
    again.renderer.tick()
    assert not again.replica.scene.objects
    again.close()
    server.tick()
    server.run, server.number = 12, 0
    server.put(name="new")
    server.tick()
    assert [item.name for item in server.loop.replica.scene.objects] == ["new"]
    assert server.taken == ChangesAck(1, server.loop.run, 12)


def test_damaged_changes_are_told_and_the_others_done(server: Server) -> None:
    item = msgspec.msgpack.encode(POINT)
    changes = [["ResetScene"], ["PutObject", "a", item, False], ["Put", 1], ["PutObject", 5, item, False]]  # fmt: skip
    raw = [1, 11, changes]
    server.files["changes"].write(msgspec.msgpack.encode(raw))
    server.tick()
    assert [one.name for one in server.loop.replica.scene.objects] == ["a"]
    assert server.taken.number == 1
    assert server.report.refused == {"": "2 changes were damaged"}
    server.files["changes"].write(b"\xc1")
    server.files["selections"].write(b"\xc1")
    server.tick(2)
    assert "Malformed" in server.report.refused[""] or "malformed" in server.report.refused[""]
    assert server.loop.renderer.halted is None


def test_technique_and_intensity_are_ordered(server: Server) -> None:
    server.change(PutObject("a", msgspec.msgpack.encode(POINT), True))
    server.tell(
        "selections",
        Selections(technique=(3, AM(frequency=50.0)), intensity=(4, 0.5)),
    )
    server.tick(2)
    (item,) = server.loop.replica.scene.objects
    assert item.technique == pc.AM(frequency=50.0)
    assert item.radiation_pressure == 2.5
    assert server.report.results == {"technique 3": "", "intensity 4": ""}


def test_a_solver_is_swapped_without_a_missing_frame(server: Server) -> None:
    server.put()
    server.arm()
    server.tick(10)
    server.tell("selections", Selections(solver=(1, Choice(name="moody"))))
    server.tick(5)
    assert server.loop.renderer.session.solver.name == "auto"  # while the new one is made
    before = server.files["frame"].number
    server.threads.pop()()
    server.tick(5)
    assert server.files["frame"].number == before + 5
    assert server.report.results == {"solver 1": ""}
    assert server.report.state["solver"] == "moody"
    assert server.sounds
    server.tell("selections", Selections(solver=(2, Choice(name="nobody"))))
    server.tick()
    server.threads.pop()()
    assert "nobody" in server.report.results["solver 2"]
    assert server.loop.renderer.session.solver.name == "moody"


def test_a_solver_that_raises_halts_until_reset(make: Callable[..., Server]) -> None:
    server = make(solver="moody")
    server.put()
    server.arm()
    server.tick(10)
    assert server.sounds

    def bad() -> None:
        raise RuntimeError("no gains today")

    Moody.mood = staticmethod(bad)
    server.put(pc.Point(position=(0.01, 0.0, 0.15), radiation_pressure=4.0))
    server.tick(3)
    assert server.frame[0].rows == 0
    assert server.report.halted == "solve: RuntimeError: no gains today"
    Moody.mood = staticmethod(lambda: None)
    server.tick(5)
    assert server.frame[0].rows == 0
    server.tell("selections", Selections(reset=1))
    server.tick(10)
    assert server.sounds
    assert server.report.halted == ""
    assert server.report.results == {"reset 1": ""}


def test_gains_that_are_not_finite_are_silence_with_the_reason(
    make: Callable[..., Server], monkeypatch: pytest.MonkeyPatch
) -> None:
    server = make(solver="moody")
    server.put()
    server.arm()
    server.tick(10)
    assert server.sounds
    monkeypatch.setattr(Moody, "gain", math.nan)
    server.put(pc.Point(position=(0.01, 0.0, 0.15), radiation_pressure=4.0))
    server.tick(20)
    assert not server.sounds
    told = {
        "sequence": 1, "time": 0.0, "output": "silent", "armed": True, "owner": "game", "scene": "hall",
        "backend": "fake",
    }  # fmt: skip
    client = ClientState(
        name="game", scene="hall", owner=True, objects=1, commands=1, errors=0, dropped=0, age=0.0, renewed=0.0
    )  # fmt: skip
    state = msgspec.convert({**server.report.state, **told, "clients": (client,)}, State)
    found = find_cause(state)
    assert found is not None
    assert '"moody" gives gains that are not finite' in found.text


@pytest.mark.parametrize("lost", [False, True])
def test_another_device_takes_over_while_a_fault_halts_it(
    make: Callable[..., Server], lost: bool
) -> None:
    """The fault is one of the device, or of the solver. The next device waits for its first frame."""

    def bad() -> None:
        raise RuntimeError("no gains today")

    server = make(solver="moody")
    server.put()
    server.arm()
    server.tick(10)
    fault = "gone" if lost else ""
    if lost:
        server.tell("device", msgspec.structs.replace(server.device, fault=fault))
    else:
        Moody.mood = staticmethod(bad)
        server.put(pc.Point(position=(0.01, 0.0, 0.15), radiation_pressure=4.0))
    server.tick(3)
    assert server.loop.renderer.halted is not None
    server.tell("device", msgspec.structs.replace(server.device, fault=fault, next_generation=2))
    server.loop.run_between()
    assert (server.frame[0].device, server.frame[0].rows) == (2, 0)
    server.tell("device", msgspec.structs.replace(server.device, generation=2))
    Moody.mood = staticmethod(lambda: None)
    server.tell("selections", Selections(reset=1))
    server.tick(10)
    assert server.frame[0].device == 2
    assert server.sounds


def test_after_a_fault_of_the_device_a_reset_waits_until_it_is_well(server: Server) -> None:
    server.put()
    server.arm()
    server.tick(10)
    server.tell("device", msgspec.structs.replace(server.device, fault="gone"))
    server.tick(2)
    assert "gone" in server.report.halted
    server.tell("selections", Selections(reset=1))
    server.tick(3)
    assert server.report.results == {}
    server.tell("device", server.device)
    server.tick(10)
    assert server.report.results == {"reset 1": ""}
    assert server.sounds


def test_a_late_solver_makes_late_ticks_and_no_fault(make: Callable[..., Server]) -> None:
    server = make(solver="moody")
    server.put()
    server.arm()
    Moody.mood = staticmethod(lambda: server.clock.advance(0.01))
    server.tick(3)
    state = server.report.state
    assert state["late"] >= 1
    assert state["fault_count"] == 0


ZONE = Zone((0.08, 0.0, 0.2), pressure=2.0, radius=0.006)  # that 256 levels keep


def zones(*given: Zone) -> SetQuiet:
    return SetQuiet(tuple((zone.position, zone.pressure, zone.radius) for zone in given))


def wait_for_zones(server: Server, count: int) -> None:
    """Wait until this number of zones is prepared. The loop is silent until then."""

    def are_kept() -> bool:
        server.tick()
        return len(server.loop.renderer.limits.zones) == count

    eventually(are_kept)


@pytest.mark.parametrize("solver", ["auto", "gs-pat", "greedy"])
def test_quiet_zones_are_kept_whatever_the_solver(make: Callable[..., Server], solver: str) -> None:
    server = make(solver=solver)
    server.put()
    server.arm()
    server.tick(10)
    assert server.sounds
    around = np.array(ZONE.position) + np.random.default_rng(1).uniform(-0.006, 0.006, (200, 3))
    before = np.abs(pc.field(ARRAY, server.loop.renderer.emitted_gains, around, medium=pc.Air()))
    server.change(zones(ZONE))
    wait_for_zones(server, 1)
    server.tick(10)
    assert server.sounds
    after = np.abs(pc.field(ARRAY, server.loop.renderer.emitted_gains, around, medium=pc.Air()))
    assert before.max() > 10.0 * ZONE.pressure
    assert after.max() <= ZONE.pressure
    (kept,) = server.loop.renderer.limits.zones  # larger than the zone, which may move
    within = np.abs(
        pc.field(ARRAY, server.loop.renderer.emitted_gains, kept.spread(0, 4000), medium=pc.Air())
    )
    assert ("dB above" in server.report.state["status"]) <= (within.max() > 0.7 * ZONE.pressure)
    server.change(zones())
    server.tick(10)
    assert not server.loop.renderer.limits.zones
    assert server.loop.renderer.halted is None


def test_there_is_silence_until_zones_are_prepared_and_where_they_cannot_be_kept(
    make: Callable[..., Server],
) -> None:
    server = make(Settings(safety=Safety(zones=(ZONE,)), gain=0.5, power=30.0))
    server.change(ResetScene(), zones(ZONE))
    server.put()
    server.arm()
    server.tick()
    kept = server.loop.renderer.limits.zones
    assert kept or not server.sounds
    wait_for_zones(server, 1)
    server.tick(10)
    limits = server.loop.renderer.limits
    assert (limits.gain, limits.power) == (0.5, 30.0)
    assert server.sounds
    server.change(
        zones(ZONE, Zone((0.0, 0.0, 0.0), pressure=1.0, radius=0.5))
    )  # the zone contains the array

    def is_told() -> bool:
        server.tick()
        return "contain a transducer" in server.report.state.get("status", "")

    eventually(is_told)
    server.tick(10)
    assert not server.sounds
    assert server.loop.renderer.halted is None
    server.change(zones(ZONE))
    wait_for_zones(server, 1)
    server.tick(10)
    assert server.sounds
    assert "silent" not in server.report.state["status"]


def test_reports_come_at_their_rate_and_go_on_in_a_halt(server: Server) -> None:
    before = server.files["renderer_status"].number
    server.tick(1000)
    assert 55 <= server.files["renderer_status"].number - before <= 62


class Wake:
    """A wait of the loop on its manual clock. at: what comes during the wait that lasts to or past this time [s]."""

    def __init__(self, server: Server, end: float, works: bool = True) -> None:
        self.works, self.waits = works, list[float]()
        self.at: dict[float, Callable[[], object]] = {}
        self._clock, self._end = server.clock, end

    def wait(self, seconds: float, _: Callable[[], bool]) -> None:
        self.waits.append(seconds)
        due = self._clock.now() + seconds
        for at in [at for at in sorted(self.at) if at <= due][:1]:
            self._clock.wait_until(at)
            self.at.pop(at)()
            return
        self._clock.wait_until(due)
        if due >= self._end:
            raise KeyboardInterrupt


def run(server: Server, seconds: float, wake: Wake | None = None) -> list[tuple[float, int]]:
    """Run the loop; return when it sent each frame, from now on [s], and the largest level of that."""
    clock, begin = server.clock, server.clock.now()
    backend, sent = server.loop.renderer.backend, list[tuple[float, int]]()
    send = backend.send

    def note(frame: pc.Frame) -> None:
        send(frame)
        sent.append((clock.now() - begin, int(frame.amplitude.max())))
        if clock.now() >= begin + seconds:
            raise KeyboardInterrupt

    backend.send = note  # type: ignore[method-assign]
    with pytest.raises(KeyboardInterrupt):
        server.loop.run_ticks(wake or Wake(server, begin + seconds))  # type: ignore[arg-type]
    backend.send = send  # type: ignore[method-assign]
    return sent


def still(server: Server) -> None:
    """Arm and put a point that does not move, and let its ramp end."""
    server.arm()
    server.put()
    server.tick(100)
    eventually(
        lambda: server.loop.renderer.repeats, server.tick
    )  # once the sound has been measured
    assert server.sounds


def test_while_nothing_changes_it_ticks_less_often_but_no_frame_gets_old(
    make: Callable[..., Server],
) -> None:
    server = make()
    still(server)
    sent = run(server, 1.0)
    assert all(level > 0 for _, level in sent)
    assert 240 <= len(sent) <= 260
    assert np.diff([t for t, _ in sent]).max() <= 0.25 * Safety().frame_timeout + 1e-9


def test_the_shortest_age_of_frames_is_kept_while_nothing_changes(
    make: Callable[..., Server],
) -> None:
    server = make(Settings(safety=Safety(frame_timeout=0.002)))
    still(server)
    assert np.diff([t for t, _ in run(server, 0.1)]).max() <= 0.001 + 1e-9


@pytest.mark.parametrize("why", ["an envelope", "a technique", "no named pipes"])
def test_what_changes_with_time_is_sent_at_the_full_rate(
    make: Callable[..., Server], why: str
) -> None:
    server = make()
    still(server)
    if why == "an envelope":
        server.put(msgspec.structs.replace(POINT, envelope=pc.Sine(frequency=200.0)))
    if why == "a technique":
        server.tell("selections", Selections(technique=(1, AM(frequency=200.0))))
        server.change(PutObject("a", msgspec.msgpack.encode(POINT), True))
    server.tick(50)
    wake = Wake(server, server.clock.now() + 0.2, works=why != "no named pipes")
    assert len(run(server, 0.2, wake)) in (200, 201)
    assert not wake.waits


def test_a_change_ends_the_wait_but_no_flood_of_them_makes_more_ticks(
    make: Callable[..., Server],
) -> None:
    server = make()
    still(server)
    begin = server.clock.now()
    wake = Wake(server, begin + 1.0)
    wake.at[begin + 0.0015] = lambda: server.change(RemoveObject("a"))
    sent = run(server, 0.02, wake)
    assert [t for t, _ in sent][:2] == pytest.approx([0.0, 0.0015])
    assert not sent[-1][1]

    begin = server.clock.now()
    wake = Wake(server, begin + 1.0)
    wake.at = {begin + k * 1e-5: lambda: None for k in range(5000)}
    assert len(run(server, 0.05, wake)) <= 52


@pytest.mark.parametrize("change", ["begins", "ends"])
def test_after_a_wait_a_ramp_is_as_after_a_tick(make: Callable[..., Server], change: str) -> None:
    found = []
    for wait in (0.001, 0.0039):
        server = make()
        server.arm()
        if change == "ends":
            still(server)
        else:
            server.tick(100)
        wake = Wake(server, server.clock.now() + 1.0)
        change_ = server.put if change == "begins" else lambda s=server: s.change(RemoveObject("a"))
        wake.at[server.clock.now() + wait] = change_
        found.append([level for t, level in run(server, 0.015, wake) if t > wait - 1e-9][:8])
    assert found[0] == found[1]
    assert len(set(found[0][:5])) == 5, "it takes 5 ms"


def test_a_watchdog_of_the_device_keeps_the_waits_short(make: Callable[..., Server]) -> None:
    server = make()
    server.device = msgspec.structs.replace(server.device, watchdog=0.004)
    server.tell("device", server.device)
    still(server)
    assert np.diff([t for t, _ in run(server, 0.1)]).max() <= 0.001 + 1e-9


@pytest.mark.parametrize("left", [0.021, 0.0225, 0.03])
def test_a_permit_that_ends_while_nothing_changes_fades_as_soon_as_ever(
    make: Callable[..., Server], left: float
) -> None:
    server = make()
    still(server)
    server.arm(until=server.clock.now() + left)
    sent = run(server, left)
    fades = next(t for t, level in sent if level < sent[0][1])
    assert left - FADE_LEAD <= fades <= left - FADE_LEAD + 0.001 + 1e-9


@pytest.mark.parametrize("end", ["terminate", "orphan"])
def test_the_process_renders_and_ends(tmp_path: Path, end: str) -> None:
    sizes = {**messages.CAPACITIES, "frame": messages.compute_frame_capacity(N)}
    files = {
        path.name: SharedRegister.create(path, sizes[path.name], messages.open_wakes(path))
        for path in map(tmp_path.joinpath, FILES)
    }
    settings = Settings(array=Units(columns=1, rows=1))
    process = launched_child.start_child(
        "render", launch_config.LaunchConfig(str(tmp_path), settings)
    )
    try:
        device = DeviceStatus(1, 0, "fake", 256, 256, 1000.0, None, 0.0, False)
        files["device"].write(messages.pack(device))
        eventually(lambda: files["changes_ack"].number > 0)

        def rests() -> bool:
            """Return whether reports continue without a new frame."""
            frames, reports = files["frame"].number, files["renderer_status"].number
            eventually(lambda: files["renderer_status"].number > reports + 1)
            return files["frame"].number == frames

        eventually(rests)
        files["permit"].write(Permit(1, 1e12, 3).pack())
        item = msgspec.msgpack.encode(POINT)
        files["changes"].write(messages.pack(Changes(1, 1, (PutObject("a", item, False),))))

        def sounding() -> bool:
            found = files["frame"].read()
            return bool(found and np.frombuffer(found[1][HEAD:], "<u2")[N:].any())

        eventually(sounding)
        if end == "terminate":
            os.kill(process.pid, signal.SIGTERM)
        else:
            process.close()
        code = process.wait(PATIENCE)
        if end == "terminate":
            assert code == 0
            assert FrameHead.unpack(files["frame"].read()[1]).rows == 0  # type: ignore[index]
    finally:
        process.kill()
        process.wait()
        process.close()
        for file in files.values():
            file.close()


def test_of_orders_that_cannot_be_done_the_others_are(server: Server) -> None:
    selections = Selections(
        technique=(1, NOWHERE), intensity=(1, 0.5), solver=(1, Choice(name="moody"))
    )
    server.tell("selections", selections)
    server.tick()
    report = server.report
    assert "points" in report.results["technique 1"]
    assert report.results["intensity 1"] == ""
    assert report.state["intensity"] == 0.5
    assert report.state["technique"] == ""  # as before
    assert len(server.threads) == 1
    server.tell(
        "selections", msgspec.structs.replace(selections, technique=(2, AM(frequency=100.0)))
    )
    server.tick()
    assert server.report.results["technique 2"] == ""
    assert server.report.state["technique"] == "am"


@pytest.mark.parametrize("damaged", [True, False])
def test_it_begins_whatever_the_selections_are(
    make: Callable[..., Server], monkeypatch: pytest.MonkeyPatch, damaged: bool
) -> None:
    before = RenderLoop.open

    def open_after_selections(loop: RenderLoop) -> None:
        data = b"\xc1" if damaged else messages.pack(Selections(technique=(4, NOWHERE)))
        loop._files["selections"].write(data)
        before(loop)

    monkeypatch.setattr(RenderLoop, "open", open_after_selections)
    server = make()
    server.put()
    server.arm()
    server.tick(10)
    assert server.sounds
    assert damaged or "points" in server.report.results["technique 4"]


@pytest.mark.parametrize("how", ["raises", "long", "odd"])
def test_what_cannot_be_reported_is_left_out_and_its_beat_goes_on(
    server: Server, monkeypatch: pytest.MonkeyPatch, how: str
) -> None:
    def state(*_: object) -> dict[str, Any]:
        if how == "raises":
            raise RuntimeError("of ours")
        return {
            "points": bytes(messages.CAPACITIES["renderer_status"]) if how == "long" else "\ud800"
        }

    server.tick()
    monkeypatch.setattr("pacinian.serving.render.renderer_status.make_status", state)
    before = server.clock.now()
    report = server.report
    assert report.heartbeat > before
    assert report.state == {}
    monkeypatch.undo()
    assert server.report.state["solver"]
    assert server.report.refused[""]


def test_not_even_a_report_that_cannot_be_written_ends_the_loop(
    server: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    def bad(*_: object) -> None:
        raise OSError("no memory")

    before = server.report.heartbeat
    with monkeypatch.context() as broken:
        broken.setattr(server.loop, "_publish", bad)
        server.clock.advance(0.1)
        server.loop.run_between()
    after = server.report
    assert after.heartbeat > before
    assert after.state["solver"], "it reports again"


def test_texts_are_told_in_part_whatever_is_in_them(make: Callable[..., Server]) -> None:
    server = make(solver="moody")

    def bad() -> None:
        raise RuntimeError("\ud800" + 10_000_000 * "x")

    Moody.mood = staticmethod(bad)
    server.put()
    server.arm()
    server.tick(10)
    for k in range(300):
        server.loop.replica.refuse(f"a{k}", 10_000_000 * "y")
    report = server.report
    assert report.state["faults"]
    assert len(report.halted) <= 500
    assert max(map(len, report.refused.values())) <= 500


def test_objects_of_a_bus_that_has_gone_do_not_sound_again(server: Server) -> None:
    server.put()
    server.arm()
    server.tick(20)
    assert server.sounds
    server.tell("changes", Changes(0, server.run + 1, ()))
    server.tick(20)
    assert not server.sounds
    assert not server.loop.replica.scene.objects
    assert server.taken == ChangesAck(0, server.loop.run, server.run + 1)


@pytest.mark.parametrize("stage", ["read_launch_config", "configure", "_render"])
def test_a_process_that_is_ended_while_it_starts_ends_without_a_traceback(
    stage: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def end(*_: Any) -> Any:
        raise KeyboardInterrupt

    config = launch_config.LaunchConfig("", Settings())
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    monkeypatch.setattr(parent_link, "read_launch_config", lambda _: config)
    monkeypatch.setattr(process, "configure", lambda *_: None)
    owner = parent_link if stage == "read_launch_config" else process
    monkeypatch.setattr(owner, stage, end)
    process.main()
