from __future__ import annotations

import math
import threading
import time
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pacinian as pc
from pacinian.rendering.row_times import MAX_SERVER_ROWS
from pacinian.scene.config_sections import PluginConfig
from pacinian.serving.guard.output_gate import MAX_INPUTS, OutputGate
from pacinian.serving.guard.process import REPORT_INTERVAL, REST_REPORT_INTERVAL, GuardLoop
from pacinian.serving.ipc.messages import (
    CAPACITIES,
    DeviceStatus,
    FrameHead,
    Permit,
    Selections,
    compute_frame_capacity,
    open_wakes,
    pack,
)
from pacinian.serving.ipc.shared_memory import SharedRegister
from pacinian.serving.settings import Settings
from pacinian.testing import ManualClock
from pacinian.wire.control import Choice as Selected

from ....waiting import eventually

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

N, STALE, ROUND = 5, 0.02, 0.25e-3
FOREVER = Permit(1, math.inf, 1, 0)
SIMULATED = Settings(backend=PluginConfig("simulated"))


class Recorded(pc.Backend):
    """Records its calls with their times. raises: the errors of its methods."""

    name: ClassVar[str] = "recorded"

    def __init__(self, clock: ManualClock, capability: pc.Capability | None = None) -> None:
        self.clock, self.can = clock, capability or pc.Capability()
        self.log: list[tuple[float, str, int]] = []
        self.loud = False
        self.raises: dict[str, BaseException] = {}

    @property
    def capability(self) -> pc.Capability:
        return self.can

    def _told(self, what: str, number: int = 0) -> None:
        self.log.append((self.clock.time, what, number))
        if what in self.raises:
            raise self.raises[what]
        self.loud = what == "send"

    def open(self, array: pc.Array) -> None:
        self._told("open")

    def send(self, frame: pc.Frame) -> None:
        assert frame.phase.shape == frame.amplitude.shape
        self._told("send", frame.sequence)

    def silence(self) -> None:
        self._told("silence")

    def close(self) -> None:
        self._told("close")

    @property
    def what(self) -> list[str]:
        return [what for _, what, _ in self.log]

    @property
    def sent(self) -> list[int]:
        return [number for _, what, number in self.log if what == "send"]


class Bench:
    """An output gate with a device, frames and a clock."""

    def __init__(self, **changes: Any) -> None:
        self.clock = ManualClock(100.0)
        options: dict[str, Any] = {
            "gain": 1.0,
            "frame_timeout": STALE,
            "clock": self.clock.now,
            **changes,
        }
        self.gate = OutputGate(N, **options)
        self.backend = Recorded(self.clock)
        self.gate.adopt_device(self.backend, self.backend.can)
        self.permit = FOREVER
        self.sequence = 0

    def frame(self, amplitude: int = 9, rows: int = 2, phase: int = 3, **changes: Any) -> bytes:
        self.sequence += 1
        head = FrameHead(self.sequence, self.clock.time, 1, 1, rows, N)._replace(**changes)
        levels = np.empty((2, rows, N), np.uint16)
        levels[0], levels[1] = phase, amplitude
        return head.pack() + levels.tobytes()

    def step(self, frame: bytes | None = None, after: float = ROUND, **permit: Any) -> bool:
        self.clock.advance(after)
        self.permit = self.permit._replace(**permit)
        return self.gate.step(self.permit, frame)

    def sound(self, **changes: Any) -> None:
        self.step(self.frame(**changes))
        assert self.gate.sounding
        assert self.backend.loud

    @property
    def status(self) -> DeviceStatus:
        return self.gate.make_status({}, ())


def test_a_frame_is_let_through_once() -> None:
    bench = Bench()
    bench.step(frame := bench.frame())
    for _ in range(10):
        bench.step()
    assert bench.backend.sent == [1]
    bench.step(frame)
    bench.step(bench.frame())
    assert bench.backend.sent == [1, 1, 2]
    assert bench.backend.what == ["send"] * 3


