"""The game whose latency is measured: it sends hands at a rate, and measures an echo round trip between two hands."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
import zmq
from msgspec import Struct

from pacinian import gallery
from pacinian.acoustics.pose import Pose
from pacinian.skip_reasons import UNDER_WAY
from pacinian.wire import binary_arrays, codec, objects, shapes
from pacinian.wire.commands import HandFrame, Hands, Put
from pacinian.wire.connection_file import Connection
from pacinian.wire.control import Arm
from pacinian.wire.modulation import Sine
from pacinian.wire.state import State
from pacinian_lab.server import worker_process
from pacinian_lab.server.bare_client import BareClient, States, socket
from pacinian_lab.server.echo import Echo
from pacinian_lab.server.quantiles import Quantiles

if TYPE_CHECKING:
    from collections.abc import Callable


SIDE, POINT_SPACING = 4, 0.015  # 4 x 4 points below the palm, their spacing [m]
RADIUS = 0.006  # [m] distance within which skin feels a point
ABOVE = 0.003  # [m] height of the points within the skin of the palm
SWING = 0.005  # [m] to either side, once per second
DRIFT = 1.001  # makes the hands meet every phase of a tick, even if both rates are equal
RENEW = 0.05  # [s]
ALONE = 8.0  # [s] maximum; the server forgets a session that does not renew for 10 s
WARM = 5.0  # [s] maximum warm-up, which is not counted; never longer than the measurement
SETTLE = 0.2  # [s] after the last hand until its effect is known


class Task(Struct, frozen=True):
    """What to send. connection: path of the connection file. rate: of hands [Hz]. seconds: measured time."""

    connection: str
    echo: Echo
    rate: float
    seconds: float


class Times(Struct, frozen=True):
    """Measured times [s]. `echo`: round trips during the run; `alone`: before the server had any work.

    bus: from sent to received; loop: from received to emitted; whole: both. sent: number of hands; reached: number of
    them that reached the device (of several hands in a tick, only the newest does). samples: minimum, median,
    maximum. sounding: fraction of states. tick_ms: median and 99 % quantile at the end; late: fraction of ticks;
    waiting: fraction of ticks during which a solve beside them was still under way, which delays a hand. size: of a
    message [bytes].
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
    waiting: float
    size: int


def hands() -> list[HandFrame]:
    """Return 1000 poses of a hand above the points: one second of motion."""
    made = list[HandFrame]()
    for t in np.arange(1000) * 1e-3:
        hand = gallery.HAND.transform(Pose((SWING * np.sin(2.0 * np.pi * t), 0.0, 0.0)))
        v = 2.0 * np.pi * SWING * np.cos(2.0 * np.pi * t)
        made.append(
            HandFrame(
                joints=binary_arrays.pack(hand.carriers),
                velocities=binary_arrays.pack([v, 0.0, 0.0]),
            )
        )
    return made


def points() -> objects.Particles:
    """Return the points that the palm touches: always 16 samples."""
    along = POINT_SPACING * (np.arange(SIDE) - (SIDE - 1) / 2.0)
    places = np.stack(np.meshgrid(along, along, [0.0]), axis=-1).reshape(-1, 3)
    return objects.Particles(
        positions=binary_arrays.pack(places),
        pose=shapes.Pose((0.0, 0.0, gallery.HEIGHT + ABOVE)),
        radius=RADIUS,
        radiation_pressure=10.0,
        envelope=Sine(frequency=150.0),
    )


def pace_calls(
    rate: float, seconds: float, first: Callable[[], None], between: Callable[[], None]
) -> None:
    """Call `first` at the given rate, and `between` halfway to the next call."""
    period = DRIFT / rate
    begin = time.perf_counter()
    for k in range(max(1, round(seconds / period))):
        for due, call in ((k * period, first), ((k + 0.5) * period, between)):
            left = begin + due - time.perf_counter()
            if left > 0.0:
                time.sleep(left)
            call()


class Sender:
    """Sends hands and stores the results. context: of its sockets."""

    def __init__(
        self, context: zmq.Context[Any], task: Task, client: BareClient, states: States
    ) -> None:
        self.task, self.client, self.states = task, client, states
        self.frames = hands()
        message = Hands(session=client.key, sequence=2**40, time=1.0, hands=(self.frames[0],))
        self.payload = codec.encode(message)
        self._echo = socket(context, zmq.DEALER, task.echo.endpoint, task.echo.token)
        self._echo.rcvtimeo = self._echo.sndtimeo = 10_000
        self.trips, self.seen = list[float](), list[State]()
        self._sent, self._renewed = 0, 0.0

    def hand(self) -> None:
        """Send the pose for the current time."""
        frame = self.frames[int(1000.0 * time.perf_counter()) % 1000]
        self._sent += self.client.send(Hands, hands=(frame,))
        if time.perf_counter() > self._renewed + RENEW:
            self._renewed = time.perf_counter()
            self.client.renew_nowait()
        self.seen += self.states.new()

    def trip(self) -> None:
        """Measure a round trip to the echo."""
        begin = time.perf_counter()
        self._echo.send(self.payload)
        self._echo.recv()
        self.trips.append(time.perf_counter() - begin)

    def measure(self) -> Times:
        """Measure the echo alone, then together with the hands."""
        task, client = self.task, self.client
        self.trip()
        pace_calls(task.rate, min(max(1.0, 0.2 * task.seconds), ALONE), lambda: None, self.trip)
        alone = Quantiles.of(self.trips[1:])
        client.ask(Put, objects={"points": points()})
        client.ask(Hands, hands=(self.frames[0],))
        client.request(Arm)
        pace_calls(task.rate, min(WARM, task.seconds), self.hand, lambda: None)
        self.trips, self.seen, self._sent = [], [], 0
        first = client.sequence
        pace_calls(task.rate, task.seconds, self.hand, self.trip)
        last, sent = client.sequence, self._sent
        pace_calls(task.rate, SETTLE, self.hand, lambda: None)
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
            waiting=(end.skipped.get(UNDER_WAY, 0) - begin.skipped.get(UNDER_WAY, 0)) / ticks,
            size=len(self.payload),
        )

    def close(self) -> None:
        """Close the echo's socket."""
        self._echo.close(0)


def main() -> None:
    """Run in a separate process."""
    task = worker_process.read_task(Task)
    connection = Connection.read(task.connection)
    context = zmq.Context[Any]()
    states = States(context, connection)
    with BareClient(context, connection, "sender", "") as client:
        sender = Sender(context, task, client, states)
        worker_process.answer(sender.measure())
        sender.close()
    states.close()
    context.term()


if __name__ == "__main__":
    main()
