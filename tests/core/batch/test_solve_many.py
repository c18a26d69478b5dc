"""Batches: each solution is the one that `solve` finds alone, whatever solves it and wherever."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.batch import solve_many as module
from pacinian.batch.processes import WorkerProcess, pack_task
from pacinian.plugins.registry import discover_plugins

SOLVERS = [offer.name for offer in discover_plugins().list() if offer.kind == "solver"]
ARRAY = pc.autd()
K, M = 7, 5
UP = np.array([0.0, 0.0, 1.0])
CHANCE = np.random.default_rng(3)
POINTS = CHANCE.uniform((-0.05, -0.05, 0.1), (0.05, 0.05, 0.2), (K, M, 3))
AMPLITUDES = CHANCE.uniform(50.0, 300.0, (K, M))


@pytest.fixture(params=["one by one", "threads", "processes"])
def place(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> int:
    """Where the problems are solved, and the number of workers."""
    monkeypatch.setattr(module, "MAX_TRIED", 0.0)
    monkeypatch.setattr(module, "MIN_IN_PROCESSES", 0.0)
    monkeypatch.setattr(module, "MIN_IN_THREADS", 0.0)
    monkeypatch.setattr(module, "MAX_PART", 0.0)  # one problem at once
    monkeypatch.setattr(module, "MAX_IN_THREADS", 0.0 if request.param == "processes" else np.inf)
    return {"one by one": 1, "threads": 2, "processes": 3}[request.param]


@pytest.mark.parametrize("solver", SOLVERS)
def test_every_solver_gives_the_gains_of_single_solves(solver: str, place: int) -> None:
    count = 1 if solver == "single-focus" else M
    q, t = POINTS[:, :count], AMPLITUDES[:, :count]
    found = pc.solve_many(ARRAY, q, t, solver=solver, workers=place)
    assert len(found) == K
    for k, one in enumerate(found):
        alone = pc.solve(ARRAY, q[k], t[k], solver=solver)
        np.testing.assert_array_equal(one.gains, alone.gains)
        np.testing.assert_array_equal(found.gains[k], alone.gains)
        np.testing.assert_array_equal(found.sound_pressure[k], alone.sound_pressure)
        assert (one.status, one.solver, one.error) == (alone.status, alone.solver, alone.error)
        assert found.errors[k] == alone.error


def test_settings_are_those_of_a_single_solve(place: int) -> None:
    x, y = np.meshgrid(*2 * [np.arange(-0.009, 0.01, 0.003)])
    q = np.stack(
        [np.column_stack([x.ravel(), y.ravel(), np.full(x.size, z)]) for z in (0.12, 0.15)]
    )
    how: dict[str, Any] = {
        "limits": pc.Limits(gain=0.5), "scale": "max", "solver": "lagrange", "precision": "double",
        "medium": pc.Air(temperature=30.0), "regions": np.zeros(x.size, int),
    }  # fmt: skip
    found = pc.solve_many(ARRAY, q, np.full(x.size, 100.0), 0.0, workers=place, **how)
    for k, one in enumerate(found):
        alone = pc.solve(ARRAY, q[k], np.full(x.size, 100.0), 0.0, **how)
        np.testing.assert_array_equal(one.gains, alone.gains)
        assert one.felt == alone.felt
        assert one.gains.dtype == np.complex128


def test_one_problem_for_each_array(place: int) -> None:
    arrays = [replace(ARRAY, positions=ARRAY.positions + 0.01 * k * UP) for k in range(K)]
    moved = pc.solve_many(arrays, POINTS[0], AMPLITUDES[0], workers=place)
    for array, one in zip(arrays, moved, strict=True):
        np.testing.assert_array_equal(one.gains, pc.solve(array, POINTS[0], AMPLITUDES[0]).gains)
    sizes = [pc.lattice(0.05, 0.05), pc.lattice(0.05, 0.1)]
    unlike = pc.solve_many(sizes, POINTS[0], AMPLITUDES[0] / 100.0, workers=place)
    assert [len(one.gains) for one in unlike] == [len(array) for array in sizes]
    with pytest.raises(pc.ArgumentError, match="sizes"):
        _ = unlike.gains


def test_shapes_broadcast() -> None:
    same = pc.solve_many(ARRAY, POINTS[0], AMPLITUDES)  # points for all
    for k, one in enumerate(same):
        np.testing.assert_array_equal(one.gains, pc.solve(ARRAY, POINTS[0], AMPLITUDES[k]).gains)
    np.testing.assert_array_equal(
        pc.solve_many(ARRAY, POINTS, 100.0).gains,
        pc.solve_many(ARRAY, POINTS, np.full((K, M), 100.0)).gains,
    )
    assert len(pc.solve_many(ARRAY, POINTS[0], 100.0)) == 1
    none = pc.solve_many(ARRAY, np.empty((0, M, 3)), 1.0)
    assert len(none) == 0
    assert "0 Solutions" in repr(none)
    silent = pc.solve_many(ARRAY, np.empty((3, 0, 3)), 1.0)
    assert {one.status for one in silent} == {pc.Status.silent}


def test_solutions_are_a_sequence() -> None:
    found = pc.solve_many(ARRAY, POINTS, AMPLITUDES)
    part = found[2:4]
    assert isinstance(part, pc.Solutions)
    assert list(part) == [found[2], found[3]]
    assert found[-1] is list(found)[-1]
    assert repr(found).startswith(f"<{K} Solutions: {K} ok, largest error ")


class Clumsy(pc.Solver):
    """A solver that fails at one place."""

    name = "clumsy"

    def solve(
        self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
    ) -> pc.Result:
        if abs(propagator.points - POINTS[4]).max() == 0.0:
            raise RuntimeError("not there")
        out[:] = 0.1
        return pc.Result()


def test_an_error_tells_its_problem(place: int) -> None:
    with pytest.raises(RuntimeError, match="not there") as told:
        pc.solve_many(ARRAY, POINTS, AMPLITUDES, solver=Clumsy(), workers=place)
    assert told.value.__notes__ == [f"This was problem 4 of {K}."]
    touching = POINTS.copy()
    touching[5, 2] = ARRAY.positions[7]
    with pytest.raises(pc.PointOnTransducer) as caught:
        pc.solve_many(ARRAY, touching, AMPLITUDES, workers=place)
    assert caught.value.indices == (2,)
    assert "problem 5" in caught.value.__notes__[0]


def test_the_death_of_a_process_is_told() -> None:
    task = module._check_task(
        ARRAY, POINTS, AMPLITUDES, None, None, Clumsy(), None, "exact", None, "single"
    )
    packed = pack_task(task)
    assert packed is not None
    process = WorkerProcess(task, packed)
    assert [k for k, _ in process.solve([0, 1])] == [0, 1]
    process._process.kill()
    process._process.wait()
    with pytest.raises(pc.PluginError, match="died"):
        process.solve([2])
    process.close()


def test_what_only_a_script_knows_stays_in_its_process(monkeypatch: pytest.MonkeyPatch) -> None:
    task = module._check_task(
        ARRAY, POINTS, AMPLITUDES, None, None, Clumsy(), None, "exact", None, "single"
    )
    assert pack_task(task) is not None
    monkeypatch.setattr(Clumsy, "__module__", "__main__")
    assert pack_task(task) is None
    odd = pc.Transducer(directivity=lambda cosine: cosine)
    for limit in ("MAX_TRIED", "MAX_IN_THREADS", "MIN_IN_PROCESSES"):
        monkeypatch.setattr(module, limit, 0.0)
    made = pc.solve_many(replace(ARRAY, transducer=odd), POINTS, AMPLITUDES / 10.0, workers=2)
    assert all(one.status is pc.Status.ok for one in made)


@pytest.mark.parametrize(
    ("argument", "change"),
    [
        ("array", {"array": "array"}),
        ("array", {"array": []}),
        ("array", {"array": [ARRAY, ARRAY]}),
        ("array", {"array": 3}),
        ("points", {"points": POINTS[0, 0]}),
        ("points", {"points": POINTS[..., :2]}),
        ("points", {"points": np.full((K, M, 3), np.nan)}),
        ("points", {"points": 1e3 * POINTS}),  # millimetres
        ("points", {"points": np.zeros((2_000_000, 1, 3))}),
        ("amplitudes", {"amplitudes": np.ones(M + 1)}),
        ("amplitudes", {"amplitudes": np.full((K, M), np.nan)}),
        ("amplitudes", {"amplitudes": "loud"}),
        ("amplitudes", {"amplitudes": -AMPLITUDES}),
        ("amplitudes", {"amplitudes": 1j * AMPLITUDES}),
        ("phases", {"phases": np.ones((K, M + 1))}),
        ("phases", {"phases": np.inf}),
        ("regions", {"regions": np.zeros(3, int)}),
        ("regions", {"regions": 0.5}),
        ("scale", {"scale": "loud"}),
        ("medium", {"medium": "air"}),
        ("limits", {"limits": 1.0}),
        ("solver", {"solver": 3}),
        ("precision", {"precision": "half"}),
        ("workers", {"workers": 0}),
    ],
)
def test_bad_arguments_are_named(argument: str, change: dict[str, Any]) -> None:
    good = {"array": ARRAY, "points": POINTS, "amplitudes": AMPLITUDES}
    with pytest.raises(pc.ArgumentError) as told:
        pc.solve_many(**(good | change))
    assert told.value.argument == argument
