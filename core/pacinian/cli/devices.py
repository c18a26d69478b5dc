"""`pacinian devices`: what is connected, and whether it is what a description says."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pacinian.cli.device_calibrate import calibrate
from pacinian.cli.doctor_rules import RIGHTS
from pacinian.cli.run_output import drawable

if TYPE_CHECKING:
    from pacinian.cli.doctor_rules import Finding
    from pacinian.devices.description import DeviceDescription
    from pacinian.plugins.backend import Found

FILE = click.argument("file", type=click.Path(path_type=Path))
JSON = click.option("--json", "as_json", is_flag=True, help="One JSON object instead of text.")
ADVICE = {
    "linux": f"Rights: {RIGHTS}.",
    "win32": "Driver: give the device WinUSB with Zadig (https://zadig.akeo.ie): Options, List All Devices, "
    "choose it by its name, never a keyboard or a hub.",
    "darwin": "macOS needs no driver and no rights for USB; a serial port must be free of other programs.",
}


@click.group(invoke_without_command=True)
@click.option("--backend", default="", help="Ask this backend only, and import no other.")
@JSON
@click.pass_context
def devices(context: click.Context, backend: str, as_json: bool) -> None:
    """List the devices that are connected; or check, draw or calibrate a description of one.

    Opens none of them and changes nothing. Exit code 1 if one that is connected cannot be used, or the backend that is
    named cannot look; 2 if there is no such backend, or it does not load; else 0, also where nothing is connected.
    """
    if context.invoked_subcommand:
        return
    from pacinian.plugins.discovery import list_connected
    from pacinian.plugins.registry import installed

    found = list_connected(installed(), backend)
    if as_json:
        click.echo(json.dumps({"devices": [asdict(f) for f in found]}))
    else:
        _list(found)
    if any(f.problem and (f.title or backend) for f in found):
        raise SystemExit(1)


def _list(found: list[Found]) -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    console = Console(highlight=False, soft_wrap=True)
    table = Table(box=None, pad_edge=False)
    for name in ("backend", "serial", "device", "state"):
        table.add_column(name, overflow="fold")
    for f in found:
        bad = "[red]cannot be used[/]" if f.title else "[yellow]cannot be looked for[/]"
        state = bad if f.problem else "[green]ready[/]"
        table.add_row(f.backend, escape(f.serial) or "-", escape(f.title) or "-", state)
    if found:
        console.print(table)
    if not any(f.title for f in found):
        console.print("no device is connected; `simulated` needs none")
    problems = [f for f in found if f.problem]
    for f in problems:
        name = f"{f.backend} {f.serial}".strip()
        console.print(f"{name}: {f.problem}", markup=False)
    if problems or not found:
        console.print(ADVICE.get(sys.platform, ADVICE["linux"]), markup=False)


devices.add_command(calibrate)


@devices.command()
@FILE
@click.option("--offline", is_flag=True, help="Check the file alone; do not look for its boards.")
@JSON
def check(file: Path, offline: bool, as_json: bool) -> None:
    """Check a device description: boards, places, dead transducers, levels, and what is connected.

    Exit code 1 if anything is a problem; warnings are none.
    """
    from pacinian.cli.device_findings import calibration, described
    from pacinian.cli.doctor import tell
    from pacinian.devices.calibration import read_calibration
    from pacinian.devices.description import DeviceDescription

    device = DeviceDescription.load(file)
    findings = described(device)
    if device.calibration:
        findings.append(calibration(device, read_calibration(file.parent / device.calibration)))
    if not offline:
        findings += _looked(device)
    if as_json:
        click.echo(json.dumps({"findings": [asdict(f) for f in findings]}))
    else:
        tell(findings)
    if any(f.level == "problem" for f in findings):
        raise SystemExit(1)


def _looked(device: DeviceDescription) -> list[Finding]:
    """What the backend and the devices tell."""
    from pacinian.cli.device_findings import connected, levels
    from pacinian.plugins import discovery, registry

    found = connected(device, discovery.list_connected(registry.installed(), device.backend))
    if device.backend:
        found.insert(0, levels(device, registry.backend(device.backend).capability))
    return found


@devices.command()
@FILE
@click.option("--out", default="device.png", show_default=True, callback=drawable)
def draw(file: Path, out: str) -> None:
    """Draw a device description: boards where they are, the order of their channels, what is dead."""
    from pacinian.devices.description import DeviceDescription
    from pacinian.plot.boards import boards
    from pacinian.plot.page import save

    save(boards(DeviceDescription.load(file), file.name), out)
    click.echo(out)


@devices.command()
def udev() -> None:
    """Print the udev rule (Linux) that gives whoever sits at the machine the right to its arrays.

    Its file must sort below 73: 72-pacinian.rules.
    """
    from pacinian.cli.udev import make_rules
    from pacinian.plugins.registry import installed

    click.echo(make_rules(installed()), nl=False)


@devices.command()
def schema() -> None:
    """Print the JSON Schema of device descriptions."""
    from pacinian.devices.description import schema as made

    click.echo(json.dumps(made(), indent=2))
