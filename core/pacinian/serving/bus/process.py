"""The bus process: it takes clients' commands, keeps their objects, and tells the renderer what is new.

Plain polling, in rounds: the messages that there are, of which the newest count; what time brings; the next batch for
the renderer if it has taken the last; a slice of a query; replies. Objects that take long are converted in a thread.
A client that does not read its replies loses them.
"""

from __future__ import annotations

import contextlib
import gc
import math
import random
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, TypeVar

import msgspec
import zmq

from pacinian.errors import ServerError
from pacinian.serving.bus.coalescing import Message
from pacinian.serving.bus.dispatcher import CommandDispatcher
from pacinian.serving.bus.field_queries import EmittedGains
from pacinian.serving.bus.warmup import warm_up
from pacinian.serving.ipc import child_process, scheduling
from pacinian.serving.ipc.auth import Authenticator, receive
from pacinian.serving.ipc.logs import RateLimitedLog, configure
from pacinian.serving.ipc.messages import Changes, ChangesAck, DeviceStatus, SessionTable, pack
from pacinian.serving.ipc.shared_memory import SharedRegister
from pacinian.wire.codec import encode

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Mapping
    from concurrent.futures import Executor
    from pathlib import Path

    from pacinian.acoustics.array import Array
    from pacinian.serving.settings import Settings
    from pacinian.types import Gains

T = TypeVar("T")

FILES = "sessions", "changes", "taken", "frame", "device", "traffic"
MAX_ROUND_MESSAGES, LARGE = 2048, 4 << 20  # messages in one round, and bytes
MAX_RECEIVE_TIME = 0.002  # [s] that it may take to receive them
APART = 3e-4  # [s] from round to round, at least: what comes one by one is then taken together
SOON, LATER = 1, 5  # [ms] to wait for messages: while something is to be taken, and otherwise
SWITCH = 2e-4  # [s] that an object which is converted may hold up the rest
TELL = 0.05  # [s] between two reports
QUEUE = 256  # messages of one client that wait here


