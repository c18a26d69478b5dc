"""Play solutions: steer their field, blend one into the next, apply envelopes, and round to the device's levels."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.rendering.field_steering import Steering
from pacinian.rendering.modulator import Modulator
from pacinian.rendering.quantiser import Quantiser, Rounding, limit_rows
from pacinian.rendering.row_times import compute_row_times

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.plugins.backend import Capability, Frame
    from pacinian.rendering.smoothing import Smoothing
    from pacinian.rendering.solution_sequence import SolutionSequence
    from pacinian.solving.limits import Limits
    from pacinian.types import Floats, Gains

# Number of amplitude levels from which rounding to the nearest level adds less sound in quiet zones than dither. With
# fewer, weak gains would be 0.
MIN_UNDITHERED_LEVELS = 64


class Playback:
    """Makes one frame in each tick from what has been solved.

    array, medium: for which frames are made. smoothing: slew-rate limit from row to row. capability: of the device.
    period: of a tick [s]. Raises ArgumentError.
    """

    def __init__(
        self, array: Array, medium: Air, smoothing: Smoothing, capability: Capability, period: float
    ) -> None:
        times, gap = compute_row_times(capability, period)
        self.modulator = Modulator(times, gap, smoothing, len(array))
        self._steering = Steering(array, medium)
        self._columns = len(array)
        self._set_device(capability, len(times))
        self._frame: Frame
        self._made: tuple[object, ...] = ()  # inputs of the last frame

    def _set_device(self, capability: Capability, rows: int) -> None:
        self.capability = capability
        self.modulator.switches = len(capability.sizes) == 2
        self._quantiser = Quantiser(capability, rows, self._columns)

    @property
    def times(self) -> Floats:
        """Times of a tick's rows, from its start, (K,) [s]."""
        return self.modulator.times

    def use(self, capability: Capability, times: Floats, gap: float) -> None:
        """Make frames for a device with this capability from now on; keep the solutions.

        times, gap: as returned by `compute_row_times`.
        """
        self.modulator.retime(times, gap)
        self._set_device(capability, len(times))

    def reset(self) -> None:
        """Start from silence."""
        self.modulator.reset()
        self._steering.reset()
        self._made = ()

    @property
    def last_frame(self) -> Frame | None:
        """The last frame; None before the first."""
        return self._frame if self._made else None

    @property
    def silent(self) -> bool:
        """Whether the last frame is silent and all later ones will be, unless something changes."""
        return bool(self._made) and self.modulator.steady and not self.sounds

    @property
    def sounds(self) -> bool:
        """Whether the last frame sounds."""
        return bool(self._made) and bool(self._frame.amplitude.any())

    def follow(
        self, play: SolutionSequence, inputs: tuple[object, ...], t: float, ticks: int
    ) -> bool:
        """Follow a solution from time t [s] on; return whether its frame equals the last one.

        inputs: what the frame depends on, apart from time. ticks: over which to spread a change.
        """
        self.modulator.multiply(self._steering.follow(play.motion, t, ticks))
        return self.modulator.steady and self._steering.settled and self._made == inputs

    def repeat(self, sequence: int, time: float) -> Frame:
        """Return the last frame once more, with this number, due at `time` [s]."""
        return replace(self._frame, sequence=sequence, time=time)

    def make_frame(
        self, play: SolutionSequence, limits: Limits, inputs: tuple[object, ...], t: float, ticks: int, sequence: int,
        due: float,
    ) -> Frame:  # fmt: skip
        """Return the frame of the tick that begins at time t [s], with this number, due at `due` [s].

        play, inputs, ticks: as for `follow`, which the caller has called. limits: that the gains keep.
        """
        zones, ceiling = bool(limits.zones), find_ceiling(limits)
        self.modulator.phases = self.capability.phases if zones else 0
        rows = self.modulator.make_rows(play, t, ticks)
        self._steering.steer(rows, t)
        if zones:
            limit_rows(rows, ceiling)
        rounding = self._choose_rounding(limits)
        self._frame = self._quantiser.make_frame(rows, ceiling, sequence, due, rounding)
        self._made = inputs
        return self._frame

    def is_repeat(self, frame: Frame) -> bool:
        """Return whether a frame repeats the one before."""
        return frame is not self._frame

    def copy_plain_gains(self) -> Gains:
        """Return the last gains of the frames that take turns, without envelopes and before rounding, (K, N)."""
        return self._steering.steer_like_last(self.modulator.copy_plain_gains())

    def find_highest_amplitudes(self, play: SolutionSequence) -> Floats:
        """Return the highest amplitude of each transducer from now until the output has reached `play`, (N,)."""
        parts = [
            one.gains[None] if one.contributions is None else one.contributions
            for one in dict.fromkeys(play.rows)
        ]
        solved = [np.abs(gains).sum(axis=0, keepdims=True) for gains in parts]
        plain = np.abs(self.modulator.copy_plain_gains())
        return np.asarray(np.concatenate([plain, *solved]).max(axis=0), np.float64)

    def quantise_gains(self, gains: Gains, limits: Limits) -> Gains:
        """Return gains, (N,), as rounded by the device."""
        rounding = self._choose_rounding(limits)
        return self._quantiser.quantise_gains(gains, find_ceiling(limits), rounding)

    def _choose_rounding(self, limits: Limits) -> Rounding:
        """Return how to round amplitudes: down, so that a power limit is kept, or as is best for quiet zones."""
        if limits.power is not None:
            return "down"
        fine = len(self.capability.sizes) >= MIN_UNDITHERED_LEVELS
        return "nearest" if limits.zones and fine else "dithered"

    def quantise_frames(self, play: SolutionSequence, limits: Limits) -> Gains:
        """Return the gains of what is played in turn, steered and rounded by the device, (K, N)."""
        every = dict.fromkeys(play.rows) if play.cycle else play.rows[-1:]
        gains, motion = [one.gains for one in every], play.motion
        if motion is not None and motion.shift.any():
            place = motion.centre + motion.shift
            factors = self._steering.find_factors(motion.centre, place)
            gains = [g * factors for g in gains]
        made = [self.quantise_gains(g, limits) for g in gains]
        return np.array(made, np.complex64).reshape(-1, self._columns)


def find_ceiling(limits: Limits) -> float:
    """Return the largest amplitude that limits permit, 0..1."""
    return min(1.0, limits.gain or 1.0)
