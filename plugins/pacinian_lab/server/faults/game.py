"""A game in a separate process: `python -m pacinian_lab.server.faults.game FILE [control=tcp://...]`.

The game puts an object and arms the output. It renews and moves at 90 Hz, and arms again when it has lost the output,
until its standard input ends. Each input line is a request for the control socket, as JSON, except that `freeze` and
`jump`, with `seconds`, act on the game's thread and clock. Answers are JSON lines.
"""

from __future__ import annotations

import json
import math
import queue
import sys
import threading
import time
from pathlib import Path

from pacinian.errors import PacinianError
from pacinian.wire.binary_arrays import pack
from pacinian_lab.server.faults.misbehaving_client import Message, MisbehavingClient, Silent

RATE = 90.0  # [Hz]
ARM_INTERVAL = 0.05  # [s] between attempts to arm
LOST = 0.5  # [s] without an answer until the game reconnects
RADIUS, HEIGHT, TURN = 0.02, 0.2, 6.0  # [m], [m], [rad/s] circle of the point
POINT: Message = {"type": "point", "position": [0.0, 0.0, HEIGHT], "radiation_pressure": 20.0}


class Game:
    """The game. file: the server's connection file. hide: as in `MisbehavingClient`."""

    def __init__(self, file: Path, **hide: str) -> None:
        self.file, self.hide = file, hide
        self._ahead = 0.0  # [s] offset of its clock
        self._client: MisbehavingClient | None = None
        self._heard = self._tried = 0.0

    def clock(self) -> float:
        """Return the game's time [s]."""
        return time.perf_counter() + self._ahead

    def do(self, kind: str, seconds: float = 0.0, **fields: object) -> None:
        """Perform an order."""
        if kind == "freeze":
            time.sleep(seconds)
        elif kind == "jump":
            self._ahead += seconds
        elif self._client is not None:
            self._client.say(kind, **fields)

    def tick(self) -> list[Message]:
        """Play one tick, and return the answers received."""
        now = time.perf_counter()
        try:
            if self._client is None or now - self._heard > LOST:
                self._connect()
                return []
            self._client.renew()
            x, y = (RADIUS * f(TURN * now) for f in (math.cos, math.sin))
            poses = pack([[x, y, HEIGHT, 0.0, 0.0, 0.0, 1.0]])
            self._client.tell("move", names=["thing"], poses=poses)
            return self._listen(self._client, now)
        except (Silent, PacinianError):  # the server is gone
            self._heard = 0.0
            return []

    def _connect(self) -> None:
        self.close()
        self._client = client = MisbehavingClient(
            self.file, clock=self.clock, beats=True, **self.hide
        )
        if client.hello(wait=LOST, client="game")["type"] == "welcome":
            self._heard = time.perf_counter()
            client.tell("put", objects={"thing": POINT})
            client.renew()
            client.say("arm")

    def _listen(self, client: MisbehavingClient, now: float) -> list[Message]:
        replies = client.drain()
        for reply in replies:
            if reply["type"] == "renewed":
                self._heard = now
                if not reply["armed"] and reply["id"] and now - self._tried > ARM_INTERVAL:
                    self._tried = now
                    client.say("arm")
            elif reply.get("code") == "session":
                self._heard = 0.0
        return [reply for reply in replies if reply["type"] in ("ok", "error")]

    def close(self) -> None:
        """Close the connection."""
        if self._client is not None:
            self._client.close()
            self._client = None


def main() -> None:
    """Play until standard input ends."""
    file, *rest = sys.argv[1:]
    game = Game(Path(file), **dict(pair.split("=", 1) for pair in rest))
    lines: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(lines,), daemon=True).start()
    due = time.perf_counter()
    while True:
        for reply in game.tick():
            print(json.dumps(reply), flush=True)  # noqa: T201
        due = max(due + 1.0 / RATE, time.perf_counter())
        time.sleep(max(0.0, due - time.perf_counter()))
        while not lines.empty():
            if not (line := lines.get()):
                game.close()
                return
            order = json.loads(line)
            game.do(order.pop("type"), **order)


def _read(lines: queue.SimpleQueue[str]) -> None:
    for line in sys.stdin:
        lines.put(line)
    lines.put("")


if __name__ == "__main__":
    main()
