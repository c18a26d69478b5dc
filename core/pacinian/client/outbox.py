"""The outbox: commands that wait because the socket has no room.

A command that a newer one replaces is removed, and so is a command whose time to live is over.

Pure: it holds commands without sequence numbers, and callers pass the time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from pacinian.wire.commands import (
    AnyCommand,
    Clear,
    Envelopes,
    Hands,
    Move,
    Put,
    Quiet,
    Remove,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Collection

# Kinds of waiting commands that a newer command of each kind removes, or removes from, for the objects that it names.
SUPERSEDES: dict[type[AnyCommand], tuple[type[AnyCommand], ...]] = {
    Put: (Put, Move, Remove, Envelopes),
    Move: (Move,),
    Remove: (Put, Move, Remove, Envelopes),
    Envelopes: (Envelopes,),
    Hands: (Hands,),
    Quiet: (Quiet,),
    Clear: (Put, Move, Remove, Envelopes, Hands, Quiet, Clear),
}


class Outbox:
    """Commands that wait to be sent, oldest first."""

    def __init__(self) -> None:
        self.waiting: list[AnyCommand] = []
        self.superseded = 0
        """Number of commands superseded, wholly or partly, before they were sent."""

    def add(self, command: AnyCommand) -> None:
        """Add a command, and remove what it supersedes from the waiting ones."""
        kinds, names = SUPERSEDES[type(command)], _names(command)
        kept: list[AnyCommand] = []
        for old in self.waiting:
            left: AnyCommand | None = old
            if isinstance(old, kinds):
                left = _without(old, names)
                self.superseded += left is not old
            if left is not None:
                kept.append(left)
        self.waiting = [*kept, command]

    def flush(self, now: float, send: Callable[[AnyCommand], bool]) -> bool:
        """Send the waiting commands until `send` returns False; return whether none is left. Drops expired ones."""
        self.waiting = [c for c in self.waiting if now - c.time <= c.ttl]
        while self.waiting and send(self.waiting[0]):
            del self.waiting[0]
        return not self.waiting


def _names(command: AnyCommand) -> frozenset[str] | None:
    """Return the names of a command's objects; None if it concerns all."""
    if isinstance(command, Put):
        return frozenset(command.objects)
    if isinstance(command, (Move, Remove, Envelopes)):
        return frozenset(command.names)
    return None


def _without(command: AnyCommand, names: Collection[str] | None) -> AnyCommand | None:
    """Return the command without these objects; None if none are left."""
    if names is None or not isinstance(command, (Put, Move, Remove, Envelopes)):
        return None
    if isinstance(command, Put):
        objects = {name: item for name, item in command.objects.items() if name not in names}
        if len(objects) == len(command.objects):
            return command
        return replace(command, objects=objects) if objects else None
    rows = [i for i, name in enumerate(command.names) if name not in names]
    if len(rows) == len(command.names):
        return command
    kept = tuple(command.names[i] for i in rows)
    if not kept:
        return None
    if not isinstance(command, Move):
        return replace(command, names=kept)
    poses = b"".join(command.poses[28 * i : 28 * i + 28] for i in rows)
    velocities = b"".join(command.velocities[24 * i : 24 * i + 24] for i in rows)
    return replace(command, names=kept, poses=poses, velocities=velocities)
