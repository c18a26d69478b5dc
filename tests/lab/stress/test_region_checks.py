"""Guarantees of regions: a broken one is found, by other means than the session's."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian_lab.stress import guarantees
from pacinian_lab.stress.answer_checks import find_broken_guarantees
from pacinian_lab.stress.case import Case
from pacinian_lab.stress.check import compute_ratio
from pacinian_lab.stress.problem_parts import SMALL_ARRAY
from pacinian_lab.stress.region_problems import make_square, regions, shapes

CASES = {case.name.removeprefix("regions: "): case for case in regions()}
FINE = CASES["a square"]
COARSE_Q = make_square(4, spacing=0.02)  # says nothing of the field between
COARSE = Case(
    "test: coarse", SMALL_ARRAY, COARSE_Q, np.full(16, 20.0), regions=np.zeros(16, np.int64)
)


def broken(case: Case, **changes: Any) -> dict[str, str]:
    """The guarantees that an answer breaks which is changed behind the session's back."""
    return dict(
        find_broken_guarantees(case, dataclasses.replace(case.solve("lagrange"), **changes), 0.0)
    )


def test_a_right_answer_breaks_none() -> None:
    assert not broken(FINE)
    assert not broken(COARSE)
    assert COARSE.solve("lagrange").status is not pc.Status.ok


def test_ok_that_is_uneven_is_found() -> None:
    assert "between the samples of region 0" in broken(COARSE, status=pc.Status.ok)["even"]
    g = np.complex64(0.9) * FINE.solve("lagrange").gains
    assert broken(FINE, gains=g, sound_pressure=FINE.B @ g)["even"]


def test_phases_of_more_than_one_wave_are_found() -> None:
    asked = FINE.solve("lagrange").asked_phases
    assert asked is not None
    assert "together" not in broken(FINE, asked_phases=asked + 1.0)  # turned as a whole
    one = asked + np.where(np.arange(len(asked)) == 3, 0.01, 0.0)
    assert "0.01 rad off one wave" in broken(FINE, asked_phases=one)["together"]
    assert broken(FINE, asked_phases=None)["together"] == "no phases are reported"


def test_given_phases_that_are_changed_are_found() -> None:
    given = CASES["phases half given, level 0.3"]
    asked = given.solve("lagrange").asked_phases
    assert asked is not None
    assert "together" not in broken(given)
    assert "given" in broken(given, asked_phases=asked + 1.0)["together"]


def test_the_residual_beside_counts_by_its_weight() -> None:
    case = CASES["with points beside"]
    solution = case.solve("lagrange")
    assert solution.quiet_weight < 0.1
    guarantee = guarantees.get_guarantee("lagrange").near
    assert guarantee is not None
    assert compute_ratio(case, guarantee, solution) <= guarantee.factor
    heavy = dataclasses.replace(solution, quiet_weight=1.0)
    assert compute_ratio(case, guarantee, heavy) > compute_ratio(case, guarantee, solution)
    assert "bound" in broken(case, quiet_weight=1.0)


@pytest.mark.parametrize("solver", ["lagrange", "pseudo-inverse"])
def test_the_shapes_are_felt_as_asked_or_it_is_said(solver: str) -> None:
    """`ok` means even by `Solution.felt` too; and most of these shapes the small array can make."""
    even = 0
    for name in shapes():
        solution = CASES[name].solve(solver)
        assert (solution.status is pc.Status.ok) <= all(part.even for part in solution.felt)
        even += solution.status is pc.Status.ok
    assert even > len(shapes()) / 2 if solver == "lagrange" else even


def test_they_go_as_far_as_is_said() -> None:
    every = list(CASES.values())
    assert max(len(case.points) for case in every) > 1000
    assert min(len(case.points) for case in every) == 1
    assert any(case.refused for case in every)
    assert any(np.ptp(case.points, axis=0).max() == 10.0 for case in every)
    assert any(len(before) == 3 for case in every for before in case.history)
