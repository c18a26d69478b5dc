"""`pacinian doctor`."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from pacinian.cli.options import CONNECTION
from pacinian.errors import replace_unprintable

if TYPE_CHECKING:
    from pacinian.cli.doctor_rules import Finding

COLOURS = {"ok": "green", "warning": "yellow", "problem": "bold red"}


@click.command()
@CONNECTION
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of lines.")
def doctor(connection: str | None, as_json: bool) -> None:
    """Find what is wrong here, and how to fix it.

    Examines this machine and its server. Changes nothing. Exit code 1 if there is a problem; warnings do not count.
    """
    from pacinian.cli.doctor_probes import examine

    report_findings(examine(connection), as_json)


def report_findings(findings: list[Finding], as_json: bool) -> None:
    """Print findings, as lines or as one JSON object. Exits with code 1 if there is a problem."""
    if as_json:
        click.echo(json.dumps({"findings": [asdict(f) for f in findings]}))
    else:
        print_findings(findings)
    if any(f.level == "problem" for f in findings):
        raise SystemExit(1)


def print_findings(findings: list[Finding]) -> None:
    """Print findings, one per line, each with its remedy."""
    from rich.console import Console
    from rich.markup import escape

    console = Console(highlight=False, soft_wrap=True)  # remedies are copied: no line may be broken
    for f in findings:
        level = f"[{COLOURS[f.level]}]{f.level:<8}[/]"
        # a device chooses some of the texts
        console.print(f"{level} {escape(replace_unprintable(f'{f.name}: {f.text}'))}")
        if f.fix:
            console.print(f"         -> {escape(replace_unprintable(f.fix))}")
    problems, warnings = (
        sum(f.level == level for f in findings) for level in ("problem", "warning")
    )
    summary = "no problem found" if not problems else f"problems to fix: {problems}"
    console.print(f"{summary}; warnings: {warnings}" if warnings else summary)
