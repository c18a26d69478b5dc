"""Client sessions: hello, renewals and goodbyes. Pure: callers pass the time, and replies are collected."""

from __future__ import annotations

import secrets
from typing import TYPE_CHECKING

from pacinian.serving.control.client_session import ClientSession
from pacinian.serving.control.output_lease import OutputLease
from pacinian.serving.ipc import messages
from pacinian.wire.control import Arm, Bye, Disarm, Hello, Renew, Reset, Stop
from pacinian.wire.protocol import MAJOR, MINOR, SESSION_BYTES
from pacinian.wire.replies import Error, Ok, Renewed, Welcome
from pacinian.wire.state import PRIVATE_SCENE_PREFIX

if TYPE_CHECKING:
    from pacinian.serving.settings import Settings
    from pacinian.wire.control import AnyControl
    from pacinian.wire.replies import Code, Reply

# Longest time from a cut connection to silence [s]: `auth.MAX_UNACKNOWLEDGED_TIME`, and a margin for the coarser TCP
# timer.
MAX_DEAD_LINK_TIME = 0.8


class ClientSessions:
    """Manages the sessions and the output lease.

    server: the server's name and version, sent to clients. changes: number of sessions that came or went. resets:
    number of stops and faults that were reset. replayed: number of times a session's key was used on another
    connection.
    """

    def __init__(self, settings: Settings, server: str = "pacinian") -> None:
        self.lease = OutputLease(settings.safety.takeover)
        self.changes = self.resets = self.replayed = 0
        self._settings, self._server = settings, server
        self._scenes = 0  # that have begun
        self._by_key: dict[bytes, ClientSession] = {}
        self._by_peer: dict[bytes, ClientSession] = {}

    @property
    def all(self) -> tuple[ClientSession, ...]:
        """All sessions."""
        return tuple(self._by_key.values())

    def list_sessions(self) -> messages.SessionTable:
        """Return the sessions that may send commands, and the owner's scene."""
        infos = (messages.SessionInfo(s.key, s.name, s.scene, s.user, s.number) for s in self.all)
        owner = self.lease.owner
        return messages.SessionTable(tuple(infos), owner.scene if owner is not None else "")

    def take_replies(self) -> list[tuple[bytes, Reply]]:
        """Return the collected replies, and clear them."""
        replies = self.lease.replies
        self.lease.replies = []
        return replies

    def pass_time(self, now: float) -> None:
        """End the leases and sessions that expire at `now` [s]."""
        self.lease.pass_time(now)
        timeout = self._settings.safety.session_timeout
        for session in [s for s in self.all if now - s.renewed > timeout]:
            problem = f"the session ended, because the client sent no renewal for {timeout:g} s"
            self._tell(session.peer, Error(code="session", message=problem, advice="say hello"))
            self._end_session(session, now)

    def handle(self, peer: bytes, user: str, message: AnyControl, now: float) -> None:
        """Handle a request of an authenticated peer at `now` [s], if it needs nothing but the sessions."""
        self.pass_time(now)
        match message:
            case Hello():
                self._begin_session(peer, user, message, now)
                return
            case Stop():
                self.lease.stop()  # confirmed once the guard is silent
                return
            case _:
                session = self.find(peer, message.session, message.id)
        if session is None:
            return
        match message:
            case Renew():
                self._renew(session, message, now)
                return
            case Arm():
                self.lease.arm(session, message.id, message.take, now, resume=message.resume)
                return
            case Disarm():
                if not self.lease.disarm(session, now):
                    self._tell_error(peer, message.id, "owner", "another client owns the output")
                    return
            case Reset():
                self.resets += self.lease.reset()
            case Bye():
                self._end_session(session, now, fade=True)
            case _:
                raise TypeError(type(message).__name__)
        self._tell(peer, Ok(id=message.id))

    def find(self, peer: bytes, key: bytes, request: int = 0) -> ClientSession | None:
        """Return the session with that key on this connection; otherwise None, with an error to the peer."""
        session = self._by_key.get(key)
        if session is not None and session.peer == peer:
            return session
        self.replayed += session is not None
        problem = "this connection has no session with that key"
        self._tell_error(peer, request, "session", problem, "say hello first")
        return None

    def end_peer(self, peer: bytes, now: float) -> None:
        """End the session of a lost connection. If it owns the output, this silences it."""
        if session := self._by_peer.get(peer):
            self._end_session(session, now)

    def end_all(self, problem: str, now: float, advice: str) -> None:
        """End all sessions, because their scenes are lost."""
        for session in self.all:
            error = Error(code="session", message=problem, advice=advice)
            self._tell(session.peer, error)
            self._end_session(session, now)

    def make_probe(self, session: ClientSession, now: float) -> Renewed:
        """Return the unsolicited message that reports the session's lease."""
        return self._make_renewed(session, 0, now)

    def _number_scene(self, name: str) -> int:
        """Return the number of a scene that has a session, or else a new one."""
        for session in self.all:
            if session.scene == name:
                return session.number
        self._scenes += 1
        return self._scenes

    def _begin_session(self, peer: bytes, user: str, message: Hello, now: float) -> None:
        major = message.protocol[0]
        if major != MAJOR:
            problem = f"the client speaks protocol {major}, the server {MAJOR}.{MINOR}"
            side = "server" if major > MAJOR else "client"
            self._tell_error(peer, message.id, "version", problem, f"update the {side}")
            return
        if message.scene.startswith(PRIVATE_SCENE_PREFIX):
            problem = f"a scene's name must not begin with {PRIVATE_SCENE_PREFIX!r}: this prefix is reserved"
            self._tell_error(peer, message.id, "argument", problem)
            return
        if old := self._by_peer.get(peer):
            self._end_session(old, now, fade=True)
        most = self._settings.clients.max_sessions
        if len(self._by_key) >= most:
            self._tell_error(
                peer, message.id, "limit", f"the server has its maximum of {most} clients"
            )
            return
        most_lease = self._settings.safety.lease
        scene = message.scene or f"{PRIVATE_SCENE_PREFIX}{secrets.token_hex(8)}"
        session = ClientSession(
            key=secrets.token_bytes(SESSION_BYTES),
            peer=peer,
            user=user,
            name=message.client,
            scene=scene,
            number=self._number_scene(scene),
            lease=most_lease if message.lease is None else min(message.lease, most_lease),
            renewed=now,
        )
        self._by_key[session.key] = self._by_peer[peer] = session
        self.changes += 1
        self._tell(
            peer,
            Welcome(
                id=message.id,
                session=session.key,
                protocol=(MAJOR, MINOR),
                server=self._server,
                time=now,
                scene=session.scene,
                lease=session.lease,
                link=MAX_DEAD_LINK_TIME,
                rate=self._settings.rate,
            ),
        )

    def _renew(self, session: ClientSession, message: Renew, now: float) -> None:
        if message.sequence <= session.sequence:
            problem = f"renewal {message.sequence} is not above {session.sequence}"
            self._tell_error(session.peer, message.id, "sequence", problem)
            return
        session.sequence, session.time, session.renewed = message.sequence, message.time, now
        sent = now - session.clock.compute_age(message.time, now)
        session.until = max(session.until, sent + session.lease)
        self.lease.renew(session, now)
        self._tell(session.peer, self._make_renewed(session, message.id, now))

    def _make_renewed(self, session: ClientSession, request: int, now: float) -> Renewed:
        owner = session is self.lease.owner
        return Renewed(
            id=request,
            sequence=session.sequence,
            time=session.time,
            server_time=now,
            until=session.until,
            owner=owner,
            armed=owner and self.lease.armed,
        )

    def _end_session(self, session: ClientSession, now: float, *, fade: bool = False) -> None:
        del self._by_key[session.key], self._by_peer[session.peer]
        self.changes += 1
        self.lease.end_session(session, now, fade=fade)

    def _tell(self, peer: bytes, reply: Reply) -> None:
        self.lease.replies.append((peer, reply))

    def _tell_error(
        self, peer: bytes, request: int, code: Code, problem: str, advice: str = ""
    ) -> None:
        self._tell(peer, Error(id=request, code=code, message=problem, advice=advice))
