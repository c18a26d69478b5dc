"""The rules of `pacinian devices calibrate`: pure functions from the fit of a scan to findings.

What refuses a scan: devices/scan_check.py.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.cli.doctor_rules import Finding, Level, list_first

if TYPE_CHECKING:
    from pacinian.devices.description import DeviceDescription
    from pacinian.devices.scan import Scan
    from pacinian.devices.scan_fit import ScanFit
    from pacinian.types import Flags, Floats

# Largest unexplained part of a typical reading of a good scan.
MAX_GOOD_RESIDUAL = 0.1
# Largest residual at a good position, relative to the expected rms there.
MAX_POSITION_RESIDUAL = 0.5
# Largest share of a scan's readings that may be outliers without a warning.
MAX_SCAN_OUTLIER_SHARE = 0.02
# Share of the highest amplitude from which a reading may be clipped.
MIN_CLIPPED_AMPLITUDE = 0.995
# Largest share of the readings that may be so high without a warning.
MAX_CLIPPED_SHARE = 0.01
# Smallest number of clipped readings that is a warning; fewer may be chance.
MIN_CLIPPED = 10
# Largest standard error of the phases without a warning [deg]. It costs 3 % of a focus.
MAX_PHASE_ERROR = 10.0
# Smallest widening of a standard error that is reported.
MIN_REPORTED_WIDENING = 1.05
# Largest deviation of the pose without a warning, in standard errors.
MAX_GOOD_POSE_DEVIATION = 2.5
# Largest deviation of the pose that is accepted, in standard errors.
MAX_POSE_DEVIATION = 4.0
# Deviation of a pose that counts as zero [m], [rad].
POSE_ROUNDING = 1e-6
# Largest share of the channels that may not fit; if more do not, their order is wrong.
MAX_ODD_SHARE = 0.05
# Number of channels that may not fit however few there are: a pair of swapped wires.
MAX_SWAPPED = 2
# Largest deviation of a file's gain, relative, and of its phase reference [rad], without a warning.
MAX_FILE_CHANGE = 0.02
# The same limit in standard errors. The larger of the two limits holds.
MAX_FILE_SURPRISE = 4.0
# Largest ratio of the measured P0 to the described one, or inverse; beyond, the unit is wrong.
MAX_P0_RATIO = 10.0


def check_scan(fit: ScanFit, scan: Scan, names: list[str], known: Floats) -> list[Finding]:
    """Check what a fit says of the scan and of the transducers.

    names: of the transducers. known: standard errors of the pose before the fit, (6,) [m], [rad].
    """
    return [
        _check_residual(fit),
        *_describe_fit(fit, scan),
        *_check_readings(fit, scan),
        *_check_errors(fit, known),
        *_list_misfits(fit, scan, names),
    ]


def _check_residual(fit: ScanFit) -> Finding:
    """Return how much of the readings the fit explains."""
    text = f"{fit.residual:.1%} of a typical reading is not explained; {fit.outliers} outliers"
    if fit.residual <= MAX_GOOD_RESIDUAL:
        return Finding("fit", "ok", text)
    fix = (
        "look for noise and reflections, and check that the microphone's gain, the phase reference and the array did "
        "not change within a file"
    )
    return Finding("fit", "warning", text, fix)


def _describe_fit(fit: ScanFit, scan: Scan) -> list[Finding]:
    """Return what the fit found, as findings that need no action."""
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
    return [Finding(name, "ok", text) for name, text in texts.items()]


def _check_readings(fit: ScanFit, scan: Scan) -> list[Finding]:
    """Check for outliers and clipped readings."""
    found: list[Finding] = []
    read = np.abs(scan.readings[np.isfinite(scan.readings)])
    if fit.outliers > MAX_SCAN_OUTLIER_SHARE * len(read):
        text = f"{fit.outliers} of {len(read)} readings are ignored in part"
        fix = "look for reflections and loose contacts, and check the order of the channels"
        found.append(Finding("outliers", "warning", text, fix))
    highest = int((read >= MIN_CLIPPED_AMPLITUDE * read.max()).sum())
    if highest >= max(MIN_CLIPPED, MAX_CLIPPED_SHARE * len(read)):
        text = f"{highest} readings share the highest amplitude"
        fix = "the microphone or its amplifier may be at its limit: lower the gain, or scan farther away"
        found.append(Finding("clipped", "warning", text, fix))
    return found


def _check_errors(fit: ScanFit, known: Floats) -> list[Finding]:
    """Check the standard errors, the pose, and what the scan does not determine. known: as in `check_scan`."""
    found: list[Finding] = []
    phase_errors = fit.phase_errors[~fit.dead & ~fit.unseen]
    mean = np.degrees(np.sqrt(np.mean(phase_errors**2)))
    if mean > MAX_PHASE_ERROR:
        fix = "scan at more positions, farther apart and at different heights, and measure the positions"
        found.append(Finding("standard error", "warning", f"above {MAX_PHASE_ERROR:g} deg", fix))
    off = float(
        np.max(
            (np.abs(np.r_[fit.shift, fit.turn]) - POSE_ROUNDING) / np.maximum(known, POSE_ROUNDING)
        )
    )
    if off > MAX_GOOD_POSE_DEVIATION:
        fix = (
            "check the positions' frame and the order of the channels. If they are right, give --shift-error and "
            "--turn-error as large as they may be; the gains and phases then hold"
        )
        level: Level = "problem" if off > MAX_POSE_DEVIATION else "warning"
        found.append(Finding("pose", level, f"off by {off:.1f} of the standard errors given", fix))
    wider = [
        f"{factor:.1f} times --{name}-error"
        for name, factor in zip(("position", "shift", "turn"), fit.widened, strict=True)
        if factor >= MIN_REPORTED_WIDENING
    ]
    if wider:
        text = f"the scan shows {', '.join(wider)}; all errors reported here include that"
        fix = "nothing to do, unless positions and pose are known that well: then check them"
        found.append(Finding("standard errors", "ok", text, fix))
    for text in fit.vague:
        what, _, fix = text.partition(": ")
        found.append(Finding("unknown", "warning", what, fix))
    return found


def _list_misfits(fit: ScanFit, scan: Scan, names: list[str]) -> list[Finding]:
    """List the channels and positions that do not fit, and the dead, reversed and unseen transducers."""
    found: list[Finding] = []
    places = [" ".join(f"{1e3 * v:.0f}" for v in q) + " mm" for q in scan.positions]
    if fit.odd.any():
        wrong = fit.odd.sum() > max(MAX_ODD_SHARE * len(fit.odd), MAX_SWAPPED)
        fix = "check the order of the channels, their wires and joints, or leave their rows out"
        text = _list(names, fit.odd)
        level: Level = "problem" if wrong else "warning"
        found.append(Finding("channels that do not fit", level, text, fix))
    for name, which, items, fix in (
        (
            "positions that do not fit",
            fit.doubtful | (fit.residuals > MAX_POSITION_RESIDUAL),
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


def compare_files(fit: ScanFit, names: list[str]) -> list[Finding]:
    """Return how the microphone's gain and the phase reference differ between files. names: of the files."""
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


