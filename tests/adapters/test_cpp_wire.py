"""The C++ core reads and writes as Python does: byte vectors, mutations of them, JSON and coordinates."""

from __future__ import annotations

import random
import subprocess
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import pacinian as pc
from pacinian.wire.codec import encode

from . import jsons, tools
from .mutations import WIRE, mutated, vectors, verdict
from .test_csharp_wire import HUGE, sizes

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

pytestmark = pytest.mark.deep("cmake", "ninja", "g++", "pkg-config")

KNOWN = vectors()
TESTS = "vectors", "vectors_hostile", "vectors_allocations", "space"
ANSWERS = "vectors_answers", "space_answers"


@pytest.fixture(scope="module")
def programs() -> Path:
    """Return the folder of the test programs, which abort at invalid addresses and undefined behaviour."""
    return tools.cmake("sanitized", [*TESTS, *ANSWERS], "-DPACINIAN_SANITIZE=ON", *tools.JOINED)


@pytest.mark.parametrize("name", TESTS)
def test_a_program_that_tests_itself(programs: Path, name: str) -> None:
    tools.run(programs / name, WIRE)


def answers(program: Path, lines: Iterable[str]) -> list[str]:
    """Return what a program answers to each line."""
    done = subprocess.run(
        program, input="".join(f"{line}\n" for line in lines), capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-4000:]
    return [line.rstrip() for line in done.stdout.splitlines()]


def compare(programs: Path, cases: Iterable[tuple[str, bytes]]) -> list[str]:
    """Return what C++ makes of messages, which must equal what Python makes of them."""
    lines = [verdict(*case).split("\t") for case in cases]
    told = answers(programs / "vectors_answers", (f"{line[0]} {line[1]}" for line in lines))
    wanted = [" ".join(line[2:]).rstrip() for line in lines]
    for case, want, found in zip(lines, wanted, told, strict=True):
        assert found == want, f"{case[0]} {case[1]}"
    return told


@pytest.mark.parametrize("seed", range(2))
def test_what_python_refuses_is_refused_at_the_same_path(programs: Path, seed: int) -> None:
    choose = random.Random(seed)
    cases = (mutated(KNOWN, choose) for _ in range(5000))
    told = compare(programs, [case for case in cases if not HUGE.search(case[1])])
    assert 300 < sum(line.startswith("valid") for line in told) < 3000


def test_all_lengths_of_heads_and_numbers(programs: Path) -> None:
    told = compare(programs, [(socket, encode(message)) for socket, message in sizes()])
    assert all(line.startswith("valid") for line in told)


def test_flat_json_is_read_as_msgspec_reads_it(programs: Path) -> None:
    cases = list(jsons.cases(4000))
    lines = (f"json {text.encode().hex()} {name.encode().hex()}" for text, name in cases)
    told = answers(programs / "vectors_answers", lines)
    for (text, name), line in zip(cases, told, strict=True):
        assert line == jsons.found(text, name), (text, name)


