"""The problems, and the evaluator's own B."""

import mpmath as mp
import numpy as np
import pytest

import pacinian as pc
from pacinian_lab.solvers.problems import AIR, BenchmarkProblem, matrix, problems


@pytest.mark.parametrize(("units", "N"), [(1, 249), (4, 996), (9, 2241)])
def test_points_lie_in_the_square_before_the_middle_of_the_array(units: int, N: int) -> None:
    problem = BenchmarkProblem.make(units, 200, 0.5, 3)
    assert problem.positions.shape == (N, 3)
    np.testing.assert_allclose(
        (problem.positions.min(axis=0) + problem.positions.max(axis=0)) / 2.0, 0.0, atol=1e-12
    )
    assert (np.abs(problem.points[:, :2]) <= 0.1).all()
    assert np.abs(problem.points[:, :2]).max() > 0.09
    assert (problem.points[:, 2] == 0.2).all()


@pytest.mark.parametrize("level", [0.5, 1.0])
def test_the_level_is_that_of_one_focus(level: float) -> None:
    problem = BenchmarkProblem.make(1, 16, level, 0)
    focus = np.abs(matrix(problem.positions, problem.points)).sum(axis=1).mean()
    assert np.linalg.norm(problem.targets) == pytest.approx(level * focus, rel=1e-12)
    assert problem.targets.min() / problem.targets.max() >= 0.3


def test_a_seed_is_a_problem() -> None:
    a, b, c = (BenchmarkProblem.make(1, 5, 0.5, seed) for seed in (1, 1, 2))
    assert (a.points == b.points).all()
    assert (a.targets == b.targets).all()
    assert not (a.points == c.points).all(axis=1).any()


def test_from_frame_to_frame_every_point_moves_by_a_millimetre_and_comes_back() -> None:
    frames = BenchmarkProblem.make(1, 7, 0.5, 0).frames
    np.testing.assert_array_equal(frames[0], BenchmarkProblem.make(1, 7, 0.5, 0).points)
    steps = np.linalg.norm(np.roll(frames, -1, axis=0) - frames, axis=2)
    np.testing.assert_allclose(steps, 1e-3, rtol=1e-9)


def test_its_b_is_that_of_pacinian_and_of_mpmath() -> None:
    problem = BenchmarkProblem.make(4, 6, 0.5, 0)
    B = matrix(problem.positions, problem.points)
    array = pc.Array(problem.positions, transducer=pc.Transducer(pressure=4.386))
    np.testing.assert_allclose(B, pc.matrix(array, problem.points, AIR), rtol=1e-12)
    with mp.workdps(40):
        for m, n in ((0, 0), (5, 995), (3, 500)):
            d = [
                mp.mpf(a) - mp.mpf(b)
                for a, b in zip(problem.points[m], problem.positions[n], strict=True)
            ]
            r = mp.sqrt(sum(x * x for x in d))
            exact = mp.mpf("4.386") / r * mp.expj(-2 * mp.pi * 40000 / 340 * r)
            assert abs(complex(exact) - B[m, n]) < 1e-12 * abs(B[m, n])


def test_all_combinations_the_small_ones_first() -> None:
    made = problems([4, 1, 1], [8, 2], [1.0, 0.5], 2)
    places = [(p.units, len(p.points), p.level, p.seed) for p in made]
    assert places == sorted(places)
    assert len(set(places)) == len(places) == 16


@pytest.mark.parametrize(
    ("units", "count", "level", "says"),
    [(2, 4, 0.5, "square"), (0, 4, 0.5, "units"), (1, 0, 0.5, "points"), (1, 4, 0.0, "levels")],
)
def test_what_cannot_be_meant_is_refused(units: int, count: int, level: float, says: str) -> None:
    with pytest.raises(pc.ArgumentError, match=says):
        BenchmarkProblem.make(units, count, level, 0)
