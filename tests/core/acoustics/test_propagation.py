from __future__ import annotations

import math
import os
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest

import pacinian as pc
from pacinian.acoustics import propagation
from pacinian.acoustics.propagation import KernelData

WAVELENGTH = pc.Air().wavelength(40e3)  # [m]
K = 2 * math.pi / WAVELENGTH  # [rad/m]
PISTON = pc.Piston(0.0045, K)
MEDIA = {
    "spherical": pc.Air(),
    "none": pc.Air(attenuation="none"),
    "absorbing": pc.Air(attenuation="absorbing"),
    "square": pc.Air(attenuation=2.0),
    "cylindrical": pc.Air(attenuation=0.5),
    "hot": pc.Air(attenuation="absorbing", temperature=35.0, humidity=0.8),
    "foggy": pc.Air(attenuation="none", absorption=3.0),
}
KINDS = {
    "omni": pc.Transducer(pressure=2.5),
    "t4010a1": pc.T4010A1,
    "piston": pc.Transducer(frequency=25e3, pressure=0.7, directivity=PISTON),
}
media = pytest.mark.parametrize("medium", list(MEDIA.values()), ids=list(MEDIA))
kinds = pytest.mark.parametrize("kind", list(KINDS.values()), ids=list(KINDS))
precisions = pytest.mark.parametrize("precision", ["single", "double"])

# The specification's table: A, B, C, D of each ten degrees.
T4010A1 = """
1 0 0 0
1 0 0 0
1 -0.00459648054721 -0.000787968093807 1.60125528528e-05
0.891250938 -0.0155520765675 -0.000307591508224 2.9747624976e-06
0.707945784 -0.0208114779827 -0.000218348633296 2.31910931569e-05
0.501187234 -0.0182211227016 0.00047738416141 -1.1901034125e-05
0.354813389 -0.0122437497109 0.000120353137658 6.77743734332e-06
0.251188643 -0.00780345575475 0.000323676257958 -5.99548024824e-06
0.199526231 -0.00312857467007 0.000143850511 -4.79372835035e-06
"""


def rig(rng: np.random.Generator, N: int, kind: pc.Transducer) -> pc.Array:
    """N transducers at random positions, pointing roughly up."""
    positions = rng.uniform([-0.3, -0.3, -0.02], [0.3, 0.3, 0.02], (N, 3))
    return pc.Array(positions, rng.normal((0, 0, 1), 0.3, (N, 3)), kind)


def somewhere(rng: np.random.Generator, M: int) -> np.ndarray:
    """M points above, between and below [m]."""
    return rng.uniform([-0.4, -0.4, -0.3], [0.4, 0.4, 0.8], (M, 3))


def single(array: pc.Array, points: np.ndarray, medium: pc.Air) -> np.ndarray:
    """Return B from the kernel, in single precision."""
    out = np.full((len(points), len(array)), np.nan, np.complex64)
    KernelData.prepare(array, medium).matrix(points, out)
    return out


def directivity(kind: pc.Transducer, cosine: Any) -> Any:
    """Return the directivity with many digits."""
    if kind.directivity is pc.omni:
        return mpmath.mpf(1)
    if cosine <= 0:
        return mpmath.mpf(0)
    if kind.directivity is PISTON:
        x = mpmath.mpf(K) * mpmath.mpf(0.0045) * mpmath.sqrt(1 - cosine**2)
        return 2 * mpmath.besselj(1, x) / x
    theta = mpmath.degrees(mpmath.acos(cosine))
    segment = min(max(int(mpmath.ceil(theta / 10)) - 1, 0), 8)
    A, B, C, D = map(mpmath.mpf, T4010A1.split("\n")[1 + segment].split())
    x = theta - 10 * segment
    return A + B * x + C * x**2 + D * x**3


def in_many_digits(array: pc.Array, points: np.ndarray, medium: pc.Air) -> np.ndarray:
    """Return B by its definition, with thirty digits."""
    kind = array.transducer
    B = np.empty((len(points), len(array)), complex)
    with mpmath.workdps(30):
        k = 2 * mpmath.pi * mpmath.mpf(kind.frequency) / mpmath.mpf(medium.speed_of_sound)
        beta = mpmath.mpf(medium.beta(kind.frequency))
        for m, q in enumerate(points.tolist()):
            for n, (r, normal) in enumerate(
                zip(array.positions.tolist(), array.normals.tolist(), strict=True)
            ):
                d = [mpmath.mpf(a) - mpmath.mpf(b) for a, b in zip(q, r, strict=True)]
                distance = mpmath.sqrt(sum(x * x for x in d))
                cosine = (
                    sum(x * y for x, y in zip(d, map(mpmath.mpf, normal), strict=True)) / distance
                )
                B[m, n] = complex(
                    mpmath.mpf(kind.pressure)
                    * directivity(kind, cosine)
                    * distance ** -mpmath.mpf(medium.exponent)
                    * mpmath.exp(-beta * distance)
                    * mpmath.expj(-k * distance)
                )
    return B


