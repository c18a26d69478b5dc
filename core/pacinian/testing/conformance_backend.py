"""`check_backend`: checks that a backend fulfils the contract of `pacinian.Backend`."""

from __future__ import annotations

import gc
import time
import weakref
from contextlib import contextmanager, suppress
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.array import autd
from pacinian.errors import BackendError
from pacinian.plugins.backend import Backend, Capability, FoundDevice, Frame
from pacinian.testing.conformance import (
    Broken,
    call_with_limit,
    check_class,
    check_rules,
    require,
    require_kind,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike

LIMIT = 10.0  # duration of a call [s]
POLL_INTERVAL = 0.01  # period of polling `measure_gains` [s]
QUIET = 0.1  # drive of the trials, relative to full drive
OFF = 0.02  # deviation of the emitted gains, relative to full drive


def check_backend(
    make: Callable[[], Backend],
    array: Array | None = None,
    *,
    measure_gains: Callable[[Any], ArrayLike] | None = None,
    lose: Callable[[Any], None] | None = None,
    limit: float = LIMIT,
) -> None:
    """Check a backend against every rule of its interface. Opens the device several times and drives it at a tenth.

    make: constructs the backend, as users do. array: array with which it is opened; by default an AUTD unit.
    measure_gains: returns the gains (N,) that the backend or a model of its device emits now; without it, no emission
    is checked. lose: unplugs the device, which is not plugged in again. limit: time limit of each call [s]. Raises
    NotConforming, which lists the broken rules.
    """
    kit = _Kit(make, array or autd(), measure_gains, limit)
    rules = {
        "class": kit.its_class,
        "find_devices": kit.find_devices,
        "capability": kit.capability,
        "closed before it is open": kit.before,
        "send before open": kit.send_before_open,
        "open is silent": kit.open_silent,
        "sounds": kit.sounds,
        "leaves frames alone": kit.leaves_frames,
        "keeps no arrays": kit.keeps_no_arrays,
        "read-only frames": kit.read_only,
        "rows": kit.rows,
        "silence": kit.silence,
        "sounds again": kit.sounds_again,
        "close is silent": kit.close_silent,
        "close twice": kit.close_twice,
        "send after close": kit.send_after_close,
        "gives back": kit.gives_back,
    }
    if lose is not None:
        rules["loss"] = lambda: kit.loss(lose)
    check_rules(getattr(call_with_limit("make()", make, limit), "name", "a backend"), rules)


class _Kit:
    """The trial of a backend. Every rule gets a new backend, and every call its own thread."""

    def __init__(
        self,
        make: Callable[[], Backend],
        array: Array,
        measure_gains: Callable[[Any], ArrayLike] | None,
        limit: float,
    ) -> None:
        self.array, self._make, self._measure_gains, self._limit = array, make, measure_gains, limit
        self._sequence = 0

    # ------------------------------------------------------------------ building blocks of the rules

    def make(self) -> Backend:
        """Construct a new backend."""
        return call_with_limit("make()", self._make, self._limit)

    def call(self, method: Callable[..., Any], *arguments: Any) -> Any:
        """Call a method of the backend, with the time limit."""
        return call_with_limit(f"{method.__name__}()", lambda: method(*arguments), self._limit)

    @contextmanager
    def open_backend(self) -> Generator[Backend]:
        """Open a new backend, and close it afterwards."""
        backend = self.make()
        self.call(backend.open, self.array)
        try:
            yield backend
        finally:
            with suppress(BackendError):
                self.call(backend.close)

    def frame(self, can: Capability, share: float = QUIET, rows: int = 1) -> Frame:
        """Make a frame with different phases. share: its drive, relative to full drive."""
        self._sequence += 1
        N = len(self.array)
        phase = (np.arange(rows * N) % can.phases).astype(np.uint16).reshape(rows, N)
        level = max(1, can.highest(share)) if share else 0
        return Frame(self._sequence, self._sequence / can.rate, phase, np.full_like(phase, level))

    def refuses(self, what: str, method: Callable[..., Any], *arguments: Any) -> None:
        """Require that a call raises BackendError."""
        try:
            self.call(method, *arguments)
        except BackendError:
            return
        except Broken:
            raise
        except Exception as error:
            seen = f"{what} raises {type(error).__name__}, not BackendError: {error}"
            raise Broken(seen) from error
        raise Broken(f"{what} is accepted: it must raise BackendError")

    def require_emitted(self, backend: Backend, asked: Frame | None, when: str) -> None:
        """Require that the last row of a frame, or silence if it is None, is emitted within the time limit."""
        if (measure := self._measure_gains) is None:
            return
        can, N = backend.capability, len(self.array)
        want = np.zeros(N) if asked is None else asked.gains(can)[-1]
        due = time.monotonic() + self._limit
        while True:
            got = np.asarray(
                call_with_limit("measure_gains()", lambda: measure(backend), self._limit)
            )
            require(got.shape == (N,), f"measure_gains() must give {N} gains, not {got.shape}")
            off = float(np.abs(got - want).max())
            if off <= (OFF if asked is not None else 0.0):
                return
            if time.monotonic() > due:
                what = "silence" if asked is None else "what was sent"
                raise Broken(f"{when}, {what} is not what is emitted: {off:.3g} of full drive off")
            time.sleep(POLL_INTERVAL)

    # ------------------------------------------------------------------ the rules

    def its_class(self) -> None:
        """It is a backend with a name and a docstring."""
        check_class(Backend, self.make())

    def find_devices(self) -> None:
        """The search for devices raises nothing and returns `FoundDevice`s with the backend's name."""
        cls = type(self.make())
        for one in self.call(cls.find_devices):
            require_kind(FoundDevice, one, "what find_devices() tells")
            require(one.backend == cls.name, f"find_devices() tells of backend {one.backend!r}")

    def capability(self) -> None:
        """It is a Capability of plain numbers and does not change."""
        backend = self.make()
        before = backend.capability
        require_kind(Capability, before, "capability")
        plain = Capability(before.phases, before.amplitudes, before.rate, before.watchdog)
        for field in fields(plain):
            given, wanted = getattr(before, field.name), getattr(plain, field.name)
            require(
                type(given) is type(wanted) and given == wanted,
                f"its {field.name} is {given!r}, not {wanted!r}",
            )
        seen = [before]
        with suppress(BackendError):
            self.call(backend.open, self.array)
            seen.append(backend.capability)
            self.call(backend.send, self.frame(before))
            seen.append(backend.capability)
        self.call(backend.silence)
        seen.append(backend.capability)
        self.call(backend.close)
        seen.append(backend.capability)
        require(all(can == before for can in seen), f"capability changes: {seen}")

    def before(self) -> None:
        """A backend that was never opened can be closed: opening may have failed."""
        self.call(self.make().close)

    def send_before_open(self) -> None:
        """It refuses a frame before `open`."""
        backend = self.make()
        self.refuses("send() before open()", backend.send, self.frame(backend.capability))

    def open_silent(self) -> None:
        """It is silent after `open`."""
        with self.open_backend() as backend:
            self.require_emitted(backend, None, "after open()")

    def sounds(self) -> None:
        """It emits what is sent, and frames of amplitude 0 are silent."""
        with self.open_backend() as backend:
            for share in (QUIET, 0.0, QUIET):
                frame = self.frame(backend.capability, share)
                self.call(backend.send, frame)
                self.require_emitted(backend, frame, "after send()")

    def leaves_frames(self) -> None:
        """It does not write to a frame, because the loop may send it again."""
        with self.open_backend() as backend:
            frame = self.frame(backend.capability)
            phase, amplitude = frame.phase.copy(), frame.amplitude.copy()
            self.call(backend.send, frame)
            self.call(backend.silence)
            same = (frame.phase == phase).all() and (frame.amplitude == amplitude).all()
            require(bool(same), "send() writes to the frame's arrays")

    def keeps_no_arrays(self) -> None:
        """It does not keep a frame's arrays, because the loop reuses them as soon as `send` returns."""
        with self.open_backend() as backend:
            frame = self.frame(backend.capability)
            kept = [weakref.ref(frame.phase), weakref.ref(frame.amplitude)]
            self.call(backend.send, frame)
            del frame
            gc.collect()
            alive = any(reference() is not None for reference in kept)
            require(not alive, "send() keeps the frame's arrays, which are reused: copy them")

    def read_only(self) -> None:
        """It sends read-only frames, such as those of a recording."""
        with self.open_backend() as backend:
            frame = self.frame(backend.capability)
            frame.phase.flags.writeable = frame.amplitude.flags.writeable = False
            self.call(backend.send, frame)

    def rows(self) -> None:
        """It accepts frames of several rows, and jumps of sequence and time."""
        with self.open_backend() as backend:
            for rows in (1, 2, 5, 1):
                frame = self.frame(backend.capability, rows=rows)
                self._sequence += rows
                self.call(backend.send, frame)
                self.require_emitted(backend, frame, f"after {rows} rows")

    def silence(self) -> None:
        """`silence` silences at any time after `open`, any number of times."""
        with self.open_backend() as backend:
            self.call(backend.silence)
            self.call(backend.send, self.frame(backend.capability))
            for _ in range(3):
                self.call(backend.silence)
                self.require_emitted(backend, None, "after silence()")

    def sounds_again(self) -> None:
        """It emits what is sent after `silence`."""
        with self.open_backend() as backend:
            for _ in range(2):
                frame = self.frame(backend.capability)
                self.call(backend.send, frame)
                self.require_emitted(backend, frame, "after silence() and send()")
                self.call(backend.silence)

    def close_silent(self) -> None:
        """`close` silences."""
        with self.open_backend() as backend:
            self.call(backend.send, self.frame(backend.capability))
            self.call(backend.close)
            self.require_emitted(backend, None, "after close()")

    def close_twice(self) -> None:
        """`close` may be called twice."""
        with self.open_backend() as backend:
            self.call(backend.close)
            self.call(backend.close)

    def send_after_close(self) -> None:
        """It refuses a frame after `close`, and emits nothing."""
        with self.open_backend() as backend:
            self.call(backend.close)
            self.refuses("send() after close()", backend.send, self.frame(backend.capability))
            self.require_emitted(backend, None, "after close() and send()")

    def gives_back(self) -> None:
        """After `close`, another backend can open the device."""
        with self.open_backend() as backend:
            self.call(backend.send, self.frame(backend.capability))
            self.call(backend.close)
            with self.open_backend() as other:
                self.call(other.send, self.frame(other.capability))

    def loss(self, lose: Callable[[Any], None]) -> None:
        """`send` to a device that is gone raises BackendError, at once and from then on; `close` raises nothing."""
        with self.open_backend() as backend:
            self.call(backend.send, self.frame(backend.capability))
            lose(backend)
            for _ in range(2):
                self.refuses(
                    "send() to a device that is gone", backend.send, self.frame(backend.capability)
                )
                with suppress(BackendError):
                    self.call(backend.silence)
            self.call(backend.close)
