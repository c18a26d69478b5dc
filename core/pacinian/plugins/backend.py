"""The backend seam: frames in, sound out."""

from __future__ import annotations

from abc import ABC, abstractmethod
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from pacinian.checks import check_integer, check_number, check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike, Gains, Levels, Singles


MAX_RATE = 1e6  # [Hz] frames
MAX_LEVELS = 1 << 16  # levels
MIN_STEP = (
    2.0**-24
)  # of full drive, the precision of amplitudes; those of a table are further apart
SLACK = 1e-3  # of a step; a limit this little below a level is that level, but for rounding


@dataclass(frozen=True)
class Capability:
    """What a device can do.

    phases: how many levels. amplitudes: how many levels, of evenly spaced sound pressures; or, where they are not
    even, the sound pressure of each, ascending from 0 to 1, in single precision. rate: frames that it plays per
    second [Hz]; a tick of the loop sends as many frames as it lasts. watchdog: seconds after which it goes silent by
    itself when frames stop [s]; None if it does not.
    """

    phases: int = 256
    amplitudes: int | tuple[float, ...] = 256
    rate: float = 1000.0
    watchdog: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "phases", _count("phases", self.phases))
        if isinstance(self.amplitudes, (tuple, list, np.ndarray)):
            amplitudes: int | tuple[float, ...] = _table(self.amplitudes)
        else:
            amplitudes = _count("amplitudes", self.amplitudes)
        object.__setattr__(self, "amplitudes", amplitudes)
        check_number("rate", self.rate, low=1.0, high=MAX_RATE)

    def __str__(self) -> str:
        kind = "" if self.even else "uneven "
        return f"{self.phases} phases, {len(self.sizes)} {kind}amplitudes, {self.rate:g} Hz"

    @property
    def even(self) -> bool:
        """Whether the amplitudes of the levels are evenly spaced."""
        return isinstance(self.amplitudes, int)

    @cached_property
    def sizes(self) -> Singles:
        """The amplitude of each level, 0..1, in a read-only array."""
        if isinstance(self.amplitudes, int):
            made = np.arange(self.amplitudes) / (self.amplitudes - 1)
        else:
            made = np.array(self.amplitudes)
        sizes = made.astype(np.float32)
        sizes.flags.writeable = False
        return sizes

    def highest(self, gain: float) -> int:
        """The highest amplitude level that is not above a limit of the gain."""
        return bisect_right(self._allowed, gain)

    @cached_property
    def _allowed(self) -> list[float]:
        """From which limit on each level but 0 is allowed."""
        sizes = self.sizes.astype(np.float64)
        allowed: list[float] = (sizes[1:] - SLACK * np.diff(sizes) - MIN_STEP).tolist()
        return allowed


def _count(name: str, value: int) -> int:
    levels = check_integer(name, value, low=2)
    if levels > MAX_LEVELS:
        raise ArgumentError(name, f"must be at most {MAX_LEVELS}, not {levels}")
    return levels


def _table(given: ArrayLike) -> tuple[float, ...]:
    """Amplitudes in single precision. Raises ArgumentError."""
    sizes = check_numbers("amplitudes", given, (None,)).astype(np.float32).astype(np.float64)
    if not 2 <= len(sizes) <= MAX_LEVELS:
        raise ArgumentError("amplitudes", f"must be 2 to {MAX_LEVELS} levels, not {len(sizes)}")
    steps = np.diff(sizes)
    if (steps < MIN_STEP).any():
        wrong = int(np.argmax(steps < MIN_STEP))
        raise ArgumentError(
            "amplitudes",
            f"must ascend: level {wrong} is {sizes[wrong]:.9g}, the next {sizes[wrong + 1]:.9g}",
        )
    if sizes[0] != 0.0 or sizes[-1] != 1.0:
        ends = f"{sizes[0]:.7g} to {sizes[-1]:.7g}"
        raise ArgumentError("amplitudes", f"must go from 0, silence, to 1, full drive, not {ends}")
    return tuple(sizes.tolist())


@dataclass(frozen=True, eq=False)
class Frame:
    """K successive gains as a device's levels; at most one is sent per tick.

    sequence: counts up. time: when its first row is due [s]. phase: (K, N), 0..phases - 1 for one turn.
    amplitude: (K, N), 0 for silence to the last level for 1. The arrays are reused: a backend that keeps them copies.
    """

    sequence: int
    time: float
    phase: Levels
    amplitude: Levels

    def gains(self, capability: Capability) -> Gains:
        """The gains that these levels stand for, (K, N). Raises IndexError for levels beyond the device's."""
        turn = self.phase * np.float32(2.0 * np.pi / capability.phases)
        size = capability.sizes[self.amplitude]
        return np.asarray(size * np.exp(1j * turn), dtype=np.complex64)


@dataclass(frozen=True)
class Found:
    """A device that is connected now.

    backend: the name of what drives it. serial: tells it from others of its kind; empty where it cannot be
    read. title: what it is, and where it is plugged in; empty if it stands for all that could not be looked for.
    problem: what keeps it from being used, and what to do about it; empty if nothing does.
    """

    backend: str
    serial: str
    title: str
    problem: str = ""


class Backend(ABC):
    """A device, or what stands for one.

    Never called by two threads at once; a server opens and closes it in other threads than it sends from.
    `send` and `silence` raise BackendError for a device that refuses or is gone; the loop then goes silent
    and says so.
    """

    name: ClassVar[str]
    """What users call it."""
    usb: ClassVar[tuple[tuple[int, int] | tuple[int, int, int], ...]] = ()
    """Its USB devices: `pacinian devices udev` gives users the right to them.

    (vendor, product); or, whoever makes them, (class, subclass, protocol) of an interface that only they have.
    """

    @classmethod
    def found(cls) -> Iterable[Found]:
        """Devices of this kind that are connected now; one that cannot be read is told of as a `problem`."""
        return ()

    @property
    @abstractmethod
    def capability(self) -> Capability:
        """What the device can do; does not change."""

    @abstractmethod
    def open(self, array: Array) -> None:
        """Claim the device and leave it silent."""

    @abstractmethod
    def send(self, frame: Frame) -> None:
        """Emit `frame`; return as soon as it is on its way."""

    @abstractmethod
    def silence(self) -> None:
        """Stop all sound at once; may be called at any time after `open`, any number of times."""

    @abstractmethod
    def close(self) -> None:
        """Silence and give the device back; may be called twice."""
