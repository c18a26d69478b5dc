"""The owner of the output: observes it while other clients load the server, and pings the control socket."""

from __future__ import annotations

import queue
import time
from typing import Any

import zmq
from msgspec import Struct

from pacinian.errors import ServerError
from pacinian.serving.ipc import scheduling
from pacinian.wire.connection_file import Connection
from pacinian.wire.control import Arm
from pacinian.wire.state import ClientState, State
from pacinian_lab.server import positions, worker_process
from pacinian_lab.server.bare_client import BareClient, States
from pacinian_lab.server.quantiles import Quantiles

NAME = "watcher"
PING = 0.01  # [s] between pings
SEEN = 5.0  # [s] within which a position, or any state, must appear


class Watch(Struct, frozen=True):
    """The connection file and the scene to observe."""

    connection: str
    scene: str


class Look(Struct, frozen=True, tag=True):
    """Order: observe from `begin` to `end` [s]."""

    begin: float
    end: float


class Check(Struct, frozen=True, tag=True):
    """Order: check that objects first..last - 1 are felt where they were put at time t [s], and all commands came."""

    t: float
    first: int
    last: int
    commands: int


class Seen(Struct, frozen=True):
    """Results of an observation.

    ping: round trips of `renew` [s]. age: age of the newest move in each state when it was published [s]. backwards:
    how often an object was felt at an earlier place than before. ticks, frames: per second. late: fraction of ticks.
    tick_ms: median and 99 % quantile of the last second. gap: longest time between two frames since the start [s].
    samples: median. sounding: fraction of the states. lost: unanswered pings and expired leases.
    """

    ping: Quantiles
    age: Quantiles
    backwards: int
    ticks: float
    frames: float
    late: float
    tick_ms: tuple[float, float]
    gap: float
    samples: int
    sounding: float
    lost: int
    faults: int


class Checked(Struct, frozen=True):
    """missing: objects that were not felt there. The other counts are of all clients except the observer."""

    missing: tuple[int, ...]
    objects: int
    commands: int
    errors: int
    dropped: int


class Watcher:
    """Owns the output and observes it."""

    def __init__(self, context: zmq.Context[Any], watch: Watch) -> None:
        self._context, self._scene = context, watch.scene
        self._connection = Connection.read(watch.connection)
        self.states = States(context, self._connection)
        self.lost = 0
        self.client = self._connect()

    def _connect(self) -> BareClient:
        client = BareClient(self._context, self._connection, NAME, self._scene)
        client.request(Arm, take=True)
        return client

    def ping(self) -> float | None:
        """Return a round trip [s], or None if it failed. Counts a lost session or lease and restores it."""
        try:
            trip = self.client.renew()
            if self.client.notices.pop("expired", 0):
                self.lost += 1
                self.client.request(Arm)
        except ServerError as error:
            self.lost += 1
            if getattr(error, "code", "") == "session":
                self.client.close(bye=False)
                self.client = self._connect()
            return None
        return trip

    def look(self, look: Look) -> Seen:
        """Ping and collect states."""
        self.lost = 0
        trips, ages = list[float](), list[float]()
        seen, backwards, newest = list[State](), 0, dict[int, float]()
        while (now := time.perf_counter()) < look.end + SEEN * (len(seen) < 2):
            fresh = self.states.new()
            if now >= look.begin:
                for state in fresh:
                    sent = positions.decode_send_times(state.points, state.time)
                    backwards += sum(
                        t < newest.get(i, t) - positions.PERIOD * positions.WITHIN / positions.WAY
                        for i, t in sent.items()
                    )
                    newest |= sent
                    ages += [state.time - max(sent.values())] if sent else []
                seen += fresh
            trip = self.ping()
            if trip is not None and now >= look.begin:
                trips.append(trip)
            time.sleep(max(0.0, now + PING - time.perf_counter()))
        if len(seen) < 2:
            raise ServerError("publishes no state")
        first, last = seen[0], seen[-1]
        ticks, passed = last.ticks - first.ticks, max(1e-9, last.time - first.time)
        return Seen(
            ping=Quantiles.of(trips),
            age=Quantiles.of(ages),
            backwards=backwards,
            ticks=ticks / passed,
            frames=(last.frames - first.frames) / passed,
            late=(last.late - first.late) / max(1, ticks),
            tick_ms=last.tick_ms[:2],
            gap=last.longest_gap,
            samples=sorted(len(s.points) // 12 for s in seen)[len(seen) // 2],
            sounding=sum(s.output == "sounding" for s in seen) / len(seen),
            lost=self.lost,
            faults=last.fault_count - first.fault_count,
        )

    def check(self, check: Check) -> Checked:
        """Wait until the objects are felt and the commands are counted."""
        due = time.perf_counter() + SEEN
        indices = range(check.first, check.last)
        missing, others = list(indices), list[ClientState]()
        while time.perf_counter() < due:
            for state in self.states.new():
                missing = positions.find_missing(state.points, indices, check.t)
                others = [client for client in state.clients if client.name != NAME]
            if not missing and sum(client.commands for client in others) >= check.commands:
                break
            self.ping()
            time.sleep(PING)
        return Checked(
            tuple(missing),
            sum(client.objects for client in others),
            sum(client.commands for client in others),
            sum(client.errors for client in others),
            sum(client.dropped for client in others),
        )

    def close(self) -> None:
        """Leave the session."""
        self.client.close()
        self.states.close()


def main() -> None:
    """Run in a separate process until the parent ends."""
    scheduling.raise_priority()  # so that its waiting times are the server's, not its own
    context = zmq.Context[Any]()
    watcher = Watcher(context, worker_process.read_task(Watch))
    worker_process.answer(Watch("", ""))
    orders = worker_process.queue_orders(Look | Check)
    while True:
        try:
            order = orders.get(timeout=PING)
        except queue.Empty:
            watcher.ping()
            continue
        if order is None:
            break
        worker_process.answer(
            watcher.look(order) if isinstance(order, Look) else watcher.check(order)
        )
    watcher.close()
    context.term()


if __name__ == "__main__":
    main()
