"""Turn solutions into the rows of a frame: follow them smoothly, and apply envelopes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.rendering.envelope_gains import (
    MIN_POWER,
    EnvelopeFade,
    Source,
    group_amplitudes,
    mean_amplitude,
    mix,
)
from pacinian.rendering.smoothing import GainSmoother

if TYPE_CHECKING:
    from pacinian.rendering.cached_solution import CachedSolution
    from pacinian.rendering.smoothing import Smoothing
    from pacinian.rendering.solution_sequence import SolutionSequence
    from pacinian.solving.limits import Limits
    from pacinian.types import Floats, Gains, Singles


class Slot:
    """One frame of a cycle that is played: it has every K-th row, and follows its own solutions.

    last: the `GainSmoother` from whose last row this frame starts. span: remaining rows of a change.
    """

    def __init__(self, last: GainSmoother) -> None:
        self.smoother = GainSmoother(last.settings, len(last.gains))
        self.smoother.gains[:] = last.gains
        self.solved: CachedSolution | None = None
        self.span = 0


class Modulator:
    """Turns solutions into rows of gains.

    times: of a tick's rows, from its start, (K,) [s]. gap: from row to row [s]. columns: number of transducers N.
    """

    def __init__(self, times: Floats, gap: float, smoothing: Smoothing, columns: int) -> None:
        self.switches = False
        """Whether square waves have vertical edges, because the device's transducers are only on or off."""
        self.phases = 0
        """Number of the device's phase levels, if solutions are turned by whole levels; 0 for any angle."""
        self.smoother = GainSmoother(smoothing, columns)
        self._smoothing, self._jumps = smoothing, replace(smoothing, rate=None)
        self.place_in_cycle = 0, 1
        """Which frame of a cycle the first row of the last tick was, and the number of frames in the cycle."""
        self._row = 0  # number of the next row
        self._followed: list[CachedSolution] = []
        self._fade = EnvelopeFade()
        self._span = 0  # remaining rows of a change
        self._limits: Limits | None = None  # of the last row
        self._slots: list[Slot] = []  # of the cycle that is played
        self.retime(times, gap)

    def retime(self, times: Floats, gap: float) -> None:
        """Make rows at other times from the next tick on; keep the solutions. Arguments as for the constructor."""
        K, N = len(times), len(self.smoother.gains)
        self.times, self._gap = times, gap
        self.steady = False
        """Whether the next tick's rows will all equal the last row, if nothing changes."""
        self._plain = np.zeros((K, N), dtype=np.complex64)
        self._smooth = np.zeros((K, N), dtype=np.complex64)
        self._rows = np.zeros((K, N), dtype=np.complex64)

    def reset(self) -> None:
        """Start from silence."""
        self._followed, self._limits, self._slots = [], None, []
        self._fade.reset()
        self.smoother.reset()

    def multiply(self, factors: Gains | None) -> None:
        """Multiply the gains of the last row by factors, (N,), that leave its steered field unchanged.

        factors: None to change nothing.
        """
        if factors is None:
            return
        for smoother in (self.smoother, *(slot.smoother for slot in self._slots)):
            smoother.gains *= factors
            smoother.settled = False
        self.steady = False

    def copy_plain_gains(self) -> Gains:
        """Return the last gains of the frames that take turns, without envelopes, (K, N)."""
        return np.array(
            [of.gains for of in [slot.smoother for slot in self._slots] or [self.smoother]]
        )

    @property
    def held_back(self) -> bool:
        """Whether the slew-rate limit keeps the last row from its solution, although the change should be over."""
        # a frame begins with what another one played, and may take one row more
        followers = [(slot.smoother, slot.span + 1) for slot in self._slots]
        return any(
            smoother.settings.rate is not None and not smoother.settled and span <= 0
            for smoother, span in followers or [(self.smoother, self._span)]
        )

    def make_rows(self, play: SolutionSequence, t: float, ticks: int = 1) -> Gains:
        """Return the gains of the rows of the tick that begins at time t [s], (K, N); the array is reused.

        play: the solutions; silence before the first. ticks: number of ticks between solutions, over which a change is
        spread.
        """
        if not play.rows:
            self._rows[:] = 0.0
            return self._rows
        solved, count = list(play.rows), play.frames
        self.place_in_cycle = self._row % count, count
        if play.cycle:
            solved = [solved[(self._row + k) % count] for k in range(len(self.times))]
        flat = self.smoother.settled and len(solved) == 1 and solved == self._followed
        flat = flat and not play.cycle and not self._fade
        at = t + self.times
        if flat:
            self._smooth[:] = self.smoother.gains
            self.smoother.rest()
            self._fade.end()
            self._write_steady(solved[0], group_amplitudes(solved[0], at, self.switches))
        else:
            self._follow(solved, play, ticks)
            sounding = solved * (len(at) // len(solved)) if self._fade.cycles else solved
            for n, one in enumerate(sounding):
                own = slice(n, len(at), len(sounding))  # its rows
                self._rows[own] = self._mix(one, own, at[own], self._smooth[own])
        self._fade.advance(len(at))
        self._row += len(at)
        self.steady = flat and solved[0].steady
        return self._rows

    def _mix(self, one: CachedSolution, own: slice, t: Floats, s: Gains) -> Gains:
        """Apply envelopes to the smooth gains s, (K, N), of one solution's rows `own` of this tick, at times t [s]."""
        past = self._fade.shares(self._row + own.start, own)
        if not past and one.contributions is None:
            return np.asarray(group_amplitudes(one, t, self.switches)[0][:, None] * s)
        share = 1.0 - sum((share for _, share in past), np.zeros(len(t)))
        return mix([Source(x, w, t, s, self.switches) for x, w in [(one, share), *past]], s)

    def _write_steady(self, one: CachedSolution, a: Singles) -> None:
        """Write the rows while nothing fades. a: amplitudes of the groups, (V, K)."""
        if one.contributions is None:
            np.multiply(a[0][:, None], self._smooth, out=self._rows)
            return
        g = one.gains
        turn = np.vdot(g, self._smooth[0]) / max(float(np.vdot(g, g).real), MIN_POWER)
        a = np.vstack([a, mean_amplitude(one, a)])
        np.matmul((turn * a.T).astype(np.complex64), one.contributions, out=self._rows)

    def _follow(self, solved: list[CachedSolution], play: SolutionSequence, ticks: int) -> None:
        plain = self._plain[: len(solved)]
        for gains, one in zip(plain, solved, strict=True):
            gains[:] = one.gains
        # An intended jump of a focus is not smoothed. Other limits apply from the first row on, unless the output is
        # silent: then all rows keep them, also smoothed ones.
        limited = self._limits is not None and self._limits != play.limits
        jumps = play.one_per_row or (limited and self.smoother.gains.any())
        settings = self._jumps if jumps else self._smoothing
        self._limits = play.limits
        if solved != self._followed:
            self._span = ticks * len(self.times)
        rate = settings.rate
        self._fade.begin(
            play.rows, 1.0 if rate is None else min(rate * self._gap, 1 / max(self._span, 1))
        )
        if play.cycle or (self._slots and not play.one_per_row):
            self._follow_slots(plain, solved, play, ticks, settings)
        else:
            self._slots, self.smoother.settings = [], settings
            span = 1 if settings.rate is None else self._span
            self.smoother.follow(plain, self._gap, self._smooth, span, play.growth, self.phases)
        self._span -= len(self.times)
        self._followed = solved

    def _follow_slots(
        self,
        plain: Gains,
        solved: list[CachedSolution],
        play: SolutionSequence,
        ticks: int,
        settings: Smoothing,
    ) -> None:
        """Move each frame of a cycle towards its own solution.

        After the cycle, all frames move towards the one solution, until they have reached it.

        plain: gains of `solved`; one for each row, or one for all.
        """
        count = len(play.rows) if play.cycle else len(self._slots)
        if len(self._slots) != count:
            old = self._slots
            self._slots = [
                Slot(old[k % len(old)].smoother if old else self.smoother) for k in range(count)
            ]
        for n in range(len(self.times)):
            slot, k = self._slots[(self._row + n) % count], n % len(solved)
            if slot.solved is not solved[k]:
                slot.solved, slot.span = solved[k], max(1, ticks * len(self.times) // count)
            slot.smoother.settings = settings
            span = 1 if settings.rate is None else slot.span
            row = self._smooth[n : n + 1]
            gap = count * self._gap
            slot.smoother.follow(plain[k : k + 1], gap, row, span, play.growth, self.phases)
            slot.span -= 1
        ended = not play.cycle and all(
            slot.solved is solved[0] and slot.smoother.settled for slot in self._slots
        )
        self.smoother.gains[:], self.smoother.settled = self._smooth[-1], ended
        if ended:
            self._slots = []
