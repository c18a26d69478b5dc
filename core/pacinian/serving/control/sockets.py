"""The control process's sockets: requests, replies, published state, and refused connections."""

from __future__ import annotations

import contextlib
import math
import struct
import time
from collections import Counter
from typing import TYPE_CHECKING

import zmq

from pacinian.closeable import Closeable
from pacinian.serving.ipc.auth import receive
from pacinian.serving.ipc.ports import bind_socket
from pacinian.wire.protocol import MAX_CONTROL_BYTES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.serving.ipc.auth import ClientAuthenticator
    from pacinian.serving.settings import Network
    from pacinian.wire.stop_datagram import StopSocket

# Largest size of a message from a subscriber [bytes]. Its handshake is the longest.
MAX_SUBSCRIPTION_BYTES = 4096
# Number of requests that may wait from one client: more than a game sends at 1 kHz until its heartbeat notices that
# control stands still. libzmq 4.3 aborts (`!_io_error`) at a heartbeat behind a full queue of a closed connection.
MAX_WAITING_REQUESTS = 2048
# Number of states queued for a slow subscriber before it misses some.
MAX_WAITING_STATES = 8
REFUSED = {
    zmq.EVENT_HANDSHAKE_FAILED_AUTH: "secret",  # an unknown token or key
    zmq.EVENT_HANDSHAKE_FAILED_PROTOCOL: "protocol",  # another mechanism, or not ZeroMQ
    zmq.EVENT_HANDSHAKE_FAILED_NO_DETAIL: "handshake",
    zmq.EVENT_ACCEPT_FAILED: "accept",
}
WATCHED = sum(REFUSED) + zmq.EVENT_ACCEPTED + zmq.EVENT_DISCONNECTED
# Largest number of connection events handled in one round, 6 us each. ZeroMQ blocks once some 2000 events wait.
MAX_ROUND_EVENTS = 1024
MAX_DRAIN_TIME = 2.0  # longest wait for the last events of the monitors [s]
QUIET_TIME = 20  # time without an event after which the monitors count as ended [ms]
EVENT = struct.Struct("=hi")  # layout of an event and its value, as in zmq_socket_monitor(3)


class ControlSockets(Closeable):
    """The bound sockets. A context manager. control, state: ports. counts: connections, and refused ones by reason.

    stop: socket for connectionless emergency stops. Raises ServerError if a port is taken.
    """

    def __init__(
        self,
        context: zmq.Context[zmq.Socket[bytes]],
        authenticator: ClientAuthenticator,
        network: Network,
        stop: StopSocket,
    ) -> None:
        self.stop = stop
        self.counts: Counter[str] = Counter()
        self.watchers = 0
        """Number of connections to the state socket."""
        self._authenticator = authenticator
        with contextlib.ExitStack() as stack:
            self._control = stack.enter_context(context.socket(zmq.ROUTER))
            self._state = stack.enter_context(context.socket(zmq.PUB))
            authenticator.configure_socket(self._control, MAX_CONTROL_BYTES)
            authenticator.configure_socket(self._state, MAX_SUBSCRIPTION_BYTES)
            self._control.rcvhwm = MAX_WAITING_REQUESTS
            self._state.sndhwm = MAX_WAITING_STATES
            self._monitors = [
                stack.enter_context(socket.get_monitor_socket(WATCHED))
                for socket in (self._control, self._state)
            ]
            stack.callback(self._control.disable_monitor)
            stack.callback(self._state.disable_monitor)
            self.control = bind_socket(self._control, network.endpoint(network.control))
            self.state = bind_socket(self._state, network.endpoint(network.state))
            self._poller = zmq.Poller()
            self._poller.register(self._control, zmq.POLLIN)
            self._poller.register(stop.socket, zmq.POLLIN)
            self._stack = stack.pop_all()

    def wait(self, seconds: float) -> bool:
        """Wait at most `seconds` for a request; return whether there is one."""
        return bool(self._poller.poll(math.ceil(1e3 * seconds)))

    def receive_requests(self, most: int) -> Iterator[tuple[bytes, str, bytes]]:
        """Yield at most `most` requests: peer, user, message. The message is empty unless it was a single part."""
        for _ in range(most):
            taken = receive(self._control)
            if taken is None:
                return
            peer, user, data = taken
            yield peer, self._authenticator.name_user(user), data

    def reply(self, peer: bytes, data: bytes) -> bool:
        """Send to a peer; return False if it is gone. A peer that does not read misses the reply."""
        try:
            self._control.send_multipart((peer, data), zmq.NOBLOCK)
        except zmq.Again:
            self.counts["unread"] += 1
        except zmq.ZMQError as error:
            if error.errno != zmq.EHOSTUNREACH:
                raise
            return False
        return True

    def publish(self, topic: bytes, data: bytes) -> None:
        """Publish to the subscribers of a topic; slow subscribers miss some messages."""
        with contextlib.suppress(zmq.Again):
            self._state.send_multipart((topic, data), zmq.NOBLOCK)

    def take_refusals(self) -> list[tuple[str, str]]:
        """Return the connections refused since the last call: reason, detail."""
        seen: list[tuple[str, str]] = []
        for monitor in self._monitors:
            for _ in range(MAX_ROUND_EVENTS):
                try:
                    head, _ = monitor.recv_multipart(zmq.NOBLOCK)
                except zmq.Again:
                    break
                event, value = EVENT.unpack(head)
                came = (event == zmq.EVENT_ACCEPTED) - (event == zmq.EVENT_DISCONNECTED)
                if monitor is self._monitors[-1]:
                    self.watchers = max(0, self.watchers + came)
                if came:
                    self.counts["connections" if came > 0 else "disconnections"] += 1
                else:
                    why = REFUSED[event]
                    self.counts[f"refused_{why}"] += 1
                    seen.append((why, f"code {value}"))
        seen += [("key", key) for key in self._authenticator.take_unknown_keys()]
        return seen

    def close(self) -> None:
        """Close the sockets. May be called twice."""
        try:
            self._end_accepting()
        finally:
            self._stack.close()

    def _end_accepting(self) -> None:
        """Accept no more, and read all events of the monitors: libzmq waits while nobody reads them, even at the end.

        With a full table of files, it tries to accept without a pause, and each failure is an event.
        """
        events = zmq.Poller()
        if self._control.closed or any(monitor.closed for monitor in self._monitors):
            return
        for socket in self._control, self._state:
            with contextlib.suppress(zmq.ZMQError):
                socket.unbind(socket.get_string(zmq.LAST_ENDPOINT))
        for monitor in self._monitors:
            events.register(monitor, zmq.POLLIN)
        due = time.monotonic() + MAX_DRAIN_TIME
        while events.poll(QUIET_TIME) and time.monotonic() < due:
            self.take_refusals()
