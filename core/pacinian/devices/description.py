"""A device description: boards, where they are, how they are wired, and how they differ from ideal ones."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr, replace

from pacinian.acoustics.array import MIN_STRENGTH, Array
from pacinian.acoustics.directivity import omni, t4010a1
from pacinian.acoustics.pose import Pose
from pacinian.acoustics.transducer import Transducer
from pacinian.checks import check_integer, check_number
from pacinian.devices.calibration import apply_calibration
from pacinian.devices.layouts import Grid, Places, Unit
from pacinian.documents import decode_document, json_schema
from pacinian.errors import ArgumentError, SceneFileError

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats, Indices

DIRECTIVITIES = {"omni": omni, "t4010a1": t4010a1}
MAX_STRENGTH = 100.0  # of its kind's strength


class Element(Struct, frozen=True, forbid_unknown_fields=True):
    """The kind of transducer; those of the AUTD units unless given: as `pacinian.Transducer`."""

    frequency: float = 40_000.0
    pressure: float = 4.386
    directivity: Literal["omni", "t4010a1"] = "t4010a1"

    def __post_init__(self) -> None:
        self.make()

    def make(self) -> Transducer:
        """The kind."""
        return Transducer(
            frequency=self.frequency,
            pressure=self.pressure,
            directivity=DIRECTIVITIES[self.directivity],
        )


class Steps(Struct, frozen=True, forbid_unknown_fields=True):
    """How many levels of phase and of amplitude the device has."""

    phases: int = 256
    amplitudes: int = 256

    def __post_init__(self) -> None:
        check_integer("phases", self.phases, low=2)
        check_integer("amplitudes", self.amplitudes, low=2)


class Board(Struct, frozen=True, forbid_unknown_fields=True):
    """One board of a device, with L transducers; a channel is a place in the order of its wire.

    serial: tells it from the others. layout: where its transducers are, on the board. pose: where the board is.
    order: which transducer of the layout each channel drives, (L,); in the layout's own order unless given.
    dead: channels that make no sound, or are to make none; one of gain below 0.001 is one, too.
    gain, phase: by how much each channel is stronger than its kind, and its sound leads [rad]; one, or (L,).
    Raises ArgumentError.
    """

    serial: str = ""
    layout: Unit | Grid | Places = Unit()
    pose: Pose = Pose()
    order: tuple[int, ...] = ()
    dead: tuple[int, ...] = ()
    gain: float | tuple[float, ...] = 1.0
    phase: float | tuple[float, ...] = 0.0

    def __post_init__(self) -> None:
        L = self.layout.count
        if self.order and sorted(self.order) != list(range(L)):
            raise ArgumentError("order", f"must name each of the transducers 0 to {L - 1} once")
        wrong = [c for c in self.dead if not 0 <= c < L]
        if wrong or len(set(self.dead)) < len(self.dead):
            raise ArgumentError("dead", f"must be different channels of 0 to {L - 1}: {wrong}")
        for name, low, high in (("gain", 0.0, MAX_STRENGTH), ("phase", -1e3, 1e3)):
            value: float | tuple[float, ...] = getattr(self, name)
            if isinstance(value, tuple):
                if len(value) != L:
                    raise ArgumentError(name, f"must be one, or {L} of them, not {len(value)}")
                for c, one in enumerate(value):
                    check_number(f"{name}[{c}]", one, low=low, high=high)
            else:
                check_number(name, value, low=low, high=high)
        force_setattr(self, "dead", tuple(sorted(self.dead)))

    @property
    def drives(self) -> Indices:
        """Which transducer of the layout each channel drives, (L,)."""
        return np.array(self.order or range(self.layout.count), dtype=np.intp)

    @property
    def responses(self) -> Complexes:
        """How each channel differs from its kind, complex, (L,); 0 where dead."""
        L = self.layout.count
        gain, phase = (np.broadcast_to(np.asarray(v, float), (L,)) for v in (self.gain, self.phase))
        made = np.asarray(gain * np.exp(1j * phase), np.complex128)
        made[list(self.dead)] = 0.0
        return made

    @property
    def alive(self) -> Indices:
        """The channels that sound, in their order."""
        return np.flatnonzero(np.abs(self.responses) >= MIN_STRENGTH)


@dataclass(frozen=True, eq=False)
class Wiring:
    """Which of the array's transducers a board's channels drive.

    serial: of the board. size: how many channels it has. channels: those that are not dead, (K,), rising.
    indices: for each of those, which transducer of the array it drives, (K,): levels of the board are
    `levels = np.zeros(size); levels[channels] = frame.amplitude[row, indices]`.
    """

    serial: str
    size: int
    channels: Indices
    indices: Indices


class DeviceDescription(Struct, frozen=True, forbid_unknown_fields=True):
    """A device that is made of boards: what `pacinian devices check` reads, and a backend's `description`.

    boards: at least one. backend: the name of what drives it. transducer: their kind. levels: of phase and
    amplitude. calibration: a file beside this one with gains and phases that were measured; they replace those
    that are written here.

    The array has the boards' transducers in the order of the boards, on each in the order of its layout, without
    those that are dead. Raises ArgumentError.
    """

    boards: tuple[Board, ...]
    backend: str = ""
    transducer: Element = Element()
    levels: Steps | None = None
    calibration: str = ""

    def __post_init__(self) -> None:
        if not self.boards:
            raise ArgumentError("boards", "must hold at least one board")
        serials = [board.serial for board in self.boards]
        if len(serials) > 1 and "" in serials:
            raise ArgumentError(
                f"boards[{serials.index('')}].serial", "must be given where there are several"
            )
        if len(set(serials)) < len(serials):
            twice = next(s for i, s in enumerate(serials) if s in serials[:i])
            raise ArgumentError("boards", f"must have different serials: {twice!r} is there twice")
        if not any(len(board.alive) for board in self.boards):
            raise ArgumentError("boards", "must have a transducer that is not dead")

    @classmethod
    def load(cls, path: str | Path) -> DeviceDescription:
        """Read a file that ends in .toml or .json, and its calibration.

        All numbers in SI units. Raises SceneFileError, which names the file, the key and the fix.
        """
        path = Path(path)
        read = decode_document(path, cls)
        if read.calibration:
            boards = apply_calibration(path.parent / read.calibration, read.boards)
            read = replace(read, boards=boards)
        try:
            read.array()
        except ArgumentError as error:
            raise SceneFileError(path, "$.boards", str(error)) from error
        return read

    def array(self) -> Array:
        """The array, which knows how its transducers differ. Raises ArgumentError."""
        places: list[Floats] = []
        normals: list[Floats] = []
        responses: list[Complexes] = []
        for board in self.boards:
            kept = _kept(board)
            places.append(board.pose.points(board.layout.positions())[kept])
            normals.append(
                np.tile(board.pose.directions(np.array([0.0, 0.0, 1.0])), (len(kept), 1))
            )
            responses.append(board.responses[np.argsort(board.drives)][kept])
        return Array(
            np.concatenate(places),
            np.concatenate(normals),
            self.transducer.make(),
            np.concatenate(responses),
        )

    @property
    def wiring(self) -> tuple[Wiring, ...]:
        """For each board, which of the array's transducers its channels drive."""
        made: list[Wiring] = []
        start = 0
        for board in self.boards:
            kept, channels = _kept(board), board.alive
            indices = start + np.searchsorted(kept, board.drives[channels])
            made.append(Wiring(board.serial, board.layout.count, channels, indices))
            start += len(kept)
        return tuple(made)


def schema() -> dict[str, Any]:
    """The JSON Schema of device descriptions."""
    return json_schema(DeviceDescription, "Pacinian device")


def _kept(board: Board) -> Indices:
    """Which transducers of its layout are not dead, rising."""
    return np.sort(board.drives[board.alive])
