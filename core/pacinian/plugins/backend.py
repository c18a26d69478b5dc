"""The backend seam: frames in, sound out."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from pacinian.checks import integer, number
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.acoustics.array import Array
    from pacinian.types import Gains, Levels


FASTEST = 1e6  # [Hz] frames


@dataclass(frozen=True)
class Capability:
    """What a device can do.

    phases, amplitudes: how many levels of each. rate: frames that it plays per second [Hz]; a tick of
    the loop sends as many frames as it lasts. watchdog: seconds after which it goes silent by itself
    when frames stop [s]; None if it does not.
    """

    phases: int = 256
    amplitudes: int = 256
    rate: float = 1000.0
    watchdog: float | None = None

    def __post_init__(self) -> None:
        for name in ("phases", "amplitudes"):
            levels = integer(name, getattr(self, name), low=2)
            if levels > 1 << 16:
                raise ArgumentError(name, f"must be at most 65536, not {levels}")
        number("rate", self.rate, low=1.0, high=FASTEST)


@dataclass(frozen=True, eq=False)
class Frame:
    """K successive gains as a device's levels; at most one is sent per tick.

    sequence: counts up. time: when its first row is due [s]. phase: (K, N), 0..phases - 1 for one turn.
    amplitude: (K, N), 0..amplitudes - 1 for 0..1. The arrays are reused: a backend that keeps them copies.
    """

    sequence: int
    time: float
    phase: Levels
    amplitude: Levels

    def gains(self, capability: Capability) -> Gains:
        """The gains that these levels stand for, (K, N)."""
        turn = self.phase * np.float32(2.0 * np.pi / capability.phases)
        size = self.amplitude / np.float32(capability.amplitudes - 1)
        return np.asarray(size * np.exp(1j * turn), dtype=np.complex64)


@dataclass(frozen=True)
class Found:
    """A device that is connected now.

    backend: the name of what drives it. serial: tells it from others of its kind; empty where it cannot be
    read. title: what it is, and where it is plugged in. problem: what keeps it from being used, and what to do
    about it; empty if nothing does.
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
    usb: ClassVar[tuple[tuple[int, int], ...]] = ()
    """Vendor and product numbers of its USB devices: `pacinian devices udev` gives users the right to them."""

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
