"""`pacinian devices calibrate`: computes strengths and phases of the channels from a microphone scan."""

from __future__ import annotations

import json
from dataclasses import asdict
from functools import reduce
from operator import add
from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from pacinian.cli.doctor_rules import Finding

if TYPE_CHECKING:
    from pacinian.devices.calibration import Measured
    from pacinian.devices.scan import Scan
    from pacinian.devices.scan_fit import ScanFit

MISFIT = 0.5  # residual at a position, relative to the expected rms there, above which it is named
VAGUE = 10.0  # standard error of phases that costs 3 % of a focus [deg]
MAX_LISTED = 8  # items listed in one finding


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.argument("scans", type=click.Path(path_type=Path), nargs=-1, required=True)
@click.option(
    "--out", default=Path("calibration.csv"), show_default=True, type=click.Path(path_type=Path)
)
@click.option("--temperature", type=float, help="Temperature of the air [degC]; fitted by default.")
@click.option(
    "--position-error", default=0.001, show_default=True, type=float,
    help="Standard error of the microphone's coordinates [m], which the fit corrects.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of text.")
def calibrate(
    file: Path,
    scans: tuple[Path, ...],
    out: Path,
    temperature: float | None,
    position_error: float,
    as_json: bool,
) -> None:
    """Compute a calibration from a description FILE and microphone SCANS.

    A scan is a CSV file with the columns x,y,z,serial,channel,amplitude,phase ([m], any unit, [rad]) of channels driven
    one at a time, or an NPZ file with positions, drives and readings. It needs at least 6 positions of the microphone,
    better 12, at different heights. The result replaces all strengths, phases and dead channels of FILE. This command
    drives no device; docs/devices.md explains how to measure.
    """
    from pacinian.acoustics.air import Air
    from pacinian.cli.doctor import tell
    from pacinian.devices.calibration import write_calibration
    from pacinian.devices.scan import read_scan, undo_calibration
    from pacinian.devices.scan_fit import fit_scan

    given = {path.resolve() for path in (file, *scans)}
    if out.suffix != ".csv" or out.resolve() in given or not out.parent.is_dir():
        raise click.BadParameter(
            f"{out} must end in .csv, be in an existing folder, and be none of the input files"
        )
    if len(given) <= len(scans):
        raise click.BadParameter("a file is given twice, so its readings would count twice")
    device = undo_calibration(file)
    scan = reduce(add, (read_scan(path, device) for path in scans))
    speed = None if temperature is None else Air(temperature=temperature).speed_of_sound
    order = np.concatenate([w.indices for w in device.wiring])  # channels to transducers
    fit = fit_scan(
        device.array(),
        scan.positions,
        scan.readings[:, np.argsort(order)],
        position_error=position_error,
        speed_of_sound=speed,
    )
    keys = [(w.serial, int(c)) for w in device.wiring for c in w.channels]
    measured: Measured = {
        key: (float(np.abs(fit.responses[n])), float(np.angle(fit.responses[n])))
        for key, n in zip(keys, order, strict=True)
        if not fit.unseen[n]
    }
    write_calibration(out, measured)
    names = [" ".join(map(str, keys[i])).strip() for i in np.argsort(order)]  # of transducers
    findings = _findings(fit, scan, names, device.transducer.pressure)
    if as_json:
        told = {
            "out": str(out),
            "findings": [asdict(f) for f in findings],
            "channels": [
                dict(
                    zip(
                        ("serial", "channel", "gain", "phase"), (*key, *measured[key]), strict=True
                    ),
                    error=float(fit.errors[n]),
                )
                for key, n in zip(keys, order, strict=True)
                if key in measured
            ],
        }
        click.echo(json.dumps(told))
    else:
        tell(findings)
        click.echo(f"{out}: {len(measured)} channels; set it as `calibration` in {file}")


def _findings(fit: ScanFit, scan: Scan, names: list[str], pressure: float) -> list[Finding]:
    """Return the findings of a fit. names: names of the transducers. pressure: pressure of their kind [Pa m]."""
    from pacinian.acoustics.air import Air

    good = ~fit.dead & ~fit.unseen
    s, errors = fit.responses[good], fit.errors[good]
    moved = 1e3 * np.linalg.norm(fit.positions - scan.positions, axis=1)  # [mm]
    room = Air(temperature=20.0).speed_of_sound
    air = 293.15 * (fit.speed_of_sound / room) ** 2 - 273.15  # [degC]
    scatter = np.degrees(np.sqrt(np.mean(np.angle(np.where(s.real < 0.0, -s, s)) ** 2)))
    mean, worst = np.degrees(np.sqrt(np.mean(errors**2))), np.degrees(errors.max())
    before = np.abs(s.sum()) ** 2 / np.abs(s).sum() ** 2
    told = {
        "fit": f"{fit.residual:.1%} of a typical reading is not explained; {fit.outliers} outliers",
        "air": f"{fit.speed_of_sound:.2f} m/s, give or take {fit.speed_error:.2f}: {air:.0f} degC",
        "microphone": f"corrected by {moved.mean():.2f} mm in the mean, {moved.max():.2f} mm at most",
        "strength": f"{np.abs(s).min():.2f} to {np.abs(s).max():.2f} times the mean, which is "
        f"{fit.gain * pressure:.3g} at 1 m in the microphone's unit (described: {pressure:g} Pa)",
        "phase": f"scatter {scatter:.1f} deg; standard error {mean:.1f} deg, {worst:.1f} deg at most",
        "focus": f"{before:.3f} of its radiation pressure uncorrected, some "
        f"{np.exp(-np.mean(errors**2)):.3f} corrected",
    }
    found = [Finding(name, "ok", text) for name, text in told.items()]
    if mean > VAGUE:
        fix = "scan at more positions, farther apart and at different heights, and measure the positions"
        found.append(Finding("standard error", "warning", f"above {VAGUE:g} deg", fix))
    places = [" ".join(f"{1e3 * v:.0f}" for v in q) + " mm" for q in scan.positions]
    for name, which, items, fix in (
        ("positions that do not fit", fit.residuals > MISFIT, places, "measure there again"),
        ("dead", fit.dead, names, "they get strength 0 and are not driven: check their joints"),
        (
            "reversed",
            fit.reversed,
            names,
            "nothing to do: the calibration turns their phase",
        ),
        ("unseen", fit.unseen, names, "left out: scan closer to them, or at more positions"),
    ):
        chosen = [items[i] for i in np.flatnonzero(which)]
        more = f" and {len(chosen) - MAX_LISTED} more" if len(chosen) > MAX_LISTED else ""
        if chosen:
            text = f"{len(chosen)}: {', '.join(chosen[:MAX_LISTED])}{more}"
            found.append(Finding(name, "warning", text, fix))
    return found
