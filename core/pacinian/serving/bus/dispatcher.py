"""The command dispatcher: authorises, decodes, carries out and answers each message. Pure: callers pass the time."""

from __future__ import annotations

import math
from contextlib import contextmanager
from typing import TYPE_CHECKING

from pacinian.errors import WireError
from pacinian.serving.bus.change_batcher import ChangeBatcher
from pacinian.serving.bus.coalescing import coalesce
from pacinian.serving.bus.conversion_queue import Converter
from pacinian.serving.bus.field_queries import FieldQueries
from pacinian.serving.bus.message_admission import BusSession
from pacinian.serving.bus.scene_snapshot import make_snapshot
from pacinian.serving.bus.shared_scene import CommandRejected, SharedScene
from pacinian.serving.bus.stored_object import make_error_reply
from pacinian.serving.ipc.messages import BusStatus
from pacinian.serving.ipc.rate_limit import PeerRateLimiter
from pacinian.wire.codec import decode_command, id_of
from pacinian.wire.commands import (
    Clear,
    Envelopes,
    Field,
    Hands,
    Move,
    Put,
    Quiet,
    Remove,
    Show,
)
from pacinian.wire.replies import Error, Ok

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from concurrent.futures import Executor

    from pacinian.acoustics.array import Array
    from pacinian.serving.bus.coalescing import Message
    from pacinian.serving.ipc.logs import RateLimitedLog
    from pacinian.serving.ipc.messages import SessionInfo, SessionTable
    from pacinian.serving.settings import Settings
    from pacinian.types import Gains
    from pacinian.wire.commands import AnyCommand
    from pacinian.wire.replies import Code, Reply

PEERS_PER_CLIENT = 4  # number of connections whose rates are remembered, for each permitted client


