"""A socket to the server and a monitor of its connection: lost once, it is lost for good.

It does not connect again by itself, and takes a message only while it is connected (IMMEDIATE), so that nothing
old can reach a server that was started anew. Heartbeats (ZMTP's) tell of a server that is stopped or cut off.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import zmq
from zmq.utils.monitor import recv_monitor_message

from pacinian.errors import ConnectionLost, WireError
from pacinian.wire.codec import decode_reply, id_of
from pacinian.wire.protocol import MAX_REPLY_BYTES
from pacinian.wire.replies import Error

if TYPE_CHECKING:
    from pacinian.wire.connection import Connection
    from pacinian.wire.replies import AnyReply
    from pacinian.wire.state import State

USER = b"pacinian"
DENIED = zmq.EVENT_HANDSHAKE_FAILED_AUTH
FOREIGN = zmq.EVENT_HANDSHAKE_FAILED_PROTOCOL | zmq.EVENT_HANDSHAKE_FAILED_NO_DETAIL
ENDS = zmq.EVENT_CLOSED | zmq.EVENT_DISCONNECTED | DENIED | FOREIGN
MAX_MESSAGES_AT_ONCE = 1000  # messages that are read at once
OPTIONS = {
    zmq.LINGER: 0,
    zmq.SNDHWM: 16,
    zmq.RCVHWM: MAX_MESSAGES_AT_ONCE,
    zmq.MAXMSGSIZE: MAX_REPLY_BYTES,
    zmq.HANDSHAKE_IVL: 2000,  # [ms], as all below
    zmq.CONNECT_TIMEOUT: 2000,
}
ONCE = {zmq.IMMEDIATE: 1, zmq.RECONNECT_IVL: -1}
# no high-water mark: one that is reached while a heartbeat is due makes libzmq 4.3 end the process (`!_io_error`)
# Little sooner than an answer is given up: what silence waits for is the lease (decision 29).
HEARTBEAT = {
    zmq.HEARTBEAT_IVL: 50,
    zmq.HEARTBEAT_TTL: 1500,
    zmq.HEARTBEAT_TIMEOUT: 1500,
    zmq.RCVHWM: 0,
}


def make_socket(
    context: zmq.Context[zmq.Socket[bytes]], kind: int, connection: Connection
) -> zmq.Socket[bytes]:
    """A socket of that kind, with the connection's token or keys. Raises ConnectionLost."""
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
        raise ConnectionLost("the connection has no token, or no keys of a client") from error
    return socket


def connect(socket: zmq.Socket[bytes], at: str) -> None:
    """Connect it to the address `at`. Raises ConnectionLost."""
    try:
        socket.ipv6 = "[" in at
        socket.connect(at)
    except zmq.ZMQError as error:
        raise ConnectionLost(f"cannot connect to {at}: {error}") from error


class Link:
    """A DEALER socket. Belongs to one thread; to be closed before its context is.

    heartbeat: not where the server may be slow to read, as its heartbeats wait behind what it has not read.
    """

    def __init__(
        self,
        context: zmq.Context[zmq.Socket[bytes]],
        connection: Connection,
        at: str,
        *,
        heartbeat: bool = True,
    ) -> None:
        self.at = at
        self.known = False
        """Whether its server has answered, on this connection or another: what ends after that has gone."""
        self.socket = make_socket(context, zmq.DEALER, connection)
        for option, value in {**ONCE, **(HEARTBEAT if heartbeat else {})}.items():
            self.socket.setsockopt(option, value)
        self.monitor = self.socket.get_monitor_socket(ENDS)
        try:
            connect(self.socket, at)
        except ConnectionLost:
            self.close()
            raise

    def send(self, data: bytes, timeout: float = 0.0) -> bool:
        """Send, within `timeout` [s]; False if there was no room. Raises ConnectionLost."""
        try:
            self.socket.send(data, zmq.NOBLOCK)
        except zmq.Again:
            if timeout <= 0.0:
                return False
            monitors, sockets, _ = zmq.select([self.monitor], [self.socket], [], timeout)
            if monitors:
                raise self.lost() from None
            return bool(sockets) and self.send(data)
        return True

    def receive(self) -> list[AnyReply | State]:
        """All that has come. What cannot be read is an `Error` with its id."""
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

    def lost(self) -> ConnectionLost:
        """Why, after the monitor told that it is."""
        event = recv_monitor_message(self.monitor)["event"]
        if event & DENIED:
            why = "refuses the token or key: another server may have been started since"
        elif self.known:
            why = "has gone"  # also in the middle of a handshake
        elif event & FOREIGN:
            why = "is no Pacinian server, wants other security (CURVE keys or a token), or is too busy"
        elif event & zmq.EVENT_CLOSED:
            why = "does not answer: is `pacinian serve` running?"
        else:
            why = "has gone"
        return ConnectionLost(f"the server at {self.at} {why}")

    def close(self) -> None:
        """Close it at once; what was not sent is not sent any more."""
        if not self.socket.closed:
            self.socket.disable_monitor()
            self.monitor.close(0)
            self.socket.close(0)


def milliseconds(seconds: float) -> int:
    """For `poll`, rounded up so that none is a busy loop."""
    return max(0, math.ceil(1e3 * seconds))
