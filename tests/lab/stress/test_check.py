"""A broken guarantee is found, whichever it is; a kept one is not held against anybody."""

import dataclasses
from typing import Any, ClassVar

import numpy as np
import pytest

import pacinian as pc
from pacinian.testing import ManualClock
from pacinian_lab.stress import guarantees
from pacinian_lab.stress.answer_checks import find_broken_guarantees
from pacinian_lab.stress.case import Case
from pacinian_lab.stress.check import check
from pacinian_lab.stress.problem_parts import SMALL_ARRAY, compute_asked, scatter_points

Q = scatter_points(3)
CASE = Case(
    "test: plain", SMALL_ARRAY, Q, compute_asked(SMALL_ARRAY, Q, 0.3), 0.0, clock=lambda: 0.0
)
QUIET = ([[0.0, 0.0, 0.07]], 1e-3)


class Does(pc.Solver):
    """Does what it is told, under the name of the one that guarantees most."""

    name: ClassVar[str] = "lagrange"

    def __init__(self, does: Any) -> None:
        self.does = does

    def solve(
        self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
    ) -> pc.Result:
        self.does(out)
        return pc.Result()


def fails(out: Any) -> None:
    raise ZeroDivisionError("by zero")


@pytest.mark.parametrize(
    ("guarantee", "does"),
    [
        ("raises", fails),
        ("raises", lambda out: np.divide(out, 0.0)),  # a warning
        ("answers", lambda out: out.fill(0.0)),
        ("answers", lambda out: out.fill(np.nan)),  # the session makes it silence
        ("near", lambda out: out.fill(1.0)),
    ],
)
def test_a_solver_that_breaks_a_guarantee_is_found(guarantee: str, does: Any) -> None:
    assert guarantee in check(CASE, Does(does)).broken


def test_a_solver_that_takes_too_long_is_found() -> None:
    clock = ManualClock()
    case = dataclasses.replace(CASE, clock=clock.now)
    evidence = check(case, Does(lambda out: clock.advance(1e3)))
    assert {"late", "answers"} <= evidence.broken.keys()
    assert evidence.seconds == 1e3


def test_a_stranger_guarantees_less() -> None:
    solver = Does(lambda out: out.fill(0.0))
    solver.__class__ = type("Stranger", (Does,), {"name": "stranger"})
    assert not check(CASE, solver).broken


def broken(case: Case, **changes: Any) -> set[str]:
    """The guarantees that an answer breaks which is changed behind the session's back."""
    solution = dataclasses.replace(case.solve("pseudo-inverse"), **changes)
    return {guarantee for guarantee, _ in find_broken_guarantees(case, solution, 0.0)}


def test_what_the_session_guarantees_is_looked_at_all_the_same() -> None:
    g = CASE.solve("pseudo-inverse").gains
    assert not broken(CASE)
    over = np.nextafter(np.float32(1.0), np.float32(2.0))
    assert {"gain", "true"} <= broken(CASE, gains=np.full_like(g, over))
    assert broken(CASE, gains=np.full_like(g, np.nan)) == {"finite"}
    assert broken(CASE, sound_pressure=np.full(3, np.nan + 0j)) == {"finite"}
    assert broken(CASE, sound_pressure=np.full(3, 1.0 + 0j)) == {"true"}
    assert broken(CASE, status=pc.Status.silent) == {"silent"}
    nothing = dataclasses.replace(CASE, amplitudes=np.zeros(3))
    assert "silent" in broken(nothing, gains=g, sound_pressure=CASE.B @ g)
    assert broken(CASE, bound=1e9, objective=1e9, mu=0.0) == {"bound"}
    assert broken(CASE, bound=1e9, objective=1.0) == {"bound"}
    power = dataclasses.replace(CASE, limits=pc.Limits(power=1e-3))
    assert {"power", "true"} <= broken(power, gains=g)
    most = dataclasses.replace(CASE, scale="max")
    assert "strong" in broken(most, gains=np.complex64(0.5) * g / np.abs(g).max())
    assert dict(find_broken_guarantees(CASE, CASE.solve("pseudo-inverse"), 1e3)).keys() == {"late"}


@pytest.mark.parametrize("limits", [{"quiet": QUIET}, {"exact": [0]}])
def test_a_limit_that_is_ignored_is_found(limits: Any) -> None:
    class Ignores(Does):
        name: ClassVar[str] = "ignores"
        keeps: ClassVar[frozenset[str]] = frozenset({"quiet", "exact"})

        def solve(self, *arguments: Any) -> pc.Result:
            arguments[-1][:] = 1.0
            return pc.Result()

    case = dataclasses.replace(CASE, limits=pc.Limits(**limits))
    if "quiet" in limits:  # silence would keep it: it is never infeasible
        assert "quiet" in check(case, Ignores(None)).broken
    else:
        assert case.solve(Ignores(None)).status is pc.Status.infeasible
        loose = dataclasses.replace(case.solve(Ignores(None)), status=pc.Status.ok)
        assert "exact" in dict(find_broken_guarantees(case, loose, 0.0))


def test_refusals_are_right_where_they_are_called_for() -> None:
    limited = dataclasses.replace(CASE, limits=pc.Limits(quiet=QUIET))
    assert not check(limited, pc.solver("single-focus")).broken
    on = dataclasses.replace(CASE, points=SMALL_ARRAY.positions[:3], refused=pc.PointOnTransducer)
    assert not check(on, pc.solver("gs-pat")).broken
    here = dataclasses.replace(CASE, refused=pc.PointOnTransducer)
    assert "raises" in check(here, pc.solver("gs-pat")).broken


def test_every_guarantee_that_can_be_broken_is_stated() -> None:
    stated = {*guarantees.EVERY, *guarantees.OURS, *guarantees.PROPAGATOR}
    assert len(stated) == len(guarantees.EVERY) + len(guarantees.OURS) + len(guarantees.PROPAGATOR)
    assert {"gain", "finite", "near", "drift"} <= stated
