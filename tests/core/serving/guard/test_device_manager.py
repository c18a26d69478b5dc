from __future__ import annotations

import math
from collections.abc import Callable
from typing import ClassVar

import msgspec
import numpy as np
import pytest

import pacinian as pc
from pacinian.scene.config_sections import PluginConfig
from pacinian.serving.guard.device_manager import (
    MAX_HANGING,
    MAX_RESULTS,
    OPEN_TIMEOUT,
    RETRY_TIME,
    DeviceManager,
)
from pacinian.serving.guard.output_gate import OutputGate
from pacinian.serving.ipc.messages import SUPERSEDED, DeviceStatus, FrameHead, Permit, Selections
from pacinian.testing import ManualClock
from pacinian.wire.control import Choice

from ....waiting import eventually

ARRAY = pc.autd()
N = len(ARRAY)


class Named(pc.Backend):
    name: ClassVar[str] = "named"

    def __init__(self, called: str, broken: set[str]) -> None:
        self.called, self.broken, self.log = called, broken, list[str]()
        self.rate = 1000.0
        self.fields: dict[str, object] = {}  # of its capability
        self.opens: Callable[[], None] = lambda: None

    @property
    def capability(self) -> pc.Capability:
        made = pc.Capability()
        for name, value in {"rate": self.rate, **self.fields}.items():
            object.__setattr__(made, name, value)  # as a plug-in may set it
        return made

    def _told(self, what: str) -> None:
        self.log.append(what)
        if what in self.broken:
            raise OSError(f"{what} failed")

    def open(self, array: pc.Array) -> None:
        self._told("open")
        self.opens()

    def send(self, frame: pc.Frame) -> None:
        self._told("send")

    def silence(self) -> None:
        self._told("silence")

    def close(self) -> None:
        self._told("close")


class Bench:
    """A device switcher whose threads run when the test says so."""

    def __init__(self, choice: Choice | PluginConfig | None = None) -> None:
        self.clock = ManualClock()
        self.gate = OutputGate(N, gain=1.0, frame_timeout=0.02, clock=ManualClock().now)
        self.hang = ""  # name of a device that opens too late
        self.busy = 0  # number of further attempts to open that fail
        self.broken: dict[str, set[str]] = {}
        self.rates: dict[str, float] = {}
        self.fields: dict[str, dict[str, object]] = {}
        self.made: list[Named] = []
        self.waiting: list[Callable[[], None]] = []
        self.threads = True  # whether threads can be started
        self.devices = DeviceManager(
            self.gate, ARRAY, choice or Choice(name="a"), 1000.0, self.make, self.start, self.clock
        )

    def make(self, choice: Choice | PluginConfig) -> pc.Backend:
        self.made.append(Named(choice.name, self.broken.get(choice.name, set())))
        self.made[-1].rate = self.rates.get(choice.name, 1000.0)
        self.made[-1].fields = self.fields.get(choice.name, {})
        if self.busy:
            self.busy -= 1
            self.made[-1].broken = {"open"}
        if choice.name == self.hang:
            self.made[-1].opens = self.late
        return self.made[-1]

    def start(self, work: Callable[[], None]) -> None:
        if not self.threads:
            raise RuntimeError("can't start new thread")
        self.waiting.append(work)

    def late(self) -> None:
        """Take too long to open, while the guard continues."""
        self.clock.advance(1.1 * OPEN_TIMEOUT)
        self.devices.poll()

    def run(self) -> None:
        self.devices.poll()
        while self.waiting:
            self.waiting.pop(0)()
            self.devices.poll()

    def frame(self) -> None:
        """Send a frame for the next device if there is one, otherwise for the present one."""
        device = self.gate.next_generation or self.gate.generation
        head = FrameHead(1, 0.0, 1, device, 1, N).pack()
        for _ in range(2):
            self.gate.step(Permit(1, 1.0, 1, 0), head + b"\x01\0" * 2 * N)
        self.devices.poll()

    @property
    def now(self) -> str:
        backend = self.gate.backend
        return backend.called if isinstance(backend, Named) else ""


