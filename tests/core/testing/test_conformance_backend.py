"""`check_backend` passes those that are right, and catches each kind of wrong one."""

from __future__ import annotations

import itertools
import threading
import time
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import pytest

import pacinian as pc
from pacinian.plugins.registry import installed
from pacinian.testing import NotConforming, check_backend, conformance_backend

if TYPE_CHECKING:
    from collections.abc import Iterable

ARRAY = pc.lattice(0.03, 0.02)
N = len(ARRAY)


class Right(pc.Backend):
    """One that does what is promised; the others differ from it in one thing."""

    name: ClassVar[str] = "right"
    claimed: ClassVar[set[str]] = set()  # the device, which one at a time may hold

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


class Nameless(Right):
    """No name."""

    name = ""


class Stranger:
    """No backend at all."""

    name = "stranger"


class FindsRaising(Right):
    """Its search fails."""

    @classmethod
    def found(cls) -> Iterable[pc.Found]:
        raise OSError("no USB")


class FindsOthers(Right):
    """Tells of devices of another backend."""

    @classmethod
    def found(cls) -> Iterable[pc.Found]:
        return [pc.Found("other", "1", "a device")]


class Changing(Right):
    """Its capability changes once it is open."""

    @property
    def capability(self) -> pc.Capability:
        return pc.Capability(128, 65, 2000.0 if self.is_open else 1000.0)


class ClosesOnlyOpen(Right):
    """Cannot be closed before it is open, nor twice."""

    def close(self) -> None:
        if not self.is_open:
            raise pc.BackendError("not open")
        super().close()


class TakesUnopened(Right):
    """Accepts frames before `open` and after `close`."""

    def send(self, frame: pc.Frame) -> None:
        self.now = frame.gains(self.capability)[-1]


class WrongError(Right):
    """Raises what the loop does not expect."""

    def send(self, frame: pc.Frame) -> None:
        if not self.is_open:
            raise RuntimeError("not open")
        super().send(frame)


class LoudOpen(Right):
    """Opens with a click."""

    def open(self, array: pc.Array) -> None:
        super().open(array)
        self.now = np.ones(N, np.complex64)


class Louder(Right):
    """Sounds other than what it is sent."""

    def send(self, frame: pc.Frame) -> None:
        super().send(frame)
        self.now = 2.0 * self.now


class FirstRow(Right):
    """Stays at the first row of a frame."""

    def send(self, frame: pc.Frame) -> None:
        super().send(frame)
        self.now = frame.gains(self.capability)[0]


class OneRow(Right):
    """Takes frames of one row only."""

    def send(self, frame: pc.Frame) -> None:
        super().send(frame)
        if len(frame.phase) > 1:
            raise pc.BackendError("one row only")


class Writes(Right):
    """Packs in place."""

    def send(self, frame: pc.Frame) -> None:
        super().send(frame)
        frame.phase[...] ^= 1


class Keeps(Right):
    """Keeps the frame itself."""

    def send(self, frame: pc.Frame) -> None:
        super().send(frame)
        self.last = frame


class KeepsView(Right):
    """Keeps a view of it."""

    def send(self, frame: pc.Frame) -> None:
        super().send(frame)
        self.last = frame.amplitude[-1:]


class NeedsWritable(Right):
    """Wants arrays that it may write to."""

    def send(self, frame: pc.Frame) -> None:
        super().send(frame)
        (frame.phase.view(np.uint8).ravel()[:1])[...] = frame.phase.view(np.uint8).ravel()[:1]


class Loud(Right):
    """Silence is not silent."""

    def silence(self) -> None:
        self.now = 0.5 * self.now


class SilentOnce(Right):
    """Silence raises the second time."""

    def __init__(self) -> None:
        super().__init__()
        self.times = itertools.count()

    def silence(self) -> None:
        if next(self.times) > 1:
            raise pc.BackendError("again?")
        super().silence()


class StaysSilent(Right):
    """After a silence it sounds no more."""

    muted = False

    def send(self, frame: pc.Frame) -> None:
        super().send(frame)
        if self.muted:
            self.now = np.zeros(N, np.complex64)

    def silence(self) -> None:
        self.muted = True
        super().silence()