def check_strength(
    fit: ScanFit, scan: Scan, device: DeviceDescription, sensitivity_error: float
) -> Finding:
    """Return P0 and what to do about it. sensitivity_error: relative standard error of the microphone's sensitivity."""
    described, error = device.transducer.pressure, np.hypot(fit.pressure_error, sensitivity_error)
    text = f"P0 is {fit.pressure:.4g} {scan.unit or 'units'} m"
    if scan.unit != "Pa":
        fix = "to know P0, give readings in pascal, and name their unit: amplitude [Pa]"
        return Finding("strength", "ok", f"{text} (described: {described:g} Pa m)", fix)
    text += f", give or take {error:.0%}"
    ratio = fit.pressure / described
    if not 1.0 / MAX_P0_RATIO <= ratio <= MAX_P0_RATIO:
        fix = "check the microphone's sensitivity and the unit of the readings: Pa, mPa, uPa"
        return Finding("strength", "warning", f"{text}, {ratio:.2g} times the described", fix)
    fix = f"set pressure = {fit.pressure:.4g} and pressure_error = {error:.3f} under [transducer]"
    return Finding("strength", "ok", f"{text} (described: {described:g})", fix)


def _list(items: list[str], which: Flags) -> str:
    """Return how many items are chosen, and the first of them."""
    chosen = [item for item, here in zip(items, which, strict=True) if here]
    return f"{len(chosen)}: {list_first(chosen)}"


def _measure(values: Floats, errors: Floats, form: str) -> str:
    return ", ".join(f"{v:{form}} +- {e:{form}}" for v, e in zip(values, errors, strict=True))
