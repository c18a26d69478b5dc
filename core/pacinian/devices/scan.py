"""A microphone scan of a device: what was read where, while which channels were driven.

CSV, one channel driven at a time; a row a reading, in any order:

    x,y,z,serial,channel,amplitude,phase

x, y, z: the microphone's position [m], in the frame of the description. serial, channel: which channel is driven
alone, at full drive and phase 0. amplitude: in any unit, the same for all. phase: [rad], -2 pi to 2 pi, positive where
the sound leads, with one reference for the whole scan, such as the drive.

NPZ, many channels driven at a time, which is less noisy:

    positions (M, 3) [m]; drives (K, C) complex, the gain of each of the device's C channels, board by board, in each of
    K >= C patterns; readings (K, M) complex, as amplitude exp(j phase)
"""

from __future__ import annotations

import csv
import math
import zipfile
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from msgspec.structs import replace

from pacinian.checks import check_integer, check_number, check_numbers
from pacinian.devices.scan_fit import MAX_POSITIONS
from pacinian.documents import MAX_BYTES, decode_document
from pacinian.errors import ArgumentError, SceneFileError

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.devices.description import DeviceDescription
    from pacinian.types import Complexes, Floats

COLUMNS = ("x", "y", "z", "serial", "channel", "amplitude", "phase")
MAX_NPZ_BYTES = 1 << 30
MAX_AMPLITUDE = 1e12  # in any unit
MAX_CONDITION = 100.0  # of drives: by how much noise may grow
PHASELESS = (
    "has no phases, and amplitudes alone do not tell them. Read amplitude and phase, with a lock-in amplifier, "
    "or with an oscilloscope that the drive triggers"
)


@dataclass(frozen=True, eq=False)
class Scan:
    """positions: of the microphone [m], (M, 3). readings: complex, (M, C), of each channel; NaN where there is none."""

    positions: Floats
    readings: Complexes

    def __add__(self, other: Scan) -> Scan:
        return Scan(
            np.concatenate([self.positions, other.positions]),
            np.concatenate([self.readings, other.readings]),
        )


