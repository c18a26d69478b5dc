"""`pacinian plugins`."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from pacinian.plugins.registry import Offer


@click.command()
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of text.")
def plugins(as_json: bool) -> None:
    """List solvers, backends and commands.

    Also prints their settings and origin. Names plug-ins that do not load, and those with a name that is taken, with
    the reason. The exit code is then 1.
    """
    from pacinian.errors import PluginError
    from pacinian.plugins.registry import discover_plugins

    found = discover_plugins()
    found.load()
    root = click.get_current_context().find_root().command
    own = root.commands if isinstance(root, click.Group) else {}
    hidden = {
        name: PluginError(
            f"plug-in {offer.plugin!r} ({offer.distribution}) offers the command {name!r}, which Pacinian itself has: "
            "give it another name"
        )
        for name, offer in found.commands.items()
        if name in own
    }
    broken = {**found.problems, **hidden}
    offers = [found.offers[key] for key in sorted(found.offers) if key[1] not in found.clashes]
    commands = [
        {
            "name": name,
            "summary": offer.command.get_short_help_str(limit=100),
            "from": offer.distribution,
        }
        for name, offer in sorted(found.commands.items())
        if name not in own
    ]
    if as_json:
        failed = {name: str(error) for name, error in broken.items()}
        listed = {"plugins": [_plain(o) for o in offers], "commands": commands, "failed": failed}
        click.echo(json.dumps(listed))
    else:
        _print(offers, commands)
        for error in broken.values():
            click.echo(str(error), err=True)
    if broken:
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


def _print(offers: list[Offer], commands: list[dict[str, str]]) -> None:
    """Print all at once: then `pacinian plugins | head -1` does not end as if a plug-in had not loaded."""
    from rich.console import Console

    console = Console(highlight=False, soft_wrap=True)
    with console.capture() as text:
        for offer in offers:
            console.print(f"[bold]{offer.name}[/bold]  {offer.kind}, from {offer.distribution}")
            console.print(f"    {_summary(offer)}", markup=False)
            options = offer.options.items()
            settings = [k if v is ... else f"{k}={v!r}" for k, v in options if _simple(v)]
            if settings:
                console.print(f"    settings: {', '.join(settings)}", markup=False)
        for command in commands:
            console.print(f"{command['name']}  command, from {command['from']}", markup=False)
            console.print(f"    {command['summary']}", markup=False)
    click.echo(text.get(), nl=False)


def _simple(value: object) -> bool:
    return value is None or value is ... or isinstance(value, (bool, int, float, str))


def _summary(offer: Offer) -> str:
    return (offer.cls.__doc__ or "").strip().partition("\n")[0]
