"""Measure now and then, in the background, what is felt of the field that the ticks emit."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.errors import describe_error
from pacinian.neighbours import find_nearest
from pacinian.rendering.emitted_measurement import PLACES_ON_SKIN, Probe
from pacinian.rendering.measurement_schedule import (
    TICKS_PER_MEASUREMENT,
    Measurement,
    MeasurementSchedule,
)
from pacinian.rendering.solution_sequence import RISEN_FROM
from pacinian.scene.sampling.touched_skin import TouchedSkinObserver

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.rendering.playback import Playback
    from pacinian.rendering.solution_sequence import SolveResult
    from pacinian.scene.sampling.sampler import Sampler
    from pacinian.scene.sampling.samples import Samples
    from pacinian.scene.scene import Scene
    from pacinian.session import Session
    from pacinian.solving.limits import Limits
    from pacinian.types import Floats, Gains


# Smallest distance of a place beside a contact from the samples of objects that are not measured with it [m].
MIN_DISTANCE_TO_OTHERS = 0.015


class _Moment(NamedTuple):
    """What a tick has emitted.

    scene: at `time` [s]. result: the result that was played. limits: of the gains. gains: of the frames that take
    turns, without envelopes and before rounding, (K, N).
    """

    scene: Scene
    time: float
    result: SolveResult
    limits: Limits
    gains: Gains


class FeltMonitor:
    """Keeps what some ticks have emitted, until there is time to measure it.

    session: has the array and the medium. sampler: has the skin. playback: makes the frames.
    """

    def __init__(self, session: Session, sampler: Sampler, playback: Playback) -> None:
        self._session, self._sampler, self._playback = session, sampler, playback
        self._probe, self._failed = Probe(session), False
        self.reset()

    def reset(self) -> None:
        """Forget what has been played and measured."""
        self._schedule = MeasurementSchedule()
        self._moment: _Moment | None = None
        self._observer = TouchedSkinObserver(self._session.array, self._session.medium)

    def forget(self) -> None:
        """Forget what was kept and measured, so that the next measurement does not depend on how long the last took."""
        self._schedule, self._moment = MeasurementSchedule(TICKS_PER_MEASUREMENT), None

    def watch(
        self, scene: Scene, result: SolveResult, limits: Limits, t: float, ticks: int
    ) -> None:
        """Keep what the tick at time t [s] has emitted, if it is time to measure.

        result: the result that the tick played. limits: of the gains. ticks: number of ticks since the last call.
        """
        rising = _is_rising(result.solutions.samples, result.sample_counts.samples)
        self._schedule.pass_ticks(result.solutions, ticks, rising=rising)
        if self._moment is None and self._schedule.begin(result.solutions):
            time = t + float(self._playback.times[-1])
            gains = self._playback.copy_plain_gains()
            self._moment = _Moment(scene, time, result, limits, gains)

    def take_job(self) -> Callable[[], Measurement | None] | None:
        """Return a function that measures what was kept, and forget it; None if nothing was kept.

        The function returns None if it fails, for example in a user's function. The first failure is logged.
        """
        if (moment := self._moment) is None:
            return None
        self._moment = None

        def measure() -> Measurement | None:
            try:
                return self._measure(moment)
            except Exception as error:
                if not self._failed:
                    log = logging.getLogger("pacinian")
                    log.warning(
                        "a measurement failed, the output goes on: %s", describe_error(error)
                    )
                self._failed = True
                return None

        return measure

    def _measure(self, moment: _Moment) -> Measurement:
        """Measure at the samples, between those in free air, and on touched skin."""
        play, probe = moment.result.solutions, self._probe
        samples, targets, facing = play.played_samples, play.targets, play.facing
        assert samples is not None
        assert targets is not None
        solved = self._playback.quantise_frames(play, moment.limits)
        if play.motion is not None and play.motion.shift.any():
            error_at_samples = probe.estimate_error_at_samples(samples, targets, solved)
        else:
            p = moment.result.sample_pressures
            if p is None:
                p = probe.compute_pressures(samples.positions, facing, solved)
            error_at_samples = targets.relative_error(p)
        felt, on_skin = probe.measure_between(samples, targets, facing, solved), {}
        if facing is not None and targets.regions is not None:
            emitted = [self._playback.quantise_gains(g, moment.limits) for g in moment.gains]
            on_skin = probe.measure_on_skin(self._find_places(moment), np.array(emitted))
        return Measurement(error_at_samples, felt | on_skin, on_skin)

    def _find_places(self, moment: _Moment) -> Samples:
        """Return places on the skin that is touched at that moment, at the pressures after the ramps."""
        self._observer.skin = self._sampler.skin
        places = self._observer.scatter_places(moment.scene, moment.time, PLACES_ON_SKIN)
        played, full = moment.result.solutions.samples, moment.result.sample_counts.samples
        others = played.radiation_pressure > 0.0
        others &= ~np.isin(played.regions, places.regions[places.regions >= 0])
        # the pressure of other objects beside a contact was asked for
        if others.any() and len(places):
            away = find_nearest(played.positions[others], places.positions)[0]
            places = places.only((places.regions >= 0) | (away > MIN_DISTANCE_TO_OTHERS))
        P = places.radiation_pressure * _find_ramps(places, played, full)
        return places.with_pressure(P).only((P > 0.0) | (places.radiation_pressure == 0.0))


def _is_rising(played: Samples, full: Samples) -> bool:
    """Return whether samples press clearly less than they will when their ramps have ended: `full`."""
    return played is not full and played.force < RISEN_FROM * full.force


def _find_ramps(places: Samples, played: Samples, full: Samples) -> Floats:
    """Return the factor of the ramps on the pressure at each of some places, (K,).

    A place has the factor of the nearest sample of its region. Ramps limit the slope of each pressure, so that weak
    pressures at the rim of a contact reach their targets before those in its middle. played: samples after the
    ramps. full: those before the ramps.
    """
    factors = np.ones(len(places))
    if played is full:
        return factors
    for number in set(places.regions[places.regions >= 0].tolist()):
        there = places.regions == number
        own, whole = played.only(played.regions == number), full.only(full.regions == number)
        _, i, j = np.intersect1d(own.keys, whole.keys, return_indices=True)
        i, j = i[whole.radiation_pressure[j] > 0.0], j[whole.radiation_pressure[j] > 0.0]
        if len(i):
            nearest = find_nearest(whole.positions[j], places.positions[there])[1]
            ramps = own.radiation_pressure[i] / whole.radiation_pressure[j]
            factors[there] = ramps[nearest]
        else:
            factors[there] = own.force / whole.force if whole.force > 0.0 else 0.0
    return factors
