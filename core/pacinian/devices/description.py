"""Device descriptions: the boards of a device, their poses, wiring, and deviations from ideal transducers."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from pacinian.acoustics.array import Array
from pacinian.acoustics.directivity import DIRECTIVITIES, DirectivityTable
from pacinian.acoustics.transducer import T4010A1, Transducer
from pacinian.acoustics.uncertainty import MAX_PRESSURE_DEVIATION, Uncertainty
from pacinian.argument_checks import check_integer, check_number
from pacinian.config_files import decode_document, json_schema
from pacinian.devices.board import Board
from pacinian.devices.calibration import apply_calibration
from pacinian.errors import ArgumentError, SceneFileError

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats, Indices


class TransducerType(Struct, frozen=True, forbid_unknown_fields=True):
    """The kind of transducer, as `pacinian.Transducer`; by default that of the AUTD units.

    pressure_error: standard error of `pressure`, relative; by default that of published values. directivity: a name, or
    a table as measured.
    """

    frequency: float = T4010A1.frequency
    pressure: float = T4010A1.pressure
    pressure_error: float = 0.3
    directivity: Literal["omni", "t4010a1"] | DirectivityTable = "t4010a1"

    def __post_init__(self) -> None:
        check_number("pressure_error", self.pressure_error, low=0.0, high=MAX_PRESSURE_DEVIATION)
        self.make()

    def make(self) -> Transducer:
        """Return the transducer."""
        D = self.directivity
        return Transducer(
            frequency=self.frequency,
            pressure=self.pressure,
            directivity=DIRECTIVITIES[D] if isinstance(D, str) else D,
        )


class LevelCounts(Struct, frozen=True, forbid_unknown_fields=True):
    """Numbers of phase and amplitude levels of the device."""

    phases: int = 256
    amplitudes: int = 256

    def __post_init__(self) -> None:
        check_integer("phases", self.phases, low=2)
        check_integer("amplitudes", self.amplitudes, low=2)


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
    transducer: TransducerType = TransducerType()
    levels: LevelCounts | None = None
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

    def uncertainty(self, temperature: float = 0.0) -> Uncertainty:
        """Return the uncertainty of the array's strength and responses, for the `predict_` functions.

        temperature: standard deviation of the air's temperature [K]. The errors of phases and gains are those of the
        boards and of the calibration, in the order of `array()`; they count as independent. Raises ArgumentError.
        """
        gain: list[float] = []
        phase: list[float] = []
        for board in self.boards:
            kept, drives = _list_alive(board), np.argsort(board.drives)
            for kind, errors in zip((gain, phase), board.errors, strict=True):
                kind.extend(errors[drives][kept].tolist())
        return Uncertainty(
            pressure=self.transducer.pressure_error, temperature=temperature, phase=phase, gain=gain
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
