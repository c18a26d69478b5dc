"""One session with the server, from hello to bye. A lost session is never resumed."""

from __future__ import annotations

import importlib.metadata
import itertools
import math
from collections import deque
from functools import cache
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import zmq
from msgspec.structs import replace

from pacinian.client.link import Link, connect, make_socket, milliseconds
from pacinian.client.outbox import Outbox
from pacinian.client.server_clock import ServerClock
from pacinian.client.state_subscription import read_newest
from pacinian.errors import ConnectionLost, PacinianError, Refused, WireError
from pacinian.wire.codec import encode
from pacinian.wire.connection_file import START_SERVER
from pacinian.wire.control import Arm, Bye, Hello, Renew, Request, Stop
from pacinian.wire.protocol import MAJOR, MINOR
from pacinian.wire.replies import Error, Ok, Renewed, Welcome
from pacinian.wire.state import STATE, State

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.wire.commands import AnyCommand
    from pacinian.wire.connection_file import Connection
    from pacinian.wire.replies import AnyReply

R = TypeVar("R", bound="AnyReply | State")

RENEWAL_SHARE = 0.125  # interval between renewals, as a fraction of the lease
BYE_TIMEOUT = 0.2  # time limit for a bye [s]
MAX_ERRORS = 100  # number of errors kept of commands that did not wait
# What to do if nothing listens at the command port: while the bus restarts, only the control port answers.
RETRY_COMMANDS = f"{START_SERVER} If it is, it restarts its bus process: try again"
# Codes of unsolicited errors that end an owner's sound.
ENDED = "expired", "owner", "fault", "stopped"


