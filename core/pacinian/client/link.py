"""A socket to the server, with a monitor of its connection. A lost connection is lost for good.

The socket does not reconnect, and accepts messages only while it is connected (IMMEDIATE), so nothing old can reach a
restarted server. ZMTP heartbeats detect a server that is stopped or cut off.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import zmq
from zmq.utils.monitor import recv_monitor_message

from pacinian.errors import ConnectionLost, WireError
from pacinian.wire.codec import decode_reply, id_of
from pacinian.wire.connection_file import START_SERVER
from pacinian.wire.protocol import HEARTBEAT_INTERVAL_MS, HEARTBEAT_TIMEOUT_MS, MAX_REPLY_BYTES
from pacinian.wire.replies import Error

if TYPE_CHECKING:
    from pacinian.wire.connection_file import Connection
    from pacinian.wire.replies import AnyReply
    from pacinian.wire.state import State

USER = b"pacinian"
DENIED = zmq.EVENT_HANDSHAKE_FAILED_AUTH
FOREIGN = zmq.EVENT_HANDSHAKE_FAILED_PROTOCOL | zmq.EVENT_HANDSHAKE_FAILED_NO_DETAIL
ENDS = zmq.EVENT_CLOSED | zmq.EVENT_DISCONNECTED | DENIED | FOREIGN
MAX_MESSAGES_AT_ONCE = 1000  # maximum number of messages read at once
OPTIONS = {
    zmq.LINGER: 0,
    zmq.SNDHWM: 16,
    zmq.RCVHWM: MAX_MESSAGES_AT_ONCE,
    zmq.MAXMSGSIZE: MAX_REPLY_BYTES,
    zmq.HANDSHAKE_IVL: 2000,  # [ms], as are all times below
    zmq.CONNECT_TIMEOUT: 2000,
}
NO_RECONNECT = {zmq.IMMEDIATE: 1, zmq.RECONNECT_IVL: -1}
HEARTBEAT = {
    zmq.HEARTBEAT_IVL: HEARTBEAT_INTERVAL_MS,
    # A little shorter than the timeout of a reply. Silence does not depend on it, but on the lease (decision 29).
    zmq.HEARTBEAT_TTL: HEARTBEAT_TIMEOUT_MS,
    zmq.HEARTBEAT_TIMEOUT: HEARTBEAT_TIMEOUT_MS,
    # No limit, in place of that in OPTIONS: libzmq 4.3 aborts (`!_io_error`) if a heartbeat is due behind a full queue.
    zmq.RCVHWM: 0,
}


def make_socket(
    context: zmq.Context[zmq.Socket[bytes]], kind: int, connection: Connection
) -> zmq.Socket[bytes]:
    """Make a socket of that kind, with the connection's token or keys. Raises ConnectionLost."""
    socket = context.socket(kind)
    for option, value in OPTIONS.items():
        socket.setsockopt(option, value)
    try:
        if connection.server_key:
            socket.curve_serverkey = connection.server_key.encode()
            socket.curve_publickey = connection.public_key.encode()
            socket.curve_secretkey = connection.secret_key.encode()
        else:
            socket.plain_username, socket.plain_password = USER, connection.token.encode()
    except (zmq.ZMQError, ValueError) as error:
        socket.close(0)
        raise ConnectionLost("the connection has neither a token nor client keys") from error
    return socket


def connect(socket: zmq.Socket[bytes], at: str) -> None:
    """Connect a socket to the address `at`. Raises ConnectionLost."""
    try:
        socket.ipv6 = "[" in at
        socket.connect(at)
    except zmq.ZMQError as error:
        raise ConnectionLost(f"cannot connect to {at}: {error}") from error


class Link:
    """A DEALER socket. Belongs to one thread. Close it before its context.

    heartbeat: False if the server may read slowly, because heartbeats queue behind unread messages. advice: what to do
    if nothing listens at `at`.
    """

    def __init__(
        self,
        context: zmq.Context[zmq.Socket[bytes]],
        connection: Connection,
        at: str,
        *,
        heartbeat: bool = True,
        advice: str = START_SERVER,
    ) -> None:
        self.at, self._advice = at, advice
        self.has_answered = False
        """Whether the server has answered on any connection.

        A connection that ends after that means the server has gone.
        """
        self.socket = make_socket(context, zmq.DEALER, connection)
        for option, value in {**NO_RECONNECT, **(HEARTBEAT if heartbeat else {})}.items():
            self.socket.setsockopt(option, value)
        self.monitor = self.socket.get_monitor_socket(ENDS)
        try:
            connect(self.socket, at)
        except ConnectionLost:
            self.close()
            raise

    def send(self, data: bytes, timeout: float = 0.0) -> bool:
        """Send within `timeout` [s]; return False if there was no room. Raises ConnectionLost."""
        try:
            self.socket.send(data, zmq.NOBLOCK)
        except zmq.Again:
            if timeout <= 0.0:
                return False
            monitors, sockets, _ = zmq.select([self.monitor], [self.socket], [], timeout)
            if monitors:
                raise self.read_loss() from None
            return bool(sockets) and self.send(data)
        return True

    def receive(self) -> list[AnyReply | State]:
        """Return all messages received. One that cannot be decoded becomes an `Error` with its id."""
        replies: list[AnyReply | State] = []
        while len(replies) < MAX_MESSAGES_AT_ONCE:
            try:
                data = self.socket.recv_multipart(zmq.NOBLOCK)[-1]
            except zmq.Again:
                break
            try:
                replies.append(decode_reply(data))
            except WireError as error:
                problem = f"the server's answer cannot be read: {error}"
                advice = "update the older of client and server"
                replies.append(
                    Error(id=id_of(data), code="malformed", message=problem, advice=advice)
                )
        return replies

    def read_loss(self) -> ConnectionLost:
        """Return why the connection was lost, after the monitor reported the loss."""
        event = recv_monitor_message(self.monitor)["event"]
        if event & DENIED:
            why = "refuses the token or key: it does not know it, or was started again since"
        elif self.has_answered:
            why = "has gone"  # even during a handshake
        elif event & FOREIGN:
            why = "is not a Pacinian server, requires other security (CURVE keys or a token), or is too busy"
        elif event & zmq.EVENT_CLOSED:
            why = f"does not answer: {self._advice}"
        else:
            why = "has gone"
        return ConnectionLost(f"the server at {self.at} {why}")

    def close(self) -> None:
        """Close the socket at once; unsent messages are dropped."""
        if not self.socket.closed:
            self.socket.disable_monitor()
            self.monitor.close(0)
            self.socket.close(0)


def milliseconds(seconds: float) -> int:
    """Return a timeout for `poll`, rounded up to avoid a busy loop."""
    return max(0, math.ceil(1e3 * seconds))