def bound(array: pc.Array, points: np.ndarray, medium: pc.Air) -> np.ndarray:
    """Return the largest allowed error of the kernel's B [Pa], shape (M, N).

    The position of a point or transducer is rounded (6e-8 of how far it is from the centre); so are
    distance and phase, some four times (6e-8 k r each); sine and cosine are good to 1e-5; the
    directivity is interpolated (2e-5); absorption is a polynomial to the 64th power that ends at
    exp(-32).
    """
    kind = array.transducer
    r = np.linalg.norm(points[:, None] - array.positions, axis=2)
    k = medium.wavenumber(kind.frequency)
    beta = medium.beta(kind.frequency)
    spread = kind.pressure * r**-medium.exponent
    a = spread * np.exp(-beta * r)
    extent = np.abs(points - array.centre).max(axis=1, initial=0.0)[:, None]
    extent = extent + np.abs(array.positions - array.centre).max()
    omni = kind.directivity is pc.omni
    moved = 6e-8 * extent * (k + (medium.exponent + (0.0 if omni else 3.0)) / r)
    rounded = moved + 4.0 * 6e-8 * (k + beta) * r + 1e-5 + (0.0 if omni else 2e-5)
    absorbed = 64.0 / 720.0 * np.minimum(beta * r / 64.0, 0.5) ** 6
    return a * (rounded + absorbed) + spread * (math.exp(-32.0) if beta else 0.0)


@media
@kinds
def test_the_matrix_is_its_definition_in_thirty_digits(kind: pc.Transducer, medium: pc.Air) -> None:
    rng = np.random.default_rng(11)
    array = rig(rng, 6, kind)
    points = np.concatenate([somewhere(rng, 6), [[0.0, 0.0, 5.0], [1e3, -20.0, 300.0]]])
    expected = in_many_digits(array, points, medium)
    B = pc.matrix(array, points, medium)
    assert B.dtype == np.complex128
    near = slice(0, 7)
    np.testing.assert_allclose(B[near], expected[near], rtol=2e-12, atol=1e-300)
    # a kilometre away the phase is 740 000 rad, whose last digit is 1e-10 rad
    np.testing.assert_allclose(B[7:], expected[7:], rtol=1e-9, atol=1e-300)


def test_one_wavelength_away_an_ideal_transducer_makes_its_pressure_over_the_distance() -> None:
    points, air = (
        [[0, 0, 8.5e-3], [0, 8.5e-3 * 1.25, 0], [-0.5, 0, 0]],
        pc.Air(speed_of_sound=340.0),
    )
    B = pc.matrix(pc.Array([[0, 0, 0]]), points, air)
    # 1 / 8.5 mm in phase; a quarter turn late; 58.8235 wavelengths
    np.testing.assert_allclose(
        B[:, 0], [1 / 8.5e-3, -1j / 8.5e-3 / 1.25, 2 * np.exp(-2j * np.pi / 8.5e-3 / 2)], rtol=1e-12
    )


@kinds
def test_the_kernel_is_the_reference_ten_metres_away(kind: pc.Transducer) -> None:
    rng = np.random.default_rng(13)
    array, points = rig(rng, 300, kind), rng.uniform(-10.0, 10.0, (50, 3))
    for medium in MEDIA.values():
        off = np.abs(single(array, points, medium) - pc.matrix(array, points, medium))
        assert (off / bound(array, points, medium)).max() < 1.0


@pytest.mark.parametrize("medium", [MEDIA["spherical"], MEDIA["square"], MEDIA["hot"]])
def test_far_phases_are_those_of_a_rounded_distance(medium: pc.Air) -> None:
    rng = np.random.default_rng(14)
    array, points = rig(rng, 300, KINDS["omni"]), rng.uniform(-10.0, 10.0, (500, 3))
    B = pc.matrix(array, points, medium)
    r = np.linalg.norm(points[:, None] - array.positions, axis=2)
    rounding = 6e-8 * medium.wavenumber(KINDS["omni"].frequency) * r  # [rad]
    off = np.abs(single(array, points, medium) / B - 1.0) / rounding
    assert np.sqrt(np.mean(off**2)) < 1.0
    assert off.max() < 5.0


