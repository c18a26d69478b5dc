"""`pacinian study`: layouts, planes, patterns and solvers, all with each other."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from pacinian_lab.study.store import Folder, Table
    from pacinian_lab.study.tasks import Plan


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
    help="Local processes; 0: none but this one.  [default: as many as cores]",
)
@click.option(
    "--scheduler", metavar="ADDRESS", help="A Dask scheduler instead, such as tcp://host:8786."
)
@click.option("--dashboard", is_flag=True, help="Dask's page of the local processes; needs bokeh.")
@click.option("--retry", is_flag=True, help="Do what failed before again.")
@click.option("--no-pictures", is_flag=True, help="Only the table.")
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
    """Sweep layouts, planes, patterns, solvers and levels: how an arrangement shapes the image.

    Results are kept as they come: after Ctrl-C, a crash or a change of FILE the same command does what is missing,
    and nothing else. docs/studies.md has the format and what is measured. Exit code 1 if a task failed.
    """
    if schema:
        from pacinian_lab.study.file import schema as schema_of

        click.echo(json.dumps(schema_of(), indent=2))
        return
    if file is None:
        raise click.UsageError("Missing argument 'FILE'.")
    from pacinian_lab.study.store import Folder
    from pacinian_lab.study.work import planned, todo

    if scheduler is not None and (workers is not None or dashboard):
        raise click.UsageError(
            "--workers and --dashboard are of local processes: leave --scheduler out"
        )
    plan = planned(file)
    folder = Folder(out or Path(file.stem))
    missing = sum(map(len, todo(plan, folder, retry=retry)))
    if listed:
        _list(plan, folder, missing, as_json=as_json)
        return
    _changes(plan, folder, missing)
    table = _run(
        plan, folder, missing, workers=workers, scheduler=scheduler, retry=retry,
        dashboard=_page if dashboard else None,
    )  # fmt: skip
    files = [folder.path / "results.parquet"]
    if not no_pictures:
        files += _report(plan, table, folder)
    failures = len(table) - table.column("failure").null_count
    if as_json:
        told = {"tasks": len(table), "done_now": missing, "failures": failures}
        click.echo(json.dumps({**told, "files": [str(made) for made in files]}))
    else:
        click.echo(f"{len(table)} tasks, {missing} of them done now, {failures} failed")
        for made in files:
            click.echo(f"wrote {made}")
    if failures:
        raise SystemExit(1)


def _list(plan: Plan, folder: Folder, missing: int, *, as_json: bool) -> None:
    from pacinian_lab.study.store import described

    rows, done = [described(task) for task in plan.tasks], folder.rows()
    if as_json:
        click.echo(json.dumps({"tasks": rows, "missing": missing}))
        return
    for row in rows:
        mark = " " if row["key"] not in done else "-" if done[row["key"]]["failure"] else "+"
        names = ("layout", "plane", "pattern", "solver")
        click.echo(f"{mark} {' | '.join(row[name] for name in names)} | level {row['level']:g}")
    click.echo(f"{len(rows)} tasks, {missing} to do (+ done, - failed)")


def _changes(plan: Plan, folder: Folder, missing: int) -> None:
    """Say what of the folder is still good."""
    before, keys = folder.asked()
    for problem in folder.unreadable:
        click.echo(f"its tasks are done again: {problem}", err=True)
    if before and before != plan.digest:
        now = {task.key for task in plan.tasks}
        click.echo(
            f"the study has changed: {len(now - keys)} tasks are new, {len(keys - now)} no longer asked",
            err=True,
        )
    if kept := len(plan.tasks) - missing:
        click.echo(f"{kept} of {len(plan.tasks)} tasks were done before", err=True)


def _run(plan: Plan, folder: Folder, missing: int, **how: Any) -> Table:
    from rich.console import Console
    from rich.progress import MofNCompleteColumn, Progress

    from pacinian_lab.study.work import run

    columns = (*Progress.get_default_columns(), MofNCompleteColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("tasks", total=missing)
        try:
            return run(plan, folder.path, advance=lambda done: bar.advance(task, done), **how)
        except KeyboardInterrupt:
            bar.stop()
            click.echo("what is done is kept: the same command goes on", err=True)
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
    click.echo(f"Dask's page: {link}", err=True)
