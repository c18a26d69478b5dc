"""Calibration files: the measured strength and phase of every channel, and their standard errors."""

from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from msgspec.structs import replace

from pacinian.argument_checks import check_integer, check_number
from pacinian.atomic_file import replace_file
from pacinian.config_files import read_bytes
from pacinian.devices.board import GAIN_SCATTER, PHASE_SCATTER
from pacinian.errors import ArgumentError, SceneFileError

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.devices.board import Board

MAX_BYTES = 4 << 20  # size of a file, enough for some 100,000 channels [bytes]
COLUMNS = ("serial", "channel", "gain", "phase")
ERROR_COLUMNS = ("gain_error", "phase_error")
MAX_PHASE = 2.0 * math.pi + 1e-6  # largest phase, one turn and rounding [rad]


class Measurement(NamedTuple):
    """Strength relative to the kind and phase [rad] of a channel, and their standard errors, relative and [rad]."""

    gain: float
    phase: float
    gain_error: float = GAIN_SCATTER
    phase_error: float = PHASE_SCATTER


Measured = dict[tuple[str, int], Measurement]


def read_calibration(path: Path) -> Measured:
    """Read measurements by serial and channel from a CSV file: serial, channel, gain, phase, gain_error, phase_error.

    The last two columns may be missing; the errors are then those of uncalibrated transducers. Raises SceneFileError,
    which names the file, the line and the fix.
    """
    found: Measured = {}
    try:
        text = io.StringIO(read_bytes(path, largest=MAX_BYTES).decode(), newline="")
        rows = csv.reader(text, skipinitialspace=True)
        head = tuple(name.strip() for name in next(rows, []))
        if head not in (COLUMNS, COLUMNS + ERROR_COLUMNS):
            wanted = f"{','.join(COLUMNS)}, and may go on with {','.join(ERROR_COLUMNS)}"
            raise SceneFileError(path, "line 1", f"must be {wanted}")
        for row in rows:
            if not row:
                continue
            where = f"line {rows.line_num}"
            key, values = _row(path, where, row, len(head))
            if key in found:
                raise SceneFileError(path, where, f"measures channel {key[1]} of it again")
            found[key] = values
    except (UnicodeDecodeError, csv.Error) as error:
        raise SceneFileError(path, "", "is not CSV, in UTF-8") from error
    return found


def _row(path: Path, where: str, row: list[str], count: int) -> tuple[tuple[str, int], Measurement]:
    if len(row) != count:
        raise SceneFileError(path, where, f"must have {count} values, not {len(row)}")
    serial, channel, gain, phase, *errors = (value.strip() for value in row)
    try:
        key = serial, check_integer("channel", check_number("channel", float(channel)), low=0)
        values = Measurement(
            check_number("gain", float(gain), low=0.0),
            check_number("phase", float(phase)),
            *(
                check_number(name, float(error), low=0.0)
                for name, error in zip(ERROR_COLUMNS, errors, strict=False)
            ),
        )
    except ArgumentError as error:
        raise SceneFileError(path, where, str(error)) from error
    except ValueError as error:
        raise SceneFileError(path, where, "must be numbers") from error
    if abs(values.phase) > MAX_PHASE:
        raise SceneFileError(
            path,
            where,
            f"`phase` must be -2 pi to 2 pi [rad], not {values.phase:g}: were degrees given? Then multiply all phases "
            "by pi / 180",
        )
    return key, values


def write_calibration(path: Path, measured: Measured) -> None:
    """Write a calibration file, replacing an existing one atomically. Raises OSError."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(COLUMNS + ERROR_COLUMNS)
    for (serial, channel), values in measured.items():
        rows.writerow([serial, channel, *(f"{value:.5f}" for value in values)])
    with replace_file(path) as file:
        file.write(text.getvalue().encode())


def apply_calibration(path: Path, boards: tuple[Board, ...]) -> tuple[Board, ...]:
    """Return the boards with measured gains and phases in place of the described ones. Raises SceneFileError."""
    found = read_calibration(path)
    sizes = {board.serial: board.layout.count for board in boards}
    for serial, channel in found:
        if serial not in sizes:
            raise SceneFileError(path, "", f"measures board {serial!r}, which is not described")
        if channel >= sizes[serial]:
            problem = f"measures channel {channel} of {serial!r}, which has {sizes[serial]}"
            raise SceneFileError(path, "", problem)
    try:
        return tuple(_calibrate_board(board, found) for board in boards)
    except ArgumentError as error:
        raise SceneFileError(path, "", str(error)) from error


def _calibrate_board(board: Board, found: Measured) -> Board:
    L = board.layout.count
    columns = {
        name: np.broadcast_to(np.asarray(getattr(board, name), float), (L,)).copy()
        for name in Measurement._fields
    }
    for channel in range(L):
        if (board.serial, channel) in found:
            for column, value in zip(columns.values(), found[board.serial, channel], strict=True):
                column[channel] = value
    return replace(board, **{name: tuple(column.tolist()) for name, column in columns.items()})