@media
@kinds
def test_kernel_and_field_are_the_matrix_within_their_rounding(
    kind: pc.Transducer, medium: pc.Air
) -> None:
    for N in (1, 2, 255, 256, 257, 600):  # transducers go through the kernel in blocks of 256
        rng = np.random.default_rng(N)
        array, points = rig(rng, N, kind), somewhere(rng, 40)
        B, allowed = pc.matrix(array, points, medium), bound(array, points, medium)
        assert (np.abs(single(array, points, medium) - B) / allowed).max() < 1.0
        gains = (rng.normal(size=N) + 1j * rng.normal(size=N)).astype(np.complex64)
        p = pc.field(array, gains, points, medium, "double")
        assert p.dtype == np.complex128
        np.testing.assert_allclose(p, B @ gains, rtol=1e-12, atol=1e-12 * np.abs(B).max())
        p = pc.field(array, gains, points, medium, "single")
        assert p.dtype == np.complex64
        allowed = (allowed + 1e-6 * np.abs(B)) @ np.abs(gains)
        assert (np.abs(p - B @ gains) / allowed).max() < 1.0


@kinds
def test_the_kernel_is_the_reference_straight_ahead(kind: pc.Transducer) -> None:
    rng = np.random.default_rng(23)
    n = rng.normal(size=(400, 3))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    array = pc.Array(rng.uniform(-0.2, 0.2, (400, 3)), n, kind)
    points = array.positions + n * rng.uniform(0.05, 0.5, (400, 1))
    B, reference = single(array, points, pc.Air()), pc.matrix(array, points, pc.Air())
    off = np.abs(B - reference) / bound(array, points, pc.Air())
    assert np.diag(off).max() < 1.0
    np.testing.assert_allclose(
        np.abs(np.diag(reference)) * np.linalg.norm(points - array.positions, axis=1),
        kind.pressure,
        rtol=1e-12,
    )


@pytest.mark.parametrize("kind", [pc.T4010A1, KINDS["piston"]])
def test_the_kernel_reads_nothing_beyond_its_directivity_table(kind: pc.Transducer) -> None:
    rng = np.random.default_rng(24)
    n = rng.normal(size=(300, 3))
    array = pc.Array(rng.uniform(-0.2, 0.2, (300, 3)), n, kind)
    points = array.positions + array.normals * rng.uniform(0.05, 0.5, (300, 1))
    prepared = KernelData.prepare(array, pc.Air())
    memory = np.full(3 * prepared.table.size, np.nan, np.float32)  # NaN before and after it
    table = memory[prepared.table.size : 2 * prepared.table.size]
    table[:] = prepared.table
    out = np.empty((300, 300), np.complex64)
    replace(prepared, table=table).matrix(points, out)
    assert np.isfinite(out).all()


@precisions
def test_the_field_has_the_shape_of_the_points(precision: Any) -> None:
    rng = np.random.default_rng(15)
    array, gains = rig(rng, 20, pc.T4010A1), rng.normal(size=20)
    for shape in ((), (7,), (2, 1, 3), (0,), (2, 0)):
        points = rng.uniform(0.1, 0.3, (*shape, 3))
        p = pc.field(array, gains, points, precision=precision, medium=pc.Air())
        assert p.shape == shape
        for index in np.ndindex(shape):
            one = pc.field(array, gains, points[index], precision=precision, medium=pc.Air())
            assert p[index] == pytest.approx(complex(one), rel=1e-12)
    assert pc.matrix(array, [], pc.Air()).shape == (0, 20)
    assert single(array, np.empty((0, 3)), pc.Air()).shape == (0, 20)


