"""Our solutions sent through the backend, and the field that the AUTD3 project's emulator makes of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

import pacinian as pc
from pacinian.rendering.quantiser import Quantiser

from .emulated_backend import SOURCE, Emulated, field

if TYPE_CHECKING:
    from pacinian.types import Floats

HEIGHT, HALF = 0.2, 0.04  # [m], of the plane that is looked at, and half of its side
AIR = pc.Air(speed_of_sound=340.0)  # the emulator's, as it is asked
SHARE = 0.3  # of what one focus could be, that all points together ask
PLACES = np.array([[(k % 4 - 1.5) * 0.02, (k // 4 - 1.5) * 0.02, HEIGHT] for k in range(16)])
POINTS = {"1 point": np.array([[0.0, 0.0, HEIGHT]]), "16 points": PLACES}  # [m]
GRIDS = {"one unit": (1, 1), "nine units": (3, 3)}
SOURCES = {"omni": SOURCE, "T4010A1": pc.T4010A1}


@dataclass(frozen=True)
class Compared:
    """Peak sound pressures [Pa]: the emulator's and ours of the levels that were sent, and ours of the gains.

    On a plane, (M,), places [m], (M, 3); and at the points, where `asked` was asked.
    """

    places: Floats
    theirs: Floats
    ours: Floats
    solved: Floats
    at_points: Floats
    solved_at_points: Floats
    asked: Floats

    @property
    def sent(self) -> float:
        """The largest difference of the emulator's field and ours of the same levels, over the largest pressure."""
        return float(np.abs(self.theirs - self.ours).max() / self.theirs.max())

    @property
    def rounded(self) -> float:
        """The same, and ours of the gains before they were rounded."""
        return float(np.abs(self.theirs - self.solved).max() / self.theirs.max())

    @property
    def points(self) -> float:
        """The largest relative difference at the points of the emulator's field and what was asked."""
        return float(np.abs(self.at_points / self.asked - 1.0).max())


def compared(grid: str, points: str, source: str, resolution: float = 1e-3) -> Compared:
    """Solve, send, and have the emulator evaluate its field. resolution: of the plane [m]."""
    array, q = pc.autd(*GRIDS[grid], SOURCES[source]), POINTS[points]
    # [Pa] of the weakest alone, at full drive
    focus = np.abs(pc.matrix(array, q, AIR)).sum(axis=1).min()
    asked = np.full(len(q), SHARE * focus / np.sqrt(len(q)))
    solution = pc.solve(array, q, asked, medium=AIR)
    it = Emulated(array)
    can = it.backend.capability
    frame = Quantiser(can, 1, len(array)).make_frame(
        solution.gains[None].astype(np.complex64), 1.0, 0, 0.0
    )
    it.backend.send(frame)
    record = it.line.record()
    plane = (-HALF, HALF)
    places, theirs = field(record, plane, plane, HEIGHT, resolution)
    at_points = np.array([field(record, *one)[1][0] for one in q.tolist()])
    return Compared(
        places,
        theirs,
        np.abs(pc.field(array, frame.gains(can)[0], places, AIR)),
        np.abs(pc.field(array, solution.gains, places, AIR)),
        at_points,
        np.abs(pc.field(array, solution.gains, q, AIR)),
        asked,
    )