@pytest.fixture
def bench() -> Bench:
    made = Bench()
    made.devices.begin(Selections())
    made.run()
    return made


def selected(number: int, name: str, reset: int = 0) -> Selections:
    return Selections(backend=(number, Choice(name=name)), reset=reset)


def test_it_begins_as_configured(bench: Bench) -> None:
    assert bench.now == "a"
    assert bench.gate.generation == 1
    assert bench.devices.results == {"backend 0": ""}


def test_a_guard_started_anew_begins_with_what_was_selected() -> None:
    bench = Bench()
    bench.devices.begin(selected(3, "b", reset=2))
    bench.run()
    bench.devices.follow(selected(3, "b", reset=2))
    assert bench.now == "b"
    assert bench.devices.results == {"backend 3": ""}
    assert not bench.waiting


def test_another_one_takes_over_with_its_first_frame_and_the_old_one_is_closed(
    bench: Bench,
) -> None:
    bench.frame()
    bench.devices.follow(selected(1, "b"))
    bench.devices.follow(selected(1, "b"))
    bench.frame()
    assert bench.now == "a"  # while b opens
    bench.run()
    assert bench.now == "a"
    assert "backend 1" not in bench.devices.results
    bench.frame()
    bench.run()
    assert bench.now == "b"
    assert bench.devices.results["backend 1"] == ""
    assert [device.log for device in bench.made] == [
        ["open", *["send"] * 4, "silence", "close"],
        ["open", "send"],
    ]


def test_one_that_does_not_open_leaves_the_old_one_sounding(bench: Bench) -> None:
    bench.broken["b"] = {"open"}
    bench.frame()
    bench.devices.follow(selected(1, "b"))
    bench.run()
    bench.frame()
    assert bench.now == "a"
    assert bench.gate.sounding
    assert bench.devices.results["backend 1"] == "b: OSError: open failed"
    assert not bench.gate.fault
    bench.made[0].broken.add("send")
    bench.frame()
    bench.made[0].broken.clear()
    bench.devices.follow(selected(1, "b", reset=1))
    bench.run()
    assert bench.now == "a"  # the reset opens the working device again, not the one that failed


def test_one_is_opened_at_a_time_and_of_those_that_wait_the_newest(bench: Bench) -> None:
    for number in range(1, 10):
        bench.devices.follow(selected(number, f"b{number}"))
    assert len(bench.waiting) == 1
    bench.run()
    bench.frame()
    bench.run()
    assert bench.now == "b9"
    replaced = {f"backend {number}": SUPERSEDED for number in range(1, 9)}
    assert bench.devices.results == {"backend 0": "", **replaced, "backend 9": ""}
    assert [device.called for device in bench.made] == ["a", "b1", "b9"]
    assert bench.made[1].log == ["open", "close"]


def test_one_that_waits_for_its_first_frame_gives_way_to_one_selected_since(bench: Bench) -> None:
    bench.frame()
    bench.devices.follow(selected(1, "b"))
    bench.run()
    assert bench.gate.next_generation == 2
    bench.devices.follow(selected(2, "c"))
    bench.run()
    assert bench.devices.results["backend 1"] == SUPERSEDED
    bench.frame()
    bench.run()
    assert bench.now == "c"
    assert bench.devices.results["backend 2"] == ""
    assert bench.made[1].log == ["open", "close"]


def test_one_that_is_opened_too_late_never_waits_for_a_frame(bench: Bench) -> None:
    bench.frame()
    bench.devices.follow(selected(1, "b"))
    bench.devices.follow(selected(2, "c"))  # while b opens
    bench.waiting.pop(0)()
    bench.devices.poll()
    assert bench.gate.next_generation == 0
    assert bench.devices.results["backend 1"] == SUPERSEDED
    bench.run()
    bench.frame()
    assert bench.now == "c"
    assert [device.called for device in bench.made] == ["a", "b", "c"]