@pytest.mark.parametrize("M", [1, 13, 1001])
def test_many_threads_make_the_field_of_one(M: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(16)
    array, points, gains = pc.autd(), somewhere(rng, M), rng.normal(size=249)
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    alone = pc.field(array, gains, points, medium=pc.Air())
    monkeypatch.setattr(propagation, "CHUNK", 100)
    for cores in (None, 2, 5):
        monkeypatch.setattr(os, "cpu_count", lambda cores=cores: cores)
        assert np.array_equal(pc.field(array, gains, points, medium=pc.Air()), alone)


def test_a_field_of_more_than_one_chunk_is_whole() -> None:
    rng = np.random.default_rng(17)
    array, points, gains = pc.autd(), somewhere(rng, 4000), rng.normal(size=249)
    p = pc.field(array, gains, points, medium=pc.Air())
    double = pc.field(array, gains, points, precision="double", medium=pc.Air())
    np.testing.assert_allclose(p, double, atol=2e-4 * np.abs(double).max())
    np.testing.assert_allclose(
        double[3990:], pc.matrix(array, points[3990:], pc.Air()) @ gains, rtol=1e-10
    )


@precisions
@kinds
def test_an_array_a_kilometre_away_makes_the_same_field(
    kind: pc.Transducer, precision: Any
) -> None:
    rng = np.random.default_rng(18)
    array, points, gains = rig(rng, 300, kind), somewhere(rng, 50), rng.normal(size=300)
    shift = np.array([1000.0, -1000.0, 500.0])
    far = array.transform(pc.Pose(position=tuple(shift)))
    here = pc.field(array, gains, points, precision=precision, medium=pc.Air())
    there = pc.field(far, gains, points + shift, precision=precision, medium=pc.Air())
    tolerance = 1e-9 if precision == "double" else 3e-5
    scale = (np.abs(pc.matrix(array, points, pc.Air())) @ np.abs(gains)).max()
    np.testing.assert_allclose(there, here, rtol=0.0, atol=tolerance * scale)


@media
@kinds
def test_a_point_a_kilometre_away_has_a_finite_field_in_double_precision(
    kind: pc.Transducer, medium: pc.Air
) -> None:
    array, points = pc.lattice(0.1, 0.1, transducer=kind), np.array([[0, 0, 1e3], [1e3, 0, -1e3]])
    for precision in ("single", "double"):
        p = pc.field(array, np.ones(121), points, medium, precision)
        assert p.dtype == np.complex128
        assert np.isfinite(p).all()
        np.testing.assert_allclose(p, pc.matrix(array, points, medium) @ np.ones(121), rtol=1e-9)
    assert np.isfinite(single(array, points, medium)).all()


def test_beyond_ten_metres_the_field_is_in_double_precision() -> None:
    for z, dtype in ((9.5, np.complex64), (10.5, np.complex128)):
        p = pc.field(
            pc.lattice(0.1, 0.1), np.ones(121), [[0, 0, z]], precision="single", medium=pc.Air()
        )
        assert p.dtype == dtype


SINGULAR = [name for name in MEDIA if name not in ("none", "foggy")]


@pytest.mark.parametrize(
    "refusing",
    [
        pc.matrix,
        single,
        lambda array, points, medium: pc.field(array, np.ones(441), points, medium, "single"),
        lambda array, points, medium: pc.field(array, np.ones(441), points, medium, "double"),
    ],
    ids=["matrix", "kernel", "single", "double"],
)
@kinds
def test_a_point_on_a_transducer_is_refused_where_the_attenuation_is_singular(
    refusing: Any, kind: pc.Transducer
) -> None:
    array = pc.lattice(0.2, 0.2, transducer=kind)
    points = np.array([[0.1, 0.1, 0.2]] * 6)
    points[2], points[5] = array.positions[17], array.positions[440] + 5e-7
    points[5, 2] = 0.0
    for name in SINGULAR:
        with pytest.raises(pc.PointOnTransducer) as caught:
            refusing(array, points, MEDIA[name])
        assert caught.value.indices == (2, 5)
        assert all(type(index) is int for index in caught.value.indices)


@precisions
def test_all_points_on_a_transducer_are_named_however_many_there_are(precision: Any) -> None:
    array = pc.lattice(0.2, 0.4)
    points = np.full((1000, 3), 0.3)
    points[[7, 700, 999]] = array.positions[[3, 400, 860]]
    for shaped in (points, points.reshape(10, 100, 3)):
        with pytest.raises(pc.PointOnTransducer) as caught:
            pc.field(array, np.ones(861), shaped, precision=precision, medium=pc.Air())
        assert caught.value.indices == (7, 700, 999)


@pytest.mark.parametrize("name", ["none", "foggy"])
@precisions
def test_a_point_on_a_transducer_is_fine_where_the_attenuation_is_finite(
    name: str, precision: Any
) -> None:
    array = pc.Array([[0, 0, 0], [0.01, 0, 0]])
    p = pc.field(array, [1.0, 0.0], array.positions, MEDIA[name], precision)
    beta = MEDIA[name].beta(40e3)
    expected = [1.0, np.exp(-(1j * K + beta) * 0.01)]
    np.testing.assert_allclose(p, expected, atol=1e-5)
    np.testing.assert_allclose(
        single(array, array.positions, MEDIA[name])[:, 0], expected, atol=1e-5
    )


@precisions
def test_a_point_two_micrometres_from_a_transducer_has_a_field(precision: Any) -> None:
    p = pc.field(
        pc.Array([[0.3, 0.2, 0.1]]),
        [1.0],
        [0.3, 0.2, 0.1 + 2e-6],
        precision=precision,
        medium=pc.Air(),
    )
    assert abs(p) == pytest.approx(5e5, rel=1e-3)


@media
def test_only_omni_radiates_backwards(medium: pc.Air) -> None:
    rng = np.random.default_rng(19)
    behind = rng.uniform([-0.2, -0.2, -0.5], [0.2, 0.2, -0.01], (40, 3))
    ahead = behind * [1.0, 1.0, -1.0]
    gains, omni = rng.normal(size=121), pc.lattice(0.1, 0.1)
    for precision in ("single", "double"):
        for kind in (pc.T4010A1, KINDS["piston"]):
            array = omni.replace_transducer(kind)
            assert not pc.field(array, gains, behind, medium, precision).any()
            assert pc.field(array, gains, ahead, medium, precision).all()
            assert not pc.matrix(array, behind, medium).any()
            assert not single(array, behind, medium).any()
        back, front = (pc.field(omni, gains, q, medium, precision) for q in (behind, ahead))
        np.testing.assert_allclose(back, front, rtol=1e-12)


@precisions
@kinds
def test_a_turned_array_makes_the_turned_field(kind: pc.Transducer, precision: Any) -> None:
    rng = np.random.default_rng(22)
    array, points, gains = rig(rng, 60, kind), somewhere(rng, 40), rng.normal(size=60)
    pose = pc.Pose(position=(0.1, -0.2, 0.3), rotation=(0.5, -0.5, 0.1, 0.7))
    scale = (np.abs(pc.matrix(array, points, pc.Air())) @ np.abs(gains)).max()
    np.testing.assert_allclose(
        pc.field(
            array.transform(pose), gains, pose.points(points), precision=precision, medium=pc.Air()
        ),
        pc.field(array, gains, points, precision=precision, medium=pc.Air()),
        rtol=0.0,
        atol=(1e-12 if precision == "double" else 3e-5) * scale,
    )


@pytest.mark.parametrize(
    ("argument", "given_as"),
    [
        ("gains", {"gains": np.ones(8)}),
        ("gains", {"gains": np.ones((9, 1))}),
        ("gains", {"gains": None}),
        ("gains", {"gains": [math.nan] * 9}),
        ("gains", {"gains": ["1"] * 9}),
        ("points", {"points": [[0, 0]]}),
        ("points", {"points": 1.0}),
        ("points", {"points": [[0, 0, math.nan]]}),
        ("precision", {"precision": "half"}),
        ("precision", {"precision": None}),
    ],
    ids=str,
)
def test_a_bad_argument_is_refused_by_name(argument: str, given_as: dict[str, Any]) -> None:
    array = pc.lattice(0.02, 0.02)
    call = {"gains": np.ones(9), "points": [[0, 0, 0.1]]}
    for precision in ("single", "double"):
        with pytest.raises(pc.ArgumentError, match=f"`{argument}`"):
            pc.field(array, **{**call, "precision": precision, **given_as}, medium=pc.Air())
    nothing: Any = None
    with pytest.raises(pc.ArgumentError, match="`array`"):
        pc.field(nothing, np.ones(9), [[0, 0, 0.1]], pc.Air())
    with pytest.raises(pc.ArgumentError, match="`array`"):
        pc.matrix(nothing, [[0, 0, 0.1]], pc.Air())
    if argument == "points":
        with pytest.raises(pc.ArgumentError, match="`points`"):
            pc.matrix(array, given_as["points"], pc.Air())


@pytest.mark.parametrize(
    "directivity", [lambda c: 1.0, lambda c: np.ones(3), lambda c: np.full_like(c, np.nan)]
)
def test_a_directivity_of_another_shape_is_refused(directivity: Any) -> None:
    array = pc.lattice(0.02, 0.02, transducer=pc.Transducer(directivity=directivity))
    with pytest.raises(pc.ArgumentError, match="`directivity`"):
        pc.field(array, np.ones(9), [[0, 0, 0.1]], medium=pc.Air())


@precisions
def test_a_directivity_of_one_s_own_is_used_in_front_only(precision: Any) -> None:
    array = pc.Array([[0, 0, 0]], transducer=pc.Transducer(directivity=lambda c: c**2))
    points = [[0, 0, 0.1], [0.1, 0, 0.1], [0.1, 0, -0.1]]
    p = np.abs(pc.field(array, [1.0], points, pc.Air(attenuation="none"), precision))
    np.testing.assert_allclose(p, [1.0, 0.5, 0.0], atol=2e-5)
