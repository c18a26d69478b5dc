"""Batches: each solution is the one that `solve` finds alone, whatever solves it and wherever."""

from __future__ import annotations

import os
from dataclasses import replace
from importlib import import_module, reload
from pickle import UnpicklingError
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.batch import processes
from pacinian.batch import solve_many as module
from pacinian.batch.processes import WaitingProcesses, WorkerProcess, pack_task
from pacinian.plugins.registry import discover_plugins

from ...waiting import eventually

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from pacinian.batch.task import Task

SOLVERS = [offer.name for offer in discover_plugins().list() if offer.kind == "solver"]
ARRAY = pc.autd()
K, M = 7, 5
UP = np.array([0.0, 0.0, 1.0])
CHANCE = np.random.default_rng(3)
POINTS = CHANCE.uniform((-0.05, -0.05, 0.1), (0.05, 0.05, 0.2), (K, M, 3))
AMPLITUDES = CHANCE.uniform(50.0, 300.0, (K, M))


class StartedProcess(WorkerProcess):
    """A process that solves from the first problem on."""

    def __init__(self, code: object) -> None:
        super().__init__(code)
        self.started.wait()


@pytest.fixture(params=["one by one", "threads", "processes", "processes, two at once"])
def place(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> int:
    """Where the problems are solved, and the number of workers."""
    monkeypatch.setattr(module, "MAX_TRIED", 0.0)
    monkeypatch.setattr(module, "MIN_IN_PROCESSES", 0.0)
    monkeypatch.setattr(module, "MIN_IN_THREADS", 0.0)
    monkeypatch.setattr(module, "MAX_PART", np.inf if "two" in request.param else 0.0)
    monkeypatch.setattr(module, "PARTS", 1)
    in_processes = request.param.startswith("processes")
    monkeypatch.setattr(module, "MIN_FOR_WAITING", 0.0 if in_processes else np.inf)
    monkeypatch.setattr(module, "MIN_FOR_NEW", 1e-9)
    monkeypatch.setattr(processes, "WorkerProcess", StartedProcess)
    return {"one by one": 1, "threads": 2}.get(request.param, 3)


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
    strong = pc.solve_many(ARRAY, POINTS, AMPLITUDES, scale="max")
    assert float(repr(strong).rpartition(" of the proportions ")[2].rstrip(">")) < 0.05


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


def make_task(solver: pc.Solver) -> tuple[Task, bytes]:
    task = module._check_task(
        ARRAY, POINTS, AMPLITUDES, None, None, solver, None, "exact", None, "single"
    )
    packed = pack_task(task)
    assert packed is not None
    return task, packed


def test_a_process_gets_the_next_part_before_its_answer_is_read() -> None:
    process = WorkerProcess("code")
    process.begin(*make_task(pc.solver("auto")))
    taken: list[list[int]] = []

    def parts() -> Iterator[list[int]]:
        for part in ([0, 1], [2, 3], [4, 5], [6]):
            taken.append(part)
            yield part

    solved = process.solve(parts())
    found = [next(solved), next(solved)]
    assert len(taken) == 2
    found += solved
    process.close()
    assert [k for k, _ in found] == list(range(K))
    for k, one in found:
        np.testing.assert_array_equal(one.gains, pc.solve(ARRAY, POINTS[k], AMPLITUDES[k]).gains)


def test_the_death_of_a_process_is_told() -> None:
    process = WorkerProcess("code")
    process.begin(*make_task(Clumsy()))
    assert [k for k, _ in process.solve([[0, 1]])] == [0, 1]
    process._process.kill()
    process._process.wait()
    with pytest.raises(pc.PluginError, match="died"):
        list(process.solve([[2]]))
    process.close()


def test_a_process_takes_one_task_after_the_other() -> None:
    process = WorkerProcess("code")
    task, packed = make_task(pc.solver("auto"))
    for solver in (pc.solver("auto"), Clumsy(), pc.solver("gs")):
        task, packed = make_task(solver)
        process.begin(task, packed)
        (_, one), _ = process.solve([[0, 1]])
        alone = pc.solve(ARRAY, POINTS[0], AMPLITUDES[0], solver=solver)
        np.testing.assert_array_equal(one.gains, alone.gains)
        assert one.array is ARRAY
    process.begin(task, b"no task")
    with pytest.raises(UnpicklingError):
        list(process.solve([[0]]))
    process.begin(task, packed)
    assert [k for k, _ in process.solve([[0]])] == [0]
    process.close()
    assert not process.alive


@pytest.fixture
def waiting(monkeypatch: pytest.MonkeyPatch) -> Iterator[WaitingProcesses]:
    """Processes of this test alone, which start for any batch."""
    made = WaitingProcesses()
    monkeypatch.setattr(module, "waiting", made)
    for limit in ("MAX_TRIED", "MIN_IN_PROCESSES", "MIN_FOR_WAITING", "MAX_PART"):
        monkeypatch.setattr(module, limit, 0.0)
    monkeypatch.setattr(module, "MIN_FOR_NEW", 1e-9)
    monkeypatch.setattr(processes, "WorkerProcess", StartedProcess)
    yield made
    made.close()


def solve_two(solver: str | pc.Solver = "auto") -> pc.Solutions:
    return pc.solve_many(ARRAY, POINTS, AMPLITUDES, solver=solver, workers=2)


def test_processes_wait_for_the_next_batch_while_their_code_is_the_same(
    waiting: WaitingProcesses, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    solve_two()
    (first,) = waiting._all
    solve_two()
    assert waiting._all == [first]
    assert first.alive
    monkeypatch.syspath_prepend(str(tmp_path))  # it cannot find modules there
    solve_two()
    (second,) = waiting._all
    assert second is not first
    assert not first.alive
    second._process.kill()
    second._process.wait()
    solve_two()
    (third,) = waiting._all
    assert third.alive
    with pytest.raises(RuntimeError, match="not there"):
        solve_two(Clumsy())
    assert waiting._all == []  # it may still be solving
    assert not third.alive


def test_code_that_is_edited_is_read_again(
    waiting: WaitingProcesses, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "edited.py"
    code = (
        "import pacinian as pc\n\n"
        "class Edited(pc.Solver):\n"
        "    name = 'edited'\n\n"
        "    def solve(self, propagator, targets, limits, warm, budget, out):\n"
        "        out[:] = {}\n"
        "        return pc.Result()\n"
    )
    file.write_text(code.format(0.1))
    monkeypatch.syspath_prepend(str(tmp_path))
    module = import_module("edited")
    found = solve_two(module.Edited())
    (first,) = waiting._all
    solve_two("gs")
    assert waiting._all == [first]  # another solver is not other code
    assert set(found.gains.ravel()) == {np.complex64(0.1)}
    file.write_text(code.format(0.25))
    os.utime(file, ns=(1, 1))
    reload(module)
    found = solve_two(module.Edited())
    assert set(found.gains.ravel()) == {np.complex64(0.25)}
    assert waiting._all != [first]


def test_small_batches_are_together_worth_a_process(waiting: WaitingProcesses) -> None:
    assert [waiting.count_worthwhile("code", 0.4) for _ in range(5)] == [0, 0, 1, 1, 2]
    waiting.close()  # as after a minute without batches
    assert waiting.count_worthwhile("code", 0.4) == 0


def test_processes_end_when_no_batch_comes(
    waiting: WaitingProcesses, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(processes, "IDLE_TIMEOUT", 0.01)
    solve_two()
    eventually(lambda: not waiting._all)


def test_a_batch_does_not_wait_for_processes_that_start(
    waiting: WaitingProcesses, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(processes, "WorkerProcess", WorkerProcess)
    monkeypatch.setattr(processes, "COMMAND", "import time; time.sleep(600)")
    assert {one.status for one in solve_two()} == {pc.Status.ok}
    (process,) = waiting._all
    assert not process.started.is_set()


def test_a_forked_process_leaves_its_parents_processes_alone(waiting: WaitingProcesses) -> None:
    process = WorkerProcess("code")
    waiting.keep([process])
    assert waiting.count_worthwhile("code", 0.0) == 1
    waiting.forget()  # as after a fork
    assert waiting.count_worthwhile("code", 0.0) == 0
    assert process.alive
    process.close()


def test_what_only_a_script_knows_stays_in_its_process(monkeypatch: pytest.MonkeyPatch) -> None:
    task = module._check_task(
        ARRAY, POINTS, AMPLITUDES, None, None, Clumsy(), None, "exact", None, "single"
    )
    assert pack_task(task) is not None
    monkeypatch.setattr(Clumsy, "__module__", "__main__")
    assert pack_task(task) is None
    odd = pc.Transducer(directivity=lambda cosine: cosine)
    for limit in ("MAX_TRIED", "MIN_FOR_WAITING", "MIN_IN_PROCESSES"):
        monkeypatch.setattr(module, limit, 0.0)
    monkeypatch.setattr(module, "MIN_FOR_NEW", 1e-9)
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
        ("regions", {"regions": [[0, 0], [0]]}),
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


def test_no_problems_have_arrays_of_the_usual_shapes() -> None:
    none = pc.solve_many(ARRAY, np.empty((0, 4, 3)), 1.0)
    for part in (none, none[:], pc.solve_many(ARRAY, POINTS, AMPLITUDES)[:0]):
        assert part.gains.shape == (0, len(ARRAY))
        assert part.errors.shape == (0,)
    assert none.sound_pressure.shape == (0, 4)
