"""Coordinates in C#, compared with matrices, NumPy and SciPy."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import pacinian as pc

from . import tools

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    Array = np.ndarray[Any, np.dtype[np.float64]]
    Ask = Callable[..., Array]

pytestmark = pytest.mark.deep("mono", "mcs")

UNITY = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])  # Unity's axes in the world
COUNT = 300
random = np.random.default_rng(1)
TURNS = Rotation.random(COUNT, random_state=2)
QUATERNIONS = TURNS.as_quat() * random.choice([-1.0, 1.0], (COUNT, 1))
MATRICES = TURNS.as_matrix()
PLACES = random.normal(size=(COUNT, 3))
OTHERS = random.normal(size=(COUNT, 3))


@pytest.fixture(scope="module")
def ask(csharp_core: Path) -> Ask:
    """Run an operation in C# on rows of numbers."""
    program = tools.csharp(
        csharp_core.with_name("Space.exe"), [tools.CSHARP / "tests" / "Space.cs"], csharp_core
    )

    def asked(operation: str, *columns: Any) -> Array:
        rows = np.hstack(columns)
        lines = [f"{operation} {' '.join(map(repr, row))}\n" for row in rows.tolist()]
        done = subprocess.run(
            ["mono", program], input="".join(lines), capture_output=True, text=True, check=True
        )
        return np.array([line.split() for line in done.stdout.splitlines()], dtype=float)

    return asked


def matrices(quaternions: Any) -> Array:
    assert np.linalg.norm(quaternions, axis=-1) == pytest.approx(1.0, abs=1e-12)
    return np.asarray(Rotation.from_quat(quaternions).as_matrix())


def frames(places: Any, quaternions: Any) -> Array:
    """Return frames as (K, 4, 4) matrices."""
    made = np.tile(np.eye(4), (len(places), 1, 1))
    made[:, :3, :3], made[:, :3, 3] = Rotation.from_quat(quaternions).as_matrix(), places
    return made


def applied(frame: Array, places: Any) -> Array:
    return np.einsum("kij,kj->ki", frame, np.pad(places, [(0, 0), (0, 1)], constant_values=1.0))[
        :, :3
    ]


def near(made: Any, wanted: Any, error: float = 1e-12) -> None:
    assert np.asarray(made) == pytest.approx(np.asarray(wanted), abs=error)


@pytest.mark.parametrize("side", ["left", "right"])
def test_an_open_hand_is_that_of_python(ask: Ask, side: Literal["left", "right"]) -> None:
    made = ask(f"open{side}", PLACES[:3], QUATERNIONS[:3])
    for row, place, turn in zip(made, PLACES, QUATERNIONS, strict=False):
        hand = pc.Hand.open(side, pc.Pose(tuple(place), tuple(turn)))
        near(row, np.concatenate([np.ravel(hand.joints), hand.radii]), 1e-6)


def test_unity_s_places_and_rotations(ask: Ask) -> None:
    near(ask("place", PLACES), PLACES @ UNITY.T)
    near(matrices(ask("rotation", QUATERNIONS)), UNITY @ MATRICES @ UNITY.T)
    made = ask("frame", PLACES, QUATERNIONS)
    near(made[:, :3], PLACES @ UNITY.T)
    near(matrices(made[:, 3:]), UNITY @ MATRICES @ UNITY.T)


def test_all_of_unity_s_maps_are_their_own_inverse(ask: Ask) -> None:
    near(ask("place", ask("place", PLACES)), PLACES)
    near(ask("rotation", ask("rotation", QUATERNIONS)), QUATERNIONS)
    near(ask("angular", ask("angular", PLACES)), PLACES)


def test_what_turns_in_unity_turns_the_same_way_in_the_world(ask: Ask) -> None:
    """For small rotations, maps the matrix of the cross product like any matrix."""
    for made, spin in zip(ask("angular", PLACES), PLACES, strict=True):
        near(skew(made), UNITY @ skew(spin) @ UNITY.T)
    step = 1e-6  # [s]; Unity's own rotation after it, mapped, equals that by the mapped velocity
    later = Rotation.from_rotvec(step * PLACES) * TURNS
    mapped = Rotation.from_quat(ask("rotation", later.as_quat()))
    before = Rotation.from_quat(ask("rotation", QUATERNIONS))
    near((mapped * before.inv()).as_rotvec() / step, ask("angular", PLACES), 1e-8)


