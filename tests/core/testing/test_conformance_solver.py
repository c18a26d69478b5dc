"""`check_solver` accepts the installed solvers, and detects each kind of mistake."""

from __future__ import annotations

import dataclasses
import threading
from typing import Any, ClassVar, NamedTuple

import numpy as np
import pytest

import pacinian as pc
from pacinian.plugins.registry import discover_plugins
from pacinian.solving.phases import choose_phases
from pacinian.testing import NotConforming, check_solver, conformance_solver
from pacinian.testing.problems import make_problems

SOLVERS = [offer.name for offer in discover_plugins().list() if offer.kind == "solver"]
LONG = ("lbfgs",)
RIGHT = pc.solver("pseudo-inverse")
ARRAY = pc.lattice(0.09, 0.09)


class Given(NamedTuple):
    """The arguments of a solver, and its correct result."""

    solver: Any
    result: Any
    propagator: Any
    targets: Any
    warm: Any
    budget: Any
    out: Any


class Right(pc.Solver):
    """A correct solver. The wrong ones differ from it in one thing."""

    name: ClassVar[str] = "right"
    last: Any = None

    def solve(
        self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
    ) -> Any:
        result = RIGHT.solve(propagator, targets, limits, None, budget, out)
        spoilt = self.spoil(Given(self, result, propagator, targets, warm, budget, out))
        return result if spoilt is None else spoilt

    @staticmethod
    def spoil(given: Given) -> Any:
        """Do something wrong. Return a result that replaces the correct one, or None."""


def wrong_shape(given: Given) -> None:
    given.out[:] = np.zeros(len(given.out) + 1)


def divides_by_0(given: Given) -> None:
    if not given.targets.amplitudes.all():
        given.out[0] = np.nan


def needs_time(given: Given) -> None:
    if given.budget.spent:
        given.out[:] = np.inf


def too_strong(given: Given) -> None:
    given.out[:] = 10.0


def random(given: Given) -> None:
    given.out[:] *= np.exp(1j * np.random.default_rng().uniform(0.0, 1.0))


def remembers(given: Given) -> None:
    if given.solver.last is not None:
        given.out[:] = 0.9 * given.out + 0.1 * given.solver.last
    given.solver.last = given.out.copy()


def writes_targets(given: Given) -> None:
    given.targets.amplitudes.flags.writeable = True
    given.targets.amplitudes[:] *= 0.5


def writes_warm(given: Given) -> None:
    if given.warm is not None:
        given.warm.gains[:] = 0.0


def moves_points(given: Given) -> None:
    given.propagator.place(given.propagator.points + 0.01)


def scales_B(given: Given) -> None:
    given.propagator._B *= 0.5  # changes read-only data, so that all reported pressures are wrong


def single_only(given: Given) -> None:
    if given.out.dtype == np.complex128:
        given.out[:] *= 0.7


def not_linear(given: Given) -> None:
    given.out[:] *= np.sqrt(np.abs(given.out).max())


def boasts(given: Given) -> pc.Result:
    """Return a bound above the optimum."""
    y = np.zeros(len(given.targets.amplitudes), complex)
    return pc.Result(bound=float(given.targets.norm) ** 2, multipliers=y, mu=1e-4)


def silent_where_quiet(given: Given) -> None:
    if given.propagator.quiet is not None:
        given.out[:] = 0.0


def inexact(given: Given) -> None:
    given.out[:] *= 0.95


def tilts_regions(given: Given) -> None:
    """Use a wave from the side for regions instead of the given phases."""
    if given.targets.regions is not None:
        tilt = 200.0 * given.propagator.points[:, 0]
        solve_again(given, given.targets.phases + tilt)


def ignores_regions(given: Given) -> None:
    """Treat all phases in regions as free."""
    if given.targets.regions is not None:
        free = dataclasses.replace(given.targets, phases=np.full(len(given.targets.phases), np.nan))
        solve_again(given, np.angle(choose_phases(given.propagator, free, None)))


