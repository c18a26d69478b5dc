"""`lagrange` at regions near the limits: the strongest even field, and answers where Newton steps stall."""

from __future__ import annotations

from typing import Any

import cvxpy as cp
import numpy as np
import pytest

import pacinian as pc
from pacinian.solving.solution_status import REGION_TOLERANCE

from ..problems import optimum

ARRAY, AIR = pc.lattice(0.06, 0.06), pc.Air()


def square(count: int, spacing: float = 0.003, height: float = 0.1) -> Any:
    side = spacing * (np.arange(count) - (count - 1) / 2.0)
    X, Y = np.meshgrid(side, side)
    return np.c_[X.ravel(), Y.ravel(), np.full(count * count, height)]


def solve(q: Any, t: Any, array: pc.Array = ARRAY, **options: Any) -> pc.Solution:
    return pc.Session(array, AIR, "lagrange").solve(q, t, regions=np.zeros(len(q), int), **options)


LIMITS: list[dict[str, Any]] = [
    {},
    {"gain": 0.3},
    {"power": 1.0},
    {"power": 10.0, "gain": None},
    {"power": 1e3},
]


@pytest.mark.parametrize("limits", LIMITS, ids=str)
@pytest.mark.parametrize("count", [5, 7])
def test_no_even_field_is_stronger(limits: dict[str, Any], count: int) -> None:
    """Against the largest s for which some gains within the limits make ||s p - B g|| <= 0.05 s ||p||, by CVXPY."""
    q = square(count)
    found = solve(q, np.ones(len(q)), scale="max", limits=pc.Limits(**limits))
    B, p = pc.matrix(ARRAY, q, AIR), np.exp(1j * found.asked_phases)
    full = np.abs(B).sum(axis=1).mean()
    g, s = cp.Variable(len(ARRAY), complex=True), cp.Variable()
    allowed = [cp.norm(s * p - B / full @ g) <= REGION_TOLERANCE * np.linalg.norm(p) * s]
    gain, power = limits.get("gain", 1.0), limits.get("power")
    allowed += [cp.abs(g) <= gain] if gain else []
    allowed += [cp.norm(g) <= power**0.5] if power else []
    most = -optimum(-s, allowed) * full
    made = B @ found.gains.astype(complex)
    assert found.shape_error <= REGION_TOLERANCE
    assert np.abs(made).mean() >= 0.97 * most
    assert gain is None or np.abs(found.gains).max() <= gain
    assert power is None or np.linalg.norm(found.gains.astype(complex)) ** 2 <= power


def test_what_is_reached_of_a_region_does_not_depend_on_what_is_behind_the_array() -> None:
    """Samples that no sound reaches do not count; and nothing is left from another region of as many."""
    array, q = pc.autd(), square(4, height=0.15)
    q = np.concatenate([q, q * [1.0, 1.0, -1.0]])
    found = solve(q, np.ones(32), array, scale="max")
    solve(square(4).repeat(2, axis=0), np.ones(32), array, scale="max")
    again = solve(q, np.ones(32), array, scale="max")
    assert found.status is pc.Status.unreachable
    assert np.array_equal(found.gains, again.gains)
    made = np.abs(found.sound_pressure)
    assert made[:16].std() < 0.1 * made[:16].mean()
    assert not made[16:].any()
    assert found.saturation > 0.0


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize(
    ("array", "q"),
    [(pc.lattice(0.05, 0.05), square(32, 0.00125)), (pc.autd(), square(32, height=0.2))],
    ids=["36", "249"],
)
def test_with_more_samples_than_transducers_held_it_is_the_optimum(
    array: pc.Array, q: Any, precision: Any
) -> None:
    """1024 samples, three times as strong as can be: Newton steps on these stall."""
    B = pc.matrix(array, q, AIR)
    t = np.full(len(q), 3.0 * np.abs(B).sum(axis=1).mean() / 32.0)
    session = pc.Session(array, AIR, "lagrange", precision=precision)
    session.corrections = 0
    session.solve(q, t, regions=np.zeros(len(q), int))
    assert session.last is not None
    solution = session.certify(session.last.gains)
    assert solution.status is pc.Status.limited
    assert solution.bound <= solution.objective <= 1.01 * solution.bound
