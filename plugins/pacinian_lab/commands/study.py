"""`pacinian study`: evaluate all combinations of layouts, planes, patterns and solvers."""

from __future__ import annotations

import json
import math
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from pacinian_lab.study.store import Folder, Table
    from pacinian_lab.study.tasks import Plan
    from pacinian_lab.study.worker import Row

MAX_REASONS = 5  # largest number of reasons that are printed why tasks failed


@click.command()
@click.argument("file", type=click.Path(path_type=Path), required=False)
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    help="Folder for results, report and pictures.  [default: the file's name]",
)
@click.option("--list", "listed", is_flag=True, help="Show the tasks and their number; do nothing.")
@click.option(
    "--workers",
    type=click.IntRange(0),
    help="Number of local worker processes; 0: use only this one.  [default: one per core]",
)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Use this Dask scheduler instead, such as tcp://host:8786.",
)
@click.option(
    "--dashboard", is_flag=True, help="Serve Dask's dashboard of the local workers; needs bokeh."
)
@click.option("--retry", is_flag=True, help="Run failed tasks again.")
@click.option("--no-pictures", is_flag=True, help="Write only the table.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of text.")
@click.option("--schema", is_flag=True, help="Print the JSON Schema of study files.")
def study(
    file: Path | None,
    out: Path | None,
    listed: bool,
    workers: int | None,
    scheduler: str | None,
    dashboard: bool,
    retry: bool,
    no_pictures: bool,
    as_json: bool,
    schema: bool,
) -> None:
    """Sweep array layouts over patterns and solvers.

    Shows how the arrangement of an array shapes the image. Results are kept as they are computed. After Ctrl-C, a crash
    or a change of FILE, the same command runs only the missing tasks. docs/studies.md describes the format and the
    measures. Exit code 1 if a task failed.
    """
    if schema:
        from pacinian_lab.study.study_file import schema as schema_of

        click.echo(json.dumps(schema_of(), indent=2))
        return
    if file is None:
        raise click.UsageError("Missing argument 'FILE'.")
    from pacinian_lab.study.study_run import make_plan, todo

    if scheduler is not None and (workers is not None or dashboard):
        raise click.UsageError(
            "--workers and --dashboard apply to local workers only: leave --scheduler out"
        )
    plan, place = make_plan(file), out or Path(file.stem)
    if listed:
        _list(plan, place, retry=retry, as_json=as_json)
        return
    from pacinian_lab.study.store import Folder

    folder = Folder(place)
    missing = sum(map(len, todo(plan, folder.rows(), retry=retry)))
    _changes(plan, folder, missing)
    table = _run(
        plan, folder, missing, workers=workers, scheduler=scheduler, retry=retry,
        dashboard=_page if dashboard else None,
    )  # fmt: skip
    files = [folder.path / "results.parquet"]
    if not no_pictures:
        files += _report(plan, table, folder)
    elif (old := folder.path / "report.md").exists():
        click.echo(f"{old} and its pictures are of an earlier run", err=True)
    failures = len(table) - table.column("failure").null_count
    if as_json:
        result = {"tasks": len(table), "done_now": missing, "failures": failures}
        click.echo(json.dumps({**result, "files": [str(made) for made in files]}))
    else:
        click.echo(f"{len(table)} tasks, {missing} of them run now, {failures} failed")
        for made in files:
            click.echo(f"wrote {made}")
    if failures:
        reasons = Counter(filter(None, table.column("failure").to_pylist()))
        for reason, count in reasons.most_common(MAX_REASONS):
            click.echo(f"{count} failed: {reason}", err=True)
        if len(reasons) > MAX_REASONS:
            click.echo(f"and {len(reasons) - MAX_REASONS} other reasons", err=True)
        raise SystemExit(1)


def _list(plan: Plan, folder: Path, *, retry: bool, as_json: bool) -> None:
    """Print the tasks. Only results that are there need the extra `study`."""
    from pacinian_lab.study.study_run import todo
    from pacinian_lab.study.tasks import describe_task

    done: dict[str, Row] = {}
    if folder.exists():
        from pacinian_lab.study.store import Folder

        done = Folder(folder).rows()
    missing = sum(map(len, todo(plan, done, retry=retry)))
    rows = [describe_task(task) for task in plan.tasks]
    if as_json:
        for row in rows:  # JSON has no infinity: write it as in the study's file
            row["level"] = "inf" if row["level"] == math.inf else row["level"]
        click.echo(json.dumps({"tasks": rows, "missing": missing}, allow_nan=False))
        return
    for row in rows:
        mark = " " if row["key"] not in done else "-" if done[row["key"]]["failure"] else "+"
        names = ("layout", "plane", "pattern", "solver")
        click.echo(f"{mark} {' | '.join(row[name] for name in names)} | level {row['level']:g}")
    click.echo(f"{len(rows)} tasks, {missing} to do (+ done, - failed)")


def _changes(plan: Plan, folder: Folder, missing: int) -> None:
    """Print which results in the folder are still valid."""
    before, keys = folder.read_asked()
    for part, problem in folder.unreadable.items():
        click.echo(f"cannot read results, so their tasks run again: {part}: {problem}", err=True)
    if before and before != plan.digest:
        now = {task.key for task in plan.tasks}
        click.echo(
            f"the study has changed: {len(now - keys)} tasks are new, {len(keys - now)} no longer needed",
            err=True,
        )
    if kept := len(plan.tasks) - missing:
        click.echo(f"{kept} of {len(plan.tasks)} tasks were done before", err=True)


def _run(plan: Plan, folder: Folder, missing: int, **how: Any) -> Table:
    from rich.console import Console
    from rich.progress import MofNCompleteColumn, Progress

    from pacinian_lab.study.study_run import run

    columns = (*Progress.get_default_columns(), MofNCompleteColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("tasks", total=missing)
        try:
            return run(plan, folder.path, advance=lambda done: bar.advance(task, done), **how)
        except KeyboardInterrupt:
            bar.stop()
            click.echo("finished tasks are kept: run the same command to continue", err=True)
            raise


def _report(plan: Plan, table: Table, folder: Folder) -> list[Path]:
    from rich.console import Console
    from rich.progress import Progress

    from pacinian.errors import MissingExtra
    from pacinian_lab.study import images, report

    try:
        with Progress(console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task(
                "images", total=sum(len(row) for tasks in images.pages(plan) for row in tasks)
            )
            return report.write(plan, table, folder.path, lambda: bar.advance(task))
    except MissingExtra as error:
        click.echo(f"no pictures: {error}", err=True)
        return []


def _page(link: str) -> None:
    click.echo(f"Dask's dashboard: {link}", err=True)
