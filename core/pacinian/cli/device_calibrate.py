"""`pacinian devices calibrate`: computes strengths and phases of the channels, P0 and the pose from a scan."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from functools import reduce
from operator import add
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from pacinian.cli.doctor_rules import Finding, list_first
from pacinian.cli.finite_range import FiniteRange
from pacinian.cli.nonempty import NonEmptyPath

if TYPE_CHECKING:
    from pacinian.devices.calibration import Measured
    from pacinian.devices.description import DeviceDescription
    from pacinian.devices.scan import Scan
    from pacinian.devices.scan_fit import ScanFit
    from pacinian.types import Flags, Floats

MAX_RESIDUAL = 0.1  # unexplained part of a typical reading above which the scan is suspect
# of a file's gain and phase reference, relative and [rad], and in standard errors, above which files differ
MAX_FILE_CHANGE, MAX_FILE_SURPRISE = 0.02, 4.0
# Residual at a position, relative to the expected rms there, above which it is named.
MAX_MISFIT = 0.5
MAX_PHASE_ERROR = 10.0  # standard error of phases that costs 3 % of a focus [deg]
# pose, in standard errors, above which it is reported, and refused
DOUBTFUL_POSE, WRONG_POSE = 2.5, 4.0
ROUNDING = 1e-6  # of a pose that is known [m], [rad]
MAX_OUTLIER_SHARE = 0.02  # share of the readings above which outliers are a warning
# Of the highest amplitude, and the share of readings that may be above.
CLIPPING_LIMITS = 0.995, 0.01
MIN_CLIPPED = 10  # readings above; fewer may be chance
MAX_ODD = 0.05  # share of the channels that do not fit, above which their order is wrong
MAX_WIDENING = 1.05  # factor from which a standard error that has widened is reported
MAX_RATIO = 10.0  # of the measured P0 and the described one; beyond, the unit is wrong


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
        _judge_fit(fit),
        *_findings(fit, scan, names, known),
        *_compare_files(fit, [path.name for path in scans]),
        _judge_strength(fit, scan, device, sensitivity_error),
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


def _judge_fit(fit: ScanFit) -> Finding:
    """Return how much of the readings the fit explains."""
    text = f"{fit.residual:.1%} of a typical reading is not explained; {fit.outliers} outliers"
    if fit.residual <= MAX_RESIDUAL:
        return Finding("fit", "ok", text)
    fix = (
        "look for noise and reflections, and check that the microphone's gain, the phase reference and the array did "
        "not change within a file"
    )
    return Finding("fit", "warning", text, fix)


def _judge_strength(
    fit: ScanFit, scan: Scan, device: DeviceDescription, sensitivity_error: float
) -> Finding:
    """Return P0 and what to do about it. sensitivity_error: relative standard error of the microphone's sensitivity."""
    import numpy as np

    described, error = device.transducer.pressure, np.hypot(fit.pressure_error, sensitivity_error)
    text = f"P0 is {fit.pressure:.4g} {scan.unit or 'units'} m"
    if scan.unit != "Pa":
        fix = "to know P0, give readings in pascal, and name their unit: amplitude [Pa]"
        return Finding("strength", "ok", f"{text} (described: {described:g} Pa m)", fix)
    text += f", give or take {error:.0%}"
    ratio = fit.pressure / described
    if not 1.0 / MAX_RATIO <= ratio <= MAX_RATIO:
        fix = "check the microphone's sensitivity and the unit of the readings: Pa, mPa, uPa"
        return Finding("strength", "warning", f"{text}, {ratio:.2g} times the described", fix)
    fix = f"set pressure = {fit.pressure:.4g} and pressure_error = {error:.3f} under [transducer]"
    return Finding("strength", "ok", f"{text} (described: {described:g})", fix)


def _compare_files(fit: ScanFit, names: list[str]) -> list[Finding]:
    """Return how the microphone's gain and the phase reference differ between files. names: of the files."""
    import numpy as np

    first, *others = names
    logs, errors = np.log(fit.factors[1:]).view(np.float64).reshape(-1, 2), fit.factor_errors[1:]
    unknown = np.isnan(errors[:, 0])
    found = []
    if not unknown.all():
        limits = np.maximum(MAX_FILE_SURPRISE * errors, MAX_FILE_CHANGE)
        differ = bool((np.abs(logs) > limits).any())
        texts = [
            f"{name} has {np.exp(gain):.3g} times the gain of {first} (+- {error:.1%}), and leads by "
            f"{np.degrees(phase):.0f} +- {np.degrees(phase_error):.0f} deg"
            for name, (gain, phase), (error, phase_error), skip in zip(
                others, logs, errors, unknown, strict=True
            )
            if not skip
        ]
        fix = f"nothing to do: the calibration corrects this, and P0 has the gain of {first}"
        found.append(
            Finding("files", "warning" if differ else "ok", list_first(texts, "; "), fix * differ)
        )
    if unknown.any():
        alone = [name for name, skip in zip(others, unknown, strict=True) if skip]
        text = f"no channel that files share connects {first} with {list_first(alone)}"
        fix = (
            "read some channels of each file in the others, too. Otherwise the microphone's gain and the phase "
            "reference must be the same, which the fit assumes"
        )
        found.append(Finding("files that cannot be compared", "warning", text, fix))
    return found


