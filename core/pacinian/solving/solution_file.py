"""Solution files: one MessagePack map that holds a solution and its whole problem.

msgspec decodes the map and checks its types; the constructors of the parts check the values. Arrays are stored as type,
shape and little-endian bytes, so that any MessagePack library can read them. The file ends with the SHA-256 of all
bytes before it.
"""

from __future__ import annotations

import hashlib
import math
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import msgspec
import numpy as np
from msgspec import Struct

from pacinian.acoustics import array_record
from pacinian.acoustics.air import Air
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.argument_checks import check_near, check_number, check_numbers
from pacinian.atomic_file import replace_file
from pacinian.errors import ArgumentError, SolutionFileError, describe_error
from pacinian.solving.felt_figures import FeltRegion
from pacinian.solving.limits import Limits
from pacinian.solving.quiet_zone import Zone
from pacinian.solving.solution_metrics import SolutionMetrics
from pacinian.solving.solution_status import Status
from pacinian.solving.targets import Targets

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.types import Complexes, Floats

FORMAT = "pacinian solution"
VERSION = 1
MAX_BYTES = 256 << 20  # largest size of a file [bytes]
DIGEST_BYTES = 32  # size of a SHA-256 digest [bytes]
# Excess of a gain over its limit, relative to it, that counts as rounding.
ROUNDING_TOLERANCE = 1e-4


class Numbers(Struct, frozen=True, forbid_unknown_fields=True):
    """An array. kind: NumPy's name of its type, little-endian. data: its bytes, in C order."""

    kind: Literal["<f8", "<c8", "<c16", "<i8", "|b1"]
    shape: tuple[int, ...]
    data: bytes


class ArrayRecord(Struct, frozen=True, forbid_unknown_fields=True):
    """An array of transducers. settings: their type and responses, as in a recording."""

    positions: Numbers
    normals: Numbers
    settings: dict[str, Any]


class MediumRecord(Struct, frozen=True, forbid_unknown_fields=True):
    """The parameters of `Air`, with the speed of sound [m/s] and the density [kg/m^3] that were used."""

    temperature: float | None
    humidity: float
    ambient_pressure: float
    speed_of_sound: float
    density: float
    attenuation: str | float
    absorption: float | None


class TargetsRecord(Struct, frozen=True, forbid_unknown_fields=True):
    """The parameters of `Targets`."""

    amplitudes: Numbers
    phases: Numbers
    scale: Literal["exact", "max"]
    regions: Numbers | None


class ZoneRecord(Struct, frozen=True, forbid_unknown_fields=True):
    """The parameters of `Zone`."""

    position: tuple[float, float, float]
    pressure: float
    radius: float


class LimitsRecord(Struct, frozen=True, forbid_unknown_fields=True):
    """The parameters of `Limits`."""

    gain: float | None
    power: float | None
    quiet: tuple[Numbers, Numbers] | None
    exact: Numbers | None
    zones: tuple[ZoneRecord, ...]


class FacingRecord(Struct, frozen=True, forbid_unknown_fields=True):
    """The parameters of `SkinFacing`."""

    normals: Numbers
    capsules: Numbers
    edge: float


