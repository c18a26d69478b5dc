"""`pacinian plugins`."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from pacinian.plugins.registry import Offer


@click.command()
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of a table.")
def plugins(as_json: bool) -> None:
    """List solvers and backends: their settings and where they come from.

    A plug-in that does not load is named with the reason; the exit code is then 1.
    """
    from pacinian.plugins.registry import installed

    found = installed()
    offers = found.list()
    if as_json:
        failed = {name: str(error) for name, error in found.failed.items()}
        click.echo(json.dumps({"plugins": [_plain(o) for o in offers], "failed": failed}))
    else:
        _table(offers)
        for error in found.failed.values():
            click.echo(str(error), err=True)
    if found.failed:
        raise SystemExit(1)


def _plain(offer: Offer) -> dict[str, Any]:
    options = {
        k: None if v is ... else v if _simple(v) else repr(v) for k, v in offer.options.items()
    }
    return {
        "kind": offer.kind,
        "name": offer.name,
        "options": options,
        "summary": _summary(offer),
        "from": offer.distribution,
    }


def _table(offers: list[Offer]) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    for column in ("kind", "name", "settings", "what", "from"):
        table.add_column(column, overflow="fold")
    for offer in offers:
        settings = ", ".join(
            f"{k}={v!r}" if v is not ... else k for k, v in offer.options.items() if _simple(v)
        )
        table.add_row(offer.kind, offer.name, settings, _summary(offer), offer.distribution)
    Console().print(table)


def _simple(value: object) -> bool:
    return value is None or value is ... or isinstance(value, (bool, int, float, str))


def _summary(offer: Offer) -> str:
    return (offer.cls.__doc__ or "").strip().partition("\n")[0]