ENDS: dict[str, Callable[[Bench], None]] = {
    "stopped": lambda bench: bench.step(stopped=1),
    "disarmed": lambda bench: bench.step(armed=0),
    "expired": lambda bench: bench.step(until=bench.clock.time),
    "stale": lambda bench: bench.step(after=1.001 * STALE),
    "empty": lambda bench: bench.step(bench.frame(rows=0)),
    "waiting": lambda bench: bench.step(bench.frame(epoch=2)),
}


@pytest.mark.parametrize("reason", ENDS)
def test_whatever_ends_it_there_is_silence_in_the_same_round(reason: str) -> None:
    bench = Bench()
    bench.sound()
    bench.gate.changed = False
    ENDS[reason](bench)
    assert bench.backend.what == ["send", "silence"]
    assert not bench.gate.sounding
    assert bench.gate.changed
    assert bench.status.reasons == {reason: 1}
    assert bench.status.silences == 1
    for _ in range(5):
        bench.step()
    assert bench.backend.what == ["send", "silence"]


@pytest.mark.parametrize(
    "permit",
    [
        FOREVER._replace(armed=0),
        FOREVER._replace(stopped=1),
        FOREVER._replace(until=100.0),
        FOREVER._replace(until=math.nan),
        FOREVER._replace(epoch=2),
        Permit(),
    ],
)
def test_nothing_is_let_through_without_a_permit(permit: Permit) -> None:
    bench = Bench()
    bench.permit = permit
    for _ in range(200):
        bench.step(bench.frame())
    assert bench.backend.log == []


@pytest.mark.parametrize("change", [{"epoch": 0}, {"epoch": 2}, {"device": 0}, {"device": 2}])
def test_frames_made_for_something_else_are_silence(change: dict[str, int]) -> None:
    bench = Bench()
    bench.sound()
    bench.step(bench.frame(**change))
    assert bench.backend.what == ["send", "silence"]


def test_a_renewal_moves_the_end() -> None:
    bench = Bench()
    bench.permit = FOREVER._replace(until=bench.clock.time + 0.25)
    for _ in range(20):
        bench.step(bench.frame(), 0.1, until=bench.clock.time + 0.25)
    assert "silence" not in bench.backend.what
    bench.step(bench.frame(), 0.1)
    assert bench.gate.sounding
    bench.step(bench.frame(), 0.1)
    assert bench.backend.what[-1] == "silence"


def test_what_was_made_before_the_last_arming_is_never_heard() -> None:
    bench = Bench()
    bench.sound()
    bench.step(armed=0)
    old = bench.frame()
    bench.step(old)
    bench.step(old, armed=1, epoch=2)
    assert bench.backend.sent == [1]
    bench.step(bench.frame(epoch=2))
    assert bench.backend.sent == [1, 3]


def test_a_frame_that_comes_before_its_permit_waits_for_it() -> None:
    bench = Bench()
    bench.step(bench.frame(epoch=2))
    bench.step(epoch=2)
    assert bench.backend.sent == [1]


def test_one_that_has_waited_too_long_is_not_sent() -> None:
    bench = Bench()
    bench.step(bench.frame(), armed=0)
    bench.step(after=1.001 * STALE, armed=1)
    assert bench.backend.sent == []


def test_late_frames_are_silence_until_they_go_on() -> None:
    bench = Bench()
    bench.sound()
    bench.step(after=0.9 * STALE)
    assert bench.gate.sounding
    bench.step(after=0.11 * STALE)
    assert not bench.gate.sounding
    assert bench.status.stale
    bench.sound()
    assert not bench.status.stale
    assert bench.status.reasons == {"stale": 1}


def test_no_frame_after_arming_is_stale_but_not_at_once() -> None:
    bench = Bench()
    bench.step()
    bench.step(after=0.9 * STALE)
    assert not bench.status.stale
    bench.step(after=0.2 * STALE)
    assert bench.status.stale
    bench.step(epoch=2)
    assert not bench.status.stale
    bench.step(armed=0, after=1.0)
    assert not bench.status.stale


