"""Fake clients of sessions, on a manual clock and without sockets."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

from pacinian.serving.control.sessions import ClientSessions
from pacinian.serving.settings import ClientLimits, Safety, Settings
from pacinian.testing import ManualClock
from pacinian.wire.control import Arm, Hello, Renew
from pacinian.wire.protocol import MAJOR, MINOR
from pacinian.wire.replies import Error, Welcome

if TYPE_CHECKING:
    from pacinian.serving.ipc.messages import Permit

LEASE = 0.25


class FakeControl:
    """Sessions with a manual clock, and their clients."""

    def __init__(self, **safety: Any) -> None:
        self.clock = ManualClock(100.0)
        self.sessions = ClientSessions(
            Settings(safety=Safety(**safety), clients=ClientLimits(max_sessions=4))
        )

    @property
    def permit(self) -> Permit:
        return self.sessions.lease.permit

    @property
    def armed(self) -> int:
        return self.permit.armed

    def wait(self, seconds: float) -> list[tuple[bytes, Any]]:
        self.clock.advance(seconds)
        self.sessions.pass_time(self.clock.time)
        return self.sessions.take_replies()

    def ask(self, peer: bytes, message: Any) -> Any:
        """Return the last message to the peer."""
        return self.all(peer, message)[-1]

    def all(self, peer: bytes, message: Any) -> list[Any]:
        self.sessions.handle(peer, "user", message, self.clock.time)
        return [reply for to, reply in self.sessions.take_replies() if to == peer]

    def hello(self, peer: bytes = b"game", **more: Any) -> Game:
        reply = self.ask(peer, hello(client=peer.decode(), **more))
        assert isinstance(reply, Welcome)
        return Game(self, peer, reply)


class Game:
    """One client."""

    def __init__(self, desk: FakeControl, peer: bytes, welcome: Welcome) -> None:
        self.desk, self.peer, self.welcome = desk, peer, welcome
        self.count = itertools.count(1)
        self.ahead = 5000.0  # offset of its clock [s]

    def renew(self, late: float = 0.0) -> Any:
        time = self.desk.clock.time + self.ahead - late
        return self.ask(Renew, sequence=next(self.count), time=time)

    def ask(self, kind: type[Any], **fields: Any) -> Any:
        return self.desk.ask(self.peer, kind(session=self.welcome.session, id=7, **fields))

    def arm(self, take: bool = False, *, resume: bool = False) -> Any:
        return self.ask(Arm, take=take, resume=resume)

    def take(self) -> None:
        """Request the output with request 5. There is no reply yet."""
        message = Arm(session=self.welcome.session, id=5, take=True)
        self.desk.sessions.handle(self.peer, "user", message, self.desk.clock.time)


def armed(*, resume: bool = False) -> tuple[FakeControl, Game]:
    """Return a client that owns the output."""
    desk = FakeControl()
    game = desk.hello()
    game.arm(resume=resume)
    return desk, game


def hello(**fields: Any) -> Hello:
    return Hello(**{"protocol": (MAJOR, MINOR), "client": "game", **fields})


def code(reply: Any) -> str:
    assert isinstance(reply, Error), reply
    return reply.code
