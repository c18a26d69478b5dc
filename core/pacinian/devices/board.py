"""A board of a device: its layout, pose and wiring, and how its channels deviate from ideal transducers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.acoustics.array import MIN_STRENGTH
from pacinian.acoustics.pose import Pose
from pacinian.acoustics.uncertainty import MAX_GAIN_DEVIATION, MAX_PHASE_DEVIATION
from pacinian.argument_checks import check_number
from pacinian.devices.layouts import AutdUnit, Grid, Places
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats, Indices

MAX_STRENGTH = 100.0  # gain of a channel, relative to its kind
GAIN_SCATTER, PHASE_SCATTER = 0.1, 0.35  # of transducers of one kind, relative and [rad]


class Board(Struct, frozen=True, forbid_unknown_fields=True):
    """One board of a device, with L transducers. Channels are numbered in the order of the board's protocol.

    serial: serial number, which distinguishes the boards. layout: positions of the transducers on the board. pose: pose
    of the board. order: transducer of the layout that each channel drives, (L,); by default the layout's own order.
    dead: channels that make no sound, or must make none. Channels of a gain below 0.001 count as dead, too. gain:
    strength of each channel relative to its kind; one, or (L,). phase: lead of each channel's sound [rad]; one, or
    (L,). gain_error, phase_error: standard errors of both, relative and [rad]; one, or (L,); by default the scatter of
    transducers of one kind, 10 % and 20 degrees. Raises ArgumentError.
    """

    serial: str = ""
    layout: AutdUnit | Grid | Places = AutdUnit()
    pose: Pose = Pose()
    order: tuple[int, ...] = ()
    dead: tuple[int, ...] = ()
    gain: float | tuple[float, ...] = 1.0
    phase: float | tuple[float, ...] = 0.0
    gain_error: float | tuple[float, ...] = GAIN_SCATTER
    phase_error: float | tuple[float, ...] = PHASE_SCATTER

    def __post_init__(self) -> None:
        L = self.layout.count
        if self.order and sorted(self.order) != list(range(L)):
            raise ArgumentError("order", f"must name each of the transducers 0 to {L - 1} once")
        wrong = [c for c in self.dead if not 0 <= c < L]
        if wrong or len(set(self.dead)) < len(self.dead):
            raise ArgumentError("dead", f"must be different channels of 0 to {L - 1}: {wrong}")
        for name, low, high in (
            ("gain", 0.0, MAX_STRENGTH),
            ("phase", -1e3, 1e3),
            ("gain_error", 0.0, MAX_GAIN_DEVIATION),
            ("phase_error", 0.0, MAX_PHASE_DEVIATION),
        ):
            value: float | tuple[float, ...] = getattr(self, name)
            if isinstance(value, tuple):
                if len(value) != L:
                    raise ArgumentError(name, f"must be one, or {L} of them, not {len(value)}")
                for c, one in enumerate(value):
                    check_number(f"{name}[{c}]", one, low=low, high=high)
            else:
                check_number(name, value, low=low, high=high)
        force_setattr(self, "dead", tuple(sorted(self.dead)))

    @property
    def drives(self) -> Indices:
        """Transducer of the layout that each channel drives, (L,)."""
        return np.array(self.order or range(self.layout.count), dtype=np.intp)

    @property
    def responses(self) -> Complexes:
        """Complex factor by which each channel differs from its kind, (L,); 0 for a dead channel."""
        L = self.layout.count
        gain, phase = (np.broadcast_to(np.asarray(v, float), (L,)) for v in (self.gain, self.phase))
        made = np.asarray(gain * np.exp(1j * phase), np.complex128)
        made[list(self.dead)] = 0.0
        return made

    @property
    def errors(self) -> tuple[Floats, Floats]:
        """Standard errors of each channel's gain, relative, and of its phase [rad], (L,) each."""
        L = self.layout.count
        return (
            np.broadcast_to(np.asarray(self.gain_error, float), (L,)),
            np.broadcast_to(np.asarray(self.phase_error, float), (L,)),
        )

    @property
    def alive(self) -> Indices:
        """The channels that are not dead, ascending."""
        return np.flatnonzero(np.abs(self.responses) >= MIN_STRENGTH)