class SolutionRecord(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The contents of a solution file; the names are those of `Solution`.

    digest: last, the SHA-256 of the file's bytes before it. Another program may leave it out; then nothing is compared.
    """

    format: Literal["pacinian solution"]
    version: int
    versions: dict[str, str]
    array: ArrayRecord
    medium: MediumRecord
    points: Numbers
    facing: FacingRecord | None
    targets: TargetsRecord
    limits: LimitsRecord
    gains: Numbers
    sound_pressure: Numbers
    status: str
    solver: str
    iterations: int
    bound: float
    objective: float
    multipliers: Numbers | None
    mu: float
    violations: dict[str, float]
    seconds: float
    note: str
    gain_limit: float
    felt: tuple[tuple[float, float, float, float], ...]
    late: bool
    asked_phases: Numbers | None
    quiet_weight: float
    least_error: float
    digest: bytes = b""


class _Header(Struct):
    """The fields that are read before the others."""

    format: str = ""
    version: int = 0


_decoder = msgspec.msgpack.Decoder(SolutionRecord)
_header = msgspec.msgpack.Decoder(_Header)
PLAIN = (
    "status", "solver", "iterations", "bound", "objective", "mu", "violations", "seconds", "note", "gain_limit", "felt",
    "late", "quiet_weight", "least_error",
)  # fields that need no conversion, except for the status  # fmt: skip


def save_values(solution: SolutionMetrics, path: str | Path) -> None:
    """Write a solution to a file, which replaces an existing one as a whole.

    Raises ArgumentError if a part cannot be stored, SolutionFileError if the file cannot be written.
    """
    array, kept = solution.array, solution.limits
    settings = array_record.to_map(array)
    if settings["transducer"]["directivity"] is None:
        raise ArgumentError(
            "array",
            "has a directivity that is a Python function, which a file cannot hold: solve with a table of it, "
            "`pacinian.DirectivityTable.sample(function)`, or with `pacinian.Piston`, `t4010a1` or `omni`",
        )
    facing, quiet, targets = solution.facing, kept.quiet, solution.targets
    _check_evidence(solution)
    values: dict[str, Any] = {name: getattr(solution, name) for name in PLAIN}
    values |= {"status": solution.status.name, "violations": dict(solution.violations)}
    record = SolutionRecord(
        **values,
        format="pacinian solution",
        version=VERSION,
        versions=current_versions(),
        array=ArrayRecord(_pack(array.positions), _pack(array.normals), settings),
        medium=MediumRecord(**{f: getattr(solution.medium, f) for f in MediumRecord.__struct_fields__}),
        points=_pack(solution.points),
        facing=None if facing is None else FacingRecord(_pack(facing.normals), _pack(facing.capsules), facing.edge),
        targets=TargetsRecord(
            _pack(targets.amplitudes), _pack(targets.phases), targets.scale, _pack_optional(targets.regions)
        ),
        limits=LimitsRecord(
            kept.gain,
            kept.power,
            None if quiet is None else (_pack(quiet[0]), _pack(quiet[1])),
            _pack_optional(kept.exact),
            tuple(ZoneRecord(zone.position, zone.pressure, zone.radius) for zone in kept.zones),
        ),
        gains=_pack(solution.gains),
        sound_pressure=_pack(solution.sound_pressure),
        multipliers=_pack_optional(solution.multipliers),
        asked_phases=_pack_optional(solution.asked_phases),
        digest=bytes(DIGEST_BYTES),
    )  # fmt: skip
    data = msgspec.msgpack.encode(record)[:-DIGEST_BYTES]
    data += hashlib.sha256(data).digest()
    if len(data) > MAX_BYTES:
        raise SolutionFileError(path, f"would be larger than {MAX_BYTES >> 20} MiB")
    try:
        with replace_file(Path(path)) as file:
            file.write(data)
    except (OSError, ValueError) as error:  # ValueError: a null byte in the path
        problem = getattr(error, "strerror", None) or error
        raise SolutionFileError(path, f"cannot be written: {problem}") from error


def load_values(path: str | Path) -> dict[str, Any]:
    """Read the fields of a solution from a file, by name, and check all. Raises SolutionFileError."""
    data = _read(Path(path))
    try:
        header = _header.decode(data)
    except (msgspec.MsgspecError, ValueError, RecursionError) as error:
        raise SolutionFileError(path, "is no solution file, or is cut short") from error
    if header.format != FORMAT:
        raise SolutionFileError(path, "is no solution file of Pacinian")
    if header.version != VERSION:
        raise SolutionFileError(
            path, f"has version {header.version}, not {VERSION}: update Pacinian"
        )
    try:
        record = _decoder.decode(data)
        if record.digest and record.digest != hashlib.sha256(data[:-DIGEST_BYTES]).digest():
            raise ArgumentError("digest", "differs from that of the other bytes")
        return _make_values(record)
    except Exception as error:  # damaged bytes can raise anything
        raise SolutionFileError(path, f"is damaged: {describe_error(error)}") from error


def current_versions() -> dict[str, str]:
    """Return the versions of Pacinian, NumPy and Python."""
    try:
        own = version("pacinian")
    except PackageNotFoundError:  # run from a copy of the sources
        own = "unknown"
    return {"pacinian": own, "numpy": np.__version__, "python": platform.python_version()}


def _read(path: Path) -> bytes:
    try:
        if not path.is_file():
            raise SolutionFileError(path, "does not exist, or is not a file")
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, SolutionFileError):
            raise
        raise SolutionFileError(path, f"cannot be read: {error}") from error
    if len(data) > MAX_BYTES:
        raise SolutionFileError(path, f"is larger than {MAX_BYTES >> 20} MiB")
    return data


def _make_values(record: SolutionRecord) -> dict[str, Any]:
    """Make the fields of a solution. Raises ArgumentError, and others, if the values do not fit together."""
    array = _make_array(record.array)
    N, points = len(array), check_numbers("points", _unpack(record.points, "f"), (None, 3))
    M = len(points)
    check_near("points", points, array.centre)
    stored, kept, facing = record.targets, record.limits, record.facing
    targets = Targets.make_checked(
        M, _unpack(stored.amplitudes, "f"), _unpack(stored.phases, "f"), stored.scale,
        _unpack_optional(stored.regions, "i"),
    )  # fmt: skip
    quiet = (
        None if kept.quiet is None else (_unpack(kept.quiet[0], "f"), _unpack(kept.quiet[1], "f"))
    )
    limits = Limits(
        gain=kept.gain, power=kept.power, quiet=quiet, exact=_unpack_optional(kept.exact, "ib"),
        zones=tuple(Zone(zone.position, pressure=zone.pressure, radius=zone.radius) for zone in kept.zones),
    )  # fmt: skip
    limits.make_exact_mask(M)
    if record.status not in Status.__members__:
        raise ArgumentError("status", f"must be one of {', '.join(Status.__members__)}")
    medium = Air(**msgspec.structs.asdict(record.medium))
    multipliers, phases = (
        _unpack_optional(record.multipliers, "c"),
        _unpack_optional(record.asked_phases, "f"),
    )
    plain: dict[str, Any] = {name: getattr(record, name) for name in PLAIN}
    plain["status"] = Status[record.status]
    plain["felt"] = tuple(FeltRegion(*part) for part in record.felt)
    values = dict(
        **plain,
        gains=_finite("gains", _unpack(record.gains, "c"), N),
        array=array,
        medium=medium,
        points=points,
        targets=targets,
        limits=limits,
        sound_pressure=_finite("sound_pressure", _unpack(record.sound_pressure, "c"), M),
        facing=None if facing is None else _make_facing(facing, M),
        multipliers=None if multipliers is None else _finite("multipliers", multipliers, M),
        asked_phases=None if phases is None else _finite("asked_phases", phases, M),
        versions=record.versions,
    )  # fmt: skip
    _check_evidence(SolutionMetrics(**values))
    return values


def _check_evidence(solution: SolutionMetrics) -> None:
    """Refuse numbers of a solution that no solve gives. Raises ArgumentError."""
    for name in ("iterations", "seconds", "quiet_weight"):
        check_number(name, getattr(solution, name), low=0.0)
    for name in ("objective", "mu", "least_error"):  # NaN if not known
        if not math.isnan(value := getattr(solution, name)):
            check_number(name, value, low=0.0)
    if math.isinf(solution.bound):
        raise ArgumentError("bound", f"must be finite, or NaN, not {solution.bound}")
    for name, value in solution.violations.items():
        check_number(f"violations[{name!r}]", value, low=0.0)
    for felt in solution.felt:
        check_numbers("felt", felt, (len(FeltRegion._fields),))
    top = math.inf if solution.limits.gain is None else solution.limits.gain
    if solution.gain_limit != top:
        raise ArgumentError(
            "gain_limit", f"must be {top:g}, as in `limits`, not {solution.gain_limit:g}"
        )
    highest = float(np.abs(solution.gains).max(initial=0.0))
    if highest > (1.0 + ROUNDING_TOLERANCE) * top and "gain" not in solution.violations:
        raise ArgumentError("gains", f"must be at most {top:g}, their limit, not {highest:g}")


def _make_array(record: ArrayRecord) -> Array:
    r, n = _unpack(record.positions, "f"), _unpack(record.normals, "f")
    check_numbers("positions", r, (None, 3))
    check_numbers("normals", n, r.shape)
    if not (np.abs((n * n).sum(axis=1) - 1.0) < 1e-9).all():
        raise ArgumentError("normals", "must be unit vectors")
    return array_record.from_map(record.settings, r, n)


def _make_facing(record: FacingRecord, count: int) -> SkinFacing:
    facing = SkinFacing(_unpack(record.normals, "f"), _unpack(record.capsules, "f"), record.edge)
    if len(facing) != count:
        raise ArgumentError("facing", f"must have {count} normals, as many as points")
    return facing


def _finite(name: str, values: Complexes | Floats, count: int) -> Complexes | Floats:
    if values.shape != (count,) or not np.isfinite(values).all():
        raise ArgumentError(name, f"must be {count} finite numbers")
    return values


def _pack(values: Any) -> Numbers:
    array = np.ascontiguousarray(values)
    kind: Any = {
        "f": "<f8",
        "i": "<i8",
        "u": "<i8",
        "b": "|b1",
        "c": "<c8" if array.itemsize == 8 else "<c16",
    }
    kind = kind[array.dtype.kind]
    return Numbers(kind, array.shape, array.astype(kind, copy=False).tobytes())


def _pack_optional(values: Any) -> Numbers | None:
    return None if values is None else _pack(values)


def _unpack(numbers: Numbers, kinds: str) -> Any:
    """Return an array, read-only, whose type is one of `kinds`. Raises ArgumentError."""
    made = np.dtype(numbers.kind)
    if made.kind not in kinds:
        raise ArgumentError("kind", f"must be one of {', '.join(kinds)}, not {numbers.kind}")
    if any(side < 0 for side in numbers.shape) or math.prod(numbers.shape) * made.itemsize != len(
        numbers.data
    ):
        raise ArgumentError("shape", f"{numbers.shape} does not fit {len(numbers.data)} bytes")
    return np.frombuffer(numbers.data, made).reshape(numbers.shape)


def _unpack_optional(numbers: Numbers | None, kinds: str) -> Any:
    return None if numbers is None else _unpack(numbers, kinds)
