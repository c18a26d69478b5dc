"""Intensity and normal pressure: against finite differences of `matrix`, and known cases."""

from __future__ import annotations

import math

import numpy as np
import pytest

import pacinian as pc
from pacinian.acoustics.intensity import intensity, normal_pressure
from pacinian.acoustics.skin_facing import SkinFacing

AIR = pc.Air()
RHO_C = AIR.density * AIR.speed_of_sound
FAR = 9.0  # [m]
OMNI = pc.Transducer(pressure=2.0)


def smooth(cosine: pc.Floats) -> pc.Floats:
    """A smooth directivity."""
    return np.asarray(0.3 + 0.7 * cosine**3)


def rig(kind: pc.Transducer, seed: int = 0) -> tuple[pc.Array, np.ndarray, np.ndarray]:
    """An array, gains and points around it."""
    rng = np.random.default_rng(seed)
    array = pc.Array(
        rng.uniform(-0.1, 0.1, (20, 3)) * [1, 1, 0.1], rng.normal((0, 0, 1), 0.3, (20, 3)), kind
    )
    g = rng.normal(size=20) + 1j * rng.normal(size=20)
    return array, g, rng.uniform((-0.2, -0.2, 0.05), (0.2, 0.2, 0.4), (30, 3))


@pytest.mark.parametrize(
    "kind",
    [
        OMNI,
        pc.Transducer(directivity=smooth),
        pc.Transducer(frequency=25e3, directivity=pc.Piston(0.0045, 460.0)),
        pc.T4010A1,
    ],
    ids=["omni", "smooth", "piston", "t4010a1"],
)
@pytest.mark.parametrize(
    "medium", [AIR, pc.Air(attenuation="none"), pc.Air(attenuation=0.5, absorption=3.0)]
)
def test_it_follows_eulers_equation(kind: pc.Transducer, medium: pc.Air) -> None:
    array, g, q = rig(kind)
    h = 1e-7  # [m]
    steps = h * np.eye(3)
    slope = np.stack(
        [(pc.matrix(array, q + s, medium) - pc.matrix(array, q - s, medium)) @ g for s in steps], -1
    )
    omega = 2 * math.pi * kind.frequency
    v = -slope / (2 * h) / (1j * omega * medium.density)
    p = pc.matrix(array, q, medium) @ g
    exact = (p[:, None] * v.conj()).real / 2
    found = intensity(array, g, q, medium)
    off = np.abs(found - exact).max(axis=1)
    kinked = kind is pc.T4010A1  # a table in segments
    assert np.median(off) < 1e-6 * np.abs(exact).max()
    assert off.max() < (1e-3 if kinked else 1e-6) * np.abs(exact).max()


def test_a_far_transducer_is_a_plane_wave() -> None:
    direction = np.array([2.0, -1.0, 2.0]) / 3.0
    array = pc.Array([-FAR * direction], transducer=OMNI)
    q = np.array([[0.0, 0.0, 0.0], [0.01, 0.02, -0.03]])
    p = pc.matrix(array, q, pc.Air()) @ [1.5j]
    along = np.abs(p[:, None]) ** 2 / (2 * RHO_C) * direction
    np.testing.assert_allclose(
        intensity(array, [1.5j], q, medium=pc.Air()), along, rtol=0.01, atol=1e-8
    )


def test_two_that_send_against_each_other_send_nothing_on_balance() -> None:
    array = pc.Array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]], transducer=OMNI)
    middle = np.zeros((1, 3))
    one = intensity(array, [1.0, 0.0], middle, medium=pc.Air())[0, 2]
    assert np.abs(intensity(array, [1.0, 1.0], middle, medium=pc.Air())).max() < 1e-9 * one
    assert intensity(array, [0.0, 1.0], middle, medium=pc.Air())[0, 2] == pytest.approx(-one)
    up = SkinFacing([[0.0, 0.0, 1.0]])
    seen = intensity(array, [1.0, 1.0], middle, facing=up, medium=pc.Air())[0, 2]
    assert seen == pytest.approx(-one)  # skin that faces up feels only sound from above
    hidden = SkinFacing([[0.0, 0.0, 1.0]], [[-0.1, 0.0, 0.1, 0.1, 0.0, 0.1, 0.02, 0.02]])
    assert not intensity(array, [1.0, 1.0], middle, facing=hidden, medium=pc.Air()).any()