def test_an_empty_frame_is_no_fault_and_not_stale() -> None:
    bench = Bench()
    for _ in range(100):
        bench.step(bench.frame(rows=0), 1e-3)
    assert bench.backend.log == []
    assert not bench.status.stale
    assert not bench.status.fault


BAD: dict[str, Callable[[Bench], bytes]] = {
    "above the gain limit": lambda bench: bench.frame(amplitude=128),
    "phase beyond the device": lambda bench: bench.frame(phase=256),
    "too many rows": lambda bench: bench.frame(rows=MAX_SERVER_ROWS + 1),
    "negative rows": lambda bench: FrameHead(1, 0.0, 1, 1, -1, N).pack(),
    "fewer columns": lambda bench: bench.frame(columns=N - 1),
    "cut off": lambda bench: bench.frame()[:-1],
    "no head": lambda bench: bench.frame()[:71],
    "nothing": lambda bench: b"",
}


@pytest.mark.parametrize("what", BAD)
def test_a_frame_that_no_device_should_get_is_a_fault(what: str) -> None:
    bench = Bench(gain=0.5)  # 127 of 255
    bench.sound(amplitude=127)
    bench.step(BAD[what](bench))
    assert bench.backend.what == ["send", "silence"]
    assert bench.status.fault
    for _ in range(50):
        bench.step(bench.frame(amplitude=1))
    assert bench.backend.what == ["send", "silence"]
    bench.gate.clear()
    bench.sound(amplitude=127)


PULSES = tuple(np.sin(np.pi / 2.0 * np.arange(65) / 64.0).tolist())


@given(st.floats(0.01, 1.0), st.sampled_from([2, 16, 256, 65_536, PULSES]), st.floats(0.0, 1.0))
def test_the_ceiling_is_what_the_renderer_rounds_to(gain: float, levels: Any, part: float) -> None:
    from pacinian.rendering.quantiser import Quantiser

    bench = Bench(gain=gain)
    can = pc.Capability(256, levels)
    bench.gate.adopt_device(bench.backend, can)
    gains = np.full((1, N), gain * max(part, 0.5), np.complex64)
    made = Quantiser(can, 1, N).make_frame(gains, gain, 1, 0.0)
    top = Quantiser(can, 1, N).make_frame(gains * 10.0, gain, 1, 0.0)
    head = FrameHead(1, 0.0, 1, 2, 1, N).pack()
    for frame in (made, top):
        data = head + frame.phase.tobytes() + frame.amplitude.tobytes()
        bench.step(data)
        bench.step()
        assert not bench.gate.fault
    above = top.amplitude.astype(np.int64) + 1
    if above.max() < len(can.sizes):
        bench.step(head + top.phase.tobytes() + above.astype(np.uint16).tobytes())
        assert bench.gate.fault


def test_a_device_that_refuses_a_frame_is_a_fault_until_it_is_mended() -> None:
    bench = Bench()
    bench.sound()
    bench.backend.raises["send"] = pc.BackendError("unplugged")
    bench.step(bench.frame())
    assert bench.backend.what == ["send", "send", "silence"]
    assert bench.status.fault == "unplugged"
    assert not bench.status.sounding
    bench.backend.raises.clear()
    bench.step(bench.frame())
    assert bench.backend.what == ["send", "send", "silence"]
    bench.gate.clear()
    bench.sound()


@pytest.mark.parametrize("error", [OSError("gone"), ZeroDivisionError(), RuntimeError("x" * 9999)])
def test_silence_is_asked_for_every_round_until_it_works(error: Exception) -> None:
    bench = Bench()
    bench.sound()
    bench.backend.raises["silence"] = error
    for _ in range(7):
        bench.step(bench.frame(), stopped=1)
        assert bench.gate.loud
    assert bench.backend.what == ["send"] + ["silence"] * 7
    assert bench.status.sounding  # it may still sound
    assert type(error).__name__ in bench.status.fault
    bench.backend.raises.clear()
    bench.step()
    bench.step()
    assert bench.backend.what == ["send"] + ["silence"] * 8
    assert not bench.status.sounding


