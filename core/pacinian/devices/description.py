"""Device descriptions: the boards of a device, their poses, wiring, and deviations from ideal transducers."""

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
MAX_STRENGTH = 100.0  # gain of a channel, relative to its kind


class Element(Struct, frozen=True, forbid_unknown_fields=True):
    """The kind of transducer, as `pacinian.Transducer`; by default that of the AUTD units."""

    frequency: float = 40_000.0
    pressure: float = 4.386
    directivity: Literal["omni", "t4010a1"] = "t4010a1"

    def __post_init__(self) -> None:
        self.make()

    def make(self) -> Transducer:
        """Return the transducer."""
        return Transducer(
            frequency=self.frequency,
            pressure=self.pressure,
            directivity=DIRECTIVITIES[self.directivity],
        )


class Steps(Struct, frozen=True, forbid_unknown_fields=True):
    """Numbers of phase and amplitude levels of the device."""

    phases: int = 256
    amplitudes: int = 256

    def __post_init__(self) -> None:
        check_integer("phases", self.phases, low=2)
        check_integer("amplitudes", self.amplitudes, low=2)


class Board(Struct, frozen=True, forbid_unknown_fields=True):
    """One board of a device, with L transducers. Channels are numbered in the order of the board's protocol.

    serial: serial number, which distinguishes the boards. layout: positions of the transducers on the board. pose: pose
    of the board. order: transducer of the layout that each channel drives, (L,); by default the layout's own order.
    dead: channels that make no sound, or must make none. Channels of a gain below 0.001 count as dead, too. gain:
    strength of each channel relative to its kind; one, or (L,). phase: lead of each channel's sound [rad]; one, or
    (L,). Raises ArgumentError.
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
        """Transducer of the layout that each channel drives, (L,)."""
        return np.array(self.order or range(self.layout.count), dtype=np.intp)

    @property
    def responses(self) -> Complexes:
        """Complex factor by which each channel differs from its kind, (L,); 0 for a dead channel."""
        L = self.layout.count
        gain, phase = (np.broadcast_to(np.asarray(v, float), (L,)) for v in (self.gain, self.phase))
        made = np.asarray(gain * np.exp(1j * phase), np.complex128)
        made[list(self.dead)] = 0.0
        return made

    @property
    def alive(self) -> Indices:
        """The channels that are not dead, ascending."""
        return np.flatnonzero(np.abs(self.responses) >= MIN_STRENGTH)


@dataclass(frozen=True, eq=False)
class Wiring:
    """The transducers of the array that the channels of a board drive.

    serial: serial of the board. size: number of its channels. channels: channels that are not dead, (K,), ascending.
    indices: transducer of the array that each of these drives, (K,). The levels of the board are
    `levels = np.zeros(size); levels[channels] = frame.amplitude[row, indices]`.
    """

    serial: str
    size: int
    channels: Indices
    indices: Indices


class DeviceDescription(Struct, frozen=True, forbid_unknown_fields=True):
    """A device that consists of boards, for `pacinian devices check` and a backend's `description`.

    boards: boards of the device, at least one. backend: name of the backend that drives it. transducer: kind of all
    transducers. levels: numbers of phase and amplitude levels. calibration: file beside this one with measured gains
    and phases, which replace those of the boards.

    The array has the transducers board by board, each in the order of its layout, without the dead ones. Raises
    ArgumentError.
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
        """Read a .toml or .json file, and its calibration.

        All numbers are in SI units. Raises SceneFileError, which names the file, the key and the fix.
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
        """Return the array, including the deviations of its transducers. Raises ArgumentError."""
        places: list[Floats] = []
        normals: list[Floats] = []
        responses: list[Complexes] = []
        for board in self.boards:
            kept = _list_alive(board)
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
        """Transducers of the array that the channels of each board drive."""
        made: list[Wiring] = []
        start = 0
        for board in self.boards:
            kept, channels = _list_alive(board), board.alive
            indices = start + np.searchsorted(kept, board.drives[channels])
            made.append(Wiring(board.serial, board.layout.count, channels, indices))
            start += len(kept)
        return tuple(made)


def schema() -> dict[str, Any]:
    """Return the JSON Schema of device descriptions."""
    return json_schema(DeviceDescription, "Pacinian device")


def _list_alive(board: Board) -> Indices:
    """Return the transducers of a board's layout that are not dead, ascending."""
    return np.sort(board.drives[board.alive])
