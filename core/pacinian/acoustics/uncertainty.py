"""How sure a predicted pressure or force is, if the strength, the air and the transducers are not known exactly.

The uncertain quantities are independent. With z standard normal and eps the standard deviations of `Uncertainty`,

    P0      ->  P0 exp(eps_pressure z)                                         the same for all transducers
    T       ->  T + eps_temperature z                                          speed of sound, density, absorption
    g_n     ->  g_n (1 + eps_gain z_n) exp(j eps_phase z'_n)                   independent transducers

If only the phases and gains of transducers scatter, the mean square pressure is known exactly. With b_n = B_mn g_n and
k_n = exp(-eps_phase,n^2 / 2),

    E|p_m|^2 = |sum_n k_n b_n|^2 + sum_n (1 + eps_gain,n^2 - k_n^2) |b_n|^2,

as for the gain of an antenna with surface errors (J. Ruze, Proc. IEEE 54, 633, 1966). If only P0 is uncertain, all
quantities of a prediction are exact, because |p| is proportional to P0. All other quantities are sampled with a seed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from statistics import NormalDist
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import Array
from pacinian.acoustics.pressure import ALPHA_SKIN, radiation_pressure
from pacinian.acoustics.propagation import check_medium, field, matrix
from pacinian.argument_checks import (
    check_integer,
    check_kind,
    check_near,
    check_number,
    check_numbers,
)
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from pacinian.types import ArrayLike, Complexes, Floats

# Largest standard deviations: of ln P0 (a factor of 7), of the temperature [K], of phases [rad], of gains (relative).
MAX_PRESSURE_DEVIATION, MAX_TEMPERATURE_DEVIATION = 2.0, 10.0
MAX_PHASE_DEVIATION, MAX_GAIN_DEVIATION = 4.0, 1.0
MIN_SAMPLES = 100  # below, the ends of an interval are guesses
MAX_VALUES = 1 << 27  # pressures of all samples together: 1 GiB
CHUNK = 1 << 18  # elements of B in one chunk


@dataclass(frozen=True, kw_only=True)
class Uncertainty:
    """Standard deviations of what a prediction depends on; 0 for what is known.

    pressure: of ln P0, that is, about the relative one of P0 (0.3 for published values of one transducer type).
    temperature: of the air [K]. phase: of each transducer [rad]. gain: of each transducer's strength, relative. Both
    are one number for all transducers, or N of them, as `DeviceDescription.uncertainty` gives. Raises ArgumentError.
    """

    pressure: float = 0.0
    temperature: float = 0.0
    phase: float | Sequence[float] = 0.0
    gain: float | Sequence[float] = 0.0

    def __post_init__(self) -> None:
        most = (
            MAX_PRESSURE_DEVIATION,
            MAX_TEMPERATURE_DEVIATION,
            MAX_PHASE_DEVIATION,
            MAX_GAIN_DEVIATION,
        )
        for one, high in zip(fields(self), most, strict=True):
            given = getattr(self, one.name)
            if one.name in ("phase", "gain") and np.ndim(given):
                checked: Any = tuple(check_numbers(one.name, given, (None,)).tolist())
                check_number(one.name, min(checked, default=0.0), low=0.0, high=high)
                check_number(one.name, max(checked, default=0.0), low=0.0, high=high)
            else:
                checked = check_number(one.name, given, low=0.0, high=high)
            object.__setattr__(self, one.name, checked)


@dataclass(frozen=True, eq=False)
class PredictionInterval:
    """A predicted quantity and how sure it is. All have the same shape: (M,) for points, () for a force.

    nominal: without uncertainty. mean, deviation: mean and standard deviation. low, high: ends of the interval in which
    the quantity lies with probability `confidence`, as far outside below as above. The unit is that of the quantity.
    exact: whether nothing was sampled. samples: number of samples otherwise.
    """

    nominal: Floats
    mean: Floats
    deviation: Floats
    low: Floats
    high: Floats
    confidence: float
    exact: bool
    samples: int

    def __repr__(self) -> str:
        if not self.nominal.size:
            return "<PredictionInterval of no points>"
        first = f"{self.nominal.flat[0]:.3g} ({self.low.flat[0]:.3g} to {self.high.flat[0]:.3g})"
        rest = f", and of {self.nominal.size - 1} more" if self.nominal.size > 1 else ""
        return f"<PredictionInterval of {self.confidence:.0%}: {first}{rest}>"


def predict_sound_pressure(
    array: Array,
    gains: ArrayLike,
    points: ArrayLike,
    uncertainty: Uncertainty,
    medium: Air,
    *,
    confidence: float = 0.95,
    samples: int = 2000,
    seed: int = 0,
) -> PredictionInterval:
    """Predict the peak sound pressure |p| at M points, (M,) [Pa].

    array: N transducers. gains: (N,), not adapted to the errors. points: (M, 3) [m]. uncertainty: what is not known.
    medium: the air. confidence: of the interval, 0.5..0.999. samples: at least 100. seed: equal seeds give equal
    results. Raises ArgumentError, PointOnTransducer.
    """
    prediction = _Prediction(array, gains, points, uncertainty, medium, confidence, samples, seed)
    return prediction.compute(1.0, lambda p, air: np.abs(p).astype(np.float64))


def predict_radiation_pressure(
    array: Array,
    gains: ArrayLike,
    points: ArrayLike,
    uncertainty: Uncertainty,
    medium: Air,
    *,
    alpha: float = ALPHA_SKIN,
    confidence: float = 0.95,
    samples: int = 2000,
    seed: int = 0,
) -> PredictionInterval:
    """Predict the radiation pressure at M points, (M,) [Pa]. The mean is exact unless the temperature is uncertain.

    array, gains, points, uncertainty, medium, confidence, samples, seed: as in `predict_sound_pressure`. alpha: about 2
    on skin. Raises ArgumentError, PointOnTransducer.
    """
    prediction = _Prediction(array, gains, points, uncertainty, medium, confidence, samples, seed)
    return prediction.compute(2.0, lambda p, air: radiation_pressure(p, air, alpha))


def predict_force(
    array: Array,
    gains: ArrayLike,
    points: ArrayLike,
    areas: ArrayLike,
    uncertainty: Uncertainty,
    medium: Air,
    *,
    alpha: float = ALPHA_SKIN,
    confidence: float = 0.95,
    samples: int = 2000,
    seed: int = 0,
) -> PredictionInterval:
    """Predict the force of the radiation pressure on a surface, () [N]: the sum of P_m areas_m.

    The mean is exact unless the temperature is uncertain. Errors at different points are not independent, and this
    counts.

    points: (M, 3) [m], at most half a wavelength apart. areas: of the parts of the surface that they stand for, (M,)
    [m^2], or one for all. array, gains, uncertainty, medium, confidence, samples, seed: as in `predict_sound_pressure`.
    alpha: about 2 on skin. Raises ArgumentError, PointOnTransducer.
    """
    prediction = _Prediction(array, gains, points, uncertainty, medium, confidence, samples, seed)
    try:
        spread = np.broadcast_to(np.asarray(areas, dtype=np.float64), (len(prediction.q),))
    except (TypeError, ValueError):
        raise ArgumentError(
            "areas", f"must be one area [m^2] or {len(prediction.q)}, one for each point"
        ) from None
    if not (spread >= 0.0).all() or not np.isfinite(spread).all():
        raise ArgumentError("areas", "must be finite, and 0 or more [m^2]")
    return prediction.compute(2.0, lambda p, air: radiation_pressure(p, air, alpha) @ spread)


class _Prediction:
    """The checked arguments of a prediction, and its computation."""

    def __init__(
        self, array: Array, gains: ArrayLike, points: ArrayLike, uncertainty: Uncertainty,
        medium: Air, confidence: float, samples: int, seed: int,
    ) -> None:  # fmt: skip
        check_kind("array", array, Array)
        self.array, self.air = array, check_medium(medium)
        check_kind("uncertainty", uncertainty, Uncertainty)
        self.given = uncertainty
        self.q = check_numbers("points", points, (None, 3))
        check_near("points", self.q, array.centre)
        self.nominal: Complexes = field(array, gains, self.q, self.air, "double")
        self.g: Complexes = np.asarray(gains, dtype=np.complex128)
        self.phase, self.gain = (
            _spread(name, value, len(self.g))
            for name, value in (("phase", uncertainty.phase), ("gain", uncertainty.gain))
        )
        self.confidence = check_number("confidence", confidence, low=0.5, high=0.999)
        self.count = check_integer("samples", samples, low=MIN_SAMPLES)
        if self.count * max(len(self.q), len(self.g)) > MAX_VALUES:
            raise ArgumentError("samples", f"must be fewer: {self.count} of them fill the memory")
        self.rng = np.random.default_rng(check_integer("seed", seed, low=0))
        most = NormalDist().inv_cdf(1.0 - 0.5 / self.count)  # largest of `_draw_stratified_normals`
        for change in (-most * uncertainty.temperature, most * uncertainty.temperature):
            try:
                heat(self.air, change)
            except ArgumentError as error:
                raise ArgumentError(
                    "uncertainty",
                    f"has a temperature of {uncertainty.temperature:g} K, so that some samples of the air are "
                    f"{change:+.1f} K off, for which {error}: give a smaller one",
                ) from None

    def compute(
        self, power: float, quantity: Callable[[Complexes, Air], Floats]
    ) -> PredictionInterval:
        """Predict a quantity that is proportional to P0^power. quantity: of p, (..., M) [Pa], and the air."""
        nominal, s = np.asarray(quantity(self.nominal, self.air)), power * self.given.pressure
        ends = (1.0 - self.confidence) / 2.0, (1.0 + self.confidence) / 2.0
        scattered = self.phase.any() or self.gain.any()
        if not (scattered or self.given.temperature):
            low, high = (nominal * math.exp(s * NormalDist().inv_cdf(end)) for end in ends)
            mean = nominal * math.exp(s * s / 2.0)
            spread = mean * math.sqrt(math.expm1(s * s))
            return PredictionInterval(nominal, mean, spread, low, high, self.confidence, True, 0)
        found = self._sample(quantity)
        mean, variance = found.mean(axis=0), found.var(axis=0)
        if power == 2.0 and not self.given.temperature:
            mean = np.asarray(quantity(self._mean_square(), self.air))
        deviation = np.sqrt(math.exp(s * s) * variance + math.expm1(s * s) * mean * mean)
        strength = np.exp(s * self._draw_stratified_normals())
        found *= strength.reshape(-1, *[1] * nominal.ndim)
        low, high = np.quantile(found, ends, axis=0)
        grows = math.exp(s * s / 2.0)
        return PredictionInterval(
            nominal, mean * grows, deviation * grows, np.asarray(low), np.asarray(high),
            self.confidence, False, self.count,
        )  # fmt: skip

    def _sample(self, quantity: Callable[[Complexes, Air], Floats]) -> Floats:
        """Return the quantity for random air and transducers, (samples, ...), at the nominal P0."""
        warmer = self.given.temperature * self._draw_stratified_normals()
        found: list[Floats] = []
        for k in range(self.count):
            scatter = self.rng.standard_normal((2, len(self.g)))
            g = self.g * (1.0 + self.gain * scatter[0])
            g *= np.exp(1j * self.phase * scatter[1])
            air = heat(self.air, warmer[k]) if self.given.temperature else self.air
            found.append(quantity(field(self.array, g, self.q, air), air))
        return np.array(found, dtype=np.float64)

    def _draw_stratified_normals(self) -> Floats:
        """Return standard normal numbers, one of each equally probable interval, in random order, (samples,)."""
        from scipy.special import ndtri

        return np.asarray(ndtri((self.rng.permutation(self.count) + 0.5) / self.count))

    def _mean_square(self) -> Complexes:
        """Return the root of E|p|^2 if transducers scatter, (M,) [Pa]."""
        kept = np.exp(-(self.phase**2) / 2.0)
        square = np.empty(len(self.q))
        rows = max(1, CHUNK // len(self.g))
        for first in range(0, len(self.q), rows):
            part = slice(first, first + rows)
            b = matrix(self.array, self.q[part], self.air) * self.g
            square[part] = np.abs(b @ kept) ** 2 + np.abs(b) ** 2 @ (1.0 + self.gain**2 - kept**2)
        return np.sqrt(square).astype(np.complex128)


def _spread(name: str, value: float | Sequence[float], count: int) -> Floats:
    """Return a deviation for each of `count` transducers. Raises ArgumentError."""
    given = np.asarray(value, dtype=np.float64)
    if given.ndim and len(given) != count:
        raise ArgumentError(
            "uncertainty", f"has {len(given)} values of `{name}` for {count} transducers"
        )
    return np.broadcast_to(given, (count,))


def heat(air: Air, by: float) -> Air:
    """Return air that is `by` [K] warmer. A given speed of sound or density changes in the ratio of an ideal gas."""
    at = Air().temperature if air.temperature is None else air.temperature
    assert at is not None  # the default is a number
    before, after = (
        Air(temperature=t, humidity=air.humidity, ambient_pressure=air.ambient_pressure)
        for t in (at, at + by)
    )
    return Air(
        temperature=at + by,
        humidity=air.humidity,
        ambient_pressure=air.ambient_pressure,
        speed_of_sound=air.speed_of_sound * after.speed_of_sound / before.speed_of_sound,
        density=air.density * after.density / before.density,
        attenuation=air.attenuation,
        absorption=air.absorption,
    )
