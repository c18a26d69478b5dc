"""The game whose latency is measured: hands at a rate, and between two of them an echo's round trip."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
import zmq
from msgspec import Struct

from pacinian import gallery
from pacinian.acoustics.pose import Pose
from pacinian.wire import binary_arrays, codec, objects, shapes
from pacinian.wire.commands import HandFrame, Hands, Put
from pacinian.wire.connection import Connection
from pacinian.wire.control import Arm
from pacinian.wire.state import State
from pacinian.wire.time import Sine
from pacinian_lab.server import worker_process
from pacinian_lab.server.echo import Echo
from pacinian_lab.server.quantiles import Quantiles
from pacinian_lab.server.raw_client import Peer, States, socket

if TYPE_CHECKING:
    from collections.abc import Callable


SIDE, APART = 4, 0.015  # 16 points below the palm [m]
RADIUS = 0.006  # [m] from a point to the skin that feels it
ABOVE = 0.003  # [m], the points inside of the palm's skin
SWING = 0.005  # [m] to either side, once a second
DRIFT = 1.001  # so that hands meet every phase of a tick, also where both have one rate
RENEW = 0.05  # [s]
ALONE = 8.0  # [s] at most: a session that does not renew is forgotten after 10
WARM = 5.0  # [s] that are not counted, at most as long as what is
SETTLE = 0.2  # [s] after the last hand until what it did is known
TURNS = "solve, in turn with sampling"


class Task(Struct, frozen=True):
    """What to send. connection: its file. rate: of hands [Hz]. seconds: that are measured."""

    connection: str
    echo: Echo
    rate: float
    seconds: float


class Times(Struct, frozen=True):
    """What was measured [s]. `echo`: round trips beside the server; `alone`: before it had anything to do.

    bus: from sent to received; loop: from received to emitted; whole: both. sent: hands; reached: of those, how
    many the device got: of several in a tick the newest. samples: fewest, median, most. sounding: share of states.
    tick_ms: median and 99 % at the end; late: share of ticks; turns: share of ticks that only sampled, as solving too
    would have been late: a hand then takes a tick longer. size: of a message [bytes].
    """

    rate: float
    alone: Quantiles
    echo: Quantiles
    bus: Quantiles
    loop: Quantiles
    whole: Quantiles
    sent: int
    reached: int
    samples: tuple[int, int, int]
    sounding: float
    tick_ms: tuple[float, float]
    late: float
    turns: float
    size: int


def hands() -> list[HandFrame]:
    """A second of a hand above the points, in thousandths."""
    made = list[HandFrame]()
    for t in np.arange(1000) * 1e-3:
        hand = gallery.HAND.moved(Pose((SWING * np.sin(2.0 * np.pi * t), 0.0, 0.0)))
        v = 2.0 * np.pi * SWING * np.cos(2.0 * np.pi * t)
        made.append(
            HandFrame(
                joints=binary_arrays.pack(hand.carriers),
                velocities=binary_arrays.pack([v, 0.0, 0.0]),
            )
        )
    return made


def points() -> objects.Particles:
    """What the palm touches: always 16 samples."""
    along = APART * (np.arange(SIDE) - (SIDE - 1) / 2.0)
    places = np.stack(np.meshgrid(along, along, [0.0]), axis=-1).reshape(-1, 3)
    return objects.Particles(
        positions=binary_arrays.pack(places),
        pose=shapes.Pose((0.0, 0.0, gallery.HEIGHT + ABOVE)),
        radius=RADIUS,
        radiation_pressure=10.0,
        envelope=Sine(frequency=150.0),
    )


def paced(
    rate: float, seconds: float, first: Callable[[], None], between: Callable[[], None]
) -> None:
    """Call `first` at the rate, `between` halfway to the next."""
    period = DRIFT / rate
    begin = time.perf_counter()
    for k in range(max(1, round(seconds / period))):
        for due, call in ((k * period, first), ((k + 0.5) * period, between)):
            left = begin + due - time.perf_counter()
            if left > 0.0:
                time.sleep(left)
            call()


class Sender:
    """Sends and remembers. context: of its sockets."""

    def __init__(self, context: zmq.Context[Any], task: Task, peer: Peer, states: States) -> None:
        self.task, self.peer, self.states = task, peer, states
        self.frames = hands()
        message = Hands(session=peer.key, sequence=2**40, time=1.0, hands=(self.frames[0],))
        self.payload = codec.encode(message)
        self._echo = socket(context, zmq.DEALER, task.echo.endpoint, task.echo.token)
        self._echo.rcvtimeo = self._echo.sndtimeo = 10_000
        self.trips, self.seen = list[float](), list[State]()
        self._sent, self._renewed = 0, 0.0

    def hand(self) -> None:
        """The pose of now."""
        frame = self.frames[int(1000.0 * time.perf_counter()) % 1000]
        self._sent += self.peer.send(Hands, hands=(frame,))
        if time.perf_counter() > self._renewed + RENEW:
            self._renewed = time.perf_counter()
            self.peer.renewing()
        self.seen += self.states.new()

    def trip(self) -> None:
        """A round trip to the echo."""
        begin = time.perf_counter()
        self._echo.send(self.payload)
        self._echo.recv()
        self.trips.append(time.perf_counter() - begin)

    def measure(self) -> Times:
        """First the echo alone, then beside the hands."""
        task, peer = self.task, self.peer
        self.trip()
        paced(task.rate, min(max(1.0, 0.2 * task.seconds), ALONE), lambda: None, self.trip)
        alone = Quantiles.of(self.trips[1:])
        peer.ask(Put, objects={"points": points()})
        peer.ask(Hands, hands=(self.frames[0],))
        peer.request(Arm)
        paced(task.rate, min(WARM, task.seconds), self.hand, lambda: None)
        self.trips, self.seen, self._sent = [], [], 0
        first = peer.sequence
        paced(task.rate, task.seconds, self.hand, self.trip)
        last, sent = peer.sequence, self._sent
        paced(task.rate, SETTLE, self.hand, lambda: None)
        return self._times(alone, first, last, sent)

    def _times(self, alone: Quantiles, first: int, last: int, count: int) -> Times:
        found = [np.frombuffer(state.inputs, "<f8").reshape(-1, 4) for state in self.seen]
        rows = np.concatenate([*found, np.empty((0, 4))])
        rows = rows[(rows[:, 0] > first) & (rows[:, 0] <= last)]
        _, sent, received, emitted = rows.T
        samples = sorted(len(state.points) // 12 for state in self.seen) or [0]
        begin, end = self.seen[0], self.seen[-1]
        ticks = max(1, end.ticks - begin.ticks)
        return Times(
            rate=self.task.rate,
            alone=alone,
            echo=Quantiles.of(self.trips),
            bus=Quantiles.of((received - sent).tolist()),
            loop=Quantiles.of((emitted - received).tolist()),
            whole=Quantiles.of((emitted - sent).tolist()),
            sent=count,
            reached=len(rows),
            samples=(samples[0], samples[len(samples) // 2], samples[-1]),
            sounding=sum(s.output == "sounding" for s in self.seen) / len(self.seen),
            tick_ms=end.tick_ms[:2],
            late=(end.late - begin.late) / ticks,
            turns=(end.skipped.get(TURNS, 0) - begin.skipped.get(TURNS, 0)) / ticks,
            size=len(self.payload),
        )

    def close(self) -> None:
        """Close the echo's socket."""
        self._echo.close(0)


def main() -> None:
    """In its own process."""
    task = worker_process.read_task(Task)
    connection = Connection.read(task.connection)
    context = zmq.Context[Any]()
    states = States(context, connection)
    with Peer(context, connection, "sender", "") as peer:
        sender = Sender(context, task, peer, states)
        worker_process.answer(sender.measure())
        sender.close()
    states.close()
    context.term()


if __name__ == "__main__":
    main()