class Bus:
    """Joins the dispatcher to its socket and to the shared memory. Times are of `clock` [s]."""

    def __init__(
        self,
        settings: Settings,
        array: Array,
        socket: zmq.Socket[bytes],
        memory: Mapping[str, SharedRegister],
        name: Callable[[str], str],
        executor: Executor,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.port = int(socket.getsockopt_string(zmq.LAST_ENDPOINT).rpartition(":")[2])
        self._socket, self._memory, self._name, self._clock = socket, memory, name, clock
        self._seen: dict[str, int] = dict.fromkeys(FILES, 0)
        self._emitted = EmittedGains(len(array))
        run = random.getrandbits(62) + 1
        self.dispatcher = CommandDispatcher(
            settings, array, run, self._sessions, self._gains, RateLimitedLog(clock), executor
        )
        self._poller = zmq.Poller()
        self._poller.register(socket, zmq.POLLIN)
        self._told = -TELL  # [s]
        self._busy = False
        self._begun = -math.inf  # [s], the last round
        memory["changes"].write(pack(Changes(0, run, ())))  # nothing of a bus before sounds again
        self.tell()

    def round(self) -> None:
        """Take messages, tell the renderer, answer."""
        begin = self._clock()
        if begin < self._begun + APART:
            time.sleep(self._begun + APART - begin)
        self._begun = self._clock()
        outbox = self.dispatcher.batcher
        wait = (
            0 if self._busy else SOON if outbox.waits or len(self.dispatcher.converter) else LATER
        )
        if self._poller.poll(wait):
            self._take()
        with self.dispatcher.going_on("sessions"):
            if (sessions := self._sessions()) is not None:
                self.dispatcher.sessions(sessions)
        with self.dispatcher.going_on("publishing"):
            self._publish()
        self.dispatcher.round(self._clock())
        self._reply()
        if self._clock() - self._told >= TELL:
            self.tell()
        self._busy = len(self.dispatcher.queries) > 0

    def tell(self) -> None:
        """Report to control."""
        now = self._clock()
        with self.dispatcher.going_on("device"):
            self._new("device", DeviceStatus, self._emitted.device)
        self._memory["traffic"].write(pack(self.dispatcher.traffic(now, self.port)))
        self._told = now

    def _take(self) -> None:
        """All that has come, at once: what is replaced by something newer then costs next to nothing."""
        messages: list[Message] = []
        end, size = self._clock() + MAX_RECEIVE_TIME, 0
        while len(messages) < MAX_ROUND_MESSAGES and size < LARGE and (now := self._clock()) < end:
            taken = receive(self._socket)
            if taken is None:
                break
            peer, user, data = taken
            messages.append(Message(peer, self._name(user), data, now))
            size += len(data)
        self.dispatcher.messages(messages)

    def _publish(self) -> None:
        outbox = self.dispatcher.batcher
        self._new("taken", ChangesAck, outbox.taken)
        if (changes := outbox.next()) is not None:
            try:
                self._memory["changes"].write(pack(changes))
            except Exception:
                outbox.lost()
                raise

    def _reply(self) -> None:
        replies = self.dispatcher.replies[:]
        self.dispatcher.replies.clear()
        for peer, reply in replies:
            with self.dispatcher.going_on("reply"), contextlib.suppress(zmq.Again):
                self._socket.send_multipart((peer, encode(reply)), zmq.NOBLOCK)

    def _sessions(self) -> SessionTable | None:
        new: list[SessionTable] = []
        self._new("sessions", SessionTable, new.append)
        return new[0] if new else None

    def _gains(self) -> tuple[Gains, float]:
        self._new("device", DeviceStatus, self._emitted.device)
        read = self._memory["frame"].read()
        return self._emitted.gains(b"" if read is None else read[1])

    def _new(self, name: str, kind: type[T], do: Callable[[T], object]) -> None:
        """Read a file, if there is something new."""
        read = self._memory[name].read(self._seen[name])
        if read is not None:
            self._seen[name] = read[0]
            do(msgspec.msgpack.decode(read[1], type=kind))


@contextlib.contextmanager
def open_bus(settings: Settings, folder: Path, secrets: dict[str, str]) -> Generator[Bus]:
    """The bus of these settings; its socket is closed at the end. Raises ServerError if its port is taken."""
    array = settings.array.make()
    warm_up(array, settings.medium.make())
    with contextlib.ExitStack() as stack:
        memory: dict[str, SharedRegister] = {
            name: stack.enter_context(SharedRegister.attach(folder / name)) for name in FILES
        }
        context: zmq.Context[zmq.Socket[bytes]] = stack.enter_context(zmq.Context())
        gate = stack.enter_context(Authenticator(context, secrets, settings.security.keys))
        socket = stack.enter_context(context.socket(zmq.ROUTER))
        gate.protect(socket, settings.clients.command_bytes)
        socket.router_mandatory = False  # whoever has gone gets no reply
        # what waits is old when its turn comes; `rcvbuf` stays the system's: 16 KiB halved what one client can send
        socket.rcvhwm = QUEUE
        network = settings.network
        try:
            socket.bind(network.endpoint(network.command))
        except zmq.ZMQError as error:
            raise ServerError(
                f"{network.endpoint(network.command)} cannot be bound: {error.strerror}"
            ) from error
        executor = ThreadPoolExecutor(1)
        stack.callback(executor.shutdown, cancel_futures=True)
        yield Bus(settings, array, socket, memory, gate.name, executor)


def main() -> None:
    """Run until the parent goes, or tells it to."""
    ended = threading.Event()
    told = child_process.read_launch_config(ended.set)
    configure(told.settings.log, "bus")
    sys.setswitchinterval(SWITCH)
    # before clients that send too much, but not before the renderer
    scheduling.raise_priority(scheduling.EAGER - 1)
    with open_bus(told.settings, told.path, told.secrets) as bus:
        gc.collect()
        gc.freeze()
        while not ended.is_set():
            bus.round()


if __name__ == "__main__":
    main()
