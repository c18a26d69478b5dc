"""`check_backend` accepts correct backends, and detects each kind of mistake."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import pytest

import pacinian as pc
from pacinian.plugins.registry import discover_plugins
from pacinian.testing import NotConforming, check_backend, conformance_backend

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

ARRAY = pc.lattice(0.03, 0.02)
N = len(ARRAY)


class Right(pc.Backend):
    """A correct backend. The wrong ones differ from it in one thing."""

    name: ClassVar[str] = "right"
    claimed: ClassVar[set[str]] = set()  # claimed devices; only one backend at a time may hold one

    def __init__(self) -> None:
        self.is_open = self.gone = False
        self.now = np.zeros(N, np.complex64)

    @property
    def capability(self) -> pc.Capability:
        return pc.Capability(128, 65, 2000.0)

    def open(self, array: pc.Array) -> None:
        if self.claimed:
            raise pc.BackendError("somebody else holds the device")
        self.claimed.add(self.name)
        self.is_open = True

    def send(self, frame: pc.Frame) -> None:
        if not self.is_open or self.gone:
            raise pc.BackendError("the device is not open")
        self.now = frame.gains(self.capability)[-1]

    def silence(self) -> None:
        self.now = np.zeros(N, np.complex64)

    def close(self) -> None:
        self.silence()
        if self.is_open:
            self.claimed.discard(self.name)
        self.is_open = False


def others_are_found(cls: type) -> Iterable[pc.FoundDevice]:
    return [pc.FoundDevice("other", "1", "a device")]


def none_can_be_found(cls: type) -> Iterable[pc.FoundDevice]:
    raise OSError("no USB")


def changing(device: Right) -> pc.Capability:
    return pc.Capability(128, 65, 2000.0 if device.is_open else 1000.0)


def wait_negative_time(device: Right) -> pc.Capability:
    return pc.Capability(128, 65, 2000.0, watchdog=-1.0)


def set_afterwards(device: Right) -> pc.Capability:
    """Return a capability whose number is of another type, which the constructor has not seen."""
    can = pc.Capability(128, 65, 2000.0)
    object.__setattr__(can, "rate", np.float32(2000.0))
    return can


def close_only_open(device: Right) -> None:
    if not device.is_open:
        raise pc.BackendError("not open")
    Right.close(device)


def take_unopened(device: Right, frame: pc.Frame) -> None:
    device.now = frame.gains(device.capability)[-1]


def raise_another(device: Right, frame: pc.Frame) -> None:
    if not device.is_open:
        raise RuntimeError("not open")
    Right.send(device, frame)


def open_loud(device: Right, array: pc.Array) -> None:
    Right.open(device, array)
    device.now = np.ones(N, np.complex64)


def then(spoil: Callable[[Any, pc.Frame], object]) -> Callable[[Right, pc.Frame], None]:
    """Return a `send` that does something after it has sent."""

    def send(device: Right, frame: pc.Frame) -> None:
        Right.send(device, frame)
        spoil(device, frame)

    return send


def louder(device: Right, frame: pc.Frame) -> None:
    device.now = 2.0 * device.now


def stay_at_first_row(device: Right, frame: pc.Frame) -> None:
    device.now = frame.gains(device.capability)[0]


def refuse_rows(device: Right, frame: pc.Frame) -> None:
    if len(frame.phase) > 1:
        raise pc.BackendError("one row only")


def pack_in_place(device: Right, frame: pc.Frame) -> None:
    frame.phase[...] ^= 1


def keep_frame(device: Any, frame: pc.Frame) -> None:
    device.last = frame


def keep_view(device: Any, frame: pc.Frame) -> None:
    device.last = frame.amplitude[-1:]


def need_writable(device: Right, frame: pc.Frame) -> None:
    (frame.phase.view(np.uint8).ravel()[:1])[...] = frame.phase.view(np.uint8).ravel()[:1]


def be_mute(device: Any, frame: pc.Frame) -> None:
    if device.muted:
        device.now = np.zeros(N, np.complex64)


def mute(device: Any) -> None:
    device.muted = True
    Right.silence(device)


def be_loud(device: Right) -> None:
    device.now = 0.5 * device.now


def be_silent_once(device: Any) -> None:
    device.times += 1
    if device.times > 2:
        raise pc.BackendError("again?")
    Right.silence(device)


def close_loud(device: Right) -> None:
    now = device.now
    Right.close(device)
    device.now = now


def hold(device: Right) -> None:
    device.silence()
    device.is_open = False


def open_in_thread(device: Any, array: pc.Array) -> None:
    Right.open(device, array)
    device.thread = threading.current_thread()


def send_in_that_thread(device: Any, frame: pc.Frame) -> None:
    if threading.current_thread() is not device.thread:
        raise RuntimeError("wrong thread")


def send_to_nobody(device: Right, frame: pc.Frame) -> None:
    device.gone, gone = False, device.gone
    Right.send(device, frame)
    device.gone = gone


WRONG: dict[str, tuple[str, dict[str, Any]]] = {
    "no name": ("class", {"name": ""}),
    "cannot search": ("find_devices", {"find_devices": classmethod(none_can_be_found)}),
    "tells of devices of another": (
        "find_devices",
        {"find_devices": classmethod(others_are_found)},
    ),
    "another capability once open": ("capability", {"capability": property(changing)}),
    "a watchdog that no device has": ("capability", {"capability": property(wait_negative_time)}),
    "numbers of another type": ("capability", {"capability": property(set_afterwards)}),
    "closes only what is open": ("close twice", {"close": close_only_open}),
    "takes frames unopened": ("send before open", {"send": take_unopened}),
    "raises what the loop does not expect": ("send after close", {"send": raise_another}),
    "opens with a click": ("open is silent", {"open": open_loud}),
    "louder": ("sounds", {"send": then(louder)}),
    "stays at the first row": ("rows", {"send": then(stay_at_first_row)}),
    "one row only": ("rows", {"send": then(refuse_rows)}),
    "packs in place": ("leaves frames alone", {"send": then(pack_in_place)}),
    "keeps the frame": ("keeps no arrays", {"send": then(keep_frame)}),
    "keeps a view": ("keeps no arrays", {"send": then(keep_view)}),
    "needs writable arrays": ("read-only frames", {"send": then(need_writable)}),
    "silence is not silent": ("silence", {"silence": be_loud}),
    "silence raises again": ("silence", {"silence": be_silent_once, "times": 0}),
    "stays silent": ("sounds again", {"silence": mute, "send": then(be_mute), "muted": False}),
    "closes, and sounds on": ("close is silent", {"close": close_loud}),
    "never gives the device back": ("gives back", {"close": hold}),
    "of one thread": ("sounds", {"open": open_in_thread, "send": then(send_in_that_thread)}),
    "does not see a loss": ("loss", {"send": send_to_nobody}),
}


def make_wrong(how: str) -> Any:
    """Return a backend that is correct except for this."""
    return type("Wrong", (Right,), {"__doc__": "Wrong in one thing.", **WRONG[how][1]})


@pytest.fixture(autouse=True)
def _free() -> None:
    Right.claimed.clear()


class Slept:
    """A fake `time` that advances only by `sleep`."""

    def __init__(self) -> None:
        self.now = 0.0

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture(autouse=True)
def _at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(conformance_backend, "time", Slept())


def check(make: Any) -> None:
    check_backend(
        make, ARRAY, measure_gains=lambda d: d.now, lose=lambda d: setattr(d, "gone", True)
    )


def test_a_right_one_passes() -> None:
    check(Right)


@pytest.mark.parametrize("how", WRONG)
def test_a_wrong_one_is_caught(how: str) -> None:
    rule = WRONG[how][0]
    with pytest.raises(NotConforming, match="breaks") as raised:
        check(make_wrong(how))
    assert rule in raised.value.broken
    assert raised.value.broken[rule] in str(raised.value)


def test_what_is_no_backend_is_caught() -> None:
    with pytest.raises(NotConforming) as raised:
        check(type("Stranger", (), {"name": "stranger"}))
    assert "class" in raised.value.broken


def test_a_wrong_one_is_told_of_all_that_it_breaks() -> None:
    with pytest.raises(NotConforming) as raised:
        check(make_wrong("takes frames unopened"))
    assert raised.value.broken.keys() == {"send before open", "send after close", "loss"}
    with pytest.raises(NotConforming) as raised:
        check(make_wrong("closes only what is open"))
    assert {"closed before it is open", "close twice"} <= raised.value.broken.keys()


def test_a_hang_ends_the_trial() -> None:
    end = threading.Event()

    class Hangs(Right):
        """A backend that waits for a device that does not answer."""

        def silence(self) -> None:
            end.wait()

    with pytest.raises(NotConforming, match=r"silence\(\) has not returned"):
        check_backend(Hangs, ARRAY, limit=3.0)  # much longer than any other call takes
    end.set()


def test_what_cannot_be_made_is_told() -> None:
    def make() -> pc.Backend:
        raise pc.BackendError("no such device")

    with pytest.raises(pc.BackendError, match="no such device"):
        check_backend(make)


def test_without_ears_nothing_is_said_of_what_sounds() -> None:
    check_backend(Right, ARRAY)
    check_backend(make_wrong("silence is not silent"), ARRAY)
    Right.claimed.clear()
    with pytest.raises(NotConforming, match="keeps the frame's arrays"):
        check_backend(make_wrong("keeps the frame"), ARRAY)


@pytest.mark.parametrize("array", [None, ARRAY])
def test_the_simulated_array_conforms(array: pc.Array | None) -> None:
    simulated: Any = discover_plugins().find("backend", "simulated").cls
    check_backend(simulated, array, measure_gains=lambda d: d.gains, lose=lambda d: d.disconnect())
    check_backend(lambda: pc.backend("simulated", phases=32, amplitudes=2, rate=100.0), array)
