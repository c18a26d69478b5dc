"""Admission of commands: session, sequence number and age. Pure: callers pass the time.

The rate: rate_limit.py in ipc/. Number of objects: shared_scene.py.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.serving.ipc.clock_offset import ClockOffsetEstimator
from pacinian.serving.ipc.rate_limit import ERROR_RATE, TokenBucket
from pacinian.wire.replies import Error

if TYPE_CHECKING:
    from pacinian.serving.ipc.messages import SessionInfo
    from pacinian.wire.commands import AnyCommand


class BusSession:
    """The bus's record of a session. number: makes the names of its hands unique in the scene.

    peer: the connection that claimed it; empty before its first message. objects, bytes: of what it has put. commands,
    errors, dropped: counts. age: of its newest command [s].
    """

    def __init__(self, info: SessionInfo, number: int) -> None:
        self.info, self.number = info, number
        self.peer = b""
        self.objects = self.bytes = 0
        self.commands = self.errors = self.dropped = 0
        self.age = 0.0
        self._sequence = 0
        self._clock = ClockOffsetEstimator()
        self._error_quota = TokenBucket(ERROR_RATE)

    def claim(self, peer: bytes, user: str) -> bool:
        """Bind the session to `peer` on the first call by its user; return whether it is bound to `peer`."""
        if not self.peer and user == self.info.user:
            self.peer = peer
        return peer == self.peer

    def admit(self, command: AnyCommand, now: float) -> Error | None:
        """Admit a command, and set `age`; return the error if it is refused."""
        self.commands += 1
        if command.sequence <= self._sequence:
            return Error(
                id=command.id,
                code="sequence",
                message=f"must be above {self._sequence}, not {command.sequence}: seen already",
                path="$.sequence",
            )
        self._sequence = command.sequence
        self.age = self._clock.compute_age(command.time, now)
        if self.age <= command.ttl:
            return None
        self.dropped += 1
        return Error(
            id=command.id,
            code="stale",
            message=f"is {self.age:.3g} s old, more than its ttl of {command.ttl:g} s",
            path="$.ttl",
            advice="send fewer commands, or raise `ttl`",
        )

    def count_superseded(self, count: int) -> None:
        """Count commands that were superseded."""
        self.commands += count
        self.dropped += count

    def should_report(self, error: Error, now: float) -> bool:
        """Count an error; return whether to send it: always if the client expects a reply, otherwise rate-limited."""
        self.errors += 1
        return bool(error.id) or self._error_quota.take(now)