def read_scan(path: Path, device: DeviceDescription) -> Scan:
    """Read a scan of `device`, .csv or .npz. Raises SceneFileError, which names the file, the place and the fix."""
    try:
        if path.suffix not in (".csv", ".npz"):
            raise SceneFileError(path, "", "must end in .csv or .npz")
        if not path.is_file():
            raise SceneFileError(path, "", "cannot be read: it is not there, or not a file")
        scan = _read_csv(path, device) if path.suffix == ".csv" else _read_npz(path, device)
    except OSError as error:
        raise SceneFileError(path, "", f"cannot be read: {error.strerror or error}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise SceneFileError(path, "", f"is not CSV: {error}") from error
    except ArgumentError as error:
        raise SceneFileError(path, "", str(error)) from error
    phases = np.angle(scan.readings[np.abs(scan.readings) > 0.0])
    if len(phases) and not np.ptp(phases):
        raise SceneFileError(path, "", PHASELESS)
    return scan


def undo_calibration(path: Path) -> DeviceDescription:
    """A description as if none of its channels differed: without calibration, gains, phases and dead channels.

    Raises SceneFileError.
    """
    from pacinian.devices.description import DeviceDescription

    read = decode_document(path, DeviceDescription)
    boards = tuple(replace(board, gain=1.0, phase=0.0, dead=()) for board in read.boards)
    return replace(read, boards=boards, calibration="")


def _read_csv(path: Path, device: DeviceDescription) -> Scan:
    if path.stat().st_size > MAX_BYTES:
        raise SceneFileError(path, "", f"is larger than {MAX_BYTES >> 20} MiB")
    starts: dict[str, tuple[int, int]] = {}
    count = 0
    for board in device.boards:
        starts[board.serial] = count, board.layout.count
        count += board.layout.count
    rows: dict[tuple[float, ...], Complexes] = {}
    with path.open(encoding="utf-8-sig", newline="") as file:
        lines = csv.reader(file, skipinitialspace=True)
        head = tuple(name.strip() for name in next(lines, []))
        if "amplitude" in head and "phase" not in head:
            raise SceneFileError(path, "line 1", PHASELESS)
        if head != COLUMNS:
            raise SceneFileError(path, "line 1", f"must be {','.join(COLUMNS)}")
        for line in lines:
            if not line:
                continue
            where = f"line {lines.line_num}"
            place, serial, channel, reading = _read_row(path, where, line)
            first, size = starts.get(serial, (0, -1))
            if size < 0:
                known = ", ".join(map(repr, starts))
                raise SceneFileError(path, where, f"no board is {serial!r}; there are {known}")
            if channel >= size:
                raise SceneFileError(path, where, f"{serial!r} has channels 0 to {size - 1}")
            row = rows.setdefault(place, np.full(count, np.nan, np.complex128))
            if len(rows) > MAX_POSITIONS:
                raise SceneFileError(path, where, f"is at the position after {MAX_POSITIONS}")
            if not np.isnan(row[first + channel]):
                raise SceneFileError(path, where, "reads the channel there again: average them")
            row[first + channel] = reading
    if not rows:
        raise SceneFileError(path, "", "holds no reading")
    return Scan(np.array(list(rows)), np.array(list(rows.values())))


def _read_row(
    path: Path, where: str, line: list[str]
) -> tuple[tuple[float, ...], str, int, complex]:
    if len(line) != len(COLUMNS):
        raise SceneFileError(path, where, f"must have {len(COLUMNS)} values, not {len(line)}")
    x, y, z, serial, channel, amplitude, phase = (value.strip() for value in line)
    turn = 2.0 * math.pi + 1e-6
    try:
        place = tuple(check_number(n, float(v)) for n, v in (("x", x), ("y", y), ("z", z)))
        index = check_integer("channel", check_number("channel", float(channel)), low=0)
        size = check_number("amplitude", float(amplitude), low=0.0, high=MAX_AMPLITUDE)
        angle = check_number("phase", float(phase))
    except ArgumentError as error:
        raise SceneFileError(path, where, str(error)) from error
    except ValueError as error:
        raise SceneFileError(path, where, f"must be numbers: {error}") from error
    if abs(angle) > turn:
        raise SceneFileError(
            path, where, f"`phase` must be -2 pi to 2 pi [rad], not {angle:g}: were degrees given?"
        )
    return place, serial, index, size * complex(math.cos(angle), math.sin(angle))


def _read_npz(path: Path, device: DeviceDescription) -> Scan:
    try:
        with zipfile.ZipFile(path) as file:
            if sum(part.file_size for part in file.infolist()) > MAX_NPZ_BYTES:
                raise SceneFileError(path, "", f"is larger than {MAX_NPZ_BYTES >> 20} MiB")
        with np.load(path, allow_pickle=False) as file:
            missing = {"positions", "drives", "readings"} - set(file.files)
            if missing:
                raise SceneFileError(path, "", f"lacks {', '.join(sorted(missing))}")
            q, drives, readings = file["positions"], file["drives"], file["readings"]
    except SceneFileError:
        raise
    except (ValueError, EOFError, MemoryError, zipfile.BadZipFile, NotImplementedError) as error:
        raise SceneFileError(path, "", f"is not NPZ: {error}") from error
    if not np.iscomplexobj(readings):
        raise SceneFileError(path, "readings", PHASELESS)
    q = check_numbers("positions", q, (None, 3))
    C = sum(board.layout.count for board in device.boards)
    Y = _check_complex("readings", readings, len(q), "positions")
    G = _check_complex("drives", drives, C, "channels of the device")
    if len(G) != len(Y):
        raise ArgumentError("readings", f"must be of {len(G)} patterns, as drives, not {len(Y)}")
    return Scan(q, decode_drives(G, Y))


def _check_complex(name: str, value: Complexes, columns: int, what: str) -> Complexes:
    if value.dtype.kind not in "iufc" or value.ndim != 2 or value.shape[1] != columns:
        wanted = f"must be numbers of shape (K, {columns}), {columns} being the {what}"
        raise ArgumentError(name, f"{wanted}, not {value.dtype} {value.shape}")
    made = value.astype(np.complex128)
    if not (np.isfinite(made).all() and np.abs(made).max(initial=0.0) <= MAX_AMPLITUDE):
        raise ArgumentError(name, f"must be finite, and at most {MAX_AMPLITUDE:g}")
    return made


def decode_drives(drives: Complexes, readings: Complexes) -> Complexes:
    """What each channel alone would have been read as, by least squares, (M, C).

    drives: (K, C). readings: (K, M). Raises ArgumentError where the drives do not tell all channels apart.
    """
    K, C = drives.shape
    gram = drives.conj().T @ drives
    powers = np.linalg.eigvalsh(gram) if K >= C else np.zeros(1)  # squares of singular values
    if not powers[0] * MAX_CONDITION**2 > powers[-1]:
        raise ArgumentError(
            "drives",
            f"do not tell the {C} channels apart (condition number above {MAX_CONDITION:g}): use at least {C} "
            f"orthogonal patterns, as a Hadamard matrix has, or {2 * C} random ones",
        )
    return np.asarray(np.linalg.solve(gram, drives.conj().T @ readings).T, np.complex128)
