"""The sending process: `python -m pacinian_lab.server.fuzz.flood FILE KIND SEED MESSAGES SECONDS`. Prints JSON.

KIND: `command` or `control`: mutated messages of an authenticated client; `raw`: raw connections; `burn`: the same
CPU load, without sending. Ends after so many messages or seconds, whichever comes first. Prints counts.
"""

from __future__ import annotations

import json
import sys
import time
from collections import Counter
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

import zmq
from msgspec.structs import asdict

from pacinian.wire.connection_file import Connection
from pacinian.wire.protocol import MAX_COMMAND_BYTES, MAX_CONTROL_BYTES
from pacinian_lab.server.faults.misbehaving_client import MisbehavingClient, Silent
from pacinian_lab.server.fuzz.messages import COMMANDS, CONTROLS
from pacinian_lab.server.fuzz.mutations import Spoiler
from pacinian_lab.server.fuzz.packets import ANSWERS, packet, throw, within

if TYPE_CHECKING:
    from collections.abc import Iterator

FAREWELL = 5  # [ms] for the server to close a connection that sent too much
MAX_WAIT = 5.0  # [s] longest wait for an answer
HELLO, KNOWN = 0.02, 0.2  # share of hellos in control messages; of handshakes in connections
BATCH = 200  # messages between two valid ones, which show that the server has read them all


class Flood:
    """Sends until the run is over. sent: counts by mutation. failed: messages that could not be sent."""

    def __init__(self, file: Path, seed: int) -> None:
        self.file, self.random = file, Random(seed)
        self.sent: Counter[str] = Counter()
        self.failed = 0

    def messages(self, kind: str) -> Iterator[MisbehavingClient]:
        """Send mutated messages from an authenticated client. Its heartbeats are part of the load."""
        examples = COMMANDS if kind == "command" else CONTROLS
        with (
            MisbehavingClient(self.file, beats=True) as client,
            MisbehavingClient(self.file, beats=True) as stranger,
        ):
            spoiler = Spoiler(self.random, b"")
            socket = client.command if kind == "command" else client.control
            longest = MAX_COMMAND_BYTES if kind == "command" else MAX_CONTROL_BYTES
            while True:
                # a mutation may have used up the sequence
                if not self._heard(client, spoiler, kind):
                    client.hello(client="hostile")
                    spoiler.session, spoiler.sequence = client.session, 0
                for _ in range(BATCH):
                    if kind == "control" and self.random.random() < HELLO:
                        self._send(stranger.control, MAX_CONTROL_BYTES, *spoiler.hello())
                    else:
                        made = spoiler.next(examples, time.perf_counter())
                        self._send(socket, longest, *made)
                client.drain()
                stranger.drain()
                yield client

    @staticmethod
    def _heard(client: MisbehavingClient, spoiler: Spoiler, kind: str) -> bool:
        """Return whether the server has read all messages and still takes a valid one."""
        try:
            if kind == "control":
                return bool(client.ask("status", MAX_WAIT)["type"] == "state")
            client.sequence = spoiler.sequence
            spoiler.sequence += 1
            reply = client.tell("remove", MAX_WAIT, names=[])
        except Silent:
            return False
        return bool(reply and reply["type"] == "ok")

    def _send(self, socket: zmq.Socket[bytes], longest: int, name: str, data: bytes) -> None:
        if len(data) > longest:
            self._apart(data)
        elif socket.poll(1000, zmq.POLLOUT):
            socket.send(data)
        else:
            self.failed += 1
            return
        self.sent[name] += 1

    def _apart(self, data: bytes) -> None:
        """Send a message that is too long on a separate connection, because it ends the connection."""
        with MisbehavingClient(self.file, beats=True) as client:
            if client.control.poll(1000, zmq.POLLOUT):
                client.control.send(data)
                client.control.poll(FAREWELL)

    def packets(self) -> Iterator[None]:
        """Open raw connections to all sockets."""
        file = asdict(Connection.read(self.file))
        token = file["token"].encode()
        while True:
            known = self.random.random() < KNOWN
            name, data = within(self.random) if known else packet(self.random)
            address = file[self.random.choice(("control", "command", "state"))]
            self.failed += not throw(address, data, token if known else None, ANSWERS.get(name, 0))
            self.sent[name] += 1
            yield

    def burn(self) -> Iterator[None]:
        """Do the same work without sending."""
        spoiler = Spoiler(self.random, b"")
        while True:
            self.sent[spoiler.next(COMMANDS, 0.0)[0]] += 1
            yield


def main() -> None:
    """Send, then print the counts."""
    name, kind, seed, messages, seconds = sys.argv[1:]
    flood, codes = Flood(Path(name), int(seed)), Counter[str]()
    start = time.perf_counter()
    ways = {"raw": flood.packets, "burn": flood.burn}
    steps = ways[kind]() if kind in ways else flood.messages(kind)
    for client in steps:
        if isinstance(client, MisbehavingClient):
            codes = client.codes
        if flood.sent.total() >= int(messages) or time.perf_counter() > start + float(seconds):
            break
    took = time.perf_counter() - start
    result = {"sent": flood.sent, "codes": codes, "failed": flood.failed, "seconds": took}
    print(json.dumps(result))  # noqa: T201


if __name__ == "__main__":
    main()