AXES = np.array(
    [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
)  # Unreal's x, y, z in the world


def numbers(program: Path, lines: Iterable[str]) -> list[np.ndarray[Any, Any]]:
    return [np.array(line.split(), dtype=float) for line in answers(program, lines)]


def spelt(*values: Any) -> str:
    return " ".join(repr(float(x)) for value in values for x in np.ravel(value))


def same_turn(quaternion: Any, matrix: Any) -> None:
    """Check that a quaternion is this rotation matrix."""
    assert Rotation.from_quat(quaternion).as_matrix() == pytest.approx(matrix, abs=1e-12)


def test_unreal_poses_and_velocities_against_matrices(programs: Path) -> None:
    random_numbers = np.random.default_rng(1)
    turns = Rotation.random(200, random_state=2)
    places, velocities, spins = random_numbers.normal(size=(3, 200, 3)) * 100.0
    rows = zip(places, turns.as_quat(), velocities, spins, strict=True)
    told = numbers(programs / "space_answers", (f"pose {spelt(*row)}" for row in rows))
    for made, turn, place, velocity, spin in zip(
        told, turns, places, velocities, spins, strict=True
    ):
        assert made[:3] == pytest.approx(AXES @ place / 100.0, abs=1e-12)
        same_turn(made[3:7], AXES @ turn.as_matrix() @ AXES.T)
        assert made[7:10] == pytest.approx(AXES @ velocity / 100.0, abs=1e-12)
        rate = AXES @ cross_matrix(spin) @ AXES.T  # of a rotating point, in the world
        assert cross_matrix(made[10:]) == pytest.approx(rate, abs=1e-12)
    lines = (f"back {spelt(made[:7])}" for made in told)
    for made, turn, place in zip(
        numbers(programs / "space_answers", lines), turns, places, strict=True
    ):
        assert made[:3] == pytest.approx(place, abs=1e-9)
        same_turn(made[3:7], turn.as_matrix())


def cross_matrix(v: Any) -> np.ndarray[Any, Any]:
    return np.cross(np.eye(3), -np.asarray(v)).T


def kabsch(known: Any, touched: Any) -> tuple[Any, Any]:
    """Return the rotation (never a reflection) and translation, by singular values."""
    a, b = known - known.mean(0), touched - touched.mean(0)
    u, _, vt = np.linalg.svd(b.T @ a)
    matrix = u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt
    return matrix, touched.mean(0) - matrix @ known.mean(0)


@pytest.mark.parametrize("mirrored", [False, True])
def test_calibration_against_singular_values(programs: Path, mirrored: bool) -> None:
    choose = np.random.default_rng(3)
    cases: list[tuple[Any, Any]] = []
    for count, turn in zip([3, 4, 5, 8] * 25, Rotation.random(100, random_state=4), strict=True):
        known = choose.uniform(-0.2, 0.2, (count, 3))
        flip = np.diag([1.0, 1.0, -1.0 if mirrored else 1.0])
        noise = choose.normal(scale=0.002, size=known.shape)
        cases.append((known, turn.apply(known @ flip) + choose.normal(size=3) + noise))
    lines = (f"calibrate {len(known)} {spelt(known, touched)}" for known, touched in cases)
    compared = 0
    told = answers(programs / "space_answers", lines)
    for (known, touched), line in zip(cases, told, strict=True):
        if line == "refused":  # mirrored points can be fitted in two ways
            continue
        made = np.array(line.split(), dtype=float)
        matrix, at = kabsch(known, touched)
        assert Rotation.from_quat(made[3:7]).as_matrix() == pytest.approx(matrix, abs=1e-7)
        assert made[:3] == pytest.approx(at, abs=1e-7)
        distances = np.linalg.norm(known @ matrix.T + at - touched, axis=1)
        assert made[7] == pytest.approx(np.sqrt(np.mean(distances**2)), abs=1e-7)
        assert made[8] == pytest.approx(distances.max(), abs=1e-7)
        compared += 1
    assert compared > 80


def test_the_readmes_game_compiles(tmp_path: Path) -> None:
    (game,) = tools.read_examples(tools.CPP / "README.md", "cpp", "int main()")
    source = tmp_path / "game.cpp"
    source.write_text(game, encoding="utf-8")
    public = tools.ADAPTERS / "unreal" / "Pacinian" / "Source" / "PacinianCore" / "Public"
    tools.run("g++", "-std=c++17", "-Wall", "-Werror", "-fsyntax-only", f"-I{public}", source)


def test_hands_are_those_of_python(programs: Path) -> None:
    turns = Rotation.random(4, random_state=3).as_quat()
    chance = np.random.default_rng(4)
    lines: list[str] = []
    hands: list[pc.Hand] = []
    for side, turn, place in zip(
        ("left", "right") * 2, turns, chance.normal(0.0, 0.05, (4, 3)), strict=True
    ):
        lines.append(f"open {side} {spelt(*place, *turn)}")
        hands.append(pc.Hand.open(side, pc.Pose(tuple(place), tuple(turn))))
        bones, widths = chance.normal(0.0, 0.05, (5, 4, 2, 3)), chance.uniform(0.01, 0.03, (5, 4))
        rows = np.concatenate([bones.reshape(20, 6), widths.reshape(20, 1)], axis=1)
        lines.append(f"leap {spelt(*rows.ravel(), *place)}")
        hands.append(pc.Hand.leap(bones, widths, place, "right"))
    for hand, told in zip(hands, numbers(programs / "space_answers", lines), strict=True):
        assert told[:78] == pytest.approx(np.ravel(hand.joints), abs=1e-12)
        assert told[78:] == pytest.approx(hand.radii, abs=1e-12)
