"""`check_solver` passes the installed ones, and catches each kind of wrong one."""

from __future__ import annotations

import dataclasses
from typing import Any, ClassVar

import numpy as np
import pytest

import pacinian as pc
from pacinian.plugins.registry import installed
from pacinian.testing import NotConforming, check_solver

SOLVERS = [offer.name for offer in installed().list() if offer.kind == "solver"]
RIGHT = pc.solver("pseudo-inverse")


class Right(pc.Solver):
    """One that does what is promised; the others differ from it in one thing."""

    name: ClassVar[str] = "right"

    def solve(
        self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
    ) -> Any:
        result = RIGHT.solve(propagator, targets, limits, None, budget, out)
        return self.spoil(result, propagator, targets, warm, budget, out)

    def spoil(
        self, result: Any, propagator: Any, targets: Any, warm: Any, budget: Any, out: Any
    ) -> Any:
        return result


class Undocumented(Right):
    pass


class KeepsEverything(Right):
    """Claims what there is not."""

    keeps = frozenset({"quiet", "peace"})


class Empty(Right):
    """Returns nothing."""

    def spoil(self, *given: Any) -> Any:
        return None


class WrongShape(Right):
    """Writes too many gains."""

    def spoil(self, *given: Any) -> Any:
        given[-1][:] = np.zeros(len(given[-1]) + 1)
        return given[0]


class NotANumber(Right):
    """Divides by the pressure asked, which may be 0."""

    def spoil(self, result: Any, propagator: Any, targets: Any, *rest: Any) -> Any:
        if not targets.amplitudes.all():
            rest[-1][0] = np.nan
        return result


class NoTime(Right):
    """Has no answer without time."""

    def spoil(self, result: Any, propagator: Any, targets: Any, *rest: Any) -> Any:
        if rest[1].spent:
            rest[-1][:] = np.inf
        return result


class TooStrong(Right):
    """Ten times the drive for a whisper."""

    def spoil(self, result: Any, *rest: Any) -> Any:
        rest[-1][:] = 10.0
        return result


class SaysLimited(Right):
    """Says that it kept the limit, and did not."""

    def spoil(self, result: Any, *rest: Any) -> Any:
        return pc.Result(limited=True)


class Random(Right):
    """Starts from random phases."""

    def spoil(self, result: Any, *rest: Any) -> Any:
        rest[-1][:] *= np.exp(1j * np.random.default_rng().uniform(0.0, 1.0))
        return result


class Remembers(Right):
    """Starts from what it answered before."""

    def __init__(self) -> None:
        self.last: Any = None

    def spoil(self, result: Any, *rest: Any) -> Any:
        out = rest[-1]
        if self.last is not None:
            out[:] = 0.9 * out + 0.1 * self.last
        self.last = out.copy()
        return result


class WritesTargets(Right):
    """Normalises the targets in place."""

    def spoil(self, result: Any, propagator: Any, targets: Any, *rest: Any) -> Any:
        targets.amplitudes.flags.writeable = True
        targets.amplitudes[:] *= 0.5
        return result


class WritesWarm(Right):
    """Uses the last answer's array as its own."""

    def spoil(self, result: Any, propagator: Any, targets: Any, warm: Any, *rest: Any) -> Any:
        if warm is not None:
            warm.gains[:] = 0.0
        return result


class Moves(Right):
    """Moves the points to look around."""

    def spoil(self, result: Any, propagator: Any, *rest: Any) -> Any:
        propagator.place(propagator.points + 0.01)
        return result


class SpoilsB(Right):
    """Scales B behind its seal: all pressures told are wrong."""

    def spoil(self, result: Any, propagator: Any, *rest: Any) -> Any:
        propagator._B *= 0.5
        return result


class SingleOnly(Right):
    """Answers in single precision only."""

    def spoil(self, result: Any, *rest: Any) -> Any:
        if rest[-1].dtype == np.complex128:
            rest[-1][:] *= 0.7
        return result


class NotLinear(Right):
    """Says that it is linear."""

    linear = True

    def spoil(self, result: Any, *rest: Any) -> Any:
        rest[-1][:] *= np.sqrt(np.abs(rest[-1]).max())
        return result


class Unproven(Right):
    """A bound without multipliers."""

    def spoil(self, *given: Any) -> Any:
        return pc.Result(bound=0.0)


class Boasts(Right):
    """A bound above the optimum."""

    def spoil(self, result: Any, propagator: Any, targets: Any, *rest: Any) -> Any:
        y = np.zeros(len(targets.amplitudes), complex)
        return pc.Result(bound=float(targets.norm) ** 2, multipliers=y, mu=1e-4)


class IgnoresQuiet(Right):
    """Says that it keeps quiet points."""

    keeps = frozenset({"quiet"})


class QuietBySilence(Right):
    """Keeps quiet points, and nothing else."""

    keeps = frozenset({"quiet"})

    def solve(self, propagator: Any, *rest: Any) -> Any:
        result = super().solve(propagator, *rest)
        if propagator.quiet is not None:
            rest[-1][:] = 0.0
        return result


class IgnoresExact(Right):
    """Says that it meets samples exactly."""

    keeps = frozenset({"exact"})

    def spoil(self, result: Any, *rest: Any) -> Any:
        rest[-1][:] *= 0.95
        return result


WRONG = {
    Undocumented: "class",
    KeepsEverything: "class",
    Empty: "finite",
    WrongShape: "finite",
    NotANumber: "finite",
    NoTime: "budget",
    TooStrong: "gain limit",
    SaysLimited: "gain limit",
    Random: "deterministic",
    Remembers: "holds nothing",
    WritesTargets: "leaves its input alone",
    WritesWarm: "leaves its input alone",
    Moves: "leaves its input alone",
    SpoilsB: "true pressures",
    SingleOnly: "double precision",
    NotLinear: "linear",
    Unproven: "bound",
    Boasts: "bound",
    IgnoresQuiet: "quiet",
    QuietBySilence: "quiet",
    IgnoresExact: "exact",
}


def test_a_right_one_passes() -> None:
    check_solver(Right)


@pytest.mark.parametrize(("kind", "rule"), WRONG.items(), ids=lambda v: getattr(v, "__name__", v))
def test_a_wrong_one_is_caught(kind: Any, rule: str) -> None:
    with pytest.raises(NotConforming) as raised:
        check_solver(kind)
    assert rule in raised.value.broken


def test_a_hang_ends_the_trial() -> None:
    class Hangs(Right):
        """Never comes back."""

        def spoil(self, *given: Any) -> Any:
            import threading

            threading.Event().wait(3.0)

    with pytest.raises(NotConforming, match="has not come back"):
        check_solver(Hangs, limit=0.3)


@pytest.mark.parametrize("solver", SOLVERS)
def test_every_installed_solver_conforms(solver: str) -> None:
    check_solver(lambda: pc.solver(solver))


def test_an_array_of_one_s_own_may_be_given() -> None:
    array = pc.autd()
    rng = np.random.default_rng(3)
    uneven = dataclasses.replace(
        array, response=rng.uniform(0.5, 1.5, 249) * np.exp(1j * rng.normal(0, 1, 249))
    )
    for one in (array, uneven):
        check_solver(lambda: pc.solver("lagrange"), one)
