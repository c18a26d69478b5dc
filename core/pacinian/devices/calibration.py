"""Calibration files: the measured strength and phase of every channel."""

from __future__ import annotations

import csv
import io
import uuid
from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from pacinian import documents
from pacinian.checks import check_integer, check_number
from pacinian.errors import ArgumentError, SceneFileError

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.devices.board import Board

MAX_BYTES = 4 << 20  # size of a file, enough for some 100,000 channels [bytes]
COLUMNS = ("serial", "channel", "gain", "phase")
Measured = dict[tuple[str, int], tuple[float, float]]


def read_calibration(path: Path) -> Measured:
    """Read gain and phase [rad] by serial and channel from a CSV file with these four columns.

    Raises SceneFileError, which names the file, the line and the fix.
    """
    found: Measured = {}
    try:
        text = io.StringIO(documents.read_bytes(path, largest=MAX_BYTES).decode(), newline="")
        rows = csv.reader(text, skipinitialspace=True)
        head = tuple(name.strip() for name in next(rows, []))
        if head != COLUMNS:
            raise SceneFileError(path, "line 1", f"must be {','.join(COLUMNS)}")
        for row in rows:
            if not row:
                continue
            where = f"line {rows.line_num}"
            key, values = _row(path, where, row)
            if key in found:
                raise SceneFileError(path, where, f"measures channel {key[1]} of it again")
            found[key] = values
    except (UnicodeDecodeError, csv.Error) as error:
        raise SceneFileError(path, "", "is not CSV, in UTF-8") from error
    return found


def _row(path: Path, where: str, row: list[str]) -> tuple[tuple[str, int], tuple[float, float]]:
    if len(row) != len(COLUMNS):
        raise SceneFileError(path, where, f"must have {len(COLUMNS)} values, not {len(row)}")
    serial, channel, gain, phase = (value.strip() for value in row)
    try:
        key = serial, check_integer("channel", check_number("channel", float(channel)), low=0)
        values = check_number("gain", float(gain), low=0.0), check_number("phase", float(phase))
    except ArgumentError as error:
        raise SceneFileError(path, where, str(error)) from error
    except ValueError as error:
        raise SceneFileError(path, where, "must be numbers") from error
    return key, values


def write_calibration(path: Path, measured: Measured) -> None:
    """Write a calibration file, replacing an existing one atomically. Raises OSError."""
    beside = path.with_name(f".{path.name}.{uuid.uuid4().hex}")
    try:
        with beside.open("w", encoding="utf-8", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(COLUMNS)
            for (serial, channel), (gain, phase) in measured.items():
                rows.writerow([serial, channel, f"{gain:.5f}", f"{phase:.5f}"])
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


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
    gain, phase = (
        np.broadcast_to(np.asarray(v, float), (L,)).copy() for v in (board.gain, board.phase)
    )
    for channel in range(L):
        if (board.serial, channel) in found:
            gain[channel], phase[channel] = found[board.serial, channel]
    return replace(board, gain=tuple(gain.tolist()), phase=tuple(phase.tolist()))