@pytest.mark.parametrize("opens", [True, False])
@pytest.mark.parametrize("newer", [True, False])
def test_a_reset_waits_for_what_is_being_opened(bench: Bench, opens: bool, newer: bool) -> None:
    bench.frame()
    bench.broken["b"] = set() if opens else {"open"}
    bench.devices.follow(selected(1, "b"))
    bench.made[0].broken.add("send")
    bench.frame()
    assert bench.gate.fault
    bench.devices.follow(selected(1, "b", reset=1))
    if newer:
        bench.devices.follow(selected(2, "c", reset=1))
    assert len(bench.waiting) == 1
    bench.run()
    bench.frame()
    bench.run()
    assert bench.now == ("c" if newer else "b" if opens else "a")
    assert not bench.gate.fault
    assert bench.devices.results["reset 1"] == ""
    assert bench.made[0].log[-1] == "close"
    bench.frame()
    assert bench.gate.sounding


@pytest.mark.parametrize("rate", [999.0, 64_600.0, math.nan, math.inf, -1000.0])
def test_a_device_whose_rate_the_loop_cannot_serve_is_refused(bench: Bench, rate: float) -> None:
    bench.rates["b"] = rate
    bench.frame()
    bench.devices.follow(selected(1, "b"))
    bench.run()
    bench.frame()
    assert bench.now == "a"
    assert bench.gate.sounding
    assert "rows a tick" in bench.devices.results["backend 1"]
    assert bench.made[1].log == ["close"]


def test_a_reset_opens_a_faulty_device_anew(bench: Bench) -> None:
    bench.frame()
    bench.made[0].broken.add("send")
    bench.frame()
    assert bench.gate.fault
    bench.devices.follow(Selections(reset=1))
    bench.frame()  # meanwhile there is no device
    bench.run()
    assert bench.made[0].log[-1] == "close"
    assert not bench.gate.fault
    assert bench.gate.generation == 2
    assert bench.devices.results["reset 1"] == ""
    bench.frame()
    assert bench.gate.sounding


def test_a_device_that_is_still_gone_stays_a_fault(bench: Bench) -> None:
    bench.broken["a"] = bench.made[0].broken
    bench.broken["a"] |= {"open", "send", "silence", "close"}
    bench.frame()
    for k in (1, 2):
        bench.devices.follow(Selections(reset=k))
        bench.run()
        assert bench.gate.fault == bench.devices.results[f"reset {k}"] == "a: OSError: open failed"
    bench.broken["a"].clear()
    bench.devices.follow(Selections(reset=3))
    bench.run()
    assert not bench.gate.fault
    assert bench.now == "a"


def test_a_reset_without_a_fault_leaves_the_device_alone(bench: Bench) -> None:
    bench.frame()
    bench.devices.follow(Selections(reset=1))
    bench.run()
    assert bench.gate.sounding
    assert bench.devices.results["reset 1"] == ""
    assert len(bench.made) == 1


def test_a_reset_gives_way_to_the_device_that_waits(bench: Bench) -> None:
    bench.frame()
    bench.devices.follow(selected(1, "b"))
    bench.run()
    bench.made[0].broken |= {"send", "silence", "close"}
    bench.gate.fail("gone")
    bench.devices.follow(selected(1, "b", reset=1))
    bench.frame()  # the old device may sound until it is closed
    assert bench.now == "b"
    assert bench.gate.problem == "gone"
    assert bench.made[1].log == ["open"]
    bench.run()
    assert not bench.gate.problem
    bench.frame()
    assert "send" in bench.made[1].log
    assert bench.devices.results == {"backend 0": "", "reset 1": "", "backend 1": ""}
    assert bench.made[0].log[-1] == "close"


