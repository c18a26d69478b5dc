"""A study, done: what is missing in its folder is computed, and nothing else."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from pacinian.checks import check_integer
from pacinian_lab.study.file import Study, read
from pacinian_lab.study.store import Folder, Table
from pacinian_lab.study.tasks import Plan
from pacinian_lab.study.worker import measure

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence

    from pacinian_lab.study.tasks import Task
    from pacinian_lab.study.worker import Row


def run(
    study: Study | Plan | str | Path,
    out: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    retry: bool = False,
    dashboard: Callable[[str], object] | None = None,
    advance: Callable[[int], object] = lambda done: None,
) -> Table:
    """Do what is not done yet of a study; return the table of all of it, a pyarrow.Table.

    study: or its file, or its plan. out: the folder that keeps results, part by part as they come: the same call goes
    on where it was stopped. workers: local processes at most, as many as cores unless given; 0 for none but this one.
    scheduler: the address of a Dask scheduler instead. retry: also what failed before.
    dashboard: told where Dask's page of the local processes is, which needs bokeh; none unless given.
    advance: told how many tasks were done at once.

    Local processes import the program that calls this: guard it with `if __name__ == "__main__"`.
    Raises SceneFileError, ArgumentError, ServerError, MissingExtra, OSError.
    """
    plan = study if isinstance(study, Plan) else planned(study)
    if workers is not None:
        check_integer("workers", workers, low=0)
    folder = Folder(Path(out))
    folder.open()
    batches = todo(plan, folder, retry=retry)
    folder.ask(plan)
    with closing(_work(plan, batches, workers, scheduler, dashboard)) as done:
        for rows in done:
            folder.add(rows)
            advance(len(rows))
    return folder.finish()


def load(out: str | Path) -> Table:
    """The pyarrow.Table of a study's folder: a row for each task that is done, in order. Raises RecordingError."""
    return Folder(Path(out)).table()


def planned(study: Study | str | Path) -> Plan:
    """The tasks of a study, or of its file. Raises SceneFileError."""
    if isinstance(study, Study):
        return Plan(study)
    return Plan(read(study), str(study))


def todo(plan: Plan, folder: Folder, *, retry: bool = False) -> list[Sequence[Task]]:
    """The batches that are not done yet; with `retry` also what failed."""
    done = {key for key, row in folder.rows().items() if row["failure"] is None or not retry}
    return plan.batches(task.key for task in plan.tasks if task.key not in done)


def _work(
    plan: Plan,
    batches: Sequence[Sequence[Task]],
    workers: int | None,
    scheduler: str | None,
    dashboard: Callable[[str], object] | None,
) -> Generator[list[Row]]:
    """Rows as they come."""
    if not batches:
        return
    if workers == 0 and scheduler is None:
        yield from (measure(plan.batch(tasks)) for tasks in batches)
        return
    from pacinian_lab.study import engine

    with engine.start(workers, scheduler, dashboard, len(batches)) as client:
        yield from engine.results(client, plan, batches)
