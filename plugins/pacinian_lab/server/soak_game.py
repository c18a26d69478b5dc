"""The game of the soak: a moving hand, objects that come and go, and disturbances."""

from __future__ import annotations

import random
import socket as tcp
import time
from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np
import zmq
from msgspec import Struct

from pacinian import gallery
from pacinian.acoustics.pose import Pose
from pacinian.client.client import Client
from pacinian.errors import ConnectionLost, Refused, ServerError
from pacinian.scene.hands.hand import Hand
from pacinian.scene.modulation.waves import Constant, Sine
from pacinian.scene.objects import Volume
from pacinian.scene.shapes import Sphere
from pacinian.serving.ipc.messages import SUPERSEDED
from pacinian.wire.connection_file import Connection
from pacinian.wire.state import State
from pacinian_lab.server import worker_process
from pacinian_lab.server.bare_client import States, socket
from pacinian_lab.server.quantiles import Quantiles

if TYPE_CHECKING:
    from collections.abc import Callable

FRAME = 1.0 / 90.0  # [s]
SCENE = "soak"
SOLVERS = "auto", "gs-pat", "lagrange", "weighted-gs"
BALL = Volume(shape=Sphere(0.01), radiation_pressure=8.0)
MAX_BALLS = 8  # maximum number of balls that come and go
NONSENSE = 64  # malformed messages per event
SWING = 0.02  # [m]
NONE = np.empty((0, 4))


class Play(Struct, frozen=True):
    """How to play. connection: path of the connection file. beat: time between events [s]."""

    connection: str
    beat: float


class Window(Struct, frozen=True):
    """Order: play on for `seconds` [s], then report."""

    seconds: float


class Heard(Struct, frozen=True):
    """The report of a window.

    tick_ms, gap: as in `State`. late: fraction of ticks. age: time from sending a hand to emitting its frame [s].
    events: counts of the actions taken and of the problems met, by name.
    """

    ticks: int
    late: float
    tick_ms: tuple[float, float, float]
    gap: float
    age: Quantiles
    sounding: float
    faults: int
    restarts: int
    events: dict[str, int]


