"""`pacinian bench examples`: the peers' own haptic examples, made by them and by Pacinian."""

from __future__ import annotations

from pathlib import Path

import click

from pacinian.cli.options import FiniteRange
from pacinian_lab.commands.shared import print_tables


@click.command()
@click.option(
    "--peers", metavar="DIR", help="Folder in which `.ci/peers` built the peers' environments."
)
@click.option(
    "--threads",
    type=click.IntRange(1),
    default=1,
    show_default=True,
    help="Threads of each package.",
)
@click.option(
    "--seconds", type=FiniteRange(0.0, 60.0), default=0.5, show_default=True,
    help="Time to measure each way of making each example.",
)  # fmt: skip
@click.option("--markdown", is_flag=True, help="One table in Markdown.")
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of tables.")
def examples(
    peers: str | None, threads: int, seconds: float, markdown: bool, as_json: bool
) -> None:
    """Make the peers' own haptic examples, by them and by Pacinian, and compare time and field.

    The peaks near the foci are searched in a field that is computed by code no solver uses. docs/comparison.md explains
    the figures.
    """
    import msgspec
    from rich.console import Console

    from pacinian_lab.examples import run, tables
    from pacinian_lab.examples.examples import make_examples
    from pacinian_lab.examples.score import score
    from pacinian_lab.solvers import peers as environments
    from pacinian_lab.solvers.run import workers as make_workers

    root = Path(peers) if peers else environments.find_folder()
    missing = [peer for peer in environments.PEERS if environments.find_python(root, peer) is None]
    if missing:
        click.echo(environments.describe_missing(root, missing), err=True)
    todo = make_examples()
    workers = make_workers([threads], root, run.WORKERS)
    try:
        report = Console(stderr=True).print
        rows = list(run.measure(workers, todo, seconds, report))
    finally:
        for worker in workers:
            worker.close()
    if as_json:
        versions = {name: at for worker in workers for name, at in worker.versions.items()}
        by_name = {example.name: example for example in todo}
        plain = [
            {k: v for k, v in row._asdict().items() if k != "gains"}
            | vars(score(by_name[row.example], row.gains))
            for row in rows
        ]
        # msgspec writes NaN as null
        click.echo(msgspec.json.encode({"versions": versions, "rows": plain}))
    elif markdown:
        click.echo(tables.write_markdown(rows, todo))
    else:
        print_tables(tables.tabulate(rows, todo))