def test_a_device_takes_over_with_the_first_frame_for_it() -> None:
    bench = Bench()
    other = Recorded(bench.clock)
    bench.sound()
    assert bench.gate.adopt_device(other, pc.Capability(64, 32, 2000.0, 0.1)) == 2
    told = bench.status
    assert (told.generation, told.next_generation) == (1, 2)
    assert (told.phases, told.amplitudes, told.rate, told.watchdog) == (64, 32, 2000.0, 0.1)
    assert told.sizes == b""
    assert not bench.step(bench.frame())
    assert bench.backend.sent == [1, 2]
    assert bench.step(bench.frame(device=2)), "and the next round at once"
    assert not bench.step(after=0.0)
    assert bench.backend.what == ["send", "send", "silence"]
    assert other.log == [(bench.clock.time, "send", 3)]
    assert (bench.status.generation, bench.status.next_generation) == (2, 0)
    assert bench.gate.to_close == [bench.backend]
    bench.step(bench.frame())  # still for the old device
    assert other.what == ["send", "silence"]


def test_it_takes_over_while_nothing_is_permitted_too() -> None:
    bench = Bench()
    other = Recorded(bench.clock)
    bench.gate.adopt_device(other, other.can)
    bench.step(bench.frame(device=2), armed=0)
    assert bench.status.generation == 2
    assert other.log == bench.backend.log == []


def test_a_third_device_supersedes_the_one_that_waits() -> None:
    bench = Bench()
    second, third = Recorded(bench.clock), Recorded(bench.clock)
    bench.gate.adopt_device(second, second.can)
    bench.gate.adopt_device(third, third.can)
    assert bench.gate.to_close == [second]
    bench.step(bench.frame(device=2))
    assert bench.status.generation == 1
    bench.step(bench.frame(device=3))
    bench.step()
    assert third.sent == [2]


def test_no_other_device_sounds_before_one_that_refuses_to_be_silent_is_closed() -> None:
    bench = Bench()
    other = Recorded(bench.clock)
    bench.sound()
    bench.backend.raises["silence"] = OSError("stuck")
    bench.gate.adopt_device(other, other.can)
    for _ in range(5):
        bench.step(bench.frame(device=2))
        assert other.log == []
        assert "stuck" in bench.status.fault
        assert bench.status.sounding, "no stop may be confirmed"
    assert bench.gate.to_close == [bench.backend]  # waits to be closed
    bench.gate.clear()
    for _ in range(3):
        bench.step(bench.frame(device=2))
        assert other.log == []
        assert "stuck" in bench.status.fault  # control sees one and the same fault
    left = bench.gate.to_close.pop()
    left.close()
    bench.gate.changed = False
    bench.gate.mark_closed(left)
    assert bench.gate.changed
    assert not bench.status.fault
    bench.step(bench.frame(device=2))
    assert other.what == ["send"]
    bench.gate.mark_closed(left)  # a second call changes nothing


def test_frames_counts_gaps() -> None:
    bench = Bench()
    for k in range(4):
        bench.step(bench.frame(), 1e-3)
        assert bench.status.frames == k + 1
    assert bench.status.longest_gap == pytest.approx(1e-3)
    bench.step(bench.frame(), 7e-3)
    bench.step(bench.frame(), 1e-3)
    assert bench.status.longest_gap == pytest.approx(7e-3)
    bench.step(after=1.0)  # stale
    bench.sound()
    assert bench.status.longest_gap == pytest.approx(1.0 + ROUND)
    bench.step(epoch=2, after=5.0)  # armed again
    bench.step(bench.frame(epoch=2))
    assert bench.status.longest_gap == 0.0
    assert bench.status.frames == 8


