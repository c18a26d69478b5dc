"""`check_backend`: whether a backend keeps what `pacinian.Backend` promises."""

from __future__ import annotations

import gc
import time
import weakref
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.array import autd
from pacinian.errors import BackendError
from pacinian.plugins.backend import Backend, Capability, Found, Frame
from pacinian.testing.conformance import Broken, a, called, require, tried

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike

LIMIT = 10.0  # [s] that a call may take
LOOK = 0.01  # [s] between two looks at what is heard
QUIET = 0.1  # of full drive: what a device is tried with
OFF = 0.02  # of full drive, that may be heard beside a level


def check_backend(
    make: Callable[[], Backend],
    array: Array | None = None,
    *,
    heard: Callable[[Any], ArrayLike] | None = None,
    lose: Callable[[Any], None] | None = None,
    limit: float = LIMIT,
) -> None:
    """Try every rule of the backend seam; a device is opened and closed a few times, and driven at a tenth.

    make: makes the backend, as users do. array: what it is opened with; an AUTD unit unless given.
    heard: what sounds now, gains (N,), asked of the backend or of a device's model; without it nothing can be
    said of what sounds. lose: unplugs the device, which is not plugged in again. limit: of each call [s].
    Raises NotConforming, which says what was broken.
    """
    kit = _Kit(make, array or autd(), heard, limit)
    rules = {
        "class": kit.its_class,
        "found": kit.found,
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
    tried(getattr(called("make()", make, limit), "name", "a backend"), rules)


class _Kit:
    """One backend's trial; every rule has a new backend, and every call a thread of its own."""

    def __init__(
        self,
        make: Callable[[], Backend],
        array: Array,
        heard: Callable[[Any], ArrayLike] | None,
        limit: float,
    ) -> None:
        self.array, self._make, self._heard, self._limit = array, make, heard, limit
        self._sequence = 0

    # ------------------------------------------------------------------ what rules are made of

    def make(self) -> Backend:
        """A new backend."""
        return called("make()", self._make, self._limit)

    def call(self, method: Callable[..., Any], *arguments: Any) -> Any:
        """Call a method of the backend."""
        return called(f"{method.__name__}()", lambda: method(*arguments), self._limit)

    @contextmanager
    def opened(self) -> Generator[Backend]:
        """A new backend, open; closed afterwards."""
        backend = self.make()
        self.call(backend.open, self.array)
        try:
            yield backend
        finally:
            with suppress(BackendError):
                self.call(backend.close)

    def frame(self, can: Capability, share: float = QUIET, rows: int = 1) -> Frame:
        """A frame of so much drive, with phases that differ."""
        self._sequence += 1
        N = len(self.array)
        phase = (np.arange(rows * N) % can.phases).astype(np.uint16).reshape(rows, N)
        level = max(1, can.highest(share)) if share else 0
        return Frame(self._sequence, self._sequence / can.rate, phase, np.full_like(phase, level))

    def refuses(self, what: str, method: Callable[..., Any], *arguments: Any) -> None:
        """Require a BackendError."""
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

    def sounding(self, backend: Backend, asked: Frame | None, when: str) -> None:
        """Require that a frame's last row, or nothing, is heard, soon."""
        if self._heard is None:
            return
        can, N = backend.capability, len(self.array)
        want = np.zeros(N) if asked is None else asked.gains(can)[-1]
        due = time.monotonic() + self._limit
        while True:
            got = np.asarray(called("heard()", lambda: self._heard(backend), self._limit))  # type: ignore[misc]
            require(got.shape == (N,), f"heard() must give {N} gains, not {got.shape}")
            off = float(np.abs(got - want).max())
            if off <= (OFF if asked is not None else 0.0):
                return
            if time.monotonic() > due:
                what = "silence" if asked is None else "what was sent"
                raise Broken(f"{when}, {what} is not what is heard: {off:.3g} of full drive off")
            time.sleep(LOOK)

    # ------------------------------------------------------------------ the rules

    def its_class(self) -> None:
        """It is a backend with a name and a line of explanation."""
        backend = self.make()
        a(Backend, backend, "what is made")
        name = getattr(type(backend), "name", None)
        require(isinstance(name, str) and bool(name), f"its `name` is {name!r}")
        require(bool((type(backend).__doc__ or "").strip()), "it has no docstring")

    def found(self) -> None:
        """Looking for devices raises nothing and tells `Found`s of its own name."""
        cls = type(self.make())
        for one in self.call(cls.found):
            a(Found, one, "what found() tells")
            require(one.backend == cls.name, f"found() tells of backend {one.backend!r}")

    def capability(self) -> None:
        """It is a Capability and does not change."""
        backend = self.make()
        before = backend.capability
        a(Capability, before, "capability")
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
        """A frame before `open` is refused."""
        backend = self.make()
        self.refuses("send() before open()", backend.send, self.frame(backend.capability))

    def open_silent(self) -> None:
        """`open` leaves it silent."""
        with self.opened() as backend:
            self.sounding(backend, None, "after open()")

    def sounds(self) -> None:
        """What is sent is what sounds; frames without amplitude are silent."""
        with self.opened() as backend:
            for share in (QUIET, 0.0, QUIET):
                frame = self.frame(backend.capability, share)
                self.call(backend.send, frame)
                self.sounding(backend, frame, "after send()")

    def leaves_frames(self) -> None:
        """A frame is not written to: the loop may send it again."""
        with self.opened() as backend:
            frame = self.frame(backend.capability)
            phase, amplitude = frame.phase.copy(), frame.amplitude.copy()
            self.call(backend.send, frame)
            self.call(backend.silence)
            same = (frame.phase == phase).all() and (frame.amplitude == amplitude).all()
            require(bool(same), "send() writes to the frame's arrays")

    def keeps_no_arrays(self) -> None:
        """A frame's arrays are reused as soon as `send` is back, so none may be kept."""
        with self.opened() as backend:
            frame = self.frame(backend.capability)
            kept = [weakref.ref(frame.phase), weakref.ref(frame.amplitude)]
            self.call(backend.send, frame)
            del frame
            gc.collect()
            alive = any(reference() is not None for reference in kept)
            require(not alive, "send() keeps the frame's arrays, which are reused: copy them")

    def read_only(self) -> None:
        """Frames of a recording cannot be written to, and are sent all the same."""
        with self.opened() as backend:
            frame = self.frame(backend.capability)
            frame.phase.flags.writeable = frame.amplitude.flags.writeable = False
            self.call(backend.send, frame)

    def rows(self) -> None:
        """A frame has as many rows as a tick has frames; sequence and time may jump."""
        with self.opened() as backend:
            for rows in (1, 2, 5, 1):
                frame = self.frame(backend.capability, rows=rows)
                self._sequence += rows
                self.call(backend.send, frame)
                self.sounding(backend, frame, f"after {rows} rows")

    def silence(self) -> None:
        """Silence is silent, at any time after `open`, any number of times."""
        with self.opened() as backend:
            self.call(backend.silence)
            self.call(backend.send, self.frame(backend.capability))
            for _ in range(3):
                self.call(backend.silence)
                self.sounding(backend, None, "after silence()")

    def sounds_again(self) -> None:
        """What is sent after a silence sounds."""
        with self.opened() as backend:
            for _ in range(2):
                frame = self.frame(backend.capability)
                self.call(backend.send, frame)
                self.sounding(backend, frame, "after silence() and send()")
                self.call(backend.silence)

    def close_silent(self) -> None:
        """`close` silences."""
        with self.opened() as backend:
            self.call(backend.send, self.frame(backend.capability))
            self.call(backend.close)
            self.sounding(backend, None, "after close()")

    def close_twice(self) -> None:
        """`close` may be called twice."""
        with self.opened() as backend:
            self.call(backend.close)
            self.call(backend.close)

    def send_after_close(self) -> None:
        """A frame after `close` is refused, and makes no sound."""
        with self.opened() as backend:
            self.call(backend.close)
            self.refuses("send() after close()", backend.send, self.frame(backend.capability))
            self.sounding(backend, None, "after close() and send()")

    def gives_back(self) -> None:
        """After `close` another one can open the device."""
        with self.opened() as backend:
            self.call(backend.send, self.frame(backend.capability))
            self.call(backend.close)
            with self.opened() as other:
                self.call(other.send, self.frame(other.capability))

    def loss(self, lose: Callable[[Any], None]) -> None:
        """A device that is gone is a BackendError to `send`, at once and from then on; closing it is quiet."""
        with self.opened() as backend:
            self.call(backend.send, self.frame(backend.capability))
            lose(backend)
            for _ in range(2):
                self.refuses(
                    "send() to a device that is gone", backend.send, self.frame(backend.capability)
                )
                with suppress(BackendError):
                    self.call(backend.silence)
            self.call(backend.close)
