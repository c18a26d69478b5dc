"""Many clients in one process that move their objects at a given total rate."""

from __future__ import annotations

import time
from collections import Counter
from typing import Any

import zmq
from msgspec import Struct

from pacinian.errors import ServerError
from pacinian.wire.commands import Move, Put
from pacinian.wire.connection_file import Connection
from pacinian_lab.server import positions, worker_process
from pacinian_lab.server.bare_client import BareClient

WAKE = 0.001  # [s]
RENEW = 1.0  # [s]
BEHIND = 0.05  # [s] of overdue messages that are made up for; older ones are not sent


class Crowd(Struct, frozen=True):
    """The clients of a process: numbers `clients` of `of` in total. objects: in total; client i % of owns object i."""

    connection: str
    scene: str
    clients: tuple[int, ...]
    of: int
    objects: int


class Push(Struct, frozen=True, tag=True):
    """Order: move the objects `rate` times per second in total, from `begin` to `end` [s]."""

    rate: float
    begin: float
    end: float


class Place(Struct, frozen=True, tag=True):
    """Order: put each object where it belongs at time t [s] when `group` is felt. Answered after the server's reply."""

    t: float
    group: int


class Done(Struct, frozen=True):
    """Messages. sent: taken by a socket. full: found no room. notices: and errors, by code."""

    sent: int = 0
    full: int = 0
    notices: dict[str, int] = {}


class Members:
    """The clients and their objects."""

    def __init__(self, context: zmq.Context[Any], crowd: Crowd) -> None:
        connection = Connection.read(crowd.connection)
        self.clients = {
            n: BareClient(context, connection, f"client {n}", crowd.scene) for n in crowd.clients
        }
        self.own = [
            (self.clients[i % crowd.of], i)
            for i in range(crowd.objects)
            if i % crowd.of in self.clients
        ]
        self._turn, self._renewed = 0, 0.0
        now = time.perf_counter()
        for client, i in self.own:
            client.ask(Put, objects={positions.name(i): positions.point(i, now)})

    def push(self, push: Push) -> Done:
        """Move the objects in turn."""
        self._collect_counts()
        asked = sent = full = 0
        while (now := time.perf_counter()) < push.end:
            self._renew(now)
            due = int(push.rate * max(0.0, now - push.begin))
            asked, todo = due, due - asked
            for _ in range(min(todo, max(1, int(BEHIND * push.rate)))):
                client, i = self.own[self._turn]
                self._turn = (self._turn + 1) % len(self.own)
                now = time.perf_counter()
                done = client.send(
                    Move, time=now, names=(positions.name(i),), poses=positions.pose(i, now)
                )
                sent, full = sent + done, full + (not done)
            time.sleep(WAKE)
        return Done(sent, full, self._collect_counts())

    def place(self, place: Place) -> Done:
        """Put all objects where the observer expects them, and wait for each reply."""
        refused = Counter[str]()
        for client, i in self.own:
            self._renew(time.perf_counter())
            pose = positions.pose(i, place.t, place.group)
            try:
                client.ask(Move, names=(positions.name(i),), poses=pose)
            except ServerError as error:
                refused[getattr(error, "code", "no answer")] += 1
        sent = len(self.own) - refused.total()
        return Done(sent, 0, Counter(self._collect_counts()) + refused)

    def _renew(self, now: float) -> None:
        if now > self._renewed + RENEW:
            self._renewed = now
            for client in self.clients.values():
                client.renew_nowait()

    def _collect_counts(self) -> dict[str, int]:
        counts = sum((client.notices for client in self.clients.values()), Counter[str]())
        for client in self.clients.values():
            client.notices.clear()
        return dict(counts)

    def close(self) -> None:
        """Close all clients."""
        for client in self.clients.values():
            client.close()


def main() -> None:
    """Run in a separate process until the parent ends."""
    context = zmq.Context[Any]()
    members = Members(context, worker_process.read_task(Crowd))
    worker_process.answer(Done())
    while (order := worker_process.read_order(Push | Place)) is not None:
        worker_process.answer(
            members.push(order) if isinstance(order, Push) else members.place(order)
        )
    members.close()
    context.term()


if __name__ == "__main__":
    main()
