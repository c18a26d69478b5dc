"""Convergence plots: each point is the solver's result when stopped there."""

from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian import plot
from pacinian.plot.traces import trace

ARRAY = pc.autd()
RNG = np.random.default_rng(0)
POINTS = RNG.uniform([-0.06, -0.06, 0.15], [0.06, 0.06, 0.15], (8, 3))
REACH = np.abs(pc.matrix(ARRAY, POINTS, pc.Air())).sum(axis=1).mean()
AMPLITUDES = REACH / 8**0.5 * RNG.uniform(0.3, 1.0, 8)


class Halving(pc.Solver):
    """A solver that halves its error in each step, while there is time. Its `steps` is not an option."""

    name = "halving"
    linear = False

    def solve(
        self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
    ) -> pc.Result:
        B = propagator.B
        phases = np.angle(B @ np.linalg.pinv(B) @ np.ones(len(B)))
        exact = np.linalg.pinv(B) @ (targets.amplitudes * np.exp(1j * phases))
        done, late = 0, False
        while done < 6 and not late:
            done += 1
            late = done < 6 and budget.spent
        out[:] = exact * (1.0 - 0.5**done)
        return pc.Result(iterations=done, late=late)


def test_a_solver_without_a_setting_is_stopped_by_its_budget() -> None:
    weak = 0.01 * AMPLITUDES
    found = list(
        trace(ARRAY, POINTS, weak, Halving(), limits=pc.Limits(gain=None), medium=pc.Air())
    )
    assert [n for n, _ in found] == [1, 2, 3, 4, 5, 6]
    np.testing.assert_allclose([e for _, e in found], 0.5 ** np.arange(1.0, 7.0), rtol=1e-3)


@pytest.mark.parametrize("name", ["weighted-gs", "gs-pat", "lbfgs"])
def test_a_solver_with_a_setting_is_stopped_by_that(name: str) -> None:
    found = dict(trace(ARRAY, POINTS, AMPLITUDES, name, medium=pc.Air()))
    for n in sorted(found)[:3]:
        alone = pc.solve(ARRAY, POINTS, AMPLITUDES, solver=pc.solver(name, steps=n))
        assert (alone.iterations, alone.error) == (n, pytest.approx(found[n], rel=1e-4))


@pytest.mark.parametrize("name", ["lagrange", "lbfgs", "greedy", "pseudo-inverse"])
def test_the_last_point_is_the_solvers_own_answer(name: str) -> None:
    *_, (iterations, error) = trace(ARRAY, POINTS, AMPLITUDES, name, medium=pc.Air())
    whole = pc.solve(ARRAY, POINTS, AMPLITUDES, solver=name)
    assert (iterations, error) == (whole.iterations, pytest.approx(whole.error, rel=1e-3))


def test_every_solver_has_a_curve_or_a_line_with_its_name() -> None:
    (panel,) = plot.convergence(ARRAY, POINTS, AMPLITUDES, medium=pc.Air()).axes
    names = {text.get_text() for text in panel.texts}
    solvers = {offer.name for offer in pc.Plugins().list() if offer.kind == "solver"}
    assert names <= solvers
    assert {"lagrange", "weighted-gs", "lbfgs", "pseudo-inverse"} <= names
    assert len(panel.lines) == len(solvers)
    dashed = [line for line in panel.lines if line.get_linestyle() == "--"]
    assert len(dashed) == 2  # single-focus, pseudo-inverse


def test_it_draws_what_it_is_given() -> None:
    (panel,) = plot.convergence(ARRAY, POINTS, AMPLITUDES, ["gs", Halving()], medium=pc.Air()).axes
    assert {text.get_text() for text in panel.texts} == {"gs", "halving"}
    only = plot.convergence(ARRAY, POINTS, AMPLITUDES, ["pseudo-inverse"], medium=pc.Air())
    assert [text.get_text() for text in only.axes[0].texts] == ["pseudo-inverse"]
    with pytest.raises(pc.UnknownPlugin):
        plot.convergence(ARRAY, POINTS, AMPLITUDES, ["nobody"], medium=pc.Air())