def skew(v: Any) -> Array:
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def test_rotations_and_frames(ask: Ask) -> None:
    more = np.roll(QUATERNIONS, 1, axis=0)
    near(ask("turn", QUATERNIONS, PLACES), TURNS.apply(PLACES))
    product = Rotation.from_quat(QUATERNIONS) * Rotation.from_quat(more)
    near(matrices(ask("product", QUATERNIONS, more)), product.as_matrix())
    frame = frames(PLACES, QUATERNIONS)
    near(ask("point", PLACES, QUATERNIONS, OTHERS), applied(frame, OTHERS))
    near(ask("back", PLACES, QUATERNIONS, OTHERS), applied(np.linalg.inv(frame), OTHERS))
    near(ask("direction", PLACES, QUATERNIONS, OTHERS), TURNS.inv().apply(OTHERS))
    made = ask("chain", PLACES, QUATERNIONS, OTHERS, more)
    chain = frame @ frames(OTHERS, more)
    near(made[:, :3], chain[:, :3, 3])
    near(matrices(made[:, 3:]), chain[:, :3, :3])


def test_quaternions_are_normalised(ask: Ask) -> None:
    near(ask("normalised", np.geomspace(1e-9, 1e9, COUNT)[:, None] * QUATERNIONS), QUATERNIONS)
    wrong = np.array([[0.0] * 4, [1e300, 0.0, 0.0, 1.0]])
    near(ask("normalised", wrong), [[0.0, 0.0, 0.0, 1.0]] * 2)


def kabsch(known: Array, touched: Array) -> tuple[Array, Array]:
    """Return the rotation (never a reflection) and translation, by singular values."""
    a, b = known - known.mean(0), touched - touched.mean(0)
    u, _, vt = np.linalg.svd(b.T @ a)
    matrix = u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt
    return matrix, touched.mean(0) - matrix @ known.mean(0)


def touches(count: int, *, noise: float, mirrored: bool = False) -> tuple[Array, Array]:
    """Return known points of arrays, and the touched positions, (100, count, 3)."""
    known = random.uniform(-0.1, 0.1, (100, count, 3))
    seen = known * ([1.0, 1.0, -1.0] if mirrored else 1.0)
    touched = np.einsum("nij,nkj->nki", MATRICES[:100], seen) + PLACES[:100, None]
    return known, touched + random.normal(scale=noise, size=known.shape)


def fitted(ask: Ask, known: Array, touched: Array) -> Array:
    """Return position, rotation, residual, worst; NaN if the fit is refused."""
    return ask("fit", np.concatenate([known, touched], axis=2).reshape(len(known), -1))


@pytest.mark.parametrize("count", [3, 4, 10])
@pytest.mark.parametrize("noise", [0.0, 0.002])
def test_calibration_against_singular_values(ask: Ask, count: int, noise: float) -> None:
    cases = touches(count, noise=noise)
    compared = 0
    for made, known, touched in zip(fitted(ask, *cases), *cases, strict=True):
        if np.isfinite(made).all():
            matrix, place = kabsch(known, touched)
            near(made[:3], place, 1e-8)
            near(matrices(made[3:7]), matrix, 1e-8)
            left = np.linalg.norm(known @ matrix.T + place - touched, axis=1)
            near(made[7:], [np.sqrt(np.mean(left**2)), left.max()], 1e-9)
            compared += 1
    assert compared > 95  # the refused ones lie nearly on a line


def test_points_that_are_mirrored_make_no_reflection_but_a_large_residual(ask: Ask) -> None:
    made = fitted(ask, *touches(10, noise=0.0, mirrored=True))
    assert np.isfinite(made).all(axis=1).sum() > 90
    assert np.nanmin(made[:, 7]) > 0.01


THREE = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0]])
LINE = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.2, 1e-4, 0.0]])
FAR = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 1e300, 0.0]])


@pytest.mark.parametrize(
    ("known", "touched"),
    [
        (THREE[:2], THREE[:2]),
        (LINE, LINE),
        (THREE, np.tile(THREE[:1], (3, 1))),
        (1e-4 * THREE, 1e-4 * THREE),
        (THREE, FAR),
    ],
)
def test_what_does_not_say_where_the_array_is_is_refused(
    ask: Ask, known: Array, touched: Array
) -> None:
    assert np.isnan(fitted(ask, known[None], touched[None])).all()
    assert np.isfinite(fitted(ask, THREE[None], THREE[None])).all()
