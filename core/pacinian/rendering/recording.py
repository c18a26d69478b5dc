"""Recordings: scene, decisions and frame of every tick, in one self-contained file that survives an interruption.

The file is a stream of MessagePack maps: one header, then one map per tick. It is append-only, so a truncated file is
valid up to its last complete tick.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import msgpack
import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array_record import from_map, to_map
from pacinian.argument_checks import check_number
from pacinian.errors import ArgumentError, PacinianError, RecordingError, describe_error, shorten
from pacinian.exclusive_lock import try_lock
from pacinian.notebook import Card, card
from pacinian.plugins.backend import Capability, Frame
from pacinian.rendering.library_versions import list_versions
from pacinian.rendering.scene_log import Reader, TickInput, Writer
from pacinian.scene.sampling.sample_counts import ObjectSampleCounts

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from pacinian.acoustics.array import Array
    from pacinian.rendering.deviation_log import Reasons
    from pacinian.rendering.scene_log import TickOutcome
    from pacinian.scene.sampling.sample_counts import SampleCounts
    from pacinian.scene.scene import Scene
    from pacinian.types import Floats

FORMAT = "pacinian recording"
VERSION = 5
MAX_MAP_BYTES = 1 << 28  # largest size of one map [bytes]
MAX_NORMAL_ERROR = 1e-6  # largest deviation of the length of a normal from 1
MAX_TIME = 1e12  # largest plausible time of a tick [s]


@dataclass(frozen=True, eq=False)
class Tick:
    """One tick of a recording.

    frame: as sent. time: of the scene [s]. asked: scene, solver and limits; None if they could not be recorded.
    clock: the tick's clock readings [s], which determine its decisions. job_clock: those of sampling and solving, for
    the results that the tick took. begins: whether the renderer was reset just before. sent: clock reading after the
    frame was sent [s]; `frame.time` is when it was due. objects: by label, what each object asked for, and
    how much of it was rendered. deviations: what was not as asked, by label and reason, as in `Report.deviations`.
    """

    frame: Frame
    time: float = 0.0
    asked: TickInput | None = None
    clock: tuple[float, ...] = ()
    job_clock: tuple[float, ...] = ()
    begins: bool = False
    sent: float = math.nan
    objects: Mapping[str, ObjectSampleCounts] = field(default_factory=dict)
    deviations: Reasons = field(default_factory=dict)


class Recorder:
    """Writes a recording of one run. Raises RecordingError if the file cannot be written, or is no recording.

    Pass it to a `Renderer`, which opens and closes it. An earlier recording in the file stays until the run begins.
    unrecorded: why a scene could not be written, for example because it contains a Python function; "" if all could.
    Frames are written in any case.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.unrecorded = ""
        self._pack = msgpack.Packer(use_single_float=False).pack
        self._writer, self._begins = Writer(), True
        self._sample_counts: SampleCounts | None = None  # as written last
        self._deviations: Reasons = {}
        self._file: IO[bytes] | None = None
        self._check()
        try:
            if not self.path.exists() or self.path.is_file() or self.path.is_dir():
                self.path.open("ab").close()
        except (OSError, ValueError) as error:
            raise RecordingError(self.path, f"cannot be written: {error}") from error

    def _check(self) -> None:
        """Refuse to overwrite a file that is neither empty nor a recording. Raises RecordingError."""
        try:
            used = self.path.is_file() and self.path.stat().st_size > 0
        except (OSError, ValueError) as error:
            raise RecordingError(self.path, f"cannot be written: {error}") from error
        if used and not is_recording(self.path):
            problem = "exists but is not a recording, so Pacinian does not overwrite it: use another name, or delete it"
            raise RecordingError(self.path, problem)

    def begin(self, array: Array, capability: Capability, settings: dict[str, Any]) -> None:
        """Write the header, in place of an earlier recording. settings: further settings that a replay needs.

        Raises RecordingError, also if another run records to the file.
        """
        if self._file is not None:
            raise RecordingError(self.path, "has a run already: make a new Recorder for each run")
        self._check()
        try:
            self._file = self._open()
        except OSError as error:
            raise RecordingError(self.path, f"cannot be written: {error}") from error
        self._write(
            {
                "format": FORMAT,
                "version": VERSION,
                "positions": array.positions.astype("<f8").tobytes(),
                "normals": array.normals.astype("<f8").tobytes(),
                "phases": capability.phases,
                "amplitudes": capability.amplitudes,
                "rate": capability.rate,
                "settings": settings,
                "made": list_versions(),
            }
        )

    def _open(self) -> IO[bytes]:
        """Return the file, empty and locked. Raises RecordingError if another run records to it; OSError."""
        if self.path.exists() and not self.path.is_file():  # a pipe or a device
            return self.path.open("wb")
        file = self.path.open("ab")  # another run's recording stays until it is locked
        try:
            if not _lock(file):
                raise RecordingError(
                    self.path, "is being recorded by another run: give another name"
                )
            file.truncate(0)
        except BaseException:
            file.close()
            raise
        return file

    def prepare(self, scene: Scene) -> None:
        """Read the files of a scene, for example of meshes, before the first tick, which would be late otherwise."""
        # the first tick notes why they cannot be recorded
        with suppress(PacinianError, TypeError, ValueError, OverflowError, RecursionError):
            self._writer.prepare(scene)

    def mark_reset(self) -> None:
        """Mark the next tick as the first after a reset of the renderer."""
        self._begins = True

    def write(
        self,
        frame: Frame,
        time: float = 0.0,
        asked: TickInput | None = None,
        readings: tuple[list[float], list[float]] | None = None,
        outcome: TickOutcome | None = None,
        *,
        same: bool = False,
    ) -> None:
        """Append a tick.

        readings: of the tick's clock, and of the jobs' [s]. same: whether its frame repeats the levels before it.
        """
        values: dict[str, Any] = {"sequence": frame.sequence, "time": frame.time, "t": time}
        if not same:
            values["phase"] = frame.phase.astype("<u2", copy=False).tobytes()
            values["amplitude"] = frame.amplitude.astype("<u2", copy=False).tobytes()
        if readings is not None:
            values["clock"], values["job_clock"] = readings
        if outcome is not None:
            values["sent"] = outcome.sent
            if outcome.sample_counts is not self._sample_counts:
                self._sample_counts = outcome.sample_counts
                values["objects"] = {k: tuple(v) for k, v in outcome.sample_counts.objects.items()}
            if outcome.deviations != self._deviations:
                self._deviations = values["deviations"] = outcome.deviations
        if self._begins:
            values["begins"], self._begins = True, False
        if asked is not None and not self.unrecorded:
            try:
                values["new"] = self._writer.changes(asked)
            except ArgumentError as error:
                self.unrecorded = values["unrecorded"] = describe_error(error)
        self._write(values)

    def close(self) -> None:
        """End the file; may be called twice."""
        try:
            if self._file is not None:
                self._file.close()
        except OSError as error:
            raise RecordingError(self.path, f"cannot be written: {error}") from error

    def _write(self, values: dict[str, Any]) -> None:
        assert self._file is not None, "begin comes first"
        try:
            self._file.write(self._pack(values))
        except (OSError, ValueError) as error:
            raise RecordingError(self.path, f"cannot be written: {error}") from error