def inputs(bench: Bench) -> list[list[float]]:
    return np.frombuffer(bench.status.inputs, "<f8").reshape(-1, 4).tolist()  # type: ignore[no-any-return]


def test_each_input_is_noted_once_when_it_is_emitted() -> None:
    bench = Bench()
    bench.step(bench.frame(input=5, sent=1.5, received=99.0))
    first = bench.clock.time
    bench.step(bench.frame(input=5, sent=1.5, received=99.0))
    bench.step(
        bench.frame(input=7, sent=1.6, received=99.1), armed=0
    )  # not emitted, because it is not armed
    bench.step(
        bench.frame(rows=0, input=8, sent=1.7, received=99.2), armed=1
    )  # silence, because the hand is lost
    assert inputs(bench) == [[5.0, 1.5, 99.0, first], [8.0, 1.7, 99.2, bench.clock.time]]
    assert bench.status.input_count == 2


def test_the_last_inputs_are_kept() -> None:
    bench = Bench()
    for k in range(1, MAX_INPUTS + 50):
        bench.step(bench.frame(input=k))
    assert [row[0] for row in inputs(bench)] == list(range(50, MAX_INPUTS + 50))
    assert bench.status.input_count == MAX_INPUTS + 49


def test_without_a_device_nothing_happens() -> None:
    bench = Bench()
    bench.sound()
    assert bench.gate.release() is bench.backend
    assert bench.status.generation == 0
    for _ in range(5):
        bench.step(bench.frame())
    assert bench.backend.what == ["send"]
    bench.gate.mark_closed(bench.backend)
    bench.gate.adopt_device(bench.backend, bench.backend.can)
    bench.step(bench.frame())
    bench.step(bench.frame(device=2))
    assert bench.backend.sent == [1, 8]


def test_generations_go_on_after_a_restart() -> None:
    """Until it has a device, the output of the earlier guard may still sound."""
    last = Bench().status
    guard = OutputGate(N, gain=1.0, frame_timeout=STALE)
    guard.take_over_from(msgspec.structs.replace(last, generation=7, sounding=True))
    assert (guard.make_status({}, ()).generation, guard.sounding) == (0, True)
    backend = Recorded(ManualClock())
    guard.adopt_device(backend, backend.can)
    assert (guard.make_status({}, ()).generation, guard.sounding) == (8, False)


@given(
    st.lists(
        st.tuples(
            st.sampled_from(["frame", "old", "empty", "other", "cut", "none"]),
            st.sampled_from([ROUND, 1e-3, 0.5 * STALE, STALE, 0.3]),
            st.fixed_dictionaries(
                {},
                optional={
                    "armed": st.sampled_from([0, 1, 2]),
                    "stopped": st.sampled_from([0, 1]),
                    "lease": st.sampled_from([0.0, 0.001, 0.25]),
                    "epoch": st.integers(0, 3),
                    "send": st.booleans(),
                    "silence": st.booleans(),
                    "clear": st.just(value=True),
                    "take": st.just(value=True),
                    "close": st.just(value=True),
                },
            ),
        ),
        max_size=60,
    )
)
@settings(max_examples=150)
def test_whatever_happens_it_sounds_only_while_it_may(story: list[Any]) -> None:
    bench, fed = Bench(), -math.inf
    devices = [bench.backend]
    for kind, after, what in story:
        guard, now = bench.gate, bench.clock.time + after
        if what.get("take"):
            devices.append(Recorded(bench.clock))
            guard.adopt_device(devices[-1], devices[-1].can)
        if what.get("clear"):
            guard.clear()
        if what.get("close"):
            while guard.to_close:
                left = guard.to_close.pop()
                left.close()
                guard.mark_closed(left)
        for device in devices:
            device.raises = {k: OSError() for k in ("send", "silence") if what.get(k)}
        permit = {k: what[k] for k in ("armed", "stopped", "epoch") if k in what}
        if "lease" in what:
            permit["until"] = now + what["lease"]
        epoch, aim = (
            permit.get("epoch", bench.permit.epoch),
            guard.next_generation or guard.generation,
        )
        changes: dict[str, dict[str, int]] = {
            "old": {"epoch": epoch - 1},
            "empty": {"rows": 0},
            "other": {"device": 99},
        }
        made = bench.frame(**{"epoch": epoch, "device": aim, **changes.get(kind, {})})
        made = made[:80] if kind == "cut" else made
        fed = now if kind != "none" else fed
        before = [len(device.log) for device in devices]
        bench.step(None if kind == "none" else made, after, **permit)
        may = (
            bench.permit.armed
            and not bench.permit.stopped
            and now < bench.permit.until
            and now - fed < STALE
            and not guard.problem
        )
        assert sum(device.loud for device in devices) <= 1
        assert not may or not any(device.loud for device in guard.to_close)
        for device, count in zip(devices, before, strict=True):
            asked = [name for _, name, _ in device.log[count:]]
            if device.loud and not may:
                assert guard.problem
                if device not in guard.to_close:
                    assert "silence" in asked  # and it failed
                    assert what.get("silence")
            if "send" in asked:
                assert may or what.get("send")


