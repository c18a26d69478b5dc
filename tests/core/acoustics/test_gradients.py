"""Derivatives: against finite differences, and against mpmath with 40 digits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mpmath
import numpy as np
import pytest

import pacinian as pc
from pacinian.acoustics.directivity import T4010A1_CUBICS

if TYPE_CHECKING:
    from collections.abc import Callable

AIR, CHANCE = pc.Air(), np.random.default_rng(5)
N, M = 12, 6
R = CHANCE.uniform((-0.1, -0.1, -0.01), (0.1, 0.1, 0.01), (N, 3))
NORMALS = CHANCE.normal((0.0, 0.0, 1.0), 0.2, (N, 3))
G = CHANCE.normal(size=N) + 1j * CHANCE.normal(size=N)
Q = CHANCE.uniform((-0.1, -0.1, 0.1), (0.1, 0.1, 0.3), (M, 3))
RESPONSE = CHANCE.uniform(0.7, 1.3, N) * np.exp(1j * CHANCE.uniform(-1.0, 1.0, N))
MEDIA = [pc.Air(), pc.Air(attenuation="none"), pc.Air(attenuation=0.7, absorption=2.0)]
KINDS = {
    "omni": pc.Transducer(pressure=2.0),
    "t4010a1": pc.T4010A1,
    "piston": pc.Transducer(directivity=pc.Piston(0.0045, 730.0)),
}
FUNCTIONS: dict[Any, Callable[..., Any]] = {
    pc.differentiate_field: lambda p, air: p,
    pc.differentiate_amplitude: lambda p, air: np.abs(p),
    pc.differentiate_radiation_pressure: pc.radiation_pressure,
}


def rig(kind: str = "t4010a1") -> pc.Array:
    return pc.Array(R, NORMALS, KINDS[kind], RESPONSE)


@pytest.mark.parametrize("air", MEDIA, ids=["spherical", "none", "absorbing"])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("function", FUNCTIONS, ids=["field", "amplitude", "radiation"])
def test_they_are_the_limits_of_differences(function: Any, kind: str, air: pc.Air) -> None:
    array, F = rig(kind), FUNCTIONS[function]
    found = function(array, G, Q, air)
    np.testing.assert_allclose(found.value, F(pc.matrix(array, Q, air) @ G, air), rtol=1e-12)
    h = 1e-6  # [m]
    for axis, step in enumerate(h * np.eye(3)):
        up, down = (F(pc.matrix(array, Q + s, air) @ G, air) for s in (step, -step))
        slope = (up - down) / (2.0 * h)
        np.testing.assert_allclose(
            found.by_points[:, axis], slope, rtol=1e-6, atol=1e-6 * np.abs(found.by_points).max()
        )
    B = pc.matrix(array, Q, air)
    for n in range(N):
        ways = []
        for way in (1.0, 1j):
            e = 1e-6 * way * np.eye(N)[n]
            ways.append((F(B @ (G + e), air) - F(B @ (G - e), air)) / 2e-6)
        if function is pc.differentiate_field:  # holomorphic: both ways give the same derivative
            np.testing.assert_allclose(ways[0], found.by_gains[:, n], rtol=1e-6)
            np.testing.assert_allclose(ways[1] / 1j, found.by_gains[:, n], rtol=1e-6)
        else:
            scale = 1e-6 * np.abs(found.by_gains).max()
            np.testing.assert_allclose(
                ways[0] + 1j * ways[1], found.by_gains[:, n], rtol=1e-6, atol=scale
            )


def exact_pressure(array: pc.Array, q: Any, air: pc.Air, g: Any) -> Any:
    """Return p at the point q, computed with mpmath."""
    kind = array.transducer
    k = 2 * mpmath.pi * mpmath.mpf(kind.frequency) / mpmath.mpf(air.speed_of_sound)
    total = mpmath.mpc(0)
    for r, n, s, gain in zip(array.positions, array.normals, array.responses, g, strict=True):
        d = [mpmath.mpf(a) - mpmath.mpf(b) for a, b in zip(q, r, strict=True)]
        distance = mpmath.sqrt(sum(x * x for x in d))
        cosine = sum(x * mpmath.mpf(y) for x, y in zip(d, n, strict=True)) / distance
        D = mpmath.mpf(1)
        if kind is pc.T4010A1:
            theta = mpmath.degrees(mpmath.acos(cosine))
            segment = int(mpmath.ceil(theta / 10)) - 1
            x = theta - 10 * segment
            D = sum(mpmath.mpf(float(c)) * x**i for i, c in enumerate(T4010A1_CUBICS[segment]))
        loss = mpmath.exp(-mpmath.mpf(air.beta(kind.frequency)) * distance)
        B = mpmath.mpf(kind.pressure) * D * distance ** -mpmath.mpf(air.exponent) * loss
        wave = mpmath.exp(-1j * k * distance)
        total += B * wave * mpmath.mpc(complex(s)) * mpmath.mpc(complex(gain))
    return total


@pytest.mark.parametrize("kind", ["omni", "t4010a1"])
@pytest.mark.parametrize("air", MEDIA, ids=["spherical", "none", "absorbing"])
def test_forty_digits_agree(kind: str, air: pc.Air) -> None:
    array = rig(kind)
    field = pc.differentiate_field(array, G, Q, air)
    radiation = pc.differentiate_radiation_pressure(array, G, Q, air)
    with mpmath.workdps(40):
        factor = mpmath.mpf(1) / (mpmath.mpf(air.density) * mpmath.mpf(air.speed_of_sound) ** 2)
        for m in range(2):
            at = [mpmath.mpf(x) for x in Q[m]]
            p = exact_pressure(array, at, air, G)
            assert abs(complex(p) - field.value[m]) < 1e-12 * abs(field.value[m])
            for axis in range(3):

                def along(x: Any, axis: int = axis, at: Any = at) -> Any:
                    return exact_pressure(array, [*at[:axis], x, *at[axis + 1 :]], air, G)

                slope = mpmath.diff(along, at[axis])
                largest = np.abs(field.by_points[m]).max()
                assert abs(complex(slope) - field.by_points[m, axis]) < 1e-9 * largest
                push = 2 * mpmath.re(mpmath.conj(p) * slope) * factor
                largest = np.abs(radiation.by_points[m]).max()
                assert abs(float(push) - radiation.by_points[m, axis]) < 1e-9 * largest


def test_an_optimiser_climbs_along_them() -> None:
    """From random gains, steps along the gradient of P end at conjugate phases, the strongest focus."""
    array, point = rig("omni"), Q[:1]
    g = np.exp(1j * CHANCE.uniform(-np.pi, np.pi, N))
    for _ in range(200):
        step = pc.differentiate_radiation_pressure(array, g, point, AIR).by_gains[0]
        g = g + 0.3 * step / np.abs(step).max()
        g /= np.abs(g)
    best = np.abs(pc.matrix(array, point, AIR)).sum()
    assert abs(pc.matrix(array, point, AIR) @ g)[0] == pytest.approx(best, rel=1e-6)


def test_silence_has_no_slope() -> None:
    array = rig()
    for function in FUNCTIONS:
        found = function(array, np.zeros(N), Q, AIR)
        assert not found.value.any()
        assert not found.by_points.any()
        assert np.isfinite(found.by_gains).all()
    assert not pc.differentiate_amplitude(array, np.zeros(N), Q, AIR).by_gains.any()


def test_intensity_counts_the_responses() -> None:
    array = rig("omni")
    plain = pc.Array(R, NORMALS, KINDS["omni"])
    np.testing.assert_allclose(
        pc.intensity(array, G, Q, medium=pc.Air()),
        pc.intensity(plain, G * RESPONSE, Q, medium=pc.Air()),
        rtol=1e-12,
    )


def test_many_points_are_taken_part_by_part() -> None:
    array, many = pc.autd(), np.tile(Q, (100, 1))
    g = np.ones(len(array))
    one, all_ = (pc.differentiate_radiation_pressure(array, g, q, AIR) for q in (Q, many))
    np.testing.assert_allclose(all_.by_points[-M:], one.by_points, rtol=1e-9)
    np.testing.assert_allclose(all_.by_gains[-M:], one.by_gains, rtol=1e-9)
    none = pc.differentiate_field(array, g, np.empty((0, 3)), AIR)
    assert (none.value.shape, none.by_gains.shape) == ((0,), (0, len(array)))
    assert none.by_points.shape == (0, 3)


@pytest.mark.parametrize("function", FUNCTIONS)
def test_bad_arguments_are_named(function: Any) -> None:
    array, large = rig(), pc.autd(3, 3)
    many = {"array": large, "gains": np.ones(len(large)), "points": np.tile(Q, (10_000, 1))}
    touching = Q.copy()
    touching[2] = R[4]
    for argument, change in (
        ("array", {"array": None}),
        ("medium", {"medium": None}),
        ("gains", {"gains": G[:3]}),
        ("gains", {"gains": np.nan * G}),
        ("gains", {"gains": "loud"}),
        ("points", {"points": Q[0]}),
        ("points", {"points": np.inf * Q}),
        ("points", {"points": 1e3 * Q}),  # millimetres
        ("points", {"points": touching}),
        ("points", many),  # 0.2 % more derivatives than are allowed
    ):
        with pytest.raises(pc.ArgumentError) as told:
            function(**({"array": array, "gains": G, "points": Q, "medium": AIR} | change))
        assert told.value.argument == argument
    with pytest.raises(pc.ArgumentError, match="alpha"):
        pc.differentiate_radiation_pressure(array, G, Q, AIR, alpha=0.0)
