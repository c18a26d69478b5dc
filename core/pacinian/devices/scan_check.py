"""What refuses a scan: too few readings or positions, a fit that contradicts the stated errors, no fit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.devices.scan_robust_fit import MAX_MATCHING_RESIDUAL, SHARED
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.devices.scan_robust_fit import Prior, ScanModel
    from pacinian.types import ArrayLike, Flags, Floats, Longs

MIN_POSITIONS, MAX_POSITIONS = 6, 1000
MAX_MOVE = 2.0  # rms correction of the positions, in standard errors
MAX_POSE_MOVE = 5.0  # rms correction of the pose, in standard errors


def check_files(files: ArrayLike, shape: tuple[int, int]) -> Longs:
    """Return the number of the file of each reading, (M, N). Raises ArgumentError."""
    given = np.asarray(files)
    whole = given.dtype.kind in "iu"
    if not whole or (given.size and not 0 <= int(given.min()) <= int(given.max()) < MAX_POSITIONS):
        raise ArgumentError("files", f"must be whole numbers from 0 to {MAX_POSITIONS - 1}")
    try:
        return np.array(np.broadcast_to(given, shape), np.int64)
    except ValueError:
        raise ArgumentError("files", f"must broadcast to {shape}, not {given.shape}") from None


def check_count(read: Flags, factors: int) -> None:
    """Raise ArgumentError if there are fewer readings than unknowns.

    read: which there are, (M, N). factors: number of files with a factor of their own.
    """
    M, T, count = len(read), int(read.any(axis=0).sum()), int(read.sum())
    unknowns = 2 * T + 3 * M + len(SHARED) + 2 * factors
    if 2 * count <= unknowns:
        raise ArgumentError(
            "readings",
            f"are {2 * count} numbers for {unknowns} unknowns (2 for each of {T} transducers, 3 for each of {M} "
            f"positions, {len(SHARED)} for the air and the pose): the phases of the transducers cannot be "
            f"distinguished from the positions, the {SHARED[0]} and the pose. Read more transducers at each position: "
            f"{(unknowns // 2) // M + 1} or more",
        )


def check_corrections(model: ScanModel, positions: Floats, prior: Prior) -> None:
    """Raise ArgumentError if the fit moves the positions or the array much farther than their stated errors.

    positions: as given [m], (M, 3). prior: with the stated errors.
    """
    moved = float(np.sqrt(np.mean((model.positions - positions) ** 2)))
    if moved > MAX_MOVE * prior.position:
        raise ArgumentError(
            "positions",
            f"would be corrected by {1e3 * moved:.1f} mm rms in each coordinate, for an error of "
            f"{1e3 * prior.position:g} mm: measure them again, and check the order of the channels, and the "
            "temperature if it is given",
        )
    pose = np.r_[model.shift, model.turn] / prior.shared[2:]
    if float(np.sqrt(np.mean(pose**2))) > MAX_POSE_MOVE:
        raise ArgumentError(
            "positions",
            f"fit only an array that is shifted by {1e3 * np.linalg.norm(model.shift):.1f} mm and turned by "
            f"{np.linalg.norm(model.turn):.3f} rad, much more than the stated error of its pose: measure the pose "
            "again, and check the order of the channels",
        )


def describe_misfit(residual: float, turned: float) -> str:
    """Return why a scan is refused that does not fit the array, with advice.

    residual: unexplained part of a typical reading. turned: the same with the sign of all phases reversed.
    """
    text = f"do not fit the array: {residual:.0%} of a typical one is not explained. "
    if turned <= MAX_MATCHING_RESIDUAL:
        return text + (
            "They fit if the sign of all phases is reversed. A phase must be positive where the sound leads the "
            "reference. If your phases already follow this rule, the channels may be in reverse order"
        )
    return text + (
        "Check the positions (in metres, in the frame of the description), the order of the channels, the drive "
        "frequency, and the temperature. Check that all phases are in radians and have the same reference, and that "
        "the readings are from this array"
    )