def solve_again(given: Given, phases: Any) -> None:
    targets = dataclasses.replace(given.targets, phases=phases)
    RIGHT.solve(given.propagator, targets, pc.Limits(), None, given.budget, given.out)


def no_regions(given: Given) -> None:
    """Fail at samples in one place."""
    if given.targets.regions is not None and not np.ptp(given.propagator.points, axis=0).any():
        given.out[0] = np.inf


WRONG: dict[str, tuple[str, dict[str, Any]]] = {
    "undocumented": ("class", {"__doc__": None}),
    "keeps what there is not": ("class", {"keeps": frozenset({"quiet", "peace"})}),
    "returns nothing": ("finite", {"solve": lambda *_: None}),
    "wrong shape": ("finite", {"spoil": wrong_shape}),
    "divides by 0": ("finite", {"spoil": divides_by_0}),
    "no answer without time": ("budget", {"spoil": needs_time}),
    "too strong": ("gain limit", {"spoil": too_strong}),
    "says limited": ("gain limit", {"spoil": lambda _: pc.Result(limited=True)}),
    "random": ("deterministic", {"spoil": random}),
    "remembers": ("holds nothing", {"spoil": remembers}),
    "writes targets": ("leaves its input alone", {"spoil": writes_targets}),
    "writes the last answer": ("leaves its input alone", {"spoil": writes_warm}),
    "moves points": ("leaves its input alone", {"spoil": moves_points}),
    "spoils B": ("true pressures", {"spoil": scales_B}),
    "single precision only": ("double precision", {"spoil": single_only}),
    "says linear": ("linear", {"spoil": not_linear, "linear": True}),
    "a bound without multipliers": ("bound", {"spoil": lambda _: pc.Result(bound=0.0)}),
    "a bound above the optimum": ("bound", {"spoil": boasts}),
    "says quiet": ("quiet", {"keeps": frozenset({"quiet"})}),
    "quiet by silence": ("quiet", {"keeps": frozenset({"quiet"}), "spoil": silent_where_quiet}),
    "tilts regions": ("regions", {"spoil": tilts_regions}),
    "ignores regions": ("regions", {"spoil": ignores_regions}),
    "no regions": ("finite", {"spoil": no_regions}),
    "says exact": ("exact", {"keeps": frozenset({"exact"}), "spoil": inexact}),
}


def make_wrong(given: dict[str, Any]) -> Any:
    """Return a solver that is correct except for this."""
    functions = {k: staticmethod(v) if k == "spoil" else v for k, v in given.items()}
    return type("Wrong", (Right,), {"__doc__": "Wrong in one thing.", **functions})


def test_a_right_one_passes() -> None:
    check_solver(Right)


@pytest.mark.parametrize("how", WRONG)
def test_a_wrong_one_is_caught(how: str, monkeypatch: pytest.MonkeyPatch) -> None:
    few = [problem for problem in make_problems(ARRAY) if len(problem[1].q) <= 4]
    monkeypatch.setattr(conformance_solver, "make_problems", lambda _: few)
    rule, given = WRONG[how]
    with pytest.raises(NotConforming) as raised:
        check_solver(make_wrong(given), ARRAY)
    assert rule in raised.value.broken


def test_a_hang_ends_the_trial() -> None:
    end = threading.Event()
    with pytest.raises(NotConforming, match="has not returned"):
        check_solver(make_wrong({"spoil": lambda _: end.wait() and None}), limit=1.0)
    end.set()


@pytest.mark.parametrize(
    "solver",
    [pytest.param(name, marks=pytest.mark.deep) if name in LONG else name for name in SOLVERS],
)
def test_every_installed_solver_conforms(solver: str) -> None:
    check_solver(lambda: pc.solver(solver))


def test_an_array_of_one_s_own_may_be_given() -> None:
    array, rng = pc.lattice(0.1, 0.1), np.random.default_rng(3)
    N = len(array)
    uneven = dataclasses.replace(
        array, response=rng.uniform(0.5, 1.5, N) * np.exp(1j * rng.normal(0, 1, N))
    )
    check_solver(lambda: pc.solver("lagrange"), uneven)