NEWS: dict[str, tuple[Callable[[Bench], object], Callable[[Bench], object]]] = {
    "it sounds": (lambda bench: None, Bench.sound),
    "it is silent": (Bench.sound, lambda bench: bench.step(armed=0)),
    "frames are late": (Bench.sound, lambda bench: bench.step(after=1.001 * STALE)),
    "they go on": (
        lambda bench: [bench.step(after=1.001 * STALE) for _ in range(2)],
        lambda bench: bench.step(bench.frame(rows=0)),
    ),
    "a device comes": (
        lambda bench: None,
        lambda bench: bench.gate.adopt_device(Recorded(bench.clock), pc.Capability()),
    ),
    "it takes over": (
        lambda bench: bench.gate.adopt_device(Recorded(bench.clock), pc.Capability()),
        lambda bench: bench.step(bench.frame(device=2, rows=0)),
    ),
    "a fault": (lambda bench: None, lambda bench: bench.gate.fail("unplugged")),
    "a bad frame": (Bench.sound, lambda bench: bench.step(b"")),
    "it is mended": (
        lambda bench: bench.gate.fail("unplugged"),
        lambda bench: bench.gate.clear(),
    ),
}


@pytest.mark.parametrize("what", NEWS)
def test_others_are_to_know_at_once_what_is_new_and_nothing_else(what: str) -> None:
    bench = Bench()
    before, happens = NEWS[what]
    before(bench)
    bench.gate.changed = False
    bench.step()
    assert not bench.gate.changed
    happens(bench)
    assert bench.gate.changed
    bench.gate.changed = False
    bench.step()
    bench.step()
    assert not bench.gate.changed


@pytest.fixture
def memory(tmp_path: Path) -> Iterator[dict[str, SharedRegister]]:
    """Make the shared memory of a guard in `tmp_path`."""
    sizes = {**CAPACITIES, "frame": compute_frame_capacity(len(SIMULATED.array.make()))}
    files = {
        name: SharedRegister.create(tmp_path / name, sizes[name], open_wakes(tmp_path / name))
        for name in ("permit", "frame", "selections", "device")
    }
    yield files
    for file in files.values():
        file.close()


def write_frame(memory: dict[str, SharedRegister], device: int) -> None:
    """Write a frame that sounds."""
    N = len(SIMULATED.array.make())
    head = FrameHead(1, 0.0, FOREVER.epoch, device, 1, N)
    memory["frame"].write(head.pack() + np.full((2, 1, N), 5, np.uint16).tobytes())


def open_device(rounds: GuardLoop, each: Callable[[], object] = lambda: None) -> None:
    """Run rounds until a device is open. each: called before every round."""
    eventually(lambda: rounds.gate.backend, lambda: (each(), rounds.run_round()))


