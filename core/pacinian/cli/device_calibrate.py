"""`pacinian devices calibrate`: computes strengths and phases of the channels, P0 and the pose from a scan."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from functools import reduce
from operator import add
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pacinian.cli.options import FiniteRange, NonEmptyPath

if TYPE_CHECKING:
    from pacinian.devices.calibration import Measured


@click.command()
@click.argument("file", type=NonEmptyPath(path_type=Path))
@click.argument("scans", type=NonEmptyPath(path_type=Path), nargs=-1, required=True)
@click.option(
    "--out", default=Path("calibration.csv"), show_default=True, type=NonEmptyPath(path_type=Path)
)
@click.option(
    "--temperature",
    type=FiniteRange(-20, 50),  # whose speed of sound the fit accepts
    help="Temperature of the air [degC]; fitted by default.",
)
@click.option(
    "--position-error", default=0.001, show_default=True, type=float,
    help="Standard error of the microphone's coordinates [m], which the fit corrects.",
)  # fmt: skip
@click.option(
    "--shift-error", default=0.001, show_default=True, type=float,
    help="Standard error of the array's place in the microphone's frame [m], which the fit finds.",
)  # fmt: skip
@click.option(
    "--turn-error", default=0.005, show_default=True, type=float,
    help="Standard error of the array's tilt in the microphone's frame [rad], which the fit finds.",
)  # fmt: skip
@click.option(
    "--sensitivity-error", default=0.1, show_default=True, type=float,
    help="Relative standard error of the microphone's sensitivity, for that of P0.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="One JSON object instead of text.")
def calibrate(
    file: Path,
    scans: tuple[Path, ...],
    out: Path,
    temperature: float | None,
    position_error: float,
    shift_error: float,
    turn_error: float,
    sensitivity_error: float,
    as_json: bool,
) -> None:
    """Compute a calibration from a description FILE and microphone SCANS.

    A scan is a CSV file with the columns x,y,z,serial,channel,amplitude,phase ([m], any unit, [rad]) of channels driven
    one at a time, or an NPZ or HDF5 file with positions, readings and perhaps drives. It needs at least 6 positions of
    the microphone, better 12, at different heights. The microphone's gain and the phase reference may differ between
    files that share channels. The result has standard errors. It replaces all strengths, phases and dead channels of
    FILE. If the scan contradicts FILE, for example by another order of the channels, nothing is written, and the exit
    code is 1. This command drives no device; docs/devices.md explains how to measure.
    """
    import numpy as np

    from pacinian.acoustics.air import Air
    from pacinian.argument_checks import check_number
    from pacinian.cli.device_calibrate_rules import check_scan, check_strength, compare_files
    from pacinian.cli.doctor import print_findings
    from pacinian.devices.calibration import Measurement, write_calibration
    from pacinian.devices.scan import read_scan, undo_calibration
    from pacinian.devices.scan_fit import fit_scan

    given = {path.resolve() for path in (file, *scans)}
    if out.suffix != ".csv" or out.resolve() in given or not out.parent.is_dir():
        raise click.BadParameter(
            f"{out} must end in .csv, be in an existing folder, and be none of the input files"
        )
    if len(given) <= len(scans):
        raise click.BadParameter("a file is given twice, so its readings would count twice")
    check_number("sensitivity_error", sensitivity_error, low=0.0, high=1.0)
    device = undo_calibration(file)
    scan = reduce(add, (read_scan(path, device) for path in scans))
    speed = None if temperature is None else Air(temperature=temperature).speed_of_sound
    order = np.concatenate([w.indices for w in device.wiring])  # channels to transducers
    fit = fit_scan(
        device.array(),
        scan.positions,
        scan.readings[:, np.argsort(order)],
        files=scan.files[:, np.argsort(order)],
        position_error=position_error,
        shift_error=shift_error,
        turn_error=turn_error,
        speed_of_sound=speed,
    )
    keys = [(w.serial, int(c)) for w in device.wiring for c in w.channels]
    measured: Measured = {
        key: Measurement(
            float(np.abs(fit.responses[n])),
            float(np.angle(fit.responses[n])),
            float(fit.gain_errors[n]),
            float(fit.phase_errors[n]),
        )
        for key, n in zip(keys, order, strict=True)
        if not fit.unseen[n]
    }
    names = [" ".join(map(str, keys[i])).strip() for i in np.argsort(order)]  # of transducers
    known = np.r_[[shift_error] * 3, [turn_error] * 3]
    findings = [
        *check_scan(fit, scan, names, known),
        *compare_files(fit, [path.name for path in scans]),
        check_strength(fit, scan, device, sensitivity_error),
    ]
    good = all(finding.level != "problem" for finding in findings)
    if good:
        write_calibration(out, measured)
    if as_json:
        result = {
            "out": str(out) if good else None,
            "findings": [asdict(f) for f in findings],
            "pressure": fit.pressure,
            "pressure_error": float(np.hypot(fit.pressure_error, sensitivity_error)),
            "unit": f"{scan.unit} m" if scan.unit else "",
            "speed_of_sound": fit.speed_of_sound,
            "speed_error": fit.speed_error,
            "pose": {"position": fit.pose.position, "rotation": fit.pose.rotation},
            "pose_errors": fit.pose_errors.tolist(),
            "files": [
                {
                    "file": str(path),
                    "gain": float(np.abs(factor)),
                    "phase": float(np.angle(factor)),
                    "gain_error": None if np.isnan(errors[0]) else float(errors[0]),
                    "phase_error": None if np.isnan(errors[1]) else float(errors[1]),
                }
                for path, factor, errors in zip(scans, fit.factors, fit.factor_errors, strict=True)
            ],
            "widened": dict(zip(("positions", "shift", "turn"), fit.widened.tolist(), strict=True)),
            "channels": [
                {"serial": serial, "channel": channel, **values._asdict()}
                for (serial, channel), values in measured.items()
            ],
        }
        click.echo(json.dumps(result))
    else:
        print_findings(findings)
        outcome = f"not written, because the scan contradicts {file}"
        if good:
            outcome = f"{len(measured)} channels; set it as `calibration` in {file}"
        click.echo(f"{out}: {outcome}")
    if not good:
        sys.exit(1)