class ServerSession:
    """A session. lost: why it ended, or "". armed, owner: as the server last reported.

    errors: of requests and commands that did not wait, newest last. notices: why the sound ended, not raised yet.
    Raises ConnectionLost, Refused.
    """

    def __init__(
        self,
        connection: Connection,
        clock: Callable[[], float],
        timeout: float,
        ids: itertools.count[int],
        **hello: Any,
    ) -> None:
        self.clock, self.timeout, self.server_clock = clock, timeout, ServerClock()
        self.lost, self.armed, self.owner = "", False, False
        self._resumes = False  # the game's next renewal would let the output sound again
        self.errors, self.notices = (
            deque[Refused](maxlen=MAX_ERRORS),
            deque[Refused](maxlen=MAX_ERRORS),
        )
        self.outbox = Outbox()
        self._come: deque[AnyReply | State] = deque()
        self._due = math.inf  # when the session next renews itself [s]
        self._ended = ""  # why a link has ended; raised after all earlier messages are handled
        self._connection, self._ids, self._sequence = connection, ids, itertools.count(1)
        self._context: zmq.Context[zmq.Socket[bytes]] = zmq.Context()
        self._links: list[Link] = []
        self._states: zmq.Socket[bytes] | None = None
        self._poller = zmq.Poller()
        try:
            self._control = self._open_link(connection.control)
            self._command = self._open_link(
                connection.command, heartbeat=False, advice=RETRY_COMMANDS
            )
            self.welcome = self._hello(hello)
            self._due = self.clock() + self.renewal_interval
            for link in self._links:
                link.has_answered = True
        except BaseException:
            self.close()
            raise

    def _open_link(self, at: str, **options: Any) -> Link:
        """Open a link to the address `at`, and watch it. options: of `Link`. Raises ConnectionLost."""
        link = Link(self._context, self._connection, at, **options)
        self._links.append(link)
        self._poller.register(link.socket, zmq.POLLIN)
        self._poller.register(link.monitor, zmq.POLLIN)
        return link

    def _hello(self, given: dict[str, Any]) -> Welcome:
        sent = self.clock()
        welcome = self._request(
            self._control,
            Hello(protocol=(MAJOR, MINOR), version=read_version(), **given),
            Welcome,
            self.timeout,
        )
        self.server_clock.add_mark(sent, self.clock(), welcome.time)
        if (theirs := welcome.protocol[0]) != MAJOR:
            older = "server" if theirs < MAJOR else "client"
            problem = f"the server speaks protocol {theirs}, this client {MAJOR}"
            raise Refused("version", problem, advice=f"update the {older}")
        return welcome

    @property
    def renewal_interval(self) -> float:
        """Interval between two renewals [s]."""
        return RENEWAL_SHARE * self.welcome.lease

    def request(self, kind: type[Request], answer: type[R], **fields: Any) -> R:
        """Send a request to the control socket; return the reply."""
        request = kind(session=self.welcome.session, **fields)
        return self._request(self._control, request, answer, self.timeout)

    def request_slow(self, request: type[Request], timeout: float, **fields: Any) -> None:
        """Send a request that may take up to `timeout` [s]. Meanwhile, renew the lease if armed."""
        message = request(session=self.welcome.session, **fields)
        self._request(self._control, message, Ok, timeout, lease=True)

    def arm(self, take: bool, resume: bool) -> None:
        """Arm. Discards notices received before the server's Ok."""
        self.request(Arm, Ok, take=take, resume=resume)
        self.notices.clear()
        self.armed = self.owner = True
        self._resumes = resume
        self.handle_messages()

    def stop(self) -> None:
        """Send an emergency stop, which needs no session."""
        self._request(self._control, Stop(), Ok, self.timeout)

    def request_nowait(self, kind: type[Request], **fields: Any) -> int:
        """Send a request without waiting; return its number. Its error, if any, goes to `errors` with that number."""
        self.handle_messages()
        request = kind(session=self.welcome.session, id=self._number(), **fields)
        if not self._send(self._control, encode(request)):
            self.lose("the server takes no more requests")
        return request.id

    def send_command(self, command: AnyCommand, answer: type[R]) -> R:
        """Send a command; return the reply."""
        self.handle_messages()
        if not self._flush(self.timeout):
            self.lose(f"no room for a command within {self.timeout:g} s: the server hangs")
        sequence = next(self._sequence)
        return self._request(
            self._command, replace(command, sequence=sequence), answer, self.timeout
        )

    def send_nowait(self, command: AnyCommand) -> None:
        """Send a command without waiting. While there is no room, it waits, and replaces what it makes useless."""
        self.handle_messages()
        if self._flush() and self._post(command):
            return
        encode(command)  # raises now if it never can be sent
        self.outbox.add(command)

    def renew(self) -> None:
        """Renew the lease without waiting. Raises, once, each reason why the output was disarmed."""
        try:
            self.handle_messages()
        except ConnectionLost:
            if self.notices:  # it arrived before the loss
                raise self.notices.popleft() from None
            raise
        self._renew()
        self._flush()
        if self.notices:
            raise self.notices.popleft()

    def handle_messages(self, wait: float = 0.0) -> None:
        """Handle what has arrived; wait at most `wait` [s] for the first message."""
        self._receive(wait)
        while self._come:
            self._note(self._come.popleft())
        self._raise_if_lost()

    def newest(self, timeout: float) -> State | None:
        """Return the newest published state; wait at most `timeout` [s] for it. None if none arrived."""
        end = self.clock() + timeout
        self.handle_messages()
        if self._states is None:
            self._states = make_socket(self._context, zmq.SUB, self._connection)
            connect(self._states, self._connection.state)
            self._states.subscribe(STATE)
        watched = zmq.Poller()
        watched.register(self._states, zmq.POLLIN)
        for link in self._links:
            watched.register(link.socket, zmq.POLLIN)
            watched.register(link.monitor, zmq.POLLIN)
        while True:
            found = read_newest(
                self._states, lambda state: self.server_clock.age(state.time, self.clock())
            )
            left = end - self.clock()
            if found or left <= 0.0:
                return found
            if (
                not watched.poll(milliseconds(min(left, self.renewal_interval)))
                and left <= self.renewal_interval
            ):
                return None
            self.handle_messages()

    def close(self) -> None:
        """Say bye if the server listens, and close the session."""
        if not self.lost and hasattr(self, "welcome"):
            self._due = math.inf
            try:
                bye = Bye(session=self.welcome.session)
                self._request(self._control, bye, Ok, min(self.timeout, BYE_TIMEOUT))
            except PacinianError:
                pass
        self.lost = self.lost or "the session was closed"
        self.armed = self.owner = False
        for link in self._links:
            link.close()
        if self._states is not None:
            self._states.close(0)
        self._context.term()

    def _request(
        self, link: Link, message: Any, answer: type[R], timeout: float, *, lease: bool = False
    ) -> R:
        number = self._number()
        what = type(message).__name__.lower()
        data = encode(replace(message, id=number))
        self.handle_messages()
        sent = self.clock()
        found = (
            self._wait_for_reply(number, sent + timeout, lease)
            if self._send(link, data, timeout)
            else None
        )
        if found is None:
            self._raise_if_lost()
            self.lose(f"no answer to `{what}` within {timeout:g} s: the server hangs")
        self.server_clock.add_round_trip(sent, self.clock())
        if isinstance(found, Error):
            if found.code == "session":
                self.lose(found.message)
            raise _refuse(found)
        if not isinstance(found, answer):
            raise WireError(f"`{what}` was answered by a {type(found).__name__}")
        return found

    def _wait_for_reply(self, number: int, end: float, lease: bool) -> AnyReply | State | None:
        """Return the reply with that number, and note the others. None if it does not arrive by `end` [s]."""
        while (left := end - self.clock()) > 0.0:
            step = left
            if lease or self._renews_itself:
                step = min(left, max(self._due - self.clock(), 0.0))
            if not self._receive(step, lease) and step == left:
                break
            while self._come:
                if (reply := self._come.popleft()).id == number:
                    return reply
                self._note(reply)
        return None

    def _renew(self) -> None:
        renew = Renew(
            session=self.welcome.session,
            id=self._number(),
            sequence=next(self._sequence),
            time=self.clock(),
        )
        self._due = self.clock() + self.renewal_interval
        self._send(self._control, encode(renew))

    def _receive(self, wait: float, lease: bool = False) -> bool:
        """Return whether `_come` holds messages; wait at most `wait` [s] for them.

        The server forgets a client that sends nothing. This therefore also renews the session, if the renewal cannot
        let the output sound. Only two things keep an armed output sounding, or let it sound again after its lease ran
        out: the game's own `renew`, or `lease`, by which the caller has asked for renewals.
        """
        if self.lost:
            raise ConnectionLost(self.lost)
        self._raise_if_lost()
        ready = dict(self._poller.poll(0 if self._come else milliseconds(wait)))
        for link in self._links:
            if link.socket in ready:
                self._come += link.receive()
        for link in self._links:
            if link.monitor in ready and not self._ended:
                self._ended = str(link.read_loss())
        self._raise_if_lost()
        if not self._ended and (lease or self._renews_itself) and self.clock() >= self._due:
            self._renew()
        return bool(self._come)

    @property
    def _renews_itself(self) -> bool:
        """Whether the session may renew itself, because such a renewal cannot let the output sound."""
        return not self.armed and not (self.owner and self._resumes)

    def _raise_if_lost(self) -> None:
        """Raise ConnectionLost if a link has ended and no earlier message is left."""
        if self._ended and not self._come:
            self.lose(self._ended)

    def _note(self, reply: AnyReply | State) -> None:
        """Note an unsolicited message, or the reply to a call that did not wait."""
        if isinstance(reply, Renewed):
            self.armed, self.owner = reply.armed, reply.owner
            if reply.id:
                self.server_clock.add_mark(reply.time, self.clock(), reply.server_time)
        elif isinstance(reply, Error):
            if reply.code == "session":
                self.lose(reply.message)
            elif reply.id == 0 and reply.code in ENDED:
                self.armed = self._resumes = False
                self.notices.append(_refuse(reply))
            else:
                self.errors.append(_refuse(reply))

    def _flush(self, timeout: float = 0.0) -> bool:
        """Send the outbox, within `timeout` [s] in all; return whether it is empty."""
        now = self.clock()
        return not self.outbox.waiting or self.outbox.flush(
            now, lambda command: self._post(command, now + timeout - self.clock())
        )

    def _post(self, command: AnyCommand, timeout: float = 0.0) -> bool:
        data = encode(replace(command, sequence=next(self._sequence)))
        return self._send(self._command, data, timeout)

    def _send(self, link: Link, data: bytes, timeout: float = 0.0) -> bool:
        try:
            return link.send(data, timeout)
        except ConnectionLost as error:
            self.lose(str(error))

    def _number(self) -> int:
        return next(self._ids) % 0xFFFFFFFF + 1

    def lose(self, why: str) -> NoReturn:
        """Close the session, and raise ConnectionLost."""
        self.lost = why
        self.close()
        begun = "; nothing of this session goes on" if hasattr(self, "welcome") else ""
        raise ConnectionLost(why + begun)


@cache
def read_version() -> str:
    """Return the installed version of Pacinian; "" if it is not installed."""
    try:
        return importlib.metadata.version("pacinian")
    except importlib.metadata.PackageNotFoundError:
        return ""


def _refuse(error: Error) -> Refused:
    advice = error.advice
    if error.code == "version" and not advice:
        advice = f"update the older of the two: this client speaks {MAJOR}.{MINOR}"
    return Refused(error.code, error.message, error.path, advice, error.id)
