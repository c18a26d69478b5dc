"""The response of each transducer, P0, the speed of sound and the array's pose, from a microphone scan.

Least squares for s, q, c and the pose T of the array in the frame of the scan, in

    X_mn = mu_f s_n B_mn(q_m, c, T),    B as in `pacinian.matrix`, with the absorption of air

X_mn is the reading of the microphone at position m while only transducer n is driven. mu_f, the microphone's gain and
phase, is one complex number for each file f of the scan. The factor of the first file cannot be separated from a factor
common to all responses. So the responses have mean strength 1 and common phase 0, and that factor is P0 in the
microphone's unit. The factors of the other files are relative to the first. `pacinian.devices.scan_robust_fit` has the
method. What refuses a scan: `pacinian.devices.scan_check`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.sparse.csgraph import connected_components

from pacinian.acoustics.air import Air
from pacinian.argument_checks import check_near, check_number, check_numbers
from pacinian.devices.scan_check import (
    MAX_POSITIONS,
    MIN_POSITIONS,
    check_corrections,
    check_count,
    check_files,
    describe_misfit,
)
from pacinian.devices.scan_robust_fit import (
    MAX_MATCHING_RESIDUAL,
    MAX_SPEED,
    MIN_NOISE,
    MIN_SPEED,
    MIN_SUM,
    SHARED,
    TYPICAL,
    Prior,
    ScanModel,
    compare_noise,
    fit_model,
)
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.acoustics.pose import Pose
    from pacinian.types import ArrayLike, Complexes, Flags, Floats, Longs

POSITION_ERROR = 1e-3  # standard error of the microphone's coordinates [m]
SHIFT_ERROR, TURN_ERROR = 1e-3, 5e-3  # of the array's pose in the microphone's frame [m], [rad]
# Largest misfit at a position, relative to that of the scan; beyond, the position is doubtful.
MAX_POSITION_MISFIT_RATIO = 2.0
MAX_ERROR = 0.1  # relative error of a response from noise; beyond, the transducer is unseen
OUTLIER_WEIGHT = 0.1  # weight, 0..1, below which a reading is an outlier
# Largest share of outliers in a transducer's readings; above it, these are odd.
MAX_TRANSDUCER_OUTLIER_SHARE = 0.5
MIN_SCANNED_STRENGTH = 0.1  # strength relative to the mean; below, the transducer is dead
# information about a parameter from the scan, relative to its prior; below, the parameter is unknown
MIN_INFORMATION = 0.1
MIN_SHARE = 0.2  # smallest share in an unknown combination for which a parameter is named
REMEDIES = {
    SHARED[0]: "give the temperature, or measure at distances that differ by a factor of two",
    **dict.fromkeys(
        SHARED[2:5], "measure where the array is, or scan at more positions, at different heights"
    ),
    **dict.fromkeys(
        SHARED[5:8], "measure the array's tilt, or scan positions over twice the array's width"
    ),
}  # the absorption needs none: it makes P0 uncertain, and little else


@dataclass(frozen=True, eq=False)
class ScanFit:
    """The fit of N transducers to a scan at M positions. Errors are standard errors.

    responses: complex responses, (N,), of mean strength 1; 0 if dead, 1 if unseen.
    gain_errors, phase_errors: errors of the responses' sizes, relative, and of their phases [rad], (N,).
    dead: weaker than `MIN_SCANNED_STRENGTH` times the mean, (N,). unseen: the scan does not determine the response,
        (N,). reversed: in antiphase to most others, (N,).
    positions: corrected positions of the microphone [m], (M, 3), with position_errors [m], (M, 3). residuals:
        unexplained part of a typical reading at each position, relative to the expected rms there, (M,). residual:
        unexplained part of a typical reading of the whole scan, relative to its expected rms. doubtful: the misfit at a
        position is more than `MAX_POSITION_MISFIT_RATIO` times the typical misfit, (M,); the position may be wrong by a
        wavelength.
        outliers: number of readings that lost most of their weight.
    speed_of_sound: fitted or given speed [m/s]. speed_error: its error [m/s].
    pose: the array's pose in the frame of the scan: `array.transform(pose)` is where it is. shift, turn: the shift of
        its centre [m] and the turn about its centre as a rotation vector [rad], (3,) each. pose_errors: errors of both,
        (6,).
    factors: gain and phase of the microphone in each file, complex, relative to the first, (F,). factor_errors: their
        relative errors and those of their phases [rad], (F, 2). NaN if a file shares no transducer with the first, not
        even through other files, so that its factor is taken as 1.
    pressure: mean P0 of the transducers that are not dead [microphone's unit x m], with the gain of the first file.
        pressure_error: its relative error, without that of the microphone's sensitivity.
    covariance: of the speed of sound, the absorption [1/m], the shift, the turn and ln P0, in this order, (9, 9).
    widened: the errors of positions, shift and turn that the scan shows, relative to the given errors, (3,). Above 1,
        the given error was too small. All errors include this factor.
    odd: most readings of the transducer are outliers and hardly explained, (N,). They may be another transducer's.
    vague: quantities that the scan does not determine, or cannot distinguish, each with a remedy. The errors include
        their uncertainty.
    """

    responses: Complexes
    gain_errors: Floats
    phase_errors: Floats
    dead: Flags
    unseen: Flags
    reversed: Flags
    positions: Floats
    position_errors: Floats
    residuals: Floats
    residual: float
    doubtful: Flags
    outliers: int
    speed_of_sound: float
    speed_error: float
    pose: Pose
    shift: Floats
    turn: Floats
    pose_errors: Floats
    factors: Complexes
    factor_errors: Floats
    pressure: float
    pressure_error: float
    covariance: Floats
    widened: Floats
    odd: Flags
    vague: tuple[str, ...]


def fit_scan(
    array: Array,
    positions: ArrayLike,
    readings: Complexes,
    *,
    files: ArrayLike = 0,
    position_error: float = POSITION_ERROR,
    shift_error: float = SHIFT_ERROR,
    turn_error: float = TURN_ERROR,
    speed_of_sound: float | None = None,
) -> ScanFit:
    """Fit the response of each of N transducers to a scan at M positions.

    array: array as described, without responses. positions: positions of the microphone [m], (M, 3). readings: complex
    readings in any unit, (M, N); NaN if missing. A phase is positive where the sound leads. files: number of the file
    of each reading, from 0, broadcast to (M, N). Each file has its own gain of the microphone and phase reference.
    position_error: standard error of each coordinate of a position [m]; above 1 mm the fit may converge a whole
    wavelength off. shift_error, turn_error: standard errors of the array's place [m] and tilt [rad] in the frame of the
    positions; 0 if they are exact. The fit increases these three errors if the scan shows that they are too small
    (`ScanFit.widened`).
    speed_of_sound: [m/s]; fitted by default. Raises ArgumentError, also if the scan does not fit the array, or has
    fewer readings than unknowns.
    """
    q0 = check_numbers("positions", positions, (None, 3))
    check_near("positions", q0, array.centre)
    check_number("position_error", position_error, low=1e-6, high=0.01)
    check_number("shift_error", shift_error, low=0.0, high=0.01)
    check_number("turn_error", turn_error, low=0.0, high=0.1)
    if speed_of_sound is not None:
        check_number("speed_of_sound", speed_of_sound, low=MIN_SPEED, high=MAX_SPEED)
    X = np.asarray(readings, np.complex128)
    if X.shape != (len(q0), len(array)):
        raise ArgumentError("readings", f"must have shape {(len(q0), len(array))}, not {X.shape}")
    number = check_files(files, X.shape)
    if len(q0) > MAX_POSITIONS:
        raise ArgumentError("positions", f"must be at most {MAX_POSITIONS}, not {len(q0)}")
    read = ~np.isnan(X)
    finite = read.any() and bool(np.isfinite(X[read]).all())
    size = float(np.quantile(np.abs(X[read]), TYPICAL)) if finite else 0.0
    if len(q0) and not 0.0 < size < np.inf:
        raise ArgumentError("readings", "must be finite, and most of them not 0")
    X = np.where(read, X / max(size, MIN_SUM), 0.0)
    group = _group_files(number, read)  # whose factor is 1: 0
    own = group[number]
    prior = Prior(
        position_error,
        shift_error,
        turn_error,
        speed_of_sound,
        Air(attenuation="absorbing").beta(array.transducer.frequency),
    )
    if len(q0) < MIN_POSITIONS:
        vague = _find_vague(fit_model(array, q0, X, read, own, prior)) if len(q0) else ()
        few = (
            f"must be {MIN_POSITIONS} to {MAX_POSITIONS}, better 12, not {len(q0)}: with fewer, errors of the "
            "positions cannot be distinguished from errors of the phases"
        )
        raise ArgumentError("positions", "; ".join([few, *vague]))
    check_count(read, int(group.max()))
    best = fit_model(array, q0, X, read, own, prior)
    if best.residual > MAX_MATCHING_RESIDUAL:
        turned = fit_model(array, q0, X.conj(), read, own, prior)
        raise ArgumentError("readings", describe_misfit(best.residual, turned.residual))
    check_corrections(best, q0, prior)
    return _make_fit(best, size, best.prior.widths / prior.widths, group)


def _group_files(files: Longs, read: Flags) -> Longs:
    """Return 0 for files whose factor is 1, and 1, 2, ... for those with their own, (F,).

    Files that share a transducer can be compared, directly or through other files. In each group of comparable files,
    the first has the factor 1.
    """
    F = int(files.max(initial=0)) + 1
    heard = np.array([(read & (files == f)).any(axis=0) for f in range(F)], np.int64)  # (F, N)
    _, part = connected_components(heard @ heard.T, directed=False)
    own = np.ones(F, np.bool_)
    own[np.unique(part, return_index=True)[1]] = False
    return np.where(own, np.cumsum(own), 0)


def _find_vague(model: ScanModel) -> tuple[str, ...]:
    """Return the shared parameters that the scan determines hardly better than their priors, with remedies.

    If the scan determines only a combination of some parameters, they are named together.
    """
    prior = model.prior.shared
    asked = np.flatnonzero(
        [error > 1e-6 and name in REMEDIES for error, name in zip(prior, SHARED, strict=True)]
    )
    found = model.shared[asked]
    after = model.cov[np.ix_(found, found)] / np.outer(prior[asked], prior[asked])
    gained = np.linalg.inv(after) - np.eye(len(asked))  # by the readings, relative to the priors
    values, vectors = np.linalg.eigh((gained + gained.T) / 2.0)
    unknown = vectors[:, values < MIN_INFORMATION]
    share = np.abs(unknown @ unknown.T)
    left = [i for i in range(len(asked)) if share[i, i] >= MIN_SHARE]
    groups: list[tuple[str, list[str]]] = []  # what cannot be distinguished, with remedies
    while left:
        names = [SHARED[asked[i]] for i in left if share[left[0], i] >= MIN_SHARE]
        left = [i for i in left if share[left[0], i] < MIN_SHARE]
        fix = "; ".join(dict.fromkeys(REMEDIES[name] for name in names))
        groups.append((fix, names))
    alone: dict[str, list[str]] = {}  # by remedy
    for fix, names in groups:
        if len(names) == 1:
            alone.setdefault(fix, []).append(names[0])
    single = [
        f"the scan does not determine the {', the '.join(names)}: {fix}"
        for fix, names in alone.items()
    ]
    together = [
        f"the scan cannot distinguish the {', the '.join(names[:-1])} and the {names[-1]}: {fix}"
        for fix, names in groups
        if len(names) > 1
    ]
    return (*single, *together)


def _make_fit(model: ScanModel, size: float, widened: Floats, group: Longs) -> ScanFit:
    """Normalise the responses, classify transducers and propagate errors. Raises ArgumentError.

    size: reading that was scaled to 1. widened: as in `ScanFit`. group: number of each file's factor, (F,).
    """
    seen, mean = _find_seen(model)
    unseen = model.response_noise > MAX_ERROR * mean
    dead = ~unseen & ~seen
    s = _normalise_responses(model, seen, mean)
    s[dead], s[unseen] = 0.0, 1.0
    errors = _propagate_errors(model, seen, mean)
    shared_errors = np.sqrt(np.diag(errors.covariance))
    places = np.einsum("mip,pq,miq->mi", model.D, model.cov, model.D, optimize=True)
    residuals, doubtful = _measure_misfits(model)
    outlying = model.read & (model.W < OUTLIER_WEIGHT)
    return ScanFit(
        responses=s,
        gain_errors=errors.gain,
        phase_errors=errors.phase,
        dead=dead,
        unseen=unseen,
        reversed=seen & (s.real < 0.0),
        positions=model.positions,
        position_errors=np.sqrt(places),
        residuals=residuals,
        residual=model.residual,
        doubtful=doubtful,
        outliers=int(outlying.sum()),
        speed_of_sound=model.c,
        speed_error=float(shared_errors[0]),
        pose=model.pose,
        shift=model.shift,
        turn=model.turn,
        pose_errors=shared_errors[2:8],
        factors=model.factors[group],
        factor_errors=_compute_factor_errors(model, group),
        pressure=mean * size,
        pressure_error=float(shared_errors[8]),
        covariance=errors.covariance,
        widened=widened,
        odd=_find_odd(model, outlying),
        vague=_find_vague(model),
    )


def _find_seen(model: ScanModel) -> tuple[Flags, float]:
    """Return which transducers are seen and alive, (N,), and their mean strength. Raises ArgumentError if none is."""
    strength, noise = np.abs(model.s), model.response_noise
    mean, seen = 0.0, model.S > 0.0
    for _ in range(3):  # the mean is over transducers that are seen and alive
        mean = float(strength[seen].mean()) if seen.any() else 0.0
        seen = (noise <= MAX_ERROR * mean) & (strength > MIN_SCANNED_STRENGTH * mean)
    if not seen.any():
        raise ArgumentError(
            "readings",
            "show the sound of no transducer: place the microphone in front of the array, and increase the drive",
        )
    return seen, mean


def _normalise_responses(model: ScanModel, seen: Flags, mean: float) -> Complexes:
    """Return responses of mean strength 1 and common phase 0, (N,). seen, mean: see `_find_seen`."""
    s = model.s / mean
    axis = (s[seen] ** 2 / np.abs(s[seen])).sum()  # squares: reversed ones do not cancel
    s = s * np.exp(-0.5j * np.angle(axis))
    if s[seen].real.sum() < 0.0:
        s = -s
    return np.asarray(s)


class _Errors(NamedTuple):
    """Errors of the responses, (N,), and a covariance, (9, 9), as in `ScanFit`."""

    gain: Floats
    phase: Floats
    covariance: Floats


def _propagate_errors(model: ScanModel, seen: Flags, mean: float) -> _Errors:
    """Return the errors of normalised responses and of what all positions share. seen, mean: see `_find_seen`."""
    strength, noise = np.abs(model.s), model.response_noise
    weight = np.where(seen, strength, 0.0) / strength[seen].sum()  # of each response in the mean
    common = model.J @ weight  # d ln mean / d (p, c, beta, ln mu)
    J = model.J - common[:, None]
    cov = model.cov[: len(J), : len(J)]
    by_size, by_phase = (
        np.einsum("pn,pq,qn->n", K, cov, K, optimize=True) for K in (J.real, J.imag)
    )
    own = (noise / np.where(seen, strength, mean)) ** 2
    shared = float((weight**2 * own).sum())
    own = np.maximum(own * (1.0 - 2.0 * weight) + shared, 0.0)
    K = np.zeros((9, len(model.cov)))  # speed, absorption, shift, turn, ln P0
    K[np.arange(8), model.shared] = 1.0
    K[8, : len(J)] = common.real
    covariance = K @ model.cov @ K.T
    covariance[8, 8] += shared
    return _Errors(np.sqrt(own + by_size), np.sqrt(own + by_phase), covariance)


def _measure_misfits(model: ScanModel) -> tuple[Floats, Flags]:
    """Return the residual at each position and whether the position is doubtful, (M,), as in `ScanFit`."""
    misfits = np.array(
        [
            np.median(a[read]) if read.any() else 0.0
            for a, read in zip(model.residuals, model.read, strict=True)
        ]
    )
    typical = max(float(np.median(model.residuals[model.read])), MIN_NOISE)
    residuals = [
        compare_noise(float(misfit) / np.sqrt(np.log(4.0)), F[read])
        for misfit, F, read in zip(misfits, model.F, model.read, strict=True)
    ]
    return np.array(residuals), misfits > MAX_POSITION_MISFIT_RATIO * typical


def _compute_factor_errors(model: ScanModel, group: Longs) -> Floats:
    """Return the errors of the files' factors, (F, 2), as in `ScanFit`. group: number of each file's factor, (F,)."""
    own = np.diag(model.cov)[model.own][2:].reshape(-1, 2)
    errors = np.sqrt(np.concatenate([[[np.nan] * 2], own]))[group]
    errors[0] = 0.0
    return np.asarray(errors)


def _find_odd(model: ScanModel, outlying: Flags) -> Flags:
    """Return whether each transducer is odd, (N,), as in `ScanFit`. outlying: which readings are outliers, (M, N)."""
    sizes = np.maximum((np.abs(model.X) ** 2).sum(axis=0), MIN_SUM)
    missed = np.sqrt((np.abs(model.read * (model.X - model.F)) ** 2).sum(axis=0) / sizes)  # (N,)
    often = outlying.sum(axis=0) > MAX_TRANSDUCER_OUTLIER_SHARE * model.read.sum(axis=0)
    return np.asarray(often & (missed > MAX_MATCHING_RESIDUAL))
