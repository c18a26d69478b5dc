"""Run a study: compute the tasks that its folder lacks."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from pacinian.argument_checks import check_integer
from pacinian_lab.study.study_file import Study, read
from pacinian_lab.study.tasks import Plan
from pacinian_lab.study.worker import measure

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Mapping, Sequence

    from pacinian_lab.study.store import Table
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
    """Run the missing tasks of a study, and return the whole table, a pyarrow.Table.

    study: a study, its file, or its plan. out: the folder for the results, which are stored as they are computed, so
    that the same call resumes an interrupted run. workers: maximum number of local processes, by default one per
    core; 0 uses only this process. scheduler: the address of a Dask scheduler to use instead. retry: also run failed
    tasks again. dashboard: called with the address of Dask's dashboard of the local workers, which needs bokeh; None
    for no dashboard. advance: called with the number of tasks that have just finished.

    Local processes import the calling program, so guard it with `if __name__ == "__main__"`. Raises SceneFileError,
    ArgumentError, RecordingError, ServerError, MissingExtra, OSError.
    """
    from pacinian_lab.study.store import Folder

    plan = study if isinstance(study, Plan) else make_plan(study)
    if workers is not None:
        check_integer("workers", workers, low=0)
    folder = Folder(Path(out))
    with folder.lock():
        batches = todo(plan, folder.rows(), retry=retry)
        folder.set_aside_unreadable()
        folder.ask(plan)
        with closing(_work(plan, batches, workers, scheduler, dashboard)) as done:
            for rows in done:
                folder.add(rows)
                advance(len(rows))
        return folder.finish()


def load(out: str | Path) -> Table:
    """Return the pyarrow.Table of a study's folder: a row for each finished task, in order.

    Raises RecordingError, MissingExtra.
    """
    from pacinian_lab.study.store import Folder

    return Folder(Path(out)).join_table()


def make_plan(study: Study | str | Path) -> Plan:
    """Return the tasks of a study, or of its file. Raises SceneFileError."""
    if isinstance(study, Study):
        return Plan(study)
    return Plan(read(study), str(study))


def todo(plan: Plan, rows: Mapping[str, Row], *, retry: bool) -> list[Sequence[Task]]:
    """Return the batches of unfinished tasks; with `retry`, also of failed ones. rows: the measurements, by key."""
    done = {key for key, row in rows.items() if row["failure"] is None or not retry}
    return plan.batches(task.key for task in plan.tasks if task.key not in done)


def _work(
    plan: Plan,
    batches: Sequence[Sequence[Task]],
    workers: int | None,
    scheduler: str | None,
    dashboard: Callable[[str], object] | None,
) -> Generator[list[Row]]:
    """Yield the rows as they are computed."""
    if not batches:
        return
    if workers == 0 and scheduler is None:
        yield from (measure(plan.batch(tasks)) for tasks in batches)
        return
    from pacinian_lab.study import engine

    with engine.start(workers, scheduler, dashboard, len(batches)) as client:
        yield from engine.results(client, plan, batches)
