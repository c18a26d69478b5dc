"""Workers, and all the ways in which they can fail."""

import json
import sys
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from pacinian_lab.solvers import run
from pacinian_lab.solvers import worker_process as process
from pacinian_lab.solvers.problems import BenchmarkProblem
from pacinian_lab.solvers.score import score
from pacinian_lab.solvers.worker_process import Worker, WorkerError

PROBLEM = BenchmarkProblem.make(1, 3, 0.5, 0)
FAKE = Path(__file__).with_name("fake.py")
LIMIT = 60.0


@pytest.fixture
def made() -> Iterator[list[Worker]]:
    workers: list[Worker] = []
    yield workers
    for worker in workers:
        worker.close()


def fake(made: list[Worker], how: str) -> run.Entry:
    made.append(Worker("fake", [sys.executable, str(FAKE), how], 1))
    return run.Entry(made[-1], "fake", "cold")


def test_one_that_works_is_measured(made: list[Worker]) -> None:
    entry = fake(made, "works")
    row = run.run_one(entry, PROBLEM, 0.0, LIMIT)
    expected = score(PROBLEM.positions, PROBLEM.points, PROBLEM.targets, np.ones(249))
    assert row.ok
    assert (row.p50, row.p99, row.samples, row.traced, row.resident) == (1e-3, 2e-3, 3, 10, 1e6)
    assert (row.error, row.scale) == pytest.approx((expected.error, expected.best_multiple))
    assert row.error_8bit == pytest.approx(row.error)
    assert row.drive == 1.0
    assert (row.family, row.N, row.M, row.threads) == ("fake", 249, 3, 1)
    assert entry.worker.versions == {"fake": "1"}


@pytest.mark.parametrize(
    ("how", "says"),
    [
        ("dies at once", "crashed: no such library"),
        ("says nothing of itself", "does not say what it offers"),
        ("crashes", "crashed: last words"),
        ("fails", "failed: ValueError: not today"),
        ("is short", r"gains of shape \(5,\), not \(249,\)"),
        ("is ragged", "gave an invalid answer"),
        ("is not finite", "gains that are not finite"),
        ("moves", r"points of shape \(2, 3\)"),
        ("forgets", "gave an invalid answer"),
        ("says text", "gave an invalid answer"),
        ("is a list", "gave an invalid answer"),
        ("is no JSON", "gave an invalid answer"),
    ],
)
def test_what_goes_wrong_is_the_rows_status(made: list[Worker], how: str, says: str) -> None:
    entry = fake(made, how)
    row = run.run_one(entry, PROBLEM, 0.0, LIMIT)
    assert not row.ok
    with pytest.raises(AssertionError, match=says):
        raise AssertionError(row.status)
    assert np.isnan(row.error)
    assert run.run_one(entry, PROBLEM, 0.0, LIMIT).status == row.status  # it is started again


def test_one_that_hangs_is_given_up(made: list[Worker]) -> None:
    entry = fake(made, "hangs")
    entry.worker.offers()
    row = run.run_one(entry, PROBLEM, 0.0, 0.2)
    assert row.status == "timed out after 0.2 s"
    assert entry.worker.offers() == [("fake", "cold")]  # a new process


def test_one_that_is_not_there_is_told(made: list[Worker]) -> None:
    made.append(Worker("fake", ["/nowhere/python"], 1))
    with pytest.raises(WorkerError, match="cannot be started"):
        made[-1].offers()
    told: list[str] = []
    assert run.entries(made, None, told.append) == []
    assert "fake left out: it cannot be started" in told[0]


def test_ours_must_start(made: list[Worker]) -> None:
    made.append(Worker(run.OURS, [sys.executable, str(FAKE), "dies at once"], 1))
    with pytest.raises(WorkerError, match="no such library"):
        run.entries(made, None, print)


def test_a_warm_up_goes_on_after_a_fault(made: list[Worker]) -> None:
    entries = [fake(made, "crashes"), fake(made, "works")]
    run.warm_up(entries)
    assert run.run_one(entries[1], PROBLEM, 0.0, LIMIT).ok


PROJECT = """
import os, sys
import numpy as np
print("libraries talk")
LIBRARIES = ["numpy"]
assert len(sys.argv) == 1

def offers(threads):
    print("and talk")
    def prepare(problem):
        if problem["targets"][0] < 0:
            raise ValueError("negative")
        def solve():
            os.write(1, b"even from C")
            return threads
        return solve, lambda n: (np.full(249, n + 1j), np.array(problem["frames"][0]))
    return {("constant", "cold"): prepare}
"""


def test_the_worker_measures_and_keeps_its_lines_clean(made: list[Worker], tmp_path: Path) -> None:
    file = tmp_path / "numpy.py"  # a name that must hide nothing
    file.write_text(PROJECT)
    command = [sys.executable, "-P", str(process.HERE / "worker.py"), str(file)]
    made.append(Worker("constant", command, 2))
    entry = run.Entry(made[0], "constant", "cold")
    assert made[0].offers() == [("constant", "cold")]
    assert made[0].versions == {"numpy": version("numpy")}
    told = made[0].ask(run.message(entry, PROBLEM, 0.0), LIMIT)
    assert told["re"] == [2.0] * 249
    assert told["im"] == [1.0] * 249
    assert told["samples"] == 1
    assert told["p50"] >= 0.0
    bad = run.message(entry, PROBLEM, 0.0)
    bad["problem"]["targets"][0] = -1.0
    with pytest.raises(WorkerError, match="failed: ValueError: negative"):
        made[0].ask(bad, LIMIT)
    assert run.run_one(entry, PROBLEM, 0.0, LIMIT).ok


def test_every_thread_variable_is_set(made: list[Worker]) -> None:
    code = "import json, os; print(json.dumps({'offers': [], 'versions': dict(os.environ)}))"
    made.append(Worker("environment", [sys.executable, "-c", code], 3))
    made[0].offers()
    assert {made[0].versions[name] for name in process.THREADS} == {"3"}
    assert json.loads(json.dumps(made[0].versions["CUDA_VISIBLE_DEVICES"])) == ""
