"""Uncertainty bands, against independent Monte Carlo code and exactly known cases."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.acoustics.uncertainty import heat

CHANCE = np.random.default_rng(8)
N, M = 40, 4
R = CHANCE.uniform((-0.08, -0.08, 0.0), (0.08, 0.08, 0.0), (N, 3))
ARRAY = pc.Array(R, transducer=pc.Transducer(pressure=3.0))
Q = np.array([[0.0, 0.0, 0.15], [0.01, 0.0, 0.15], [0.03, 0.02, 0.16], [-0.02, 0.0, 0.2]])
AIR = pc.Air(temperature=20.0, humidity=0.0)
AREAS = np.array([1.0, 2.0, 0.5, 1.5]) * 1e-5  # [m^2]
G = np.exp(2j * np.pi * 40e3 / AIR.speed_of_sound * np.linalg.norm(R - Q[0], axis=1))
TRIALS = 15_000
ALL = pc.Uncertainty(pressure=0.2, temperature=3.0, phase=0.4, gain=0.2)
CASES = {
    "pressure": pc.Uncertainty(pressure=0.3),
    "temperature": pc.Uncertainty(temperature=4.0),
    "phase": pc.Uncertainty(phase=0.8),
    "gain": pc.Uncertainty(gain=0.4),
    "all": ALL,
    "each": pc.Uncertainty(phase=CHANCE.uniform(0.0, 0.8, N), gain=CHANCE.uniform(0.0, 0.4, N)),
}


@functools.cache
def throw(name: str) -> tuple[Any, Any]:
    """Amplitudes [Pa] and radiation pressures [Pa], (TRIALS, M), of dry air, from the textbook's equations."""
    u = CASES[name]
    r = np.sqrt(((Q[:, None] - R) ** 2).sum(axis=2))  # (M, N)
    chance = np.random.default_rng(1)
    air, transducers = chance.standard_normal((TRIALS, 2)), chance.standard_normal((TRIALS, 2, N))
    strength = 3.0 * np.exp(u.pressure * air[:, 0])
    kelvin = 293.15 + u.temperature * air[:, 1]
    c = np.sqrt(1.4 * 8.314462618 * kelvin / 0.0289647)
    rho = 101_325.0 * 0.0289647 / (8.314462618 * kelvin)
    g = G * (1.0 + np.asarray(u.gain) * transducers[:, 0])
    g *= np.exp(1j * np.asarray(u.phase) * transducers[:, 1])
    wave = np.exp(-2j * math.pi * 40e3 / c[:, None, None] * r) / r  # (TRIALS, M, N)
    p = strength[:, None] * np.abs((wave * g[:, None]).sum(axis=2))
    P = p**2 / (rho * c * c)[:, None]
    return p, P


@pytest.mark.parametrize("name", CASES)
def test_monte_carlo_by_other_code_agrees(name: str) -> None:
    u = CASES[name]
    p, P = throw(name)
    for band, thrown in (
        (pc.predict_sound_pressure(ARRAY, G, Q, u, AIR, samples=2000), p),
        (pc.predict_radiation_pressure(ARRAY, G, Q, u, AIR, samples=2000), P),
        (pc.predict_force(ARRAY, G, Q, AREAS, u, AIR, samples=2000), P @ AREAS),
    ):
        deviation = thrown.std(axis=0)
        np.testing.assert_allclose(band.mean, thrown.mean(axis=0), atol=0.06 * deviation.max())
        np.testing.assert_allclose(band.deviation, deviation, rtol=0.05)
        low, high = np.quantile(thrown, [0.025, 0.975], axis=0)
        np.testing.assert_allclose(band.low, low, atol=0.2 * deviation.max())
        np.testing.assert_allclose(band.high, high, atol=0.25 * deviation.max())
        assert band.exact == (name == "pressure")


def test_what_is_known_has_no_band() -> None:
    band = pc.predict_radiation_pressure(ARRAY, G, Q, pc.Uncertainty(), AIR)
    P = pc.radiation_pressure(pc.field(ARRAY, G, Q, AIR, "double"), AIR)
    for part in (band.nominal, band.mean, band.low, band.high):
        np.testing.assert_allclose(part, P, rtol=1e-12)
    assert not band.deviation.any()
    assert band.exact


def test_a_band_holds_its_share() -> None:
    _, P = throw("all")
    for confidence in (0.5, 0.99):
        band = pc.predict_radiation_pressure(
            ARRAY, G, Q, ALL, AIR, confidence=confidence, samples=4000
        )
        share = ((band.low <= P) & (band.high >= P)).mean(axis=0)
        np.testing.assert_allclose(share, confidence, atol=0.02)


