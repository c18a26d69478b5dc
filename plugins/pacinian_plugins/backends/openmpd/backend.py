"""The backend `openmpd`: sends frames to the boards of an array."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

import pacinian as pc
from pacinian.argument_checks import check_integer, check_names, check_number
from pacinian.errors import ArgumentError
from pacinian_plugins.backends.openmpd.board import Board
from pacinian_plugins.backends.openmpd.link import CHIPS, open_port
from pacinian_plugins.backends.openmpd.protocol import (
    BOARD,
    MAX_PULSE,
    PHASES,
    PULSE_PRESSURES,
    RESYNC_PAUSE,
    Packer,
    encode_divider,
)

if TYPE_CHECKING:
    from array import array
    from collections.abc import Callable, Iterable, Sequence

NAME = CHIPS.name
MAX_FRAMES = 16  # maximum number of frames in a tick; the FPGA stops reading at 28


@dataclass
class OpenMpd(pc.Backend):
    """OpenMPD's phased arrays: boards of 256 transducers, each on an FT232H: docs/openmpd.md.

    description: file that describes the boards of the array; without it, they are `serials`, and the transducers of a
    board are in the order of its pins. Boards that are not named are not touched, because any FT232H looks like one.
    rate: frames sent per second [Hz]. led: light of the open boards: red, green, blue, 0 to 255. timeout: time for
    which a board may accept no data [s]; a hanging board blocks `send` for no longer.
    library: backend of pyusb instead of libusb's; wait, clock: time; for tests.
    """

    name: ClassVar[str] = NAME
    usb = CHIPS.usb

    description: str = ""
    serials: str | Sequence[str] = ()
    rate: float = 2000.0
    led: Sequence[int] = (0, 0, 0)
    timeout: float = 0.01
    library: Any = field(default=None, repr=False)
    wait: Callable[[float], None] = field(default=time.sleep, repr=False)
    clock: Callable[[], float] = field(default=time.perf_counter, repr=False)

    def __post_init__(self) -> None:
        self.rate = check_number("rate", self.rate, low=100.0, high=10_000.0)
        self.timeout = check_number("timeout", self.timeout, low=0.001, high=1.0)
        self.serials = check_names("serials", self.serials)
        self.led = [check_integer("led", level, low=0) for level in self.led]
        if len(self.led) != 3 or max(self.led) > 255:
            raise ArgumentError("led", f"must be red, green and blue, 0 to 255, not {self.led}")
        self._capability = pc.Capability(PHASES, PULSE_PRESSURES, self.rate)
        self._divide = encode_divider(self.rate)
        self._columns = 0
        self._packer = Packer([])
        self.boards: list[Board] = []
        """Open boards, in the array's order."""

    @classmethod
    def find_devices(cls) -> Iterable[pc.FoundDevice]:
        """Return the connected chips by serial, whether they are boards or other devices."""
        title = "FT232H, an OpenMPD board or anything else"
        return [pc.FoundDevice(NAME, *one) for one in CHIPS.describe(title)]

    @property
    def capability(self) -> pc.Capability:
        """The capability of all boards; they have no watchdog."""
        return self._capability

    def open(self, array: pc.Array) -> None:
        """Claim the boards and silence them. Takes 1.3 s, in which each board discards an incomplete frame.

        Raises BackendError, SceneFileError, MissingExtra.
        """
        self.close()
        wirings = self._wirings(len(array))
        try:
            listed = CHIPS.list_devices(self.library)
            for one in [CHIPS.select(listed, wiring.serial) for wiring in wirings]:
                link = open_port(one)
                self.boards.append(Board(link, self._divide, self.led, self.timeout, self.clock))
                self.boards[-1].silence()
            self.wait(RESYNC_PAUSE)
        except BaseException:
            self.close()
            raise
        self._packer, self._columns = Packer(wirings), len(array)

    def send(self, frame: pc.Frame) -> None:
        """Send a frame to each board. Raises BackendError at the first board that does not accept it; never retries.

        After an error, only some of the boards may have the frame; call `silence` next.
        """
        for board, data in zip(self.boards, self.pack_frame(frame), strict=True):
            board.send(data)

    def pack_frame(self, frame: pc.Frame) -> list[array[int]]:
        """Return the bytes of a frame for each board, in reused buffers. Raises BackendError."""
        if not self.boards:
            raise pc.BackendError(f"{NAME} is not open")
        phase, amplitude = frame.phase, frame.amplitude
        if len(phase) > MAX_FRAMES:
            raise pc.BackendError(
                f"{NAME}: a tick has {len(phase)} frames, but the boards can hold only {MAX_FRAMES}: "
                f"run the loop at {self.rate / MAX_FRAMES:.0f} Hz or more, or lower `rate`"
            )
        if phase.shape[1] != self._columns or phase.max() >= PHASES or amplitude.max() > MAX_PULSE:
            raise pc.BackendError(f"{NAME}: a frame contains levels that the boards cannot emit")
        return self._packer.pack(phase, amplitude)

    def silence(self) -> None:
        """Silence every board after the frames under way. Raises BackendError if one continues to sound."""
        problems: list[pc.BackendError] = []
        for board in self.boards:
            try:
                board.silence()
            except pc.BackendError as error:
                problems.append(error)
        if problems:
            raise problems[0]

    def close(self) -> None:
        """Silence and release the boards."""
        for board in self.boards:
            board.close()
        self.boards = []

    def _wirings(self, N: int) -> Sequence[pc.Wiring]:
        """Return the wiring of each board. Raises BackendError, SceneFileError."""
        if self.description:
            wirings = pc.DeviceDescription.load(self.description).wiring
        else:
            channels = np.arange(BOARD)
            wirings = tuple(
                pc.Wiring(serial, BOARD, channels, BOARD * b + channels)
                for b, serial in enumerate(self.serials)
            )
        if not wirings or not all(wiring.serial for wiring in wirings):
            there = (
                ", ".join(one.serial for one in CHIPS.list_devices(self.library) if not one.problem)
                or "none"
            )
            raise pc.BackendError(
                f"{NAME}: name the boards: `serials`, or those of a `description`; any FT232H looks like one; "
                f"there are: {there}"
            )
        if any(wiring.size != BOARD for wiring in wirings):
            raise pc.BackendError(f"{NAME}: a board has {BOARD} channels: correct the description")
        driven = sum(len(wiring.indices) for wiring in wirings)
        if driven != N:
            raise pc.BackendError(
                f"{NAME}: the array has {N} transducers, and its {len(wirings)} boards {driven}"
            )
        return wirings