class Game:
    """Plays the game. Each event has its own period."""

    def __init__(self, context: zmq.Context[Any], play: Play) -> None:
        self.play, self.context, self.random = play, context, random.Random(5)
        self.connection = Connection.read(play.connection)
        self.states = States(context, self.connection)
        self.client, self.friend = self._join("game"), list[Client]()
        self.events, self.count, self.due = Counter[str](), 0, time.perf_counter()
        self.there, self.last = list[str](), self.client.status()
        self._turns: tuple[tuple[int, Callable[[], None]], ...] = (
            (1, self.come_and_go), (2, self.wrap), (3, self.swap), (4, self.join_or_leave),
            (5, self.nonsense), (7, self.dim), (10, self.pause), (20, self.emergency),
        )  # fmt: skip
        self.begin()

    def _join(self, name: str) -> Client:
        return Client(self.connection, name=name, scene=SCENE)

    def begin(self) -> None:
        """Put the permanent objects and arm the output."""
        self.there = []
        for k, at in enumerate(gallery.NEAR):
            self.client.put(_ball(f"near {k}", at))
        self.client.hands(gallery.HAND)
        self.client.arm()

    def window(self, window: Window) -> Heard:
        """Play on for the length of the window, and return the report."""
        end = time.perf_counter() + window.seconds
        seen, due = list[State](), time.perf_counter()
        while due < end:
            self.frame(due)
            seen += self.states.new()
            due = max(due + FRAME, time.perf_counter())
            time.sleep(max(0.0, due - time.perf_counter()))
        before = self.last
        self.last = seen[-1] if seen else self.last
        rows = np.concatenate(
            [np.frombuffer(s.inputs, "<f8").reshape(-1, 4) for s in seen] or [NONE]
        )
        rows = rows[rows[:, 0] > 0.0]  # silent frames carry no hands
        events, self.events = dict(self.events), Counter()
        return Heard(
            ticks=self.last.ticks - before.ticks,
            late=(self.last.late - before.late) / max(1, self.last.ticks - before.ticks),
            tick_ms=self.last.tick_ms,
            gap=self.last.longest_gap,
            age=Quantiles.of((rows[:, 3] - rows[:, 1]).tolist() if rows.size else ()),
            sounding=sum(s.output == "sounding" for s in seen) / max(1, len(seen)),
            faults=self.last.fault_count,
            restarts=sum(self.last.restarts.values()),
            events=events,
        )

    def frame(self, now: float) -> None:
        """Play one frame: move the hand and the balls, renew the lease, and perform an event if one is due."""
        try:
            self._frame(now)
            for error in self.client.errors:
                late = SUPERSEDED in str(error)  # a later selection replaced it: not a refusal
                self.events["superseded" if late else f"refused: {error.code}"] += 1
        except Refused as error:
            self.events[f"raised: {error.code}"] += 1
            self.client.arm(take=True)
        except ConnectionLost as error:
            self.events[f"lost: {error}"] += 1
            self.friend.clear()
            self.client.reconnect()
            self.begin()

    def _frame(self, now: float) -> None:
        x, v = SWING * np.sin(2.0 * np.pi * now), 2.0 * np.pi * SWING * np.cos(2.0 * np.pi * now)
        joints = gallery.HAND.transform(Pose((x, 0.0, 0.0))).joints
        self.client.hands(Hand(joints, velocities=(v, 0.0, 0.0)), wait=False)
        moved = {name: Pose(_place(k, now)) for k, name in enumerate(self.there)}
        if moved:
            self.client.moves(moved, wait=False)
        for friend in self.friend:
            friend.move("friend", Pose((-x, -0.02, gallery.HEIGHT)), wait=False)
            friend.renew()
        self.client.renew()
        if now > self.due:
            self.due, self.count = now + self.play.beat, self.count + 1
            for every, event in self._turns:
                if self.count % every == 0:
                    self.events[event.__name__] += 1
                    event()

    def come_and_go(self) -> None:
        """Add a ball, or remove some."""
        if len(self.there) < MAX_BALLS:
            name = f"ball {self.count}"
            self.client.put(_ball(name, _place(len(self.there), 0.0)))
            self.there.append(name)
        else:
            self.client.remove(*self.there[2:])
            del self.there[2:]

    def wrap(self) -> None:
        """Change the envelope of all balls."""
        if self.there:
            envelope = self.random.choice((Sine(150.0), Sine(80.0), Constant(0.7)))
            self.client.envelope(tuple(self.there), envelope)

    def swap(self) -> None:
        """Change the solver."""
        self.client.select(solver=self.random.choice(SOLVERS), wait=False)

    def dim(self) -> None:
        """Change the intensity."""
        self.client.select(intensity=self.random.uniform(0.5, 1.0), wait=False)

    def join_or_leave(self) -> None:
        """Let a second client join or leave."""
        if self.friend:
            self.friend.pop().close()
            return
        friend = self._join("friend")
        self.friend.append(friend)
        friend.put(_ball("friend", (0.0, -0.02, gallery.HEIGHT)))

    def nonsense(self) -> None:
        """Send bytes that are not a message, with and without the token."""
        for address in (self.connection.control, self.connection.command):
            with socket(self.context, zmq.DEALER, address, self.connection.token) as one:
                for _ in range(NONSENSE if one.poll(100, zmq.POLLOUT) else 0):
                    one.send(self.random.randbytes(self.random.randrange(200)), zmq.NOBLOCK)
            host, _, port = address.removeprefix("tcp://").rpartition(":")
            with tcp.create_connection((host.strip("[]"), int(port)), 1.0) as raw:
                raw.sendall(self.random.randbytes(500))

    def pause(self) -> None:
        """Disarm the output and arm it again."""
        self.client.disarm()
        self.client.arm()

    def emergency(self) -> None:
        """Stop the output, reset it and arm it again."""
        self.client.stop()
        self.client.reset()
        self.client.arm()

    def close(self) -> None:
        """Close all clients."""
        for client in (*self.friend, self.client):
            client.close()
        self.states.close()


def _ball(name: str, at: tuple[float, float, float]) -> Volume:
    return Volume(
        shape=BALL.shape, radiation_pressure=BALL.radiation_pressure, pose=Pose(at), name=name
    )


def _place(k: int, t: float) -> tuple[float, float, float]:
    """Return the place of the k-th ball at time t [s], on a circle around the hand [m]."""
    phi = 2.0 * np.pi * (0.3 * t + k / MAX_BALLS)
    return 0.04 * float(np.cos(phi)), 0.04 * float(np.sin(phi)), gallery.HEIGHT


def main() -> None:
    """Run in a separate process and play while orders arrive."""
    context = zmq.Context[Any]()
    game = Game(context, worker_process.read_task(Play))
    while (order := worker_process.read_order(Window)) is not None:
        try:
            worker_process.answer(game.window(order))
        except ServerError as error:
            raise SystemExit(f"the game ends: {error}") from error
    game.close()
    context.term()


if __name__ == "__main__":
    main()
