"""The bus process: it takes clients' commands, stores their objects, and sends the changes to the renderer.

It polls in rounds: receive the messages and drop superseded ones; expire objects; send the next batch if the renderer
has taken the last; process a slice of a query; send replies. A thread converts objects that take long. A client that
does not read its replies loses them.
"""

from __future__ import annotations

import contextlib
import math
import random
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, TypeVar

import msgspec
import zmq

from pacinian.serving.bus.coalescing import Message
from pacinian.serving.bus.dispatcher import CommandDispatcher
from pacinian.serving.bus.field_queries import EmittedGains
from pacinian.serving.bus.warmup import warm_up
from pacinian.serving.ipc import parent_link, scheduling
from pacinian.serving.ipc.auth import ClientAuthenticator, receive
from pacinian.serving.ipc.logs import RateLimitedLog, configure
from pacinian.serving.ipc.messages import (
    Changes,
    ChangesAck,
    DeviceStatus,
    SessionTable,
    open_wake_pipe,
    open_wakes,
    pack,
)
from pacinian.serving.ipc.ports import bind_socket
from pacinian.serving.ipc.shared_memory import SharedRegister
from pacinian.serving.ipc.system_setup import trim_memory
from pacinian.wire.codec import encode

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Mapping
    from concurrent.futures import Executor
    from pathlib import Path

    from pacinian.acoustics.array import Array
    from pacinian.serving.ipc.wake_pipe import WakePipe
    from pacinian.serving.settings import Settings
    from pacinian.types import Gains

T = TypeVar("T")

FILES = "sessions", "changes", "changes_ack", "frame", "device", "bus_status"
# Maximum number of messages, and of bytes, received in one round.
MAX_ROUND_MESSAGES, MAX_ROUND_BYTES = 2048, 4 << 20
MAX_RECEIVE_TIME = 0.002  # time limit to receive the messages of one round [s]
# Minimum interval between rounds [s], so that messages that arrive one by one are handled together.
MIN_ROUND_INTERVAL = 3e-4
# Longest wait for messages [s]: while the renderer or the converter has work pending; while neither has; and on a
# system where a new session cannot end the wait.
BUSY_WAIT, IDLE_WAIT, POLLED_WAIT = 1e-3, 0.05, 5e-3
# Thread switch interval [s]. It limits how long a conversion blocks the loop.
THREAD_SWITCH_INTERVAL = 2e-4
REPORT_INTERVAL = 0.05  # interval between two status reports [s]