def test_a_first_device_that_does_not_open_is_a_fault() -> None:
    bench = Bench()
    bench.broken["a"] = {"open"}
    bench.devices.begin(Selections())
    bench.run()
    assert "open failed" in bench.gate.fault
    bench.devices.follow(selected(1, "b"))
    bench.run()
    assert bench.now == "b"
    bench.devices.follow(selected(1, "b", reset=1))
    bench.run()
    assert not bench.gate.fault


def fail_to_make(error: BaseException) -> Bench:
    """Return a bench whose backend could not be made, because of this error."""
    bench = Bench()

    def make(choice: object) -> pc.Backend:
        raise error

    bench.devices._make = make
    bench.devices.begin(Selections())
    bench.run()
    return bench


@pytest.mark.parametrize(
    ("error", "wrong"),
    [
        (pc.ArgumentError("serial", "is no option"), "backend"),
        (TypeError("an argument is missing"), "backend"),
        (ValueError("no such mode"), "backend"),
        (pc.BackendError("no device"), ""),
        (OSError("no device"), ""),
    ],
)
def test_options_that_no_device_accepts_are_told_from_a_device_that_is_absent(
    error: Exception, wrong: str
) -> None:
    bench = fail_to_make(error)
    assert str(error) in bench.gate.fault
    assert bench.devices.wrong_setting == wrong


def test_an_array_that_does_not_fit_the_device_is_no_wrong_option() -> None:
    bench = Bench()
    bench.broken["a"] = {"open"}
    bench.devices.begin(Selections())
    bench.run()
    assert bench.gate.fault
    assert not bench.devices.wrong_setting


@pytest.mark.parametrize("error", [SystemExit(1), KeyboardInterrupt(), OSError()])
def test_whatever_a_plug_in_raises_ends_in_a_reason(error: BaseException) -> None:
    bench = fail_to_make(error)
    assert bench.gate.fault.startswith(f"a: {type(error).__name__}")


@pytest.mark.parametrize("text", ["gone", "a: gone"])
def test_a_reason_names_its_device_once(text: str) -> None:
    bench = Bench()

    def make(choice: object) -> pc.Backend:
        raise pc.BackendError(text)

    bench.devices._make = make
    bench.devices.begin(Selections())
    bench.run()
    assert bench.gate.fault == "a: gone"


def test_results_do_not_grow(bench: Bench) -> None:
    for k in range(1, 3 * MAX_RESULTS):
        bench.devices.follow(Selections(reset=k))
    assert len(bench.devices.results) == MAX_RESULTS
    assert f"reset {3 * MAX_RESULTS - 1}" in bench.devices.results


def test_real_threads_open_a_real_plug_in() -> None:
    guard = OutputGate(N, gain=1.0, frame_timeout=0.02)
    devices = DeviceManager(
        guard, ARRAY, Choice(name="simulated", options={"amplitudes": 32}), 1000.0
    )
    devices.begin(Selections())
    eventually(lambda: devices.poll() or guard.backend)
    assert guard.make_status({}, ()).amplitudes == 32


def test_a_device_that_hangs_while_it_opens_is_given_up_and_others_can_be_selected(
    bench: Bench,
) -> None:
    bench.frame()
    bench.devices.follow(selected(1, "b"))
    hangs = bench.waiting.pop(0)  # b hangs while it opens
    bench.clock.advance(0.9 * OPEN_TIMEOUT)
    bench.devices.follow(selected(2, "c"))
    bench.devices.poll()
    assert not bench.waiting, "one is opened at a time"
    bench.clock.advance(0.2 * OPEN_TIMEOUT)
    bench.devices.poll()
    assert "not open within" in bench.devices.results["backend 1"]
    assert bench.gate.sounding, "as before"
    bench.run()
    bench.frame()
    bench.run()
    assert bench.now == "c"
    hangs()  # b opens after all
    bench.run()
    bench.frame()
    assert bench.now == "c"
    assert not bench.gate.next_generation
    late = bench.made[-1]
    assert late.called == "b"
    assert late.log == ["close"], "it has not even been opened"
    assert bench.devices.results["backend 2"] == ""


