"""A client's session, as control remembers it."""

from __future__ import annotations

from dataclasses import dataclass, field

from pacinian.serving.ipc.clock_offset import ClockOffsetEstimator


@dataclass(eq=False, slots=True)
class ClientSession:
    """A client. until: end of its lease. renewed: arrival of its last renewal. time: time stamp in it. All [s].

    number: number of its scene, as in `Permit`.
    """

    key: bytes
    peer: bytes
    user: str
    name: str
    scene: str
    lease: float
    renewed: float
    until: float = 0.0
    time: float = 0.0
    sequence: int = 0
    number: int = 0
    clock: ClockOffsetEstimator = field(default_factory=ClockOffsetEstimator)
