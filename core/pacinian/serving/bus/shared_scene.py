"""What clients have put, by scene: objects by name, hands, quiet zones. Pure: time is given."""

from __future__ import annotations

from collections import Counter
from heapq import heapify, heappop, heappush
from typing import TYPE_CHECKING

import msgspec

from pacinian.errors import WireError
from pacinian.serving.bus.client_hands import Tracked, tracked
from pacinian.serving.bus.conversion import Objects, Wraps
from pacinian.serving.bus.pending_changes import MOVED, WRAPPED, News
from pacinian.serving.bus.stored_object import (
    AT_ONCE,
    HEAVY,
    Thing,
    bulk,
    check_poses,
    refused,
    too_strong,
)
from pacinian.serving.ipc.messages import SetQuiet, scene_number
from pacinian.wire.commands import Clear, Envelopes, Hands, Move, Put, Quiet, Remove
from pacinian.wire.convert import envelope_to_scene

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from pacinian.serving.bus.admission import Client
    from pacinian.serving.bus.conversion import Converter
    from pacinian.serving.ipc.messages import SetHands
    from pacinian.serving.settings import Settings
    from pacinian.wire.commands import AnyCommand, Zone
    from pacinian.wire.replies import Code, Error

MEMORY = 16 << 20  # [bytes] of what one client has put
QUIET = 16  # zones of one scene's clients


class Refusal(Exception):
    """A command that is not done."""

    def __init__(self, code: Code, problem: str, path: str) -> None:
        super().__init__(problem)
        self.code: Code = code
        self.path = path