def test_one_that_has_opened_too_late_is_closed_and_never_sounds(bench: Bench) -> None:
    bench.frame()
    bench.hang = "b"
    bench.devices.follow(selected(1, "b"))
    bench.run()  # b opens too late
    bench.frame()
    bench.run()
    assert "not open within" in bench.devices.results["backend 1"]
    assert bench.made[1].log == ["open", "close"]
    assert bench.now == "a"
    assert bench.gate.sounding


def test_a_reset_whose_device_hangs_is_a_fault_until_the_next(bench: Bench) -> None:
    bench.frame()
    bench.made[0].broken.add("send")
    bench.frame()
    bench.devices.follow(Selections(reset=1))
    bench.waiting.clear()  # opening hangs
    bench.clock.advance(1.1 * OPEN_TIMEOUT)
    bench.devices.poll()
    assert "not open within" in bench.devices.results["reset 1"]
    assert "not open within" in bench.gate.fault
    bench.devices.follow(Selections(reset=2))
    bench.run()
    assert bench.devices.results["reset 2"] == ""
    assert not bench.gate.fault


def test_those_that_hang_are_only_so_many(bench: Bench) -> None:
    hang = list[Callable[[], None]]()
    for number in range(1, MAX_HANGING + 3):
        bench.devices.follow(selected(number, "b"))
        hang += bench.waiting
        bench.waiting.clear()
        bench.clock.advance(1.1 * OPEN_TIMEOUT)
        bench.devices.poll()
    assert len(hang) == MAX_HANGING
    assert "hang" in bench.devices.results[f"backend {MAX_HANGING + 2}"]
    for one in hang:
        one()
    bench.run()
    bench.devices.follow(selected(number + 1, "c"))
    bench.run()
    bench.frame()
    assert bench.now == "c"


def test_where_no_more_threads_are_permitted_a_device_opens_while_none_sounds() -> None:
    bench = Bench()
    bench.threads = False
    bench.devices.begin(Selections(), PluginConfig("c"))
    bench.run()
    assert [device.log for device in bench.made] == [["open", "close"], ["open"]]
    assert (bench.now, bench.devices.results) == ("a", {"backend 0": ""})
    bench.frame()
    bench.devices.follow(selected(1, "b"))
    assert "no more threads" in bench.devices.results["backend 1"]
    bench.frame()
    assert bench.now == "a"
    bench.gate.to_close.append(bench.made[0])
    bench.run()
    assert bench.devices.busy, "it is closed as soon as there is a thread"
    bench.threads = True
    bench.run()
    assert bench.made[0].log == ["open", "close", "close"]


def test_a_guard_that_takes_over_opens_again_until_the_device_lets_it() -> None:
    bench = Bench()
    bench.busy = 3
    bench.devices.begin(Selections(), PluginConfig("a"))
    bench.run()
    assert bench.now == "a"
    assert [made.log for made in bench.made] == [["open", "close"]] * 3 + [["open"]]
    bench = Bench()
    bench.broken["a"] = {"open"}
    bench.devices.begin(Selections(), PluginConfig("a"))
    bench.run()
    assert "open failed" in bench.gate.fault
    assert 2 <= len(bench.made) <= RETRY_TIME / 0.005, "for a bounded time"


def test_what_another_guard_left_sounding_is_silenced_before_another_device_is_opened() -> None:
    bench = Bench()
    bench.busy = 1  # the device is still claimed
    bench.devices.begin(selected(1, "b"), PluginConfig("a", {"port": "x" * 1000}))
    assert bench.devices.choice == PluginConfig("a", {"port": "x" * 1000})
    bench.run()
    assert [(made.called, made.log) for made in bench.made] == [
        ("a", ["open", "close"]), ("a", ["open", "close"]), ("b", ["open"]),
    ]  # fmt: skip
    assert bench.now == "b"
    assert bench.devices.choice == PluginConfig("b")