def test_it_looks_again_in_a_quarter_of_a_millisecond_while_there_may_be_sound_or_at_once(
    memory: dict[str, SharedRegister], tmp_path: Path
) -> None:
    """This bounds how late an end of sound is noticed. Another device is used without a wait."""
    with GuardLoop(tmp_path, SIMULATED) as rounds:
        open_device(rounds)
        assert 0.0 < rounds.run_round() <= 1e-3
        memory["permit"].write(FOREVER.pack())
        assert 0.0 < rounds.run_round() <= 0.25e-3
        other = Recorded(ManualClock())
        rounds.gate.adopt_device(other, other.can)
        write_frame(memory, 2)
        assert rounds.run_round() == 0.0
        assert 0.0 < rounds.run_round() <= 0.25e-3
        assert rounds.gate.backend is other
        write_frame(memory, 2)
        rounds.run_round()
        assert other.loud
        other.raises["silence"] = OSError("stuck")
        memory["permit"].write(FOREVER._replace(armed=0).pack())
        for _ in range(3):  # no longer permitted, but it still sounds
            assert 0.0 < rounds.run_round() <= 0.25e-3
        other.raises.clear()
        rounds.run_round()
        assert not other.loud


def test_a_frame_ends_its_wait_and_so_does_the_time_when_there_must_be_silence(
    memory: dict[str, SharedRegister], tmp_path: Path
) -> None:
    """If the wait did not end, this test would hang. If it ended late, sound would last too long.

    After a stall of this process, the frame may be too old at once. The guard then does not wait for news.
    """

    def wait_for_news() -> None:
        rounds.wait(1e4 if rounds._listens else 1e-3)

    with GuardLoop(tmp_path, SIMULATED) as rounds:
        rounds.backends = ()
        open_device(rounds)
        now = time.perf_counter()
        memory["permit"].write(FOREVER._replace(until=now + 3600.0).pack())
        rounds.run_round()
        threading.Timer(0.01, write_frame, [memory, rounds.gate.generation]).start()
        while not rounds.gate.loud:
            wait_for_news()
            rounds.run_round()
        assert rounds.gate.compute_time_left(rounds._permit.value) <= SIMULATED.safety.frame_timeout
        memory["permit"].write(FOREVER._replace(until=time.perf_counter() + 1e-3).pack())
        wait_for_news()
        assert rounds.run_round() <= 1e-3 or not rounds.gate.loud
        while rounds.gate.loud:
            rounds.wait(rounds.run_round())
        assert rounds.gate.compute_time_left(rounds._permit.value) == math.inf


def test_without_a_permit_it_rests_until_a_permit_or_orders_wake_it(
    memory: dict[str, SharedRegister], tmp_path: Path
) -> None:
    """A permit and a selection come before or during a wait. If they did not end the wait, this test would hang."""
    with GuardLoop(tmp_path, SIMULATED) as rounds:
        rounds.backends = ()
        open_device(rounds)
        eventually(lambda: rounds.run_round() == REST_REPORT_INTERVAL)
        memory["permit"].write(FOREVER.pack())
        rounds.wait(1e4)
        assert rounds.run_round() <= REPORT_INTERVAL
        memory["permit"].write(FOREVER._replace(armed=0).pack())
        assert rounds.run_round() == REST_REPORT_INTERVAL
        rounds.wait(1e4)
        selections = pack(Selections(backend=(1, Selected(name="simulated"))))
        threading.Timer(0.01, memory["selections"].write, [selections]).start()
        rounds.wait(1e4)

        def follow() -> None:
            assert (
                rounds.run_round() < REST_REPORT_INTERVAL
            )  # another device is opened, then waits for its frame
            write_frame(memory, 2)

        eventually(lambda: rounds.gate.generation == 2, follow)


