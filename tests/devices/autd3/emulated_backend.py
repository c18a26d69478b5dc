"""A backend on the emulator, with a clock that is told; what it emitted, and the emulator's field of that."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from autd3_core import Duration, Velocity
from autd3_emulator import Grid, RmsRecordOption

import pacinian as pc
from pacinian.testing import ManualClock
from pacinian_plugins.backends.autd3 import Autd3
from pacinian_plugins.backends.autd3.emulated import EmulatedTransport

if TYPE_CHECKING:
    from pacinian.types import ArrayLike, Floats, Levels

PERIOD = Duration.from_micros(25)
SOURCE = pc.Transducer(pressure=4.3859003539)  # [Pa m], omnidirectional: the emulator's


class Emulated:
    """A backend that is open. time is told by `clock` [s]."""

    def __init__(self, array: pc.Array | None = None, **options: Any) -> None:
        self.array, self.clock = array or pc.autd(), ManualClock()
        self.backend = Autd3(link="emulator", clock=self.clock.now, **options)
        self.backend.open(self.array)
        self._sequence = 0

    @property
    def line(self) -> EmulatedTransport:
        assert isinstance(self.backend.line, EmulatedTransport)
        return self.backend.line

    def send(self, phase: ArrayLike, amplitude: ArrayLike) -> int:
        """Send rows now, (rows, N); return how many messages that took."""
        rows = [np.atleast_2d(np.asarray(levels, np.uint16)) for levels in (phase, amplitude)]
        before = self.line.messages
        self.backend.send(pc.Frame(self._sequence, self.clock.time, *rows))
        self._sequence += 1
        return self.line.messages - before

    def recorded(self, seconds: float) -> tuple[Levels, Levels]:
        """Phases and widths of the last seconds, (249 units, periods)."""
        record = self.line.record(seconds)
        return record.phase().to_numpy(), record.pulse_width().to_numpy()


def field(record: Any, x: Any, y: Any, z: Any, resolution: float = 1e-3) -> tuple[Floats, Floats]:
    """Where the emulator has evaluated its field [m], (M, 3), and the peak sound pressure there [Pa], (M,).

    x, y, z: one, or (from, to) [m]. resolution: [m].
    """
    axes = [
        tuple(1e3 * v for v in one) if isinstance(one, tuple) else 1e3 * one for one in (x, y, z)
    ]
    grid = Grid(*axes, 1e3 * resolution, "xyz")
    made = record.sound_field(grid, RmsRecordOption(Velocity.from_m_s(340.0)))
    points = made.observe_points().to_numpy()[:, :3].astype(float) * 1e-3
    return points, np.sqrt(2.0) * made.next(PERIOD).to_numpy()[:, 0].astype(float)
