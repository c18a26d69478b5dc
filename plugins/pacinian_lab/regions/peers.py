"""autd3's own solvers on the same shapes, in a separate process and environment."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.acoustics.array import autd
from pacinian.acoustics.pressure import sound_pressure
from pacinian.acoustics.transducer import Transducer
from pacinian.closeable import Closeable
from pacinian_lab.regions.methods import OURS, SPACINGS, MethodResult
from pacinian_lab.solvers.problems import AIR, PRESSURE, make_message
from pacinian_lab.solvers.worker_process import read_gains

if TYPE_CHECKING:
    from pacinian_lab.regions.shapes import Shape
    from pacinian_lab.solvers.worker_process import Worker

PEER = "autd3"
SOLVERS = ("gspat", "greedy")
LIMIT = 120.0  # [s] longest wait for a solve


class Peers(Closeable):
    """autd3's `gspat` and `greedy` with foci 8.5 and 4.25 mm apart.

    worker: `Worker.of("autd3", ...)`; `close` ends it. side: AUTD units along each side of the array. The foci lie
    where Pacinian's foci of these spacings do, each with the pressure of its place as target. Foci with a target of
    zero are left out.
    """

    ours = f"{OURS}, autd3's field"

    def __init__(self, worker: Worker, side: int) -> None:
        self.worker = worker
        self.array = autd(side, side, Transducer(pressure=PRESSURE))
        """The peer's model of the array: omnidirectional, 1/r, 340 m/s."""
        self._asked = {
            f"{PEER} {solver}, {name}": (f"{PEER}-{solver}", spacing)
            for solver in SOLVERS
            for name, spacing in SPACINGS.items()
        }

    def close(self) -> None:
        """End the peer's process."""
        self.worker.close()

    @property
    def ways(self) -> tuple[str, ...]:
        """Names of the solvers in the tables."""
        return tuple(self._asked)

    def make(self, shape: Shape, way: str, pressure: float) -> MethodResult:
        """Let a peer make a shape with at most `pressure` [Pa]. Raises WorkerError."""
        solver, spacing = self._asked[way]
        samples = shape.samples(self.array, spacing)
        wanted = samples.radiation_pressure > 0.0
        q = samples.positions[wanted]
        t = sound_pressure(pressure * samples.radiation_pressure[wanted], AIR)
        problem = make_message(self.array.positions, q[None], t)
        message = {"solver": solver, "mode": "cold", "seconds": 0.0, "problem": problem}
        reply = self.worker.ask(message, LIMIT)
        return MethodResult(read_gains(reply, (len(self.array),)), len(q))