def test_it_is_told_every_ten_milliseconds_and_at_once_when_something_is_new(
    memory: dict[str, SharedRegister], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = ManualClock()
    monkeypatch.setattr(
        "pacinian.serving.guard.process.time",
        SimpleNamespace(perf_counter=clock.now, sleep=clock.advance),
    )
    news = memory["device"]

    def read_status() -> DeviceStatus:
        read = news.read()
        assert read is not None
        return msgspec.msgpack.decode(read[1], type=DeviceStatus)

    with GuardLoop(tmp_path, SIMULATED) as rounds:
        open_device(rounds)
        rounds.run_round()
        assert news.number == 0  # before the other backends are known
        rounds.backends = ()
        rounds.run_round()
        assert news.number == 1
        assert read_status().name == "simulated"
        for _ in range(20):
            rounds.run_round()
        clock.advance(0.009)
        rounds.run_round()
        assert news.number == 1
        clock.advance(0.002)
        rounds.run_round()
        rounds.run_round()
        assert news.number == 2
        memory["permit"].write(FOREVER.pack())
        write_frame(memory, 1)
        rounds.run_round()
        assert (news.number, read_status().sounding) == (3, True)
        memory["permit"].write(FOREVER._replace(armed=0).pack())
        rounds.run_round()
        assert (news.number, read_status().sounding) == (4, False)
        rounds.run_round()
        assert news.number == 4
    last = news.number

    rounds = GuardLoop(tmp_path, SIMULATED)  # another guard, which takes over the status
    opens: list[Callable[[], None]] = []
    monkeypatch.setattr(rounds.devices, "_thread", opens.append)
    memory["permit"].write(FOREVER.pack())
    with rounds:
        rounds.run_round()
        assert news.number == last + 1, "it lives"
        assert read_status().generation == 0, "but has no device yet"
        opens.pop()()
        rounds.run_round()
        rounds.run_round()
        assert read_status().generation == 2
        assert read_status().choice == PluginConfig("simulated")
        assert not read_status().sounding  # the frame was for the earlier device


def test_at_the_end_all_devices_are_closed_even_if_it_cannot_be_told(
    memory: dict[str, SharedRegister], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = ManualClock()
    backends = [Recorded(clock) for _ in range(3)]
    backends[0].raises["close"] = OSError("gone")
    rounds = GuardLoop(tmp_path, SIMULATED)

    def bad() -> None:
        raise RuntimeError("told by a plug-in")

    monkeypatch.setattr(rounds, "publish_status", bad)
    with rounds:
        for backend in backends[:2]:
            rounds.gate.adopt_device(backend, backend.can)
        rounds.gate.to_close.append(backends[2])
    assert [backend.what[-1] for backend in backends] == ["close"] * 3


@pytest.mark.parametrize("read_before", [False, True])
def test_a_guard_takes_over_from_one_whose_status_cannot_be_read(
    memory: dict[str, SharedRegister], tmp_path: Path, read_before: bool
) -> None:
    """Its device gets a generation that no earlier one had. read_before: by this guard, as a spare."""
    told = OutputGate(N, gain=1.0, frame_timeout=STALE).make_status({}, ())
    for watchdog in (None, "x"):
        status = msgspec.structs.replace(told, generation=1, watchdog=watchdog, sounding=True)
        memory["device"].write(pack(status))
    rounds = GuardLoop(tmp_path, SIMULATED)
    if read_before:
        assert rounds.read_heartbeat() == (0.0, False)
    with rounds:
        assert rounds.backends is None, "they are listed again"
        assert not rounds.first
        assert rounds.gate.sounding, "the device of the other guard may sound"
        open_device(rounds)
        assert rounds.gate.generation == 3
        assert not rounds.gate.sounding


def test_at_the_end_all_devices_are_closed_even_if_one_exits(
    memory: dict[str, SharedRegister], tmp_path: Path
) -> None:
    backends = [Recorded(ManualClock()) for _ in range(2)]
    backends[0].raises["close"] = SystemExit(3)
    with GuardLoop(tmp_path, SIMULATED) as rounds:
        for backend in backends:
            rounds.gate.adopt_device(backend, backend.can)
    assert [backend.what[-1] for backend in backends] == ["close"] * 2