class Room:
    """One scene: objects in the order in which they came. felt: whether by hands only, once any were tracked.

    number: of the scene, as permits have it.
    """

    def __init__(self, settings: Settings, converter: Converter, name: str = "") -> None:
        self.name, self.number = name, scene_number(name)
        self.things: dict[str, Thing] = {}
        self.hands: dict[Client, Tracked] = {}
        self.zones: dict[Client, tuple[Zone, ...]] = {}
        self.clients: set[Client] = set()
        self.felt = False
        self.news = News()
        self._settings, self._converter = settings, converter
        self._ends: list[tuple[float, str]] = []  # a heap of times at which objects may be over

    def do(self, client: Client, command: AnyCommand, seen: float, now: float, size: int) -> bool:
        """Do a client's command, sent at `seen` and received at `now` [s] by our clock. Raises Refusal, WireError.

        Returns whether it is done: the converter answers for what takes long.
        """
        if isinstance(command, Move):
            self._move(command, seen)
        elif isinstance(command, Put):
            return self._put(client, command, seen, size)
        elif isinstance(command, Hands):
            self.hands[client] = tracked(client.number, command, seen, now)
            self.felt = True
            self.news.hand()
        elif isinstance(command, Remove):
            self._remove(command.names)
        elif isinstance(command, Envelopes):
            return self._wrap(client, command)
        elif isinstance(command, Quiet):
            self._quiet(client, command.zones)
        elif isinstance(command, Clear):
            self.clear(client)
        return True

    def clear(self, client: Client) -> None:
        """Without all that this client has put, tracks, and wants to be quiet."""
        self._remove([thing.name for thing in self.things.values() if thing.owner is client])
        if self.hands.pop(client, None) is not None:
            self.news.hand()
        if self.zones.pop(client, None) is not None:
            self.news.quiet = True

    def expire(self, now: float) -> None:
        """Without objects whose time is over."""
        while self._ends and self._ends[0][0] <= now:
            _, name = heappop(self._ends)
            thing = self.things.get(name)
            if thing is not None and thing.until is not None and thing.until <= now:
                self._remove([name])

    def has(self, thing: Thing) -> bool:
        """Whether it is there still."""
        return self.things.get(thing.name) is thing

    def drop(self, things: list[Thing]) -> None:
        """Without those of these objects that are there still."""
        self._remove([thing.name for thing in things if self.has(thing)])

    def pack(self, thing: Thing) -> Error | None:
        """Convert an object; one that cannot be meant is gone, and the error is its client's."""
        try:
            thing.pack(self._settings.safety.pressure)
        except WireError as error:
            self._remove([thing.name])
            return refused(error)
        return None

    def all_hands(self) -> SetHands:
        """Of all clients."""
        return Tracked.together(self.hands.values(), self.felt)

    def all_quiet(self) -> SetQuiet:
        """The installation's zones, and those of all clients."""
        zones = [zone for given in self.zones.values() for zone in given]
        ours = [(zone.position, zone.pressure, zone.radius) for zone in self._settings.safety.zones]
        return SetQuiet((*ours, *((zone.position, zone.pressure, zone.radius) for zone in zones)))

    def _put(self, client: Client, command: Put, seen: float, size: int) -> bool:
        most = self._settings.safety.pressure
        things = [Thing(name, item, client, seen) for name, item in command.objects.items()]
        rest = max(0, size - sum(thing.size for thing in things))
        for thing in things:
            thing.size += rest // len(things)
            thing.slow |= bool(command.id) and len(things) > AT_ONCE
        self._make_room(client, things)
        for thing in things:
            item = thing.item
            if item is not None and (item.radiation_pressure or 0.0) > most:
                raise too_strong(thing.name, item, item.radiation_pressure or 0.0, most)
        heavy = [thing for thing in things if thing.heavy]
        for thing in things if command.id else ():
            if not thing.heavy:
                thing.pack(most)
        for thing in things:
            self._place(thing)
        if heavy:
            self._converter.ask(Objects(self, heavy, client, command.id))
        if len(self._ends) > 2 * len(self.things) + 64:  # most of these were put anew
            self._ends = [(t.until, t.name) for t in self.things.values() if t.until is not None]
            heapify(self._ends)
        return not heavy

    def _make_room(self, client: Client, things: list[Thing]) -> None:
        limits = self._settings.clients
        old = [old for thing in things if (old := self.things.get(thing.name))]
        own = [thing for thing in old if thing.owner is client]
        for have, most, whose in (
            (client.objects - len(own), limits.per_client, "of one client"),
            (len(self.things) - len(old), limits.objects, "of one scene"),
        ):
            if have + len(things) > most:
                raise Refusal("limit", f"would be more than {most} {whose}", "$.objects")
        held = client.bytes + sum(t.size for t in things) - sum(t.size for t in own)
        if held > MEMORY:
            raise full("$.objects")

    def _place(self, thing: Thing) -> None:
        old = self.things.get(thing.name)
        if old is not None:
            _count(old, -1)
            old.leave()
        _count(thing, 1)
        self.things[thing.name] = thing
        if thing.until is not None:
            heappush(self._ends, (thing.until, thing.name))
        self.news.put(thing.name, there=old is not None)

    def _move(self, command: Move, seen: float) -> None:
        check_poses(command)
        poses, velocities = command.poses, command.velocities
        for i, thing in self._those(command.names):
            pose, velocity = poses[28 * i : 28 * i + 28], velocities[24 * i : 24 * i + 24]
            thing.moved = pose, velocity, seen
            self.news.new(thing.name, MOVED)
        self._all_there(command.names)

    def _wrap(self, client: Client, command: Envelopes) -> bool:
        things, size = [thing for _, thing in self._those(command.names)], bulk(command.envelope)
        heavy, envelope = size > HEAVY, b""
        if not heavy:
            envelope = msgspec.msgpack.encode(envelope_to_scene(command.envelope))
            size = len(envelope)
        more: Counter[Client] = Counter()
        for thing in things:
            more[thing.owner] += size - (thing.waits if heavy else len(thing.wrapped) + thing.waits)
        if any(owner.bytes + bytes_ > MEMORY for owner, bytes_ in more.items()):
            raise full("$.names")
        if heavy:
            ident = command.id if len(things) == len(command.names) else 0
            job = Wraps(self, things, client, ident, command.envelope)
            for thing in things:
                thing.wrap(thing.wrapped, job, size)
            self._converter.ask(job)
        else:
            for thing in things:
                thing.wrap(envelope)
                self.news.new(thing.name, WRAPPED)
        self._all_there(command.names)
        return not heavy

    def _those(self, names: tuple[str, ...]) -> Iterator[tuple[int, Thing]]:
        for i, name in enumerate(names):
            thing = self.things.get(name)
            if thing is not None:
                yield i, thing

    def _all_there(self, names: tuple[str, ...]) -> None:
        for i, name in enumerate(names):
            if name not in self.things:
                problem = f"there is no object {name!r}; the others are done"
                raise Refusal("unknown", problem, f"$.names[{i}]")

    def _remove(self, names: Iterable[str]) -> None:
        for name in names:
            thing = self.things.pop(name, None)
            if thing is not None:
                _count(thing, -1)
                thing.leave()
                self.news.removed(name)

    def _quiet(self, client: Client, zones: tuple[Zone, ...]) -> None:
        others = sum(len(given) for who, given in self.zones.items() if who is not client)
        if others + len(zones) > QUIET:
            raise Refusal("limit", f"would be more than {QUIET} zones in all", "$.zones")
        self.zones[client] = zones
        self.news.quiet = True


def full(path: str) -> Refusal:
    """Why there is no memory for more."""
    return Refusal("limit", f"would take more than {MEMORY >> 20} MiB for one client", path)


def _count(thing: Thing, by: int) -> None:
    thing.placed = by > 0
    thing.owner.objects += by
    thing.owner.bytes += by * thing.size
