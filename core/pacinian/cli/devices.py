"""`pacinian devices`: lists connected devices and checks device descriptions."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pacinian.cli.device_calibrate import calibrate
from pacinian.cli.doctor_rules import UDEV_FIX
from pacinian.cli.options import TEXT, NonEmptyPath
from pacinian.cli.run_output import check_picture_path
from pacinian.errors import replace_unprintable

if TYPE_CHECKING:
    from pacinian.cli.doctor_rules import Finding
    from pacinian.devices.description import DeviceDescription
    from pacinian.plugins.backend import FoundDevice

FILE = click.argument("file", type=NonEmptyPath(path_type=Path))
JSON = click.option("--json", "as_json", is_flag=True, help="One JSON object instead of text.")
ADVICE = {
    "linux": f"Rights: {UDEV_FIX}.",
    "win32": "Driver: install WinUSB for the device with Zadig (https://zadig.akeo.ie): Options, List All Devices, "
    "then select it by its name. Never select a keyboard or a hub.",
    "darwin": "macOS needs no driver and no rights for USB; a serial port must be free of other programs.",
}


@click.group(invoke_without_command=True)
@click.option(
    "--backend", type=TEXT, default=None, help="Ask only this backend, and import no other."
)
@JSON
@click.pass_context
def devices(context: click.Context, backend: str | None, as_json: bool) -> None:
    """List, check, draw or calibrate devices.

    Without a subcommand, lists the connected devices. The subcommands work on the description of a device. Opens no
    device and changes nothing. Exit code 1 if a connected device cannot be used, or if the backend given with --backend
    cannot search; 2 if that backend does not exist or does not load; otherwise 0, even if no device is connected.
    """
    if context.invoked_subcommand:
        return
    from pacinian.plugins.device_discovery import list_connected
    from pacinian.plugins.registry import discover_plugins

    found = list_connected(discover_plugins(), backend or "")
    if as_json:
        click.echo(json.dumps({"devices": [asdict(f) for f in found]}))
    else:
        _list(found)
    if any(f.problem and (f.title or backend) for f in found):
        raise SystemExit(1)


def _list(found: list[FoundDevice]) -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    console = Console(highlight=False, soft_wrap=True)
    table = Table(box=None, pad_edge=False)
    for name in ("backend", "serial", "device", "state"):
        table.add_column(name, overflow="fold")
    for f in found:
        bad = "[red]cannot be used[/]" if f.title else "[yellow]search failed[/]"
        state = bad if f.problem else "[green]ready[/]"
        texts = f.backend, f.serial or "-", f.title or "-"  # a device chooses some of them
        table.add_row(*(escape(replace_unprintable(text)) for text in texts), state)
    if found:
        console.print(table)
    if not any(f.title for f in found):
        console.print("no device is connected; `simulated` needs none")
    problems = [f for f in found if f.problem]
    for f in problems:
        name = f"{f.backend} {f.serial}".strip()
        console.print(replace_unprintable(f"{name}: {f.problem}"), markup=False)
    if problems or not found:
        console.print(ADVICE.get(sys.platform, ADVICE["linux"]), markup=False)


devices.add_command(calibrate)


@devices.command()
@FILE
@click.option("--offline", is_flag=True, help="Check only the file; do not search for its boards.")
@JSON
def check(file: Path, offline: bool, as_json: bool) -> None:
    """Check a device description: boards, places, dead transducers, levels, and connected devices.

    Exit code 1 if there is a problem; warnings do not count.
    """
    from pacinian.cli.device_check_rules import check_calibration, check_description
    from pacinian.cli.doctor import report_findings
    from pacinian.devices.calibration import read_calibration
    from pacinian.devices.description import DeviceDescription

    device = DeviceDescription.load(file)
    findings = check_description(device)
    if device.calibration:
        findings.append(
            check_calibration(device, read_calibration(file.parent / device.calibration))
        )
    if not offline:
        findings += _check_online(device)
    report_findings(findings, as_json)


def _check_online(device: DeviceDescription) -> list[Finding]:
    """Check the description against its backend and the connected devices."""
    from pacinian.cli.device_check_rules import check_connected, check_levels
    from pacinian.plugins import device_discovery, registry

    found = check_connected(
        device, device_discovery.list_connected(registry.discover_plugins(), device.backend)
    )
    if device.backend:
        capability = registry.read_capability(registry.backend(device.backend))
        found.insert(0, check_levels(device, capability))
    return found


@devices.command()
@FILE
@click.option(
    "--out", type=TEXT, default="device.png", show_default=True, callback=check_picture_path
)
def draw(file: Path, out: str) -> None:
    """Draw a device description: the poses of the boards, the order of their channels, and dead channels."""
    from pacinian.devices.description import DeviceDescription
    from pacinian.plot.boards import boards
    from pacinian.plot.page import save

    save(boards(DeviceDescription.load(file), file.name), out)
    click.echo(out)


@devices.command()
def udev() -> None:
    """Print the udev rules (Linux) that let the user at the machine open its arrays.

    The name of the file must sort below 73: use 72-pacinian.rules.
    """
    from pacinian.cli.udev import make_rules
    from pacinian.plugins.registry import discover_plugins

    click.echo(make_rules(discover_plugins()), nl=False)


@devices.command()
def schema() -> None:
    """Print the JSON Schema of device descriptions."""
    from pacinian.devices.description import schema as made

    click.echo(json.dumps(made(), indent=2))