def is_recording(path: Path) -> bool:
    """Return whether a file begins as a recording does, although it may be damaged; False if it cannot be read."""
    try:
        with path.open("rb") as file:
            return FORMAT.encode() in file.read(2 * len(FORMAT))
    except OSError:
        return False


class Recording:
    """Reads a recording: the array, the device's capability, and the ticks.

    Raises RecordingError if the file is not a recording. A truncated last tick is ignored.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        header = next(self._maps(), None)
        if header is None or header.get("format") != FORMAT:
            raise RecordingError(self.path, "is not a Pacinian recording")
        version = header.get("version")
        if version != VERSION:
            older = isinstance(version, int) and version < VERSION
            remedy = "record it again" if older else "update Pacinian"
            raise RecordingError(
                self.path, f"has version {shorten(repr(version))}, not {VERSION}: {remedy}"
            )
        try:
            self.positions: Floats = np.frombuffer(header["positions"], "<f8").reshape(-1, 3)
            self.normals: Floats = np.frombuffer(header["normals"], "<f8").reshape(-1, 3)
            self.capability = Capability(header["phases"], header["amplitudes"], header["rate"])
            self.settings: dict[str, Any] = dict(header["settings"])
            self.tick_rate = check_number("rate", self.settings["rate"], low=0.9, high=1.1e5)
            """Ticks per second when recorded [Hz]."""
            self.medium = Air(**self.settings["medium"])
            self.environment = {str(k): str(v) for k, v in header["made"].items()}
            """Versions of Pacinian and of what computes for it, the variant of its kernels, and the processor."""
            if len(self.normals) != len(self.positions) or not len(self.positions):
                raise ValueError("positions and normals do not fit")
            if not (np.isfinite(self.positions).all() and np.isfinite(self.normals).all()):
                raise ValueError("positions and normals are not finite")
            sizes = np.linalg.norm(np.clip(self.normals, -2.0, 2.0), axis=1)
            if not (np.abs(sizes - 1.0) < MAX_NORMAL_ERROR).all():
                raise ValueError("normals must be unit vectors")
        except (KeyError, ValueError, TypeError, AttributeError) as error:
            raise RecordingError(self.path, f"has a damaged header: {error}") from error

    @cached_property
    def array(self) -> Array:
        """The array that was driven, with the type and responses of its transducers. Raises RecordingError.

        A user-defined directivity cannot be recorded; the array is then omnidirectional.
        """
        try:
            return from_map(self.settings, self.positions, self.normals)
        except Exception as error:  # damaged bytes can raise anything
            raise RecordingError(
                self.path, f"has settings from which no array can be made: {error}"
            ) from error

    def compare_array(self, array: Array) -> tuple[str, ...]:
        """Return in words how an array differs from the recorded one; nothing if it is the same.

        A user-defined directivity is not recorded, and so not compared.
        """
        count = len(self.positions)
        if len(array) != count:
            return (f"array: {count} transducers when recorded, {len(array)} now",)
        changes: list[str] = []
        for name, unit, before, now in (
            ("positions", " m", self.positions, array.positions),
            ("normals", "", self.normals, array.normals),
        ):
            if (off := float(np.abs(now - before).max(initial=0.0))) > 0.0:
                changes.append(f"array: {name} differ by up to {off:.2g}{unit}")
        had, has = (
            {"responses": description["response"], **description["transducer"]}
            for description in (self.settings, to_map(array))
        )
        if had["directivity"] is None:
            had["directivity"] = has["directivity"]
        changes += [f"array: another {name}" for name in has if has[name] != had.get(name)]
        return tuple(changes)

    def __repr__(self) -> str:
        try:
            ticks = f"{len(self):,} ticks"
        except RecordingError:
            ticks = "damaged"
        N, rate = len(self.positions), self.capability.rate
        return f"<Recording {self.path}: {ticks}, {N} transducers, device at {rate:g} Hz>"

    def __len__(self) -> int:
        """Return the number of ticks, without a last one that is cut short. Raises RecordingError."""
        return max(0, self._count_maps()[0] - 1)  # without the header

    @property
    def cut_short(self) -> bool:
        """Whether the file ends within a tick, because it was written or copied in part. Raises RecordingError."""
        return self._count_maps()[1] < self.path.stat().st_size

    def _count_maps(self) -> tuple[int, int]:
        """Return the number of whole maps in the file, and their size [bytes]."""
        count = 0
        try:
            with self.path.open("rb") as file:
                maps = msgpack.Unpacker(file, max_buffer_size=MAX_MAP_BYTES)
                whole = 0
                try:
                    while True:
                        maps.skip()
                        count, whole = count + 1, maps.tell()
                except msgpack.OutOfData:
                    return count, whole
        except OSError as error:
            raise RecordingError(self.path, f"cannot be read: {error.strerror}") from error
        except Exception as error:  # damaged bytes can raise anything
            raise RecordingError(self.path, f"is damaged: {error}") from error

    def __bool__(self) -> bool:
        return True

    @card
    def _repr_html_(self) -> Card:
        rows = {
            "file": f"{self.path}, {self.path.stat().st_size / 1e6:.3g} MB",
            "ticks": f"{len(self):,}",
            "array": f"{len(self.positions)} transducers",
            "device": self.capability,
        }
        return Card("Recording", rows)

    def __iter__(self) -> Iterator[Frame]:
        """Iterate over the frames."""
        return (tick.frame for tick in self.ticks(frames_only=True))

    def ticks(self, *, frames_only: bool = False) -> Iterator[Tick]:
        """Iterate over the ticks; without scenes if `frames_only`."""
        maps, reader = self._maps(), None if frames_only else Reader()
        next(maps, None)
        last: Tick | None = None
        for values in maps:
            try:
                tick = self._tick(values, last, reader)
            except PacinianError as error:
                raise RecordingError(self.path, f"has an invalid tick: {error}") from error
            except Exception as error:  # damaged bytes can raise anything
                raise RecordingError(self.path, f"has a damaged tick: {error}") from error
            last = tick
            yield tick

    def _tick(self, values: dict[str, Any], last: Tick | None, reader: Reader | None) -> Tick:
        N, can = len(self.positions), self.capability
        if "phase" in values:
            phase, amplitude = (
                np.frombuffer(values[k], "<u2").reshape(-1, N) for k in ("phase", "amplitude")
            )
        elif last is not None:
            phase, amplitude = last.frame.phase, last.frame.amplitude
        else:
            raise ValueError("the first tick has no frame")
        if phase.shape != amplitude.shape or not phase.size:
            raise ValueError("phases and amplitudes do not fit")
        if phase.max() >= can.phases or amplitude.max() >= len(can.sizes):
            raise ValueError("levels beyond the device's")
        time, t = float(values["time"]), float(values["t"])
        if not (abs(time) < MAX_TIME and abs(t) < MAX_TIME):
            raise ValueError(f"its time is {time} s")
        asked = None
        if reader is not None and "new" in values:
            asked = reader.next(values["new"])
        clock, job_clock = (
            tuple(map(float, values.get(name, ()))) for name in ("clock", "job_clock")
        )
        frame = Frame(int(values["sequence"]), time, phase, amplitude)
        objects = {} if last is None else last.objects
        if "objects" in values:
            objects = {str(k): _read_object_counts(v) for k, v in values["objects"].items()}
        deviations = {} if last is None else last.deviations
        if "deviations" in values:
            deviations = {str(k): _read_counts(v) for k, v in values["deviations"].items()}
        sent = float(values.get("sent", math.nan))
        begins = bool(values.get("begins", False))
        return Tick(frame, t, asked, clock, job_clock, begins, sent, objects, deviations)

    def _maps(self) -> Iterator[dict[str, Any]]:
        if not self.path.is_file():
            raise RecordingError(self.path, "does not exist, or is not a file")
        try:
            with self.path.open("rb") as file:
                for values in msgpack.Unpacker(
                    file, max_buffer_size=MAX_MAP_BYTES, strict_map_key=False
                ):
                    if not isinstance(values, dict):
                        raise RecordingError(self.path, "is not a Pacinian recording")
                    yield values
        except RecordingError:
            raise
        except OSError as error:
            raise RecordingError(self.path, f"cannot be read: {error.strerror}") from error
        except Exception as error:  # damaged bytes can raise anything
            raise RecordingError(self.path, f"is damaged: {error}") from error


def _read_object_counts(values: Any) -> ObjectSampleCounts:
    asked, rendered, force, reasons = values
    return ObjectSampleCounts(int(asked), int(rendered), float(force), _read_counts(reasons))


def _lock(file: IO[bytes]) -> bool:
    """Lock a file; return False if another run has locked it. Some file systems have no locks."""
    try:
        return try_lock(file.fileno())
    except OSError:
        return True


def _read_counts(values: Any) -> dict[str, int]:
    return {str(reason): int(count) for reason, count in values.items()}