class Bus:
    """Connects the dispatcher to its socket and to the shared memory. Times are those of `time.perf_counter` [s].

    wake: ends the wait for messages, if the sessions have changed or the renderer has taken a batch.
    """

    def __init__(
        self,
        settings: Settings,
        array: Array,
        socket: zmq.Socket[bytes],
        memory: Mapping[str, SharedRegister],
        name: Callable[[str], str],
        executor: Executor,
        wake: WakePipe,
    ) -> None:
        self.port = int(socket.getsockopt_string(zmq.LAST_ENDPOINT).rpartition(":")[2])
        self._socket, self._memory, self._name = socket, memory, name
        self._seen: dict[str, int] = dict.fromkeys(FILES, 0)
        self._emitted = EmittedGains(len(array))
        run = random.getrandbits(62) + 1
        self.dispatcher = CommandDispatcher(
            settings, array, run, self._read_sessions, self._read_gains, RateLimitedLog(), executor
        )
        self._wake = wake
        self._poller = zmq.Poller()
        self._poller.register(socket, zmq.POLLIN)
        if wake.works:
            self._poller.register(wake.fileno(), zmq.POLLIN)
        self._reported_at = -REPORT_INTERVAL  # [s]
        self._busy = False
        self._begun = -math.inf  # begin of the last round [s]
        memory["changes"].write(pack(Changes(0, run, ())))  # nothing of an earlier bus may sound
        self.report()

    def run_round(self) -> None:
        """Receive messages, send changes to the renderer, reply."""
        begin = time.perf_counter()
        if begin < self._begun + MIN_ROUND_INTERVAL:
            time.sleep(self._begun + MIN_ROUND_INTERVAL - begin)
        self._begun = time.perf_counter()
        batcher = self.dispatcher.batcher
        wait = IDLE_WAIT if self._wake.works else POLLED_WAIT
        if batcher.has_more or len(self.dispatcher.converter):
            wait = BUSY_WAIT
        due = 0.0 if self._busy else min(wait, self.dispatcher.due - self._begun)
        ready = dict(self._poller.poll(max(0, math.ceil(1e3 * due))))
        if self._wake.fileno() in ready:
            self._wake.clear()
        if self._socket in ready:
            self._receive()
        with self.dispatcher.catch_faults("sessions"):
            if (sessions := self._read_sessions()) is not None:
                self.dispatcher.update_sessions(sessions)
        with self.dispatcher.catch_faults("publishing"):
            self._publish()
        self.dispatcher.run_round(time.perf_counter())
        self._reply()
        if time.perf_counter() - self._reported_at >= REPORT_INTERVAL:
            self.report()
        self._busy = len(self.dispatcher.queries) > 0

    def report(self) -> None:
        """Report the status to control."""
        now = time.perf_counter()
        with self.dispatcher.catch_faults("device"):
            self._read_new("device", DeviceStatus, self._emitted.note_device)
        self._memory["bus_status"].write(pack(self.dispatcher.make_status(now, self.port)))
        self._reported_at = now

    def _receive(self) -> None:
        """Receive all waiting messages at once, because superseded ones then cost next to nothing."""
        messages: list[Message] = []
        end, size = time.perf_counter() + MAX_RECEIVE_TIME, 0
        while (
            len(messages) < MAX_ROUND_MESSAGES
            and size < MAX_ROUND_BYTES
            and (now := time.perf_counter()) < end
        ):
            taken = receive(self._socket)
            if taken is None:
                break
            peer, user, data = taken
            messages.append(Message(peer, self._name(user), data, now))
            size += len(data)
        self.dispatcher.handle_messages(messages)

    def _publish(self) -> None:
        batcher = self.dispatcher.batcher
        self._read_new("changes_ack", ChangesAck, batcher.acknowledge)
        if (changes := batcher.make_batch()) is not None:
            try:
                self._memory["changes"].write(pack(changes))
            except Exception:
                batcher.resend_scene()
                raise

    def _reply(self) -> None:
        replies = self.dispatcher.replies[:]
        self.dispatcher.replies.clear()
        for peer, reply in replies:
            with self.dispatcher.catch_faults("reply"), contextlib.suppress(zmq.Again):
                self._socket.send_multipart((peer, encode(reply)), zmq.NOBLOCK)

    def _read_sessions(self) -> SessionTable | None:
        new: list[SessionTable] = []
        self._read_new("sessions", SessionTable, new.append)
        return new[0] if new else None

    def _read_gains(self) -> tuple[Gains, float]:
        self._read_new("device", DeviceStatus, self._emitted.note_device)
        read = self._memory["frame"].read()
        return self._emitted.decode_gains(b"" if read is None else read[1])

    def _read_new(self, name: str, kind: type[T], do: Callable[[T], object]) -> None:
        """Read a file; call `do` if the value is new."""
        read = self._memory[name].read(self._seen[name])
        if read is not None:
            self._seen[name] = read[0]
            do(msgspec.msgpack.decode(read[1], type=kind))


@contextlib.contextmanager
def open_bus(settings: Settings, folder: Path, secrets: dict[str, str]) -> Generator[Bus]:
    """Open the bus for these settings; close its socket at the end. Raises ServerError if its port is taken."""
    array = settings.array.make()
    warm_up(array, settings.medium.make())
    with contextlib.ExitStack() as stack:
        memory: dict[str, SharedRegister] = {
            name: stack.enter_context(
                SharedRegister.attach(path, open_wakes(path) if name == "changes" else ())
            )
            for name in FILES
            for path in (folder / name,)
        }
        wake = open_wake_pipe(folder, "bus")
        stack.callback(wake.close)
        context: zmq.Context[zmq.Socket[bytes]] = stack.enter_context(zmq.Context())
        authenticator = stack.enter_context(
            ClientAuthenticator(context, secrets, settings.security.keys)
        )
        socket = stack.enter_context(context.socket(zmq.ROUTER))
        authenticator.configure_socket(socket, settings.clients.max_command_bytes)
        socket.router_mandatory = False  # replies to a closed connection are dropped
        network = settings.network
        bind_socket(socket, network.endpoint(network.command))
        executor = ThreadPoolExecutor(1)
        stack.callback(executor.shutdown, cancel_futures=True)
        yield Bus(settings, array, socket, memory, authenticator.name_user, executor, wake)


def main() -> None:
    """Run until the parent ends or asks this process to end."""
    ended = threading.Event()
    config = parent_link.read_launch_config(ended.set)
    configure(config.settings.log, "bus")
    sys.setswitchinterval(THREAD_SWITCH_INTERVAL)
    # A priority above clients that flood the server, but below the renderer.
    scheduling.raise_priority(scheduling.EAGER - 1)
    with open_bus(config.settings, config.path, config.secrets) as bus:
        trim_memory()
        while not ended.is_set():
            bus.run_round()


if __name__ == "__main__":
    main()