class LoudClose(Right):
    """Closes, and sounds on."""

    def close(self) -> None:
        now = self.now
        super().close()
        self.now = now


class Holds(Right):
    """Never gives the device back."""

    def close(self) -> None:
        self.silence()
        self.is_open = False


class Hangs(Right):
    """Waits for a device that does not answer."""

    never = threading.Event()

    def silence(self) -> None:
        self.never.wait(5.0)


class OneThread(Right):
    """Works in the thread only that opened it."""

    def open(self, array: pc.Array) -> None:
        super().open(array)
        self.thread = threading.current_thread()

    def send(self, frame: pc.Frame) -> None:
        super().send(frame)
        if threading.current_thread() is not self.thread:
            raise RuntimeError("wrong thread")


class BlindToLoss(Right):
    """Does not see that the device is gone."""

    def send(self, frame: pc.Frame) -> None:
        self.gone, gone = False, self.gone
        super().send(frame)
        self.gone = gone


WRONG = {
    Nameless: "class",
    Stranger: "class",
    FindsRaising: "found",
    FindsOthers: "found",
    Changing: "capability",
    ClosesOnlyOpen: "close twice",
    TakesUnopened: "send before open",
    WrongError: "send after close",
    LoudOpen: "open is silent",
    Louder: "sounds",
    FirstRow: "rows",
    OneRow: "rows",
    Writes: "leaves frames alone",
    Keeps: "keeps no arrays",
    KeepsView: "keeps no arrays",
    NeedsWritable: "read-only frames",
    Loud: "silence",
    SilentOnce: "silence",
    StaysSilent: "sounds again",
    LoudClose: "close is silent",
    Holds: "gives back",
    Hangs: "capability",
    OneThread: "sounds",
    BlindToLoss: "loss",
}


@pytest.fixture(autouse=True)
def _free() -> None:
    Right.claimed.clear()


class Slept:
    """Time that passes while it is slept, and at no other time."""

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
    limit = 0.15 if make is Hangs else conformance_backend.LIMIT
    check_backend(
        make, ARRAY, heard=lambda d: d.now, lose=lambda d: setattr(d, "gone", True), limit=limit
    )


def test_a_right_one_passes() -> None:
    check(Right)


@pytest.mark.parametrize(("kind", "rule"), WRONG.items(), ids=lambda v: getattr(v, "__name__", v))
def test_a_wrong_one_is_caught(kind: Any, rule: str) -> None:
    with pytest.raises(NotConforming, match="breaks") as raised:
        check(kind)
    assert rule in raised.value.broken
    assert raised.value.broken[rule] in str(raised.value)


def test_a_wrong_one_is_told_of_all_that_it_breaks() -> None:
    with pytest.raises(NotConforming) as raised:
        check(TakesUnopened)
    assert raised.value.broken.keys() == {"send before open", "send after close", "loss"}
    with pytest.raises(NotConforming) as raised:
        check(ClosesOnlyOpen)
    assert {"closed before it is open", "close twice"} <= raised.value.broken.keys()


def test_a_hang_ends_the_trial_in_time() -> None:
    begin = time.monotonic()
    with pytest.raises(NotConforming, match=r"silence\(\) has not come back"):
        check(Hangs)
    assert time.monotonic() - begin < 4.0  # it would be 5 s, many times


def test_what_cannot_be_made_is_told() -> None:
    def make() -> pc.Backend:
        raise pc.BackendError("no such device")

    with pytest.raises(pc.BackendError, match="no such device"):
        check_backend(make)


def test_without_ears_nothing_is_said_of_what_sounds() -> None:
    check_backend(Right, ARRAY)
    check_backend(Loud, ARRAY)
    Right.claimed.clear()
    with pytest.raises(NotConforming, match="keeps the frame's arrays"):
        check_backend(Keeps, ARRAY)


@pytest.mark.parametrize("array", [None, ARRAY])
def test_the_simulated_array_conforms(array: pc.Array | None) -> None:
    simulated: Any = installed().find("backend", "simulated").cls
    check_backend(simulated, array, heard=lambda d: d.gains, lose=lambda d: d.disconnect())
    check_backend(lambda: pc.backend("simulated", phases=32, amplitudes=2, rate=100.0), array)