def test_energy_is_kept_on_its_way() -> None:
    """The same power flows through two spheres around an array."""
    array, g, _ = rig(pc.Transducer(frequency=5e3))
    i = np.arange(4000) + 0.5
    z, turn = 1.0 - 2.0 * i / 4000, np.pi * (1 + 5**0.5) * i
    n = np.stack([np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z], -1)
    powers = [
        4 * math.pi * R * R * (intensity(array, g, R * n, medium=pc.Air()) * n).sum(axis=1).mean()
        for R in (0.3, 0.5, 3.0)
    ]
    np.testing.assert_allclose(powers, powers[0], rtol=1e-3)


@pytest.mark.parametrize("theta", [0.0, 20.0, 60.0, 85.0, 95.0, 180.0])
def test_a_plane_wave_presses_with_twice_its_energy_times_the_squared_cosine(theta: float) -> None:
    array = pc.Array([[0.0, 0.0, -FAR]], transducer=OMNI)
    t = math.radians(theta)
    facing = SkinFacing([[math.sin(t), 0.0, -math.cos(t)]])
    q = np.zeros((1, 3))
    p = abs(pc.matrix(array, q, pc.Air())[0, 0])
    E = p**2 / (2 * AIR.density * AIR.speed_of_sound**2)
    exact = 2 * E * max(0.0, math.cos(t)) ** 2
    assert normal_pressure(array, [1.0], q, facing, medium=pc.Air())[0] == pytest.approx(
        exact, abs=1e-12
    )
    head_on = pc.radiation_pressure(p, AIR)
    assert normal_pressure(array, [1.0], q, SkinFacing([[0.0, 0.0, -1.0]]), medium=pc.Air())[
        0
    ] == pytest.approx(head_on)


def test_in_the_far_field_it_is_the_velocity_along_the_normal() -> None:
    rng = np.random.default_rng(1)
    way = rng.normal(size=(12, 3))
    way[:, 2] = -np.abs(way[:, 2])
    array = pc.Array(4.0 * way / np.linalg.norm(way, axis=1, keepdims=True), transducer=OMNI)
    g = rng.normal(size=12) + 1j * rng.normal(size=12)
    n, h = np.array([0.0, 0.0, -1.0]), 1e-6
    near = pc.matrix(array, [h * n, -h * n], pc.Air()) @ g
    v = -(near[0] - near[1]) / (2 * h) / (2j * math.pi * 40e3 * AIR.density)
    exact = pc.radiation_pressure(RHO_C * v, AIR)
    found = normal_pressure(array, g, np.zeros((1, 3)), SkinFacing([n]), medium=pc.Air())[0]
    assert found == pytest.approx(float(exact), rel=0.01)


def test_many_points_are_taken_part_by_part() -> None:
    array, g, q = rig(pc.T4010A1)
    many = np.tile(q, (200, 1))
    facing = SkinFacing(np.tile([0.0, 0.0, -1.0], (6000, 1)))
    few = SkinFacing(facing.normals[:30])
    np.testing.assert_allclose(
        intensity(array, g, many, medium=pc.Air())[-30:], intensity(array, g, q, medium=pc.Air())
    )
    np.testing.assert_allclose(
        normal_pressure(array, g, many, facing, medium=pc.Air())[-30:],
        normal_pressure(array, g, q, few, medium=pc.Air()),
    )
    assert intensity(array, g, np.empty((0, 3)), medium=pc.Air()).shape == (0, 3)


def test_bad_arguments_are_named() -> None:
    array, g, q = rig(OMNI)
    facing = SkinFacing([[0.0, 0.0, 1.0]])
    with pytest.raises(pc.ArgumentError, match="array"):
        intensity(None, g, q, medium=pc.Air())  # type: ignore[arg-type]
    with pytest.raises(pc.ArgumentError, match="gains"):
        intensity(array, g[:3], q, medium=pc.Air())
    with pytest.raises(pc.ArgumentError, match="points"):
        intensity(array, g, q[0], medium=pc.Air())
    with pytest.raises(pc.ArgumentError, match="facing"):
        intensity(array, g, q, facing=facing, medium=pc.Air())
    with pytest.raises(pc.ArgumentError, match="facing"):
        normal_pressure(array, g, q, q, medium=pc.Air())  # type: ignore[arg-type]
    q[7] = array.positions[3]
    with pytest.raises(pc.PointOnTransducer) as caught:
        intensity(array, g, q, medium=pc.Air())
    assert caught.value.indices == (7,)
