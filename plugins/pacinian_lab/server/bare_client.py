"""A client on bare sockets: it uses only the wire format, so that a benchmark measures the server."""

from __future__ import annotations

import time
from collections import Counter
from typing import TYPE_CHECKING, Any

import zmq

from pacinian.errors import Refused, ServerError
from pacinian.wire import codec
from pacinian.wire.control import Bye, Hello, Renew
from pacinian.wire.protocol import MAJOR, MINOR
from pacinian.wire.replies import Error, Renewed, Welcome
from pacinian.wire.state import STATE, State

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from pacinian.wire.commands import Command
    from pacinian.wire.connection_file import Connection
    from pacinian.wire.control import Request

LIMIT = 5.0  # [s] longest wait for a reply
USER = b"pacinian"
MAX_WAITING = 100  # messages that may wait in a socket, as in `pacinian.Client`


def socket(
    context: zmq.Context[zmq.Socket[bytes]], kind: int, address: str, token: str
) -> zmq.Socket[bytes]:
    """Return a connected socket that authenticates with the token."""
    made = context.socket(kind)
    made.linger = 0
    made.plain_username, made.plain_password = USER, token.encode()
    made.immediate = 1
    made.sndhwm = MAX_WAITING
    made.connect(address)
    return made


class BareClient:
    """A session. name: of the client. scene: the shared scene. key: of the session. Raises ServerError, Refused.

    notices: counts of unsolicited messages and errors from the server, by code.
    """

    def __init__(
        self, context: zmq.Context[zmq.Socket[bytes]], connection: Connection, name: str, scene: str
    ) -> None:
        self.notices = Counter[str]()
        self._sequence = self._id = 0
        self._control = socket(context, zmq.DEALER, connection.control, connection.token)
        self._commands = socket(context, zmq.DEALER, connection.command, connection.token)
        try:
            hello = Hello(id=self._next(), protocol=(MAJOR, MINOR), client=name, scene=scene)
            welcome = self._exchange(self._control, hello, hello.id)
            if not isinstance(welcome, Welcome):
                raise ServerError(f"welcomed by {type(welcome).__name__}")
        except BaseException:
            self._close_sockets()
            raise
        self.key = welcome.session

    def request(self, kind: type[Request], **fields: Any) -> Any:
        """Send a request on the control socket and return the reply. Raises Refused, ServerError."""
        message = kind(session=self.key, id=self._next(), **fields)
        return self._exchange(self._control, message, message.id)

    def ask(self, kind: type[Command], **fields: Any) -> Any:
        """Send a command and return the reply. Repeats the command while the server is too busy to take it in time.

        Raises Refused, ServerError.
        """
        due = time.perf_counter() + LIMIT
        while True:
            message = self._command(kind, id=self._next(), **fields)
            try:
                return self._exchange(self._commands, message, message.id)
            except Refused as error:
                if error.code not in ("busy", "stale") or time.perf_counter() > due:
                    raise

    def send(self, kind: type[Command], **fields: Any) -> bool:
        """Send a command without a reply. Returns False if the socket had no room."""
        try:
            self._commands.send(codec.encode(self._command(kind, **fields)), zmq.NOBLOCK)
        except zmq.Again:
            return False
        return True

    def renew(self) -> float:
        """Renew the lease and return the round trip [s]. Raises ServerError."""
        begin = time.perf_counter()
        self._sequence += 1
        self.request(Renew, sequence=self._sequence, time=begin)
        return time.perf_counter() - begin

    def renew_nowait(self) -> None:
        """Renew without waiting, and count the messages received."""
        self._sequence += 1
        message = Renew(session=self.key, sequence=self._sequence, time=time.perf_counter())
        try:
            self._control.send(codec.encode(message), zmq.NOBLOCK)
        except zmq.Again:
            self.notices["no room"] += 1
        for one in (self._control, self._commands):
            self._drain(one)

    @property
    def sequence(self) -> int:
        """Sequence number of the last message."""
        return self._sequence

    def _command(self, kind: type[Command], **fields: Any) -> Command:
        self._sequence += 1
        fields.setdefault("time", time.perf_counter())
        return kind(session=self.key, sequence=self._sequence, **fields)

    def _next(self) -> int:
        self._id += 1
        return self._id

    def _exchange(self, one: zmq.Socket[bytes], message: Any, number: int) -> Any:
        due = time.perf_counter() + LIMIT
        one.sndtimeo = int(1e3 * LIMIT)
        try:
            one.send(codec.encode(message))
        except zmq.Again:
            raise ServerError(f"cannot be reached within {LIMIT:g} s") from None
        while one.poll(max(0, int(1e3 * (due - time.perf_counter())))):
            reply = codec.decode_reply(one.recv())
            if reply.id != number:
                self._note(reply)
                continue
            if isinstance(reply, Error):
                raise Refused(reply.code, reply.message, reply.path, reply.advice)
            return reply
        raise ServerError(f"no answer to {type(message).__name__} within {LIMIT:g} s")

    def _drain(self, one: zmq.Socket[bytes]) -> None:
        while True:
            try:
                self._note(codec.decode_reply(one.recv(zmq.NOBLOCK)))
            except zmq.Again:
                return

    def _note(self, reply: Any) -> None:
        if not isinstance(reply, Renewed):
            self.notices[reply.code if isinstance(reply, Error) else type(reply).__name__] += 1

    def close(self, *, bye: bool = True) -> None:
        """Leave the session and close the sockets; without `bye`, only close the sockets."""
        try:
            if bye:
                self.request(Bye)
        except (ServerError, zmq.ZMQError):
            self.notices["no farewell"] += 1
        finally:
            self._close_sockets()

    def _close_sockets(self) -> None:
        self._control.close(0)
        self._commands.close(0)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close(bye=error is None)


class States:
    """A subscription to the states that the server publishes. It skips none."""

    def __init__(self, context: zmq.Context[zmq.Socket[bytes]], connection: Connection) -> None:
        self._socket = socket(context, zmq.SUB, connection.state, connection.token)
        self._socket.subscribe(STATE)

    def new(self) -> list[State]:
        """Return all states received since the last call."""
        found = list[State]()
        while self._socket.poll(0):
            state = codec.decode_state(self._socket.recv_multipart()[-1])
            if isinstance(state, State):
                found.append(state)
        return found

    def close(self) -> None:
        """Close the subscription."""
        self._socket.close(0)