class CommandDispatcher:
    """Holds all sessions, scenes and queries. replies: to send, each with its connection.

    run: random, identifies this run of the bus. reread: reads the sessions again. emitted: returns the gains that are
    emitted now, and their time. executor: converts objects that take long.
    """

    def __init__(
        self,
        settings: Settings,
        array: Array,
        run: int,
        reread: Callable[[], SessionTable | None],
        emitted: Callable[[], tuple[Gains, float]],
        log: RateLimitedLog,
        executor: Executor,
    ) -> None:
        self.batcher = ChangeBatcher(run)
        self.queries = FieldQueries(array, settings.medium.make())
        self.converter = Converter(settings.safety.pressure, executor)
        self.replies: list[tuple[bytes, Reply]] = []
        self.scenes: dict[str, SharedScene] = {}
        self.clients: dict[bytes, BusSession] = {}
        self.received = self.refused = 0
        self._settings = settings
        self._reread, self._emitted, self._log = reread, emitted, log
        self._superseded = 0  # in scenes that have ended
        self._peers = PeerRateLimiter(
            settings.clients.max_rate, PEERS_PER_CLIENT * settings.clients.max_sessions
        )
        self._numbers = 0

    def update_sessions(self, sessions: SessionTable) -> None:
        """Update the sessions that may send commands, and the rendered scene.

        Without an owner, the last scene stays.
        """
        here = {info.key: info for info in sessions.sessions}
        for key in [key for key in self.clients if key not in here]:
            self._leave(self.clients.pop(key))
        for key in here.keys() - self.clients.keys():
            self._join(here[key])
        if sessions.owned in self.scenes:
            self.batcher.render(self.scenes[sessions.owned])

    def handle_messages(self, messages: list[Message]) -> None:
        """Handle messages of authenticated connections, in order of arrival."""
        self.received += len(messages)
        kept, replaced = coalesce([one for one in messages if self._allows(one)])
        for message in kept:
            with self.catch_faults("message"):
                self._handle_message(*message)
        for key, count in replaced.items():
            if (client := self.clients.get(key)) is not None:
                client.count_superseded(count)

    @contextmanager
    def catch_faults(self, what: str) -> Generator[None]:
        """Log and count any exception of the block, so that the bus continues."""
        try:
            yield
        except Exception:
            self.refused += 1
            self._log.exception(f"fault: {what}")

    def _allows(self, message: Message) -> bool:
        allowed = self._peers.allows(message.peer, message.time)
        if not allowed:
            problem = f"the client sends more than {self._settings.clients.max_rate:g} messages a second: slow down"
            self._refuse(message.peer, message.data, "busy", problem, message.time)
        return allowed

    def _handle_message(self, peer: bytes, user: str, data: bytes, now: float) -> None:
        try:
            command = decode_command(data)
        except WireError as error:
            self._refuse(peer, data, "malformed", error.problem, now, error.path)
            return
        client = self._find_client(command.session)
        if client is None:
            problem = "no session has that key: say hello first"
            self._refuse(peer, data, "session", problem, now, "$.session")
        elif not client.claim(peer, user):
            self._log.warning("replayed: a session's key was used on another connection", user=user)
            problem = "the session belongs to another connection: say hello on this connection"
            self._refuse(peer, data, "session", problem, now, "$.session")
        else:
            self._answer(client, self._carry_out(client, command, now, len(data)), now)

    @property
    def due(self) -> float:
        """When the next object may expire [s]; infinite if none will."""
        return min((scene.due for scene in self.scenes.values()), default=math.inf)

    def run_round(self, now: float) -> None:
        """Do the timed work, and report errors found while batching."""
        for scene in self.scenes.values():
            with self.catch_faults("expiry"):
                scene.expire(now)
        errors = self.batcher.errors[:]
        self.batcher.errors.clear()
        for client, error in errors:
            self._answer(client, error, now)
        with self.catch_faults("conversion"):
            for client, reply in self.converter.run_round():
                self._answer(client, reply, now)
        with self.catch_faults("field"):
            answer = self.queries.run_chunk()
            if answer is not None:
                self._answer(*answer, now)

    def make_status(self, now: float, port: int) -> BusStatus:
        """Return the status of the bus."""
        return BusStatus(
            heartbeat=now,
            clients={
                key.hex(): (c.objects, c.commands, c.errors, c.dropped, c.age)
                for key, c in self.clients.items()
            },
            received=self.received,
            superseded=self._superseded + sum(r.pending.superseded for r in self.scenes.values()),
            refused=self.refused,
            waiting=len(self.batcher.scene.pending) if self.batcher.scene is not None else 0,
            port=port,
        )

    def _find_client(self, key: bytes) -> BusSession | None:
        client = self.clients.get(key)
        if client is None and (sessions := self._reread()) is not None:
            self.update_sessions(sessions)
            client = self.clients.get(key)
        return client

    def _join(self, info: SessionInfo) -> None:
        self._numbers += 1
        client = self.clients[info.key] = BusSession(info, self._numbers)
        scene = self.scenes.get(info.scene)
        if scene is None:
            scene = self.scenes[info.scene] = SharedScene(
                self._settings, self.converter, info.scene, info.number
            )
        scene.clients.add(client)

    def _leave(self, client: BusSession) -> None:
        scene = self.scenes[client.info.scene]
        scene.clear(client)
        scene.clients.discard(client)
        self.queries.forget(client)
        if not scene.clients:
            self._superseded += scene.pending.superseded
            del self.scenes[client.info.scene]

    def _carry_out(
        self, client: BusSession, command: AnyCommand, now: float, size: int
    ) -> Reply | None:
        error = client.admit(command, now)
        if error is not None:
            return error
        try:
            if isinstance(command, Field):
                return self.queries.begin(client, command, self._emitted())
            if isinstance(command, Show):
                return make_snapshot(self.batcher.scene, command)
            scene = self.scenes[client.info.scene]
            if not carry_out(scene, client, command, now - client.age, now, size):
                return None
        except CommandRejected as refusal:
            message = f"{refusal}"[:1000]
            return Error(id=command.id, code=refusal.code, message=message, path=refusal.path[:200])
        except WireError as wrong:
            return make_error_reply(wrong, command.id)
        except Exception:  # a bug here must not stop other commands
            self._log.exception("fault: command")
            return Error(id=command.id, code="fault", message="the server failed at this command")
        return Ok(id=command.id) if command.id else None

    def _answer(self, client: BusSession, reply: Reply | None, now: float) -> None:
        if reply is None or (isinstance(reply, Error) and not client.should_report(reply, now)):
            return
        self.replies.append((client.peer, reply))

    def _refuse(
        self, peer: bytes, data: bytes, code: Code, problem: str, now: float, path: str = ""
    ) -> None:
        """Refuse a message that was not matched to a client. Error replies are rate-limited."""
        self.refused += 1
        if self._peers.should_report(peer, now):
            error = Error(id=id_of(data), code=code, message=problem[:1000], path=path[:200])
            self.replies.append((peer, error))


def carry_out(
    scene: SharedScene, client: BusSession, command: AnyCommand, seen: float, now: float, size: int
) -> bool:
    """Change a scene by a client's command, sent at `seen` and received at `now` [s] by the server's clock.

    size: of the message [bytes]. Returns whether it is done; otherwise, the converter replies later.
    Raises CommandRejected, WireError.
    """
    if isinstance(command, Put):
        return scene.put(client, command, seen, size)
    if isinstance(command, Envelopes):
        return scene.set_envelope(client, command)
    if isinstance(command, Move):
        scene.move(command, seen)
    elif isinstance(command, Hands):
        scene.set_hands(client, command, seen, now)
    elif isinstance(command, Remove):
        scene.remove(command.names)
    elif isinstance(command, Quiet):
        scene.set_quiet(client, command.zones)
    elif isinstance(command, Clear):
        scene.clear(client)
    return True