def _findings(fit: ScanFit, scan: Scan, names: list[str], known: Floats) -> list[Finding]:
    """Return the findings of a fit. names: of the transducers. known: errors of the pose before, (6,) [m], [rad]."""
    import numpy as np

    from pacinian.acoustics.air import Air

    good = ~fit.dead & ~fit.unseen
    s, errors, sizes = fit.responses[good], fit.phase_errors[good], fit.gain_errors[good]
    moved = 1e3 * np.linalg.norm(fit.positions - scan.positions, axis=1)  # [mm]
    shift, turn = fit.shift, np.degrees(fit.turn)
    room = Air(temperature=20.0).speed_of_sound
    air = 293.15 * (fit.speed_of_sound / room) ** 2 - 273.15  # [degC]
    scatter = np.degrees(np.sqrt(np.mean(np.angle(np.where(s.real < 0.0, -s, s)) ** 2)))
    mean, worst = np.degrees(np.sqrt(np.mean(errors**2))), np.degrees(errors.max())
    before = np.abs(s.sum()) ** 2 / np.abs(s).sum() ** 2
    texts = {
        "air": f"{fit.speed_of_sound:.2f} m/s, give or take {fit.speed_error:.2f}: {air:.0f} degC",
        "microphone": f"corrected by {moved.mean():.2f} mm in the mean, {moved.max():.2f} mm at most",
        "pose": f"the array is shifted by {_measure(1e3 * shift, 1e3 * fit.pose_errors[:3], '.2f')} mm and turned by "
        f"{_measure(turn, np.degrees(fit.pose_errors[3:]), '.2f')} deg",
        "gain": f"{np.abs(s).min():.2f} to {np.abs(s).max():.2f} times the mean; "
        f"standard error {np.sqrt(np.mean(sizes**2)):.1%}, {sizes.max():.1%} at most",
        "phase": f"scatter {scatter:.1f} deg; standard error {mean:.1f} deg, {worst:.1f} deg at most",
        "focus": f"{before:.3f} of its radiation pressure uncorrected, some "
        f"{np.exp(-np.mean(errors**2)):.3f} corrected",
    }
    found = [Finding(name, "ok", text) for name, text in texts.items()]
    read = np.abs(scan.readings[np.isfinite(scan.readings)])
    if fit.outliers > MAX_OUTLIER_SHARE * len(read):
        text = f"{fit.outliers} of {len(read)} readings are ignored in part"
        fix = "look for reflections and loose contacts, and check the order of the channels"
        found.append(Finding("outliers", "warning", text, fix))
    highest = int((read >= CLIPPING_LIMITS[0] * read.max()).sum())
    if highest >= max(MIN_CLIPPED, CLIPPING_LIMITS[1] * len(read)):
        text = f"{highest} readings share the highest amplitude"
        fix = "the microphone or its amplifier may be at its limit: lower the gain, or scan farther away"
        found.append(Finding("clipped", "warning", text, fix))
    if mean > MAX_PHASE_ERROR:
        fix = "scan at more positions, farther apart and at different heights, and measure the positions"
        found.append(Finding("standard error", "warning", f"above {MAX_PHASE_ERROR:g} deg", fix))
    level: Literal["warning", "problem"]
    off = float(
        np.max((np.abs(np.r_[fit.shift, fit.turn]) - ROUNDING) / np.maximum(known, ROUNDING))
    )
    if off > DOUBTFUL_POSE:
        fix = (
            "check the positions' frame and the order of the channels. If they are right, give --shift-error and "
            "--turn-error as large as they may be; the gains and phases then hold"
        )
        level = "problem" if off > WRONG_POSE else "warning"
        found.append(Finding("pose", level, f"off by {off:.1f} of the standard errors given", fix))
    wider = [
        f"{factor:.1f} times --{name}-error"
        for name, factor in zip(("position", "shift", "turn"), fit.widened, strict=True)
        if factor >= MAX_WIDENING
    ]
    if wider:
        text = f"the scan shows {', '.join(wider)}; all errors reported here include that"
        fix = "nothing to do, unless positions and pose are known that well: then check them"
        found.append(Finding("standard errors", "ok", text, fix))
    for text in fit.vague:
        what, _, fix = text.partition(": ")
        found.append(Finding("unknown", "warning", what, fix))
    places = [" ".join(f"{1e3 * v:.0f}" for v in q) + " mm" for q in scan.positions]
    if fit.odd.any():
        wrong = fit.odd.sum() > max(
            MAX_ODD * len(fit.odd), 2.0
        )  # two may be a pair of swapped wires
        fix = "check the order of the channels, their wires and joints, or leave their rows out"
        text = _list(names, fit.odd)
        level = "problem" if wrong else "warning"
        found.append(Finding("channels that do not fit", level, text, fix))
    for name, which, items, fix in (
        (
            "positions that do not fit",
            fit.doubtful | (fit.residuals > MAX_MISFIT),
            places,
            "leave their rows out, or measure there again: they may be a wavelength off",
        ),
        ("dead", fit.dead, names, "they get strength 0 and are not driven: check their joints"),
        (
            "reversed",
            fit.reversed,
            names,
            "nothing to do: the calibration turns their phase",
        ),
        ("unseen", fit.unseen, names, "left out: scan closer to them, or at more positions"),
    ):
        if which.any():
            found.append(Finding(name, "warning", _list(items, which), fix))
    return found


def _list(items: list[str], which: Flags) -> str:
    """Return how many items are chosen, and the first of them."""
    chosen = [item for item, here in zip(items, which, strict=True) if here]
    return f"{len(chosen)}: {list_first(chosen)}"


def _measure(values: Floats, errors: Floats, form: str) -> str:
    return ", ".join(f"{v:{form}} +- {e:{form}}" for v, e in zip(values, errors, strict=True))
