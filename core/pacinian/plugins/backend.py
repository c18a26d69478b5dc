"""The backend interface: frames go in, sound comes out."""

from __future__ import annotations

from abc import ABC, abstractmethod
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from pacinian.argument_checks import check_integer, check_number, check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.acoustics.array import Array
    from pacinian.types import ArrayLike, Gains, Levels, Singles


MAX_RATE = 1e6  # rows per second [Hz]
MAX_LEVELS = 1 << 16  # levels of phase or amplitude
# precision of amplitudes, relative to full drive; levels of a table are at least this far apart
MIN_STEP = 2.0**-24
# tolerance for rounding, in steps: a limit this far below a level still allows it
LEVEL_TOLERANCE = 1e-3


@dataclass(frozen=True)
class Capability:
    """The capabilities of a device.

    phases: number of phase levels. amplitudes: number of levels if their sound pressures are evenly spaced; otherwise
    the sound pressure of each level, ascending from 0 to 1, in single precision. rate: rows that the device plays per
    second [Hz]; each tick of the loop sends a frame with one row for each row period that the tick lasts. watchdog:
    positive time after the last frame until the device falls silent by itself [s]; None if it does not. The numbers are
    stored as plain int and float. Raises ArgumentError.
    """

    phases: int = 256
    amplitudes: int | tuple[float, ...] = 256
    rate: float = 1000.0
    watchdog: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "phases", _count("phases", self.phases))
        if isinstance(self.amplitudes, (tuple, list, np.ndarray)):
            amplitudes: int | tuple[float, ...] = _check_amplitudes(self.amplitudes)
        else:
            amplitudes = _count("amplitudes", self.amplitudes)
        object.__setattr__(self, "amplitudes", amplitudes)
        object.__setattr__(self, "rate", check_number("rate", self.rate, low=1.0, high=MAX_RATE))
        if self.watchdog is not None:
            watchdog = check_number("watchdog", self.watchdog, low=0.0, above=True)
            object.__setattr__(self, "watchdog", watchdog)

    def __str__(self) -> str:
        kind = "" if self.uniform else "uneven "
        return f"{self.phases} phases, {len(self.sizes)} {kind}amplitudes, {self.rate:g} Hz"

    @property
    def uniform(self) -> bool:
        """Whether the amplitude levels are evenly spaced."""
        return isinstance(self.amplitudes, int)

    @cached_property
    def sizes(self) -> Singles:
        """Amplitude of each level, 0..1, as a read-only array."""
        if isinstance(self.amplitudes, int):
            made = np.arange(self.amplitudes) / (self.amplitudes - 1)
        else:
            made = np.array(self.amplitudes)
        sizes = made.astype(np.float32)
        sizes.flags.writeable = False
        return sizes

    def highest(self, gain: float) -> int:
        """Return the highest amplitude level that does not exceed a limit of `gain`."""
        return bisect_right(self._allowed, gain)

    @cached_property
    def _allowed(self) -> list[float]:
        """Lowest gain limit that allows each level; level 0 is left out."""
        sizes = self.sizes.astype(np.float64)
        allowed: list[float] = (sizes[1:] - LEVEL_TOLERANCE * np.diff(sizes) - MIN_STEP).tolist()
        return allowed


def _count(name: str, value: int) -> int:
    levels = check_integer(name, value, low=2)
    if levels > MAX_LEVELS:
        raise ArgumentError(name, f"must be at most {MAX_LEVELS}, not {levels}")
    return levels


def _check_amplitudes(given: ArrayLike) -> tuple[float, ...]:
    """Return the amplitudes rounded to single precision. Raises ArgumentError."""
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
    """K successive sets of gains as device levels. The loop sends at most one frame per tick.

    sequence: a number that increases. time: due time of the first row [s]. phase: shape (K, N), where 0..phases - 1
    span one turn. amplitude: shape (K, N), from 0 (silence) to the last level (full drive). The arrays of the loop are
    read-only, and it reuses them, so a backend that keeps them must copy them.
    """

    sequence: int
    time: float
    phase: Levels
    amplitude: Levels

    def gains(self, capability: Capability) -> Gains:
        """Return the gains that the levels represent, shape (K, N). Raises IndexError for levels that do not exist."""
        turn = self.phase * np.float32(2.0 * np.pi / capability.phases)
        size = capability.sizes[self.amplitude]
        return np.asarray(size * np.exp(1j * turn), dtype=np.complex64)


@dataclass(frozen=True)
class FoundDevice:
    """A device that is connected now.

    backend: name of the backend that drives it. serial: serial number; empty if it cannot be read. title: what the
    device is and where it is plugged in; empty if the backend could not search for devices at all. problem: why the
    device cannot be used, and the remedy; empty if it can.
    """

    backend: str
    serial: str
    title: str
    problem: str = ""


class Backend(ABC):
    """Base class of the drivers for devices and simulations.

    No two threads call a backend at the same time, but a server opens and closes it in other threads than the one that
    sends. `send` and `silence` raise BackendError if the device refuses or is gone. The loop then falls silent and
    reports a fault.
    """

    name: ClassVar[str]
    """The name by which users select it."""
    usb: ClassVar[tuple[tuple[int, int] | tuple[int, int, int], ...]] = ()
    """USB devices that it drives; `pacinian devices udev` prints a rule that lets users open them.

    Each is (vendor, product), or (class, subclass, protocol) of an interface that only such devices have, whatever
    their manufacturer.
    """

    @classmethod
    def find_devices(cls) -> Iterable[FoundDevice]:
        """Return the devices of this kind that are connected now. One that cannot be read has a `problem`."""
        return ()

    @property
    @abstractmethod
    def capability(self) -> Capability:
        """Capabilities of the device, which do not change."""

    @abstractmethod
    def open(self, array: Array) -> None:
        """Claim the device. It stays silent."""

    @abstractmethod
    def send(self, frame: Frame) -> None:
        """Emit `frame`. Returns as soon as the frame is on its way."""

    @abstractmethod
    def silence(self) -> None:
        """Stop all sound at once. May be called at any time after `open`, any number of times."""

    @abstractmethod
    def close(self) -> None:
        """Silence and release the device. May be called twice."""
