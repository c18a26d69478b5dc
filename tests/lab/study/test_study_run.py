"""A study in one process: what is kept, what is done again, and what a run leaves."""

from __future__ import annotations

import math
import os
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow.parquet as pq
import pytest

import pacinian as pc
import pacinian_lab.study as ps
from pacinian_lab.study import charts, images, report, store, study_run
from pacinian_lab.study.measures import MEASURES
from pacinian_lab.study.store import Folder
from pacinian_lab.study.tasks import Plan
from pacinian_lab.study.worker import measure

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The keys of what is measured."""
    keys: list[str] = []

    def measured(batch: Any) -> list[Any]:
        keys.extend(job.key for job in batch.jobs)
        return measure(batch)

    monkeypatch.setattr(study_run, "measure", measured)
    return keys


def test_a_run_ends_with_a_table_of_all_tasks_in_order(
    write: Callable[..., Path], tmp_path: Path, same: Callable[[Any], str]
) -> None:
    path, out = write(), tmp_path / "out"
    done: list[int] = []
    table = ps.run(path, out, workers=0, advance=done.append)
    plan = Plan(ps.read(path))
    assert sum(done) == len(table) == len(plan.tasks)
    assert table.column("key").to_pylist() == [task.key for task in plan.tasks]
    assert table.column("failure").null_count == len(table)
    assert same(ps.load(out)) == same(table)
    first = table.to_pylist()[0]
    assert (first["layout"], first["plane"], first["pattern"], first["solver"], first["level"]) == (
        "lattice width=0.03", "plane", "focus", "auto", 0.5,
    )  # fmt: skip
    assert (first["layout.width"], first["layout.count"], first["plane.z"]) == (0.03, None, 0.1)
    assert {"tasks.parquet", "results.parquet", "parts", "lock"} == {p.name for p in out.iterdir()}
    assert all(p.suffix == ".parquet" for p in (out / "parts").iterdir())


def test_the_same_numbers_come_in_any_order_and_alone(write: Callable[..., Path]) -> None:
    plan = Plan(ps.read(write()))
    forth = {r["key"]: r for b in plan.batches() for r in measure(plan.batch(b))}
    back = {r["key"]: r for t in plan.tasks[::-1] for r in measure(plan.batch([t]))}
    for rows in (forth, back):
        for row in rows.values():
            for name in store.TIMES:
                del row[name]
    assert repr([forth[k] for k in forth]) == repr([back[k] for k in forth])


def test_what_is_done_is_not_done_again_and_what_is_new_is(
    write: Callable[..., Path], tmp_path: Path, counted: list[str]
) -> None:
    path, out = write(), tmp_path / "out"
    ps.run(path, out, workers=0)
    count = len(counted)
    ps.run(path, out, workers=0)
    assert len(counted) == count
    path.write_text(path.read_text().replace("[0.03, 0.05]", "[0.03, 0.04]"))
    table = ps.run(path, out, workers=0)
    assert len(counted) == count + 8
    assert len(table) == count
    assert 0.05 not in table.column("layout.width").to_pylist()
    path.write_text(path.read_text().replace("[0.03, 0.04]", "[0.03, 0.05]"))
    ps.run(path, out, workers=0)  # it is still there
    assert len(counted) == count + 8


def test_an_end_in_the_middle_loses_only_what_was_going_on(
    write: Callable[..., Path], tmp_path: Path, counted: list[str], same: Callable[[Any], str]
) -> None:
    path, out = write(), tmp_path / "out"

    def stop(done: int) -> None:
        if len(counted) >= 8:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ps.run(path, out, workers=0, advance=stop)
    assert len(ps.load(out)) == 8
    table = ps.run(path, out, workers=0)
    assert len(counted) == len(set(counted)) == len(table)
    assert same(table) == same(ps.run(path, tmp_path / "undisturbed", workers=0))


def test_what_was_cut_off_or_is_something_else_or_of_another_version_is_told_and_done_again(
    write: Callable[..., Path], tmp_path: Path, counted: list[str], same: Callable[[Any], str]
) -> None:
    path, out = write(), tmp_path / "out"
    table = ps.run(path, out, workers=0)
    count = len(counted)
    cut, other, older = damaged = sorted((out / "parts").iterdir())[:3]
    lost = sum(len(pq.read_table(part)) for part in damaged)
    cut.write_bytes(cut.read_bytes()[:100])
    other.write_text("no table")
    pq.write_table(pq.read_table(older).drop_columns(["rank", "condition"]), older)
    (out / "tasks.parquet").write_text("no table")
    folder = Folder(out)
    assert folder.read_asked() == ("", set())
    assert len(folder.rows()) == count - lost
    assert set(folder.unreadable) == set(damaged)
    again = ps.run(path, out, workers=0)
    assert len(counted) == count + lost
    assert same(again) == same(table)
    assert Folder(out).read_asked()[0] == Plan(ps.read(path)).digest


def test_a_crash_while_writing_leaves_no_half_part(
    write: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = Folder(tmp_path)
    folder.open()

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        folder.add([{"key": "a", "failure": None}])
    assert not list((tmp_path / "parts").iterdir())
    assert folder.rows() == {}


FAILING = """
picture = { side = 0.1, step = 0.005 }
[[layouts]]
type = "lattice"
width = 0.02
[[patterns]]
type = "focus"
[[planes]]
z = [0.0, 0.1]
"""


def test_a_task_that_fails_is_a_row_which_only_retry_does_again(
    write: Callable[..., Path], tmp_path: Path, counted: list[str]
) -> None:
    path, out = write(FAILING), tmp_path / "out"
    bad, good = ps.run(path, out, workers=0).to_pylist()
    assert bad["failure"].startswith("PointOnTransducer")
    assert bad["plane.z"] == 0.0
    assert bad["error"] is None
    assert good["failure"] is None
    ps.run(path, out, workers=0)
    assert len(counted) == 2
    ps.run(path, out, workers=0, retry=True)
    assert counted[2:] == [bad["key"]]


def test_a_row_that_was_done_counts_more_than_one_that_failed(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    folder.open()
    for failure in ("worse", None, "bad"):
        folder.add([{"key": "a", "failure": failure}])
    assert folder.rows()["a"]["failure"] is None


def test_a_report_has_its_tables_failures_and_pictures(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    path, out = write('title = "Sparse"\n' + FAILING), tmp_path / "out"
    table = ps.run(path, out, workers=0)
    plan = Plan(ps.read(path))
    drawn: list[int] = []
    files = report.write(plan, table, out, lambda: drawn.append(1))
    text = (out / "report.md").read_text()
    assert text.startswith("# Sparse\n")
    assert "2 of 2 tasks are done, 1 of them failed" in text
    assert "1 x PointOnTransducer" in text
    assert "| lattice | 9 | 20 | 10 |" in text
    for name in MEASURES:
        assert charts.format_measure(name) in text
    assert len(drawn) == 2
    for file in files[1:]:
        assert f"({file.name})" in text
        assert file.read_bytes().startswith(b"\x89PNG")


def test_a_report_of_nothing_but_failures_is_one(
    write: Callable[..., Path], tmp_path: Path
) -> None:
    path, out = write(FAILING.replace("[0.0, 0.1]", "0.0")), tmp_path / "out"
    table = ps.run(path, out, workers=0)
    report.write(Plan(ps.read(path)), table, out)
    assert "1 of them failed" in (out / "report.md").read_text()


def test_a_folder_without_a_study_says_so(tmp_path: Path) -> None:
    with pytest.raises(pc.RecordingError, match="is not a table of a study"):
        ps.load(tmp_path)
    (tmp_path / "tasks.parquet").write_text("no table")
    with pytest.raises(pc.RecordingError, match="is not a table of a study"):
        ps.load(tmp_path)


def test_numbers_survive_the_folder_bit_by_bit(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    folder.open()
    rng = np.random.default_rng(0)
    row: dict[str, Any] = {name: float(rng.standard_normal()) for name in MEASURES}
    row |= {"key": "a", "failure": None, "error": math.nan, "condition": math.inf, "rank": 3}
    folder.add([row])
    kept = folder.rows()["a"]
    assert repr({name: kept[name] for name in row}) == repr(row)


MANY = """
picture = { side = 0.03, step = 0.01 }
layouts = [{ type = "lattice", width = 0.02, facing = [%s] }]
patterns = [{ type = "focus", name = "a | b" }]
"""


def test_of_many_layouts_the_first_are_drawn_and_the_report_says_so(
    write: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(images, "LAYOUTS", 2)
    monkeypatch.setattr(charts, "LAYOUTS", 2)
    monkeypatch.setattr(charts, "MESSAGES", dict(islice(charts.MESSAGES.items(), charts.ACROSS)))
    monkeypatch.setattr(charts, "AGAINST", charts.AGAINST[:1])
    path = write(MANY % "0.3, 0.4, 0.5")
    plan, out = Plan(ps.read(path)), tmp_path / "out"
    drawn: list[int] = []
    report.write(plan, ps.run(path, out, workers=0), out, lambda: drawn.append(1))
    assert len(drawn) == 2
    text = (out / "report.md").read_text()
    assert "Pictures show the first 2 of 3 layouts." in text
    assert text.count("| lattice facing=") == 3


def test_heights_below_the_plane_have_colours_of_their_own(
    write: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept: list[Any] = []
    monkeypatch.setattr(images, "save", lambda page, path: kept.append(page))
    text = MANY.replace("facing = [%s]", "fold = [-0.785, 0.785]")
    images.layouts(Plan(ps.read(write(text))), tmp_path / "it.png")
    for panel in kept[0].axes[:2]:
        (dots,) = panel.collections
        low, high = dots.get_clim()
        assert low <= dots.get_array().min() < dots.get_array().max() <= high


def test_nothing_in_a_name_is_taken_for_markdown() -> None:
    assert report._plain("a | *b*\n<c>") == r"a \| \*b\* \<c\>"
