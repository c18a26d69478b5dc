"""`pacinian bench`: measure the run time and the error of solvers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from pacinian.cli.options import FiniteRange
from pacinian_lab.commands.bench_batches import batches
from pacinian_lab.commands.bench_bus import bus
from pacinian_lab.commands.bench_devices import devices
from pacinian_lab.commands.bench_examples import examples
from pacinian_lab.commands.bench_expiry import expiry
from pacinian_lab.commands.bench_faults import faults, hostile
from pacinian_lab.commands.bench_footprint import footprint
from pacinian_lab.commands.bench_regions import regions
from pacinian_lab.commands.bench_scenes import scenes
from pacinian_lab.commands.bench_tick import tick
from pacinian_lab.commands.bench_view import view
from pacinian_lab.commands.shared import make_folder, print_tables

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from pacinian_lab.solvers.problems import BenchmarkProblem
    from pacinian_lab.solvers.rows import Row
    from pacinian_lab.solvers.worker_process import Worker


def several(kind: Callable[[str], Any]) -> Callable[..., list[Any] | None]:
    """Return a click callback that reads comma-separated values."""

    def read(context: click.Context, parameter: click.Parameter, text: str | None) -> Any:
        try:
            return None if text is None else [kind(part.strip()) for part in text.split(",")]
        except ValueError as error:
            raise click.BadParameter(f"{text!r} is no list of numbers: {error}") from error

    return read


@click.group(invoke_without_command=True)
@click.option("--quick", is_flag=True, help="Few problems, one thread; takes seconds.")
@click.option("--large", is_flag=True, help="Use 256 and 1024 points with 9 units instead.")
@click.option(
    "--solvers", callback=several(str), help="Of Pacinian's solvers, only these.  [default: all]"
)
@click.option(
    "--units", callback=several(int), help="AUTD units, square numbers.  [default: 1,4,9]"
)
@click.option("--points", callback=several(int), help="Numbers of points.  [default: 4,16,64]")
@click.option(
    "--levels",
    callback=several(float),
    help="2-norm of the targets, relative to the pressure of a single focus at full drive.  [default: 0.5,1.0]",
)
@click.option(
    "--seeds", type=click.IntRange(1), help="Number of problems of each kind.  [default: 3]"
)
@click.option(
    "--threads",
    callback=several(int),
    help="Thread limits to measure in turn.  [default: 1 and all]",
)
@click.option(
    "--seconds",
    type=FiniteRange(0.0, 600.0),
    help="Time to measure each solver on each problem.  [default: 0.1]",
)
@click.option(
    "--limit",
    type=FiniteRange(0.1),
    default=60.0,
    show_default=True,
    help="Give up a solver on a problem after this many seconds.",
)
@click.option(
    "--peers",
    is_flag=False,
    flag_value="",
    metavar="[DIR]",
    help="Also measure autd3, AcousTools and levitate in the environments that `.ci/peers` builds in DIR.",
)
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("bench"),
    show_default=True,
    help="Folder for bench.csv, bench.json and the pictures.",
)
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of tables.")
@click.pass_context
def bench(
    context: click.Context,
    /,
    quick: bool,
    large: bool,
    solvers: list[str] | None,
    threads: list[int] | None,
    limit: float,
    peers: str | None,
    out: Path,
    as_json: bool,
    **chosen: Any,
) -> None:
    """Measure run time against error of every solver.

    Solves random problems, cold and warm, with every installed solver. Each project runs in its own process, with
    one thread and with all threads. The same plain NumPy code evaluates all of them in double precision. Rows are
    written as they are measured, so Ctrl-C keeps them.
    """
    if context.invoked_subcommand is not None:
        _alone(context)
        return
    from pacinian.plugins.registry import discover_plugins
    from pacinian_lab.solvers import report, run
    from pacinian_lab.solvers.problems import LARGE, NORMAL, QUICK, problems

    preset = LARGE if large else QUICK if quick else NORMAL
    for name, value in preset._asdict().items():
        chosen[name] = value if chosen[name] is None else chosen[name]
    todo = problems(chosen["units"], chosen["points"], chosen["levels"], chosen["seeds"])
    for name in solvers or ():
        discover_plugins().find("solver", name)
    allowed = set(threads or ({1} if quick else {1, run.cores()}))
    if min(allowed) < 1:
        raise click.BadParameter("must be 1 or more", param_hint="--threads")
    workers = run.workers(sorted(allowed), _root(peers))
    make_folder(out, "--out")
    try:
        rows, interrupted = _measure(workers, solvers, todo, chosen["seconds"], limit, out)
    finally:
        for worker in workers:
            worker.close()
    found = report.plain(rows, workers, interrupted=interrupted, limit=limit, **chosen)
    (out / "bench.json").write_text(json.dumps(found), encoding="utf-8")
    files = [out / "bench.csv", out / "bench.json", *_draw(rows, out)]
    if as_json:
        click.echo(json.dumps({**found, "files": [str(file) for file in files]}))
    else:
        _print(rows)
        for file in files:
            click.echo(f"wrote {file}")
    if interrupted:
        raise SystemExit(130)


def _alone(context: click.Context) -> None:
    """Refuse options that stand before a subcommand, because the subcommand has its own."""
    for name in context.params:
        if context.get_parameter_source(name) is not ParameterSource.DEFAULT:
            raise click.UsageError(f"give options after `{context.invoked_subcommand}`, not before")


def _root(given: str | None) -> Path | None:
    """Return the folder of the peers' environments, or None if the user did not ask for peers."""
    from pacinian_lab.solvers import peers

    if given is None:
        return None
    root = Path(given) if given else peers.find_folder()
    missing = [peer for peer in peers.PEERS if peers.find_python(root, peer) is None]
    if len(missing) == len(peers.PEERS):
        raise click.UsageError(peers.describe_missing(root, missing))
    if missing:
        click.echo(peers.describe_missing(root, missing), err=True)
    return root


