"""The tracked hands of a client, in the form for the renderer."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from pacinian.errors import ArgumentError, WireError
from pacinian.scene.hands.hand import Hand
from pacinian.serving.ipc.messages import HandInfo, SetHands
from pacinian.wire.binary_arrays import unpack

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.wire.commands import HandFrame, Hands


class TrackedHands(NamedTuple):
    """A client's hands. sequence: of their command. sent: by the client's clock; received: by the server's [s]."""

    hands: tuple[HandInfo, ...]
    sequence: int
    sent: float
    received: float

    @staticmethod
    def merge(tracked: Iterable[TrackedHands], felt: bool) -> SetHands:
        """Merge the hands of all clients; times and sequence are those of the newest."""
        all_of = list(tracked)
        if not all_of:
            return SetHands((), felt, 0, 0.0, 0.0)
        newest = max(all_of, key=lambda t: t.received)
        hands = tuple(hand for t in all_of for hand in t.hands)
        return SetHands(hands, felt, newest.sequence, newest.sent, newest.received)


def track_hands(number: int, command: Hands, seen: float, now: float) -> TrackedHands:
    """Return the hands of the client with that number, seen at `seen` and received at `now` [s]. Raises WireError."""
    names: set[str] = set()
    hands: list[HandInfo] = []
    for i, hand in enumerate(command.hands):
        name = hand.name or hand.side
        if name in names:
            raise WireError(f"must be unique: two hands are called {name!r}", f"$.hands[{i}].name")
        names.add(name)
        _check(hand, i)
        name = f"{name}@{number}"
        hands.append(HandInfo(hand.side, name, hand.joints, hand.radii, hand.velocities, seen))
    return TrackedHands(tuple(hands), command.sequence, command.time, now)


def _check(hand: HandFrame, index: int) -> None:
    """Check a hand; a lost hand, which has no joints, passes. Raises WireError."""
    if not hand.joints:
        return
    try:
        Hand(
            unpack(hand.joints, 3),
            unpack(hand.radii, 1)[:, 0] if hand.radii else None,
            velocities=unpack(hand.velocities, 3) if len(hand.velocities) > 12 else None,
        )
    except ArgumentError as error:
        raise WireError(str(error), f"$.hands[{index}].{error.argument}") from error