def test_scatter_of_independent_transducers_leaves_the_power() -> None:
    """With random phases, powers add up, so the mean radiation pressure follows from the sum of squares."""
    band = pc.predict_radiation_pressure(ARRAY, G, Q, pc.Uncertainty(phase=4.0), AIR)
    each = pc.radiation_pressure(pc.matrix(ARRAY, Q, AIR) * G, AIR)
    np.testing.assert_allclose(band.mean, each.sum(axis=1), rtol=1e-5)


def test_equal_seeds_give_equal_bands() -> None:
    one, same, other = (
        pc.predict_force(ARRAY, G, Q, AREAS, ALL, AIR, samples=200, seed=seed) for seed in (3, 3, 4)
    )
    assert (one.low, one.mean, one.high) == (same.low, same.mean, same.high)
    assert one.low != other.low
    assert one.nominal == other.nominal


def test_a_surface_is_steadier_than_its_points() -> None:
    u = pc.Uncertainty(phase=0.8)
    P = pc.predict_radiation_pressure(ARRAY, G, Q, u, AIR)
    force = pc.predict_force(ARRAY, G, Q, 1e-5, u, AIR)
    assert force.nominal == pytest.approx(1e-5 * P.nominal.sum())
    assert force.mean == pytest.approx(1e-5 * P.mean.sum())
    assert force.deviation < 1e-5 * P.deviation.sum()


@pytest.mark.parametrize("by", [-10.0, 0.0, 7.0])
def test_warm_air_is_air_of_that_temperature(by: float) -> None:
    for how in ({}, {"attenuation": "absorbing"}, {"humidity": 0.9}):
        made = heat(pc.Air(temperature=20.0, **how), by)  # type: ignore[arg-type]
        exact = pc.Air(temperature=20.0 + by, **how)  # type: ignore[arg-type]
        assert made.speed_of_sound == pytest.approx(exact.speed_of_sound, rel=1e-12)
        assert made.density == pytest.approx(exact.density, rel=1e-12)
        assert made.beta(40e3) == pytest.approx(exact.beta(40e3), rel=1e-12)
    given = heat(pc.Air(speed_of_sound=340.0, density=1.2), by)
    assert given.speed_of_sound == pytest.approx(340.0 * math.sqrt(1.0 + by / 295.15), rel=2e-3)


def test_no_points_have_no_band() -> None:
    band = pc.predict_sound_pressure(ARRAY, G, np.empty((0, 3)), ALL, AIR)
    assert band.low.shape == (0,)
    assert "no points" in repr(band)
    assert "95%" in repr(pc.predict_sound_pressure(ARRAY, G, Q, ALL, AIR, samples=100))


@pytest.mark.parametrize(
    ("argument", "change"),
    [
        ("gains", {"gains": G[:3]}),
        ("gains", {"gains": G * np.nan}),
        ("points", {"points": Q[0]}),
        ("points", {"points": 1e3 * Q}),  # millimetres
        ("points", {"points": R[:2]}),
        ("array", {"array": None}),
        ("medium", {"medium": None}),
        ("uncertainty", {"uncertainty": 0.1}),
        ("uncertainty", {"medium": pc.Air(temperature=95.0)}),  # some samples are above 100 degC
        ("uncertainty", {"medium": pc.Air(temperature=-79.0)}),
        ("uncertainty", {"uncertainty": pc.Uncertainty(phase=[0.1, 0.2])}),
        ("confidence", {"confidence": 95.0}),  # percent
        ("samples", {"samples": 10}),
        ("samples", {"samples": 10**9}),
        ("seed", {"seed": -1}),
        ("alpha", {"alpha": -1.0}),
        ("areas", {"areas": np.ones(3)}),
        ("areas", {"areas": -1.0}),
        ("areas", {"areas": np.nan}),
        ("areas", {"areas": "large"}),
    ],
)
def test_bad_arguments_are_named(argument: str, change: dict[str, Any]) -> None:
    good = {"array": ARRAY, "gains": G, "points": Q, "areas": AREAS, "uncertainty": ALL}
    with pytest.raises(pc.ArgumentError) as told:
        pc.predict_force(**(good | {"medium": AIR} | change))
    assert told.value.argument == argument


@pytest.mark.parametrize("name", ["pressure", "temperature", "phase", "gain"])
def test_deviations_that_cannot_be_meant_are_refused(name: str) -> None:
    for value in (-0.1, np.nan, 45.0, [0.1, -0.1], [[0.1]], [0.1, 45.0], "large"):
        with pytest.raises(pc.ArgumentError, match=name):
            pc.Uncertainty(**{name: value})
