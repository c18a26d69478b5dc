"""The mean of a modulated field: shares of time for frames that were seen at a few moments.

Frames are published at uneven times, so the plain mean of some tens of them is off by ten per cent. But the strength
that an envelope gives at each of these times is known, and so is its mean over whole periods. The shares are changed as
little as possible such that the mean strength of the frames is that mean: calibration weighting (Deville and Sarndal,
J. Am. Stat. Assoc. 87, 1992).
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.scene.modulation.envelope import resolve
from pacinian.scene.modulation.presets import PRESET_PERIODS
from pacinian.wire import modulation as wire
from pacinian.wire.convert_modulation import envelope_to_scene, technique_to_scene

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.scene.modulation.envelope import Timed
    from pacinian.scene.modulation.technique import Technique
    from pacinian.types import Floats
    from pacinian.wire.objects import Object

# number of times in a period at which its mean is computed; without a period the most
PERIOD_POINTS = 2000
INTERVAL = 5e-4  # interval of these times where there is no period [s]
MAX_REPEATS = 1000  # maximum number of periods of one wave until it meets another
MAX_GAP = 0.2  # largest gap, in periods, up to which the frames show the whole period
CLOSE = 1e-9  # error of a mean that is small enough
MAX_ROUNDS = 30  # maximum number of corrections of negative shares
MIN_SINGULAR_VALUE = 1e-6  # singular values below this share of the largest count as zero


class Modulation(NamedTuple):
    """How an object's strength varies in time. technique: the object's own; None for the server's."""

    envelope: wire.Envelope
    technique: wire.Technique | None = None

    @classmethod
    def of(cls, item: Object) -> Modulation:
        """Return the modulation of an object."""
        return cls(item.envelope, item.technique)

    @property
    def steady(self) -> bool:
        """Whether nothing varies."""
        simultaneous = isinstance(self.technique, wire.Simultaneous | None)
        return isinstance(self.envelope, wire.Constant) and simultaneous

    @property
    def known(self) -> bool:
        """Whether its strength can be computed at little cost. A recorded wave would first have to be filtered."""
        return not isinstance(self.envelope, wire.Wave)


def share_time(
    times: Floats, modulations: Iterable[Modulation], parts: Floats | None = None
) -> Floats:
    """Return the share of time of each frame, (K,), for means over whole periods.

    times: of the frames in the scene, (K,) [s]. parts: which frame of a cycle each is, (K,); all get equal shares.
    """
    shares = _share_period(times, modulations)
    rows, means = [np.ones(len(times))], [1.0]
    for modulation in modulations:
        if modulation.known and not modulation.steady:
            rows.append(_compute_strength(modulation, times))
            means.append(_compute_mean(modulation, float(times.min()), float(times.max())))
    if parts is not None and len(found := np.unique(parts)) > 1:
        rows += [np.asarray(parts == part, np.float64) for part in found]
        means += [1.0 / len(found)] * len(found)
    A, b = np.array(rows), np.array(means)
    correct = (A * shares).T @ np.linalg.pinv(
        (A * shares) @ A.T, rcond=MIN_SINGULAR_VALUE, hermitian=True
    )
    for _ in range(MAX_ROUNDS):
        shares = np.maximum(shares + correct @ (b - A @ shares), 0.0)
        if np.abs(b - A @ shares).max() < CLOSE:
            break
    return np.asarray(shares / shares.sum())


def find_mean_strength(modulation: Modulation, times: Floats) -> float:
    """Return the mean strength over a period, 0..1; without a period, the mean over these times of the scene [s].

    Returns 1 for a recorded wave, and if there is no period and no time is given.
    """
    if not modulation.known:
        return 1.0
    if not len(times):
        mean = _mean_of_period(modulation)
        return 1.0 if mean is None else mean
    return _compute_mean(modulation, float(times.min()), float(times.max()))


def _share_period(times: Floats, modulations: Iterable[Modulation]) -> Floats:
    """Return shares for foci that move with one period: half the gaps to the neighbours in it. Otherwise equal ones."""
    periods = {
        period
        for _, period in (_resolve(modulation) for modulation in modulations if modulation.known)
    }
    equal = np.full(len(times), 1.0 / len(times))
    if len(times) < 2 or len(periods) != 1 or not (period := periods.pop()):
        return equal
    place = times / period % 1.0
    order = np.argsort(place)
    gaps = np.diff(place[order], append=place[order[0]] + 1.0)
    if gaps.max() > MAX_GAP:
        return equal
    shares = np.empty(len(times))
    shares[order] = (gaps + np.roll(gaps, 1)) / 2.0
    return shares


def _compute_strength(modulation: Modulation, times: Floats) -> Floats:
    """Return the strength at times [s] of the scene, 0..1."""
    (envelope, technique), _ = _resolve(modulation)
    return np.clip(envelope.at(times) * technique.factor(times), 0.0, 1.0)


def _compute_mean(modulation: Modulation, begin: float, end: float) -> float:
    """Return the mean strength over a period, or from `begin` to `end` [s] if there is none."""
    if (mean := _mean_of_period(modulation)) is not None:
        return mean
    count = min(max(1, math.ceil((end - begin) / INTERVAL)), PERIOD_POINTS)
    return float(_compute_strength(modulation, np.linspace(begin, end, count)).mean())


@functools.lru_cache(maxsize=256)
def _mean_of_period(modulation: Modulation) -> float | None:
    """Return the mean strength over a period; None if there is none."""
    _, period = _resolve(modulation)
    if not period:
        return None
    times = (np.arange(PERIOD_POINTS) + 0.5) / PERIOD_POINTS * period
    return float(_compute_strength(modulation, times).mean())


@functools.lru_cache(maxsize=256)
def _resolve(modulation: Modulation) -> tuple[tuple[Timed, Technique], float]:
    """Return the envelope and the technique of the scene, and their common period [s]; 0 if there is none."""
    technique = technique_to_scene(modulation.technique or wire.Simultaneous())
    envelope = resolve(envelope_to_scene(modulation.envelope))
    own = _find_period(modulation.envelope)
    other = 1.0 / rate if (rate := getattr(technique, "frequency", 0.0)) else None
    if own is None or other is None:
        period = (other if own is None else own) or 0.0
    else:
        period = next((n * own for n in range(1, MAX_REPEATS) if _is_whole(n * own / other)), 0.0)
    return (envelope, technique), period


def _is_whole(number: float) -> bool:
    return number > 0.5 and abs(number - round(number)) < 1e-6


def _find_period(envelope: wire.Envelope) -> float | None:
    """Return the period of an envelope [s]; None if it is constant, 0 if it has none."""
    match envelope:
        case wire.Constant():
            return None
        case wire.Sine(frequency=rate) | wire.Square(frequency=rate):
            return 1.0 / rate if rate else None
        case wire.Pulse(period=period):
            return period or 0.0
        case wire.Preset(name=name) | str(name):
            return PRESET_PERIODS.get(name, 0.0)
        case _:
            return 0.0