def _measure(
    workers: Sequence[Worker],
    solvers: Sequence[str] | None,
    todo: Sequence[BenchmarkProblem],
    seconds: float,
    limit: float,
    out: Path,
) -> tuple[list[Row], bool]:
    """Return the rows, and whether Ctrl-C interrupted the run."""
    from rich.console import Console
    from rich.progress import Progress

    from pacinian_lab.solvers import run
    from pacinian_lab.solvers.rows import Writer

    rows: list[Row] = []
    bar = Progress(console=Console(stderr=True), transient=True, refresh_per_second=2)
    with bar, Writer(out / "bench.csv") as writer:
        task = bar.add_task("starting", total=None)
        try:
            entries = run.entries(workers, solvers, bar.console.print)
            run.warm_up(entries)
            bar.update(task, total=len(entries) * len(todo))
            for row in run.measure(entries, todo, seconds, limit):
                writer.write(row)
                rows.append(row)
                done = f"N {row.N}, M {row.M}, level {row.level:g}"
                bar.update(task, advance=1, description=done)
        except KeyboardInterrupt:
            return rows, True
    return rows, False


def _draw(rows: Sequence[Row], out: Path) -> list[Path]:
    from pacinian.errors import MissingExtra
    from pacinian_lab.solvers.plots import draw
    from pacinian_lab.solvers.summary import cells

    try:
        return draw(cells(rows), out)
    except MissingExtra as error:
        click.echo(f"no pictures: {error}", err=True)
        return []


def _print(rows: Sequence[Row]) -> None:
    from rich.console import Console

    from pacinian_lab.solvers import tables
    from pacinian_lab.solvers.summary import cells, growth
    from pacinian_lab.solvers.targets import verdicts

    found = cells(rows)
    shown = [*tables.results(found), tables.updates(found), tables.resources(rows)]
    if lines := growth(found):
        shown.append(tables.exponents(lines))
    print_tables([*shown, tables.verdicts(verdicts(rows))])
    console = Console()
    for cell in found:
        if cell.note:
            place = f"N {cell.N}, M {cell.M}, level {cell.level:g}"
            console.print(f"- {cell.solver}, {place}: {cell.note}", highlight=False, markup=False)


for command in (
    scenes, tick, regions, batches, examples, bus, view, devices, expiry, footprint, faults, hostile
):  # fmt: skip
    bench.add_command(command)
