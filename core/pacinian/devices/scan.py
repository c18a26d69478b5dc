"""Microphone scans of a device: readings at many positions while known channels were driven.

A CSV file has one reading per row, in any order, with one channel driven at a time:

    x,y,z,serial,channel,amplitude [Pa],phase

x, y, z: position of the microphone [m], in the frame of the description. serial, channel: the only channel that is
driven, at full drive and phase 0. amplitude: peak, in any unit, the same for all rows. phase: [rad], -2 pi to 2 pi,
positive where the sound leads, with one reference for the whole file, such as the drive. A unit in brackets after the
name of a column replaces the default, as in `x [mm]` or `phase [deg]`.

An NPZ or HDF5 file has arrays of a device's C channels, board by board:

    positions (M, 3) [m]; readings (M, C) complex, as amplitude exp(j phase), NaN where missing

or, for patterns that drive many channels at a time, which is less noisy:

    positions (M, 3) [m]; drives (K, C) complex, the gain of each channel in each of K >= C patterns; readings (K, M)

In an HDF5 file, the attribute `units` of a dataset names its unit.
"""

from __future__ import annotations

import csv
import dataclasses
import math
import re
import zipfile
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import replace

from pacinian.argument_checks import check_integer, check_number, check_numbers
from pacinian.config_files import MAX_BYTES, decode_document
from pacinian.devices.calibration import MAX_PHASE
from pacinian.devices.scan_check import MAX_POSITIONS
from pacinian.errors import ArgumentError, MissingExtra, SceneFileError

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.devices.description import DeviceDescription
    from pacinian.types import Complexes, Floats, Longs

COLUMNS = ("x", "y", "z", "serial", "channel", "amplitude", "phase")
ARRAYS = ("positions", "drives", "readings")
MAX_ARRAY_BYTES = 1 << 30  # size of the arrays of a file, unpacked [bytes]
LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "\u00b5m": 1e-6}
ANGLES = {"rad": 1.0, "deg": math.pi / 180.0}
SIZES = {
    prefix + unit: (scale, unit)
    for unit in ("Pa", "V")
    for prefix, scale in (("", 1.0), ("k", 1e3), ("m", 1e-3), ("u", 1e-6), ("\u00b5", 1e-6))
}  # to the base unit
MAX_AMPLITUDE = 1e12  # reading, in the scan's unit
MAX_CONDITION = 100.0  # condition number of the drives, by which noise may grow
REPEAT_ADVICE = "average the two readings, or give the second position its own measured coordinates"
READ_PHASES = (
    "Phases cannot be computed from the amplitudes. Read amplitude and phase, with a lock-in amplifier or with an "
    "oscilloscope that the drive triggers"
)


@dataclass(frozen=True, eq=False)
class Scan:
    """A scan at M different positions.

    positions: of the microphone [m], (M, 3). readings: of each channel, complex, (M, C); NaN if missing. files: number
    of the file that each reading comes from, (M, C). unit: of the readings, "Pa", "V" or "", which is unknown.
    """

    positions: Floats
    readings: Complexes
    files: Longs
    unit: str = ""

    def __add__(self, other: Scan) -> Scan:
        """Return both as one scan, the files of `other` after those of this one.

        Raises ArgumentError if both read a channel at one position, or in other units.
        """
        if self.unit != other.unit:
            raise ArgumentError("scans", f"have two units, {self.unit!r} and {other.unit!r}")
        return merge_positions(
            Scan(
                np.concatenate([self.positions, other.positions]),
                np.concatenate([self.readings, other.readings]),
                np.concatenate([self.files, other.files + self.files.max(initial=0) + 1]),
                self.unit,
            )
        )