def test_a_guard_that_takes_over_knows_the_device_by_the_owners_options_too() -> None:
    configured = PluginConfig("a", {"port": "usb-1"})
    first, spare = Bench(configured), Bench(configured)
    first.devices.begin(Selections())
    first.run()
    assert first.devices.choice == configured
    selections = Selections(backend=(1, Choice(name="a", options={"phases": 8})))
    first.devices.follow(selections)
    first.run()
    first.frame()
    whole = PluginConfig("a", {"port": "usb-1", "phases": 8})
    assert first.devices.choice == whole
    spare.devices.begin(selections, first.devices.choice)
    spare.run()
    assert [made.log for made in spare.made] == [["open"]], "the same device is opened once"
    assert spare.devices.choice == whole
    first.devices.follow(selected(2, "b"))
    first.run()
    first.frame()
    assert first.devices.choice == PluginConfig("b"), "which the owner's options are not for"


@pytest.mark.parametrize(("field", "value"), [("watchdog", "x"), ("watchdog", -1.0), ("phases", 1)])
def test_a_capability_that_no_device_has_is_refused(
    bench: Bench, field: str, value: object
) -> None:
    """The guard reports the capability to other processes, and to the guard that replaces it."""
    bench.fields["b"] = {field: value}
    bench.frame()
    bench.devices.follow(selected(1, "b"))
    bench.run()
    bench.frame()
    assert bench.now == "a"
    assert bench.gate.sounding
    assert f"`{field}` must be" in bench.devices.results["backend 1"]
    assert bench.made[1].log == ["close"]


def test_a_capability_of_other_numeric_types_is_reported_in_plain_numbers(bench: Bench) -> None:
    bench.fields["b"] = {"rate": np.float32(2000.0), "watchdog": np.float32(0.5)}
    bench.devices.follow(selected(1, "b"))
    bench.run()
    told = msgspec.msgpack.encode(bench.gate.make_status({}, ()))
    assert msgspec.msgpack.decode(told, type=DeviceStatus).capability == pc.Capability(
        rate=2000.0, watchdog=0.5
    )


def test_what_is_no_capability_is_refused(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Named, "capability", None)
    bench.devices.follow(selected(1, "b"))
    bench.run()
    assert "must be a Capability, not None" in bench.devices.results["backend 1"]
    assert bench.now == "a"


def test_a_backend_that_exits_in_close_hides_no_error_of_open(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    def bad(self: Named) -> None:
        raise SystemExit(3)

    monkeypatch.setattr(Named, "close", bad)
    bench.broken["b"] = {"open"}
    bench.devices.follow(selected(1, "b"))
    bench.run()
    assert bench.devices.results["backend 1"] == "b: OSError: open failed"
    assert bench.now == "a"


def test_a_name_that_an_instance_spoils_does_not_spoil_the_status(bench: Bench) -> None:
    object.__setattr__(bench.made[0], "name", 5)
    assert bench.gate.make_status({}, ()).name == "named"


def test_after_a_fault_an_empty_frame_lets_the_next_device_take_over(bench: Bench) -> None:
    """A halted renderer sends such a frame. The fault stays until a reset."""
    bench.frame()
    bench.made[0].broken |= {"send", "silence", "close"}
    bench.frame()
    fault = bench.gate.fault
    assert fault
    bench.devices.follow(selected(1, "b"))
    bench.run()
    assert bench.now == "a"
    head = FrameHead(2, 0.0, 1, bench.gate.next_generation, 0, N).pack()
    assert bench.gate.step(Permit(1, 1.0, 1, 0), head)
    bench.run()
    assert bench.now == "b"
    assert bench.devices.results["backend 1"] == ""
    assert bench.gate.fault == fault
    bench.devices.follow(selected(1, "b", reset=1))
    bench.run()
    bench.frame()
    assert bench.gate.sounding