def merge_positions(scan: Scan) -> Scan:
    """Return a scan with one row for each position, because all readings at a position share its error.

    Raises ArgumentError if a channel was read twice at a position.
    """
    places, row = np.unique(scan.positions, axis=0, return_inverse=True)
    if len(places) == len(scan.positions):
        return scan
    row = row.reshape(-1)
    merged = np.full((len(places), scan.readings.shape[1]), np.nan, np.complex128)
    files = np.zeros(merged.shape, np.int64)
    for m, values, numbers in zip(row, scan.readings, scan.files, strict=True):
        given = ~np.isnan(values)
        if (twice := given & ~np.isnan(merged[m])).any():
            place = " ".join(f"{x:g}" for x in places[m])
            raise ArgumentError(
                "positions",
                f"contain {place} m twice, and {int(twice.sum())} channels were read both times: {REPEAT_ADVICE}",
            )
        merged[m, given], files[m, given] = values[given], numbers[given]
    return Scan(places, merged, files, scan.unit)


def read_scan(path: Path, device: DeviceDescription) -> Scan:
    """Read a scan of `device`: .csv, .npz, or .h5 or .hdf5, which need the extra `scans`.

    Raises SceneFileError, which names the file, the place and the fix, and MissingExtra.
    """
    readers = {".csv": _read_csv, ".npz": _read_npz, ".h5": _read_hdf5, ".hdf5": _read_hdf5}
    try:
        if path.suffix not in readers:
            raise SceneFileError(path, "", f"must end in {', '.join(readers)}")
        if not path.is_file():
            raise SceneFileError(path, "", "cannot be read: it is not there, or not a file")
        scan = readers[path.suffix](path, device)
    except OSError as error:
        raise SceneFileError(path, "", f"cannot be read: {error.strerror or error}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise SceneFileError(path, "", f"is not CSV: {error}") from error
    except ArgumentError as error:
        raise SceneFileError(path, "", str(error)) from error
    with np.errstate(invalid="ignore"):
        phases = np.angle(scan.readings[np.abs(scan.readings) > 0.0])
    if len(phases) and not np.ptp(phases):
        raise SceneFileError(path, "", f"all phases are equal. {READ_PHASES}")
    return scan


def undo_calibration(path: Path) -> DeviceDescription:
    """Read a description and drop its calibration, gains, phases and dead channels, as if all channels were ideal.

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
        head, units = _read_head(path, next(lines, []))
        if "amplitude" in head and "phase" not in head:
            raise SceneFileError(path, "line 1", f"has no phases. {READ_PHASES}")
        if head != COLUMNS:
            wanted = f"{','.join(COLUMNS)}, with units in brackets if others than m and rad"
            raise SceneFileError(path, "line 1", f"must be {wanted}")
        for line in lines:
            if not line:
                continue
            where = f"line {lines.line_num}"
            place, serial, channel, reading = _read_row(path, where, line, units)
            first, size = starts.get(serial, (0, -1))
            if size < 0:
                known = ", ".join(map(repr, starts))
                raise SceneFileError(path, where, f"no board is {serial!r}; there are {known}")
            if channel >= size:
                raise SceneFileError(path, where, f"{serial!r} has channels 0 to {size - 1}")
            row = rows.setdefault(place, np.full(count, np.nan, np.complex128))
            if len(rows) > MAX_POSITIONS:
                raise SceneFileError(path, where, f"has more than {MAX_POSITIONS} positions")
            if not np.isnan(row[first + channel]):
                problem = f"reads this channel again at this position: {REPEAT_ADVICE}"
                raise SceneFileError(path, where, problem)
            row[first + channel] = reading
    if not rows:
        raise SceneFileError(path, "", "holds no reading")
    return _make_single(np.array(list(rows)), np.array(list(rows.values())), units.unit)


@dataclass(frozen=True)
class _Units:
    """Factors to [m], to the base unit `unit` ("Pa", "V" or "") and to [rad]."""

    lengths: tuple[float, ...] = (1.0, 1.0, 1.0)
    scale: float = 1.0
    unit: str = ""
    angle: float = 1.0


def _read_head(path: Path, cells: list[str]) -> tuple[tuple[str, ...], _Units]:
    """Return the names of the columns, and the units in brackets behind them."""
    found = [
        re.fullmatch(r"\s*([^\s\[(]*)\s*(?:[\[(]\s*([^\])]*?)\s*[\])])?\s*", cell) for cell in cells
    ]
    names = tuple(one[1] if one else cell for one, cell in zip(found, cells, strict=True))
    given = {one[1]: one[2] for one in found if one and one[2] is not None}
    known: dict[str, dict[str, Any]] = {
        **dict.fromkeys("xyz", LENGTHS), "amplitude": SIZES, "phase": ANGLES
    }  # fmt: skip
    for name, bracketed in given.items():
        if name in known and bracketed not in known[name]:
            raise SceneFileError(
                path, "line 1", f"has `{name}` in {bracketed!r}; there are {', '.join(known[name])}"
            )
    scale, unit = SIZES[given["amplitude"]] if "amplitude" in given else (1.0, "")
    lengths = tuple(LENGTHS[given.get(axis, "m")] for axis in "xyz")
    return names, _Units(lengths, scale, unit, ANGLES[given.get("phase", "rad")])


def _read_row(
    path: Path, where: str, line: list[str], units: _Units
) -> tuple[tuple[float, ...], str, int, complex]:
    if len(line) != len(COLUMNS):
        raise SceneFileError(path, where, f"must have {len(COLUMNS)} values, not {len(line)}")
    x, y, z, serial, channel, amplitude, phase = (value.strip() for value in line)
    try:
        place = tuple(
            check_number(n, float(v)) * unit
            for n, v, unit in zip("xyz", (x, y, z), units.lengths, strict=True)
        )
        index = check_integer("channel", check_number("channel", float(channel)), low=0)
        size = check_number("amplitude", float(amplitude), low=0.0, high=MAX_AMPLITUDE)
        angle = check_number("phase", float(phase)) * units.angle
    except ArgumentError as error:
        raise SceneFileError(path, where, str(error)) from error
    except ValueError as error:
        raise SceneFileError(path, where, f"must be numbers: {error}") from error
    if abs(angle) > MAX_PHASE:
        raise SceneFileError(
            path,
            where,
            f"`phase` must be -2 pi to 2 pi [rad], not {angle:g}: were degrees given? Then name the column phase [deg]",
        )
    return place, serial, index, units.scale * size * complex(math.cos(angle), math.sin(angle))


def _read_npz(path: Path, device: DeviceDescription) -> Scan:
    try:
        with zipfile.ZipFile(path) as file:
            if sum(part.file_size for part in file.infolist()) > MAX_ARRAY_BYTES:
                raise SceneFileError(path, "", f"is larger than {MAX_ARRAY_BYTES >> 20} MiB")
        with np.load(path, allow_pickle=False) as file:
            parts = {name: file[name] for name in ARRAYS if name in file.files}
    except SceneFileError:
        raise
    except (ValueError, EOFError, MemoryError, zipfile.BadZipFile, NotImplementedError) as error:
        raise SceneFileError(path, "", f"is not NPZ: {error}") from error
    return _make_scan(path, parts, device)


def _read_hdf5(path: Path, device: DeviceDescription) -> Scan:
    try:
        import h5py
    except ImportError as error:
        raise MissingExtra("h5py", "scans") from error
    try:
        with h5py.File(path, "r") as file:
            parts: dict[str, Any] = {}
            units: dict[str, str] = {}
            for name in ARRAYS:
                link = file.get(name, getlink=True)
                if link is None:
                    continue
                data = file[name] if isinstance(link, h5py.HardLink) else None
                if not isinstance(data, h5py.Dataset) or data.is_virtual or data.external:
                    raise SceneFileError(path, name, "must be a dataset in this file, not a link")
                if data.shape is None:
                    raise SceneFileError(path, name, "is empty: it must have a shape")
                if data.nbytes > MAX_ARRAY_BYTES:
                    raise SceneFileError(path, name, f"is larger than {MAX_ARRAY_BYTES >> 20} MiB")
                parts[name], units[name] = np.asarray(data[()]), _read_unit(data.attrs)
    except SceneFileError:
        raise
    except (OSError, ValueError, KeyError, RuntimeError, TypeError, MemoryError) as error:
        raise SceneFileError(path, "", f"is not HDF5: {error}") from error
    for name, known in (("positions", LENGTHS), ("readings", SIZES)):
        if units.get(name) and units[name] not in known:
            raise SceneFileError(
                path, name, f"are in {units[name]!r}; there are {', '.join(known)}"
            )
    scan = _make_scan(path, parts, device)
    scale, unit = SIZES.get(units["readings"], (1.0, ""))
    length = LENGTHS.get(units["positions"], 1.0)
    return dataclasses.replace(
        scan, positions=scan.positions * length, readings=scan.readings * scale, unit=unit
    )


def _read_unit(attributes: Any) -> str:
    given = attributes.get("units", "")
    return given.decode(errors="replace") if isinstance(given, bytes) else str(given)


def _make_scan(path: Path, parts: dict[str, Any], device: DeviceDescription) -> Scan:
    """Return the scan that the arrays of a file hold. Raises ArgumentError, SceneFileError."""
    missing = {"positions", "readings"} - set(parts)
    if missing:
        raise SceneFileError(path, "", f"lacks {', '.join(sorted(missing))}")
    readings = parts["readings"]
    if readings.dtype.names and {"real", "imag"} <= set(readings.dtype.names):  # by MATLAB
        readings = readings["real"] + 1j * readings["imag"]
    if not np.iscomplexobj(readings):
        raise SceneFileError(path, "readings", f"has no phases. {READ_PHASES}")
    q = check_numbers("positions", parts["positions"], (None, 3))
    C = sum(board.layout.count for board in device.boards)
    if "drives" not in parts:
        Y = _check_complex("readings", readings, C, "channels of the device", gaps=True)
        if len(Y) != len(q):
            raise ArgumentError("readings", f"must be of {len(q)} positions, not {len(Y)}")
        return merge_positions(_make_single(q, Y))
    Y = _check_complex("readings", readings, len(q), "positions")
    G = _check_complex("drives", parts["drives"], C, "channels of the device")
    if len(G) != len(Y):
        raise ArgumentError("readings", f"must be of {len(G)} patterns, as drives, not {len(Y)}")
    return merge_positions(_make_single(q, decode_drives(G, Y)))


def _make_single(positions: Floats, readings: Complexes, unit: str = "") -> Scan:
    """Return the scan of one file."""
    return Scan(positions, readings, np.zeros(readings.shape, np.int64), unit)


def _check_complex(
    name: str, value: Complexes, columns: int, what: str, *, gaps: bool = False
) -> Complexes:
    """Return a matrix of complex numbers. gaps: whether NaN, which means missing, may be there."""
    if value.dtype.kind not in "iufc" or value.ndim != 2 or value.shape[1] != columns:
        wanted = f"must be numbers of shape (K, {columns}), {columns} being the {what}"
        raise ArgumentError(name, f"{wanted}, not {value.dtype} {value.shape}")
    made = value.astype(np.complex128)
    there = made[~np.isnan(made)] if gaps else made
    if not (np.isfinite(there).all() and np.abs(there).max(initial=0.0) <= MAX_AMPLITUDE):
        raise ArgumentError(name, f"must be finite, and at most {MAX_AMPLITUDE:g}")
    return made


def decode_drives(drives: Complexes, readings: Complexes) -> Complexes:
    """Solve by least squares for the reading of each channel alone, (M, C).

    drives: (K, C). readings: (K, M). Raises ArgumentError if the drives cannot separate all channels.
    """
    K, C = drives.shape
    gram = drives.conj().T @ drives
    powers = np.linalg.eigvalsh(gram) if K >= C else np.zeros(1)  # squares of singular values
    if not powers[0] * MAX_CONDITION**2 > powers[-1]:
        raise ArgumentError(
            "drives",
            f"do not distinguish the {C} channels (condition number above {MAX_CONDITION:g}): use at least {C} "
            f"orthogonal patterns, as a Hadamard matrix has, or {2 * C} random ones",
        )
    return np.asarray(np.linalg.solve(gram, drives.conj().T @ readings).T, np.complex128)
