"""Shared scenes: the objects, hands and quiet zones that clients have put. Pure: callers pass the time."""

from __future__ import annotations

import math
from collections import Counter
from heapq import heapify, heappop, heappush
from typing import TYPE_CHECKING

import msgspec

from pacinian.errors import WireError
from pacinian.serving.bus.client_hands import TrackedHands, track_hands
from pacinian.serving.bus.conversion_queue import EnvelopeConversion, ObjectConversion
from pacinian.serving.bus.pending_changes import MOVED, NEW_ENVELOPE, PendingChanges
from pacinian.serving.bus.stored_object import (
    MAX_CONVERTED_AT_ONCE,
    MIN_HEAVY_BYTES,
    StoredObject,
    check_poses,
    count_bulk_bytes,
    make_error_reply,
    reject_strength,
)
from pacinian.serving.ipc.messages import SetQuiet
from pacinian.wire.convert import envelope_to_scene
from pacinian.wire.protocol import MAX_ZONES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from pacinian.serving.bus.conversion_queue import Converter
    from pacinian.serving.bus.message_admission import BusSession
    from pacinian.serving.ipc.messages import SetHands
    from pacinian.serving.settings import Settings
    from pacinian.wire.commands import Envelopes, Hands, Move, Put, Zone
    from pacinian.wire.replies import Code, Error

# Memory limit for the objects of one client [bytes].
MAX_CLIENT_BYTES = 16 << 20


class CommandRejected(Exception):
    """A command is refused."""

    def __init__(self, code: Code, problem: str, path: str) -> None:
        super().__init__(problem)
        self.code: Code = code
        self.path = path


class SharedScene:
    """One scene. Its objects keep the order in which they arrived.

    felt: True once any client tracks hands; before that, whole objects are rendered. number: as in `Permit`.
    """

    def __init__(
        self, settings: Settings, converter: Converter, name: str = "", number: int = 0
    ) -> None:
        self.name, self.number = name, number
        self.objects: dict[str, StoredObject] = {}
        self.hands: dict[BusSession, TrackedHands] = {}
        self.zones: dict[BusSession, tuple[Zone, ...]] = {}
        self.clients: set[BusSession] = set()
        self.felt = False
        self.pending = PendingChanges()
        self._settings, self._converter = settings, converter
        self._ends: list[tuple[float, str]] = []  # a heap of the times at which objects may expire

    def clear(self, client: BusSession) -> None:
        """Remove all objects, hands and quiet zones of a client."""
        self.remove([stored.name for stored in self.objects.values() if stored.owner is client])
        if self.hands.pop(client, None) is not None:
            self.pending.note_hands()
        if self.zones.pop(client, None) is not None:
            self.pending.quiet = True

    def set_hands(self, client: BusSession, command: Hands, seen: float, now: float) -> None:
        """Replace the hands of a client, seen at `seen` and received at `now` [s] by the server's clock."""
        self.hands[client] = track_hands(client.number, command, seen, now)
        self.felt = True
        self.pending.note_hands()

    @property
    def due(self) -> float:
        """When the next object may expire [s]; infinite if none will."""
        return self._ends[0][0] if self._ends else math.inf

    def expire(self, now: float) -> None:
        """Remove the objects that have expired."""
        while self._ends and self._ends[0][0] <= now:
            _, name = heappop(self._ends)
            stored = self.objects.get(name)
            if stored is not None and stored.until is not None and stored.until <= now:
                self.remove([name])

    def drop(self, stored_objects: list[StoredObject]) -> None:
        """Remove those of the objects that are still in the scene."""
        here = [stored for stored in stored_objects if self.objects.get(stored.name) is stored]
        self.remove(stored.name for stored in here)

    def pack(self, stored: StoredObject) -> Error | None:
        """Encode an object. If it is invalid, remove it and return the error for its client."""
        try:
            stored.pack(self._settings.safety.pressure)
        except WireError as error:
            self.remove([stored.name])
            return make_error_reply(error)
        return None

    def merge_hands(self) -> SetHands:
        """Return the hands of all clients."""
        return TrackedHands.merge(self.hands.values(), self.felt)

    def merge_zones(self) -> SetQuiet:
        """Return the installation's quiet zones, and those of all clients."""
        zones = [zone for given in self.zones.values() for zone in given]
        ours = [(zone.position, zone.pressure, zone.radius) for zone in self._settings.safety.zones]
        return SetQuiet((*ours, *((zone.position, zone.pressure, zone.radius) for zone in zones)))

    def put(self, client: BusSession, command: Put, seen: float, size: int) -> bool:
        """Put objects, sent at `seen` [s] in a message of `size` [bytes].

        Returns False if the converter puts some of them later. Raises CommandRejected, WireError.
        """
        most = self._settings.safety.pressure
        stored_objects = [
            StoredObject(name, item, client, seen) for name, item in command.objects.items()
        ]
        rest = max(0, size - sum(stored.size for stored in stored_objects))
        for stored in stored_objects:
            stored.size += rest // len(stored_objects)
            stored.slow |= bool(command.id) and len(stored_objects) > MAX_CONVERTED_AT_ONCE
        self._make_room(client, stored_objects)
        for stored in stored_objects:
            item = stored.item
            if item is not None and (item.radiation_pressure or 0.0) > most:
                raise reject_strength(stored.name, item, item.radiation_pressure or 0.0, most)
        heavy = [stored for stored in stored_objects if stored.heavy]
        for stored in stored_objects if command.id else ():
            if not stored.heavy:
                stored.pack(most)
        for stored in stored_objects:
            self._place(stored)
        if heavy:
            self._converter.queue(ObjectConversion(heavy, client, command.id, self.drop))
        if len(self._ends) > 2 * len(self.objects) + 64:  # most entries are of replaced objects
            self._ends = [(t.until, t.name) for t in self.objects.values() if t.until is not None]
            heapify(self._ends)
        return not heavy

    def _make_room(self, client: BusSession, stored_objects: list[StoredObject]) -> None:
        limits = self._settings.clients
        old = [old for stored in stored_objects if (old := self.objects.get(stored.name))]
        own = [stored for stored in old if stored.owner is client]
        for have, most, whose in (
            (client.objects - len(own), limits.max_client_objects, "of one client"),
            (len(self.objects) - len(old), limits.max_objects, "of one scene"),
        ):
            if have + len(stored_objects) > most:
                raise CommandRejected("limit", f"would be more than {most} {whose}", "$.objects")
        held = client.bytes + sum(t.size for t in stored_objects) - sum(t.size for t in own)
        if held > MAX_CLIENT_BYTES:
            raise reject_full("$.objects")

    def _place(self, stored: StoredObject) -> None:
        old = self.objects.get(stored.name)
        if old is not None:
            _count(old, -1)
            old.leave()
        _count(stored, 1)
        self.objects[stored.name] = stored
        if stored.until is not None:
            heappush(self._ends, (stored.until, stored.name))
        self.pending.note_put(stored.name, there=old is not None)

    def move(self, command: Move, seen: float) -> None:
        """Set the poses and velocities of objects, as of `seen` [s]. Raises CommandRejected, WireError."""
        check_poses(command)
        poses, velocities = command.poses, command.velocities
        for i, stored in self._find_stored(command.names):
            pose, velocity = poses[28 * i : 28 * i + 28], velocities[24 * i : 24 * i + 24]
            stored.moved = pose, velocity, seen
            self.pending.note_changed(stored.name, MOVED)
        self._require_all(command.names)

    def set_envelope(self, client: BusSession, command: Envelopes) -> bool:
        """Set the envelope of objects.

        Returns False if the converter sets it later. Raises CommandRejected, WireError.
        """
        stored_objects, size = (
            [stored for _, stored in self._find_stored(command.names)],
            count_bulk_bytes(command.envelope),
        )
        heavy, envelope = size > MIN_HEAVY_BYTES, b""
        if not heavy:
            envelope = msgspec.msgpack.encode(envelope_to_scene(command.envelope))
            size = len(envelope)
        more: Counter[BusSession] = Counter()
        for stored in stored_objects:
            more[stored.owner] += size - (
                stored.waits if heavy else len(stored.envelope) + stored.waits
            )
        if any(owner.bytes + bytes_ > MAX_CLIENT_BYTES for owner, bytes_ in more.items()):
            raise reject_full("$.names")
        if heavy:
            ident = command.id if len(stored_objects) == len(command.names) else 0
            job = EnvelopeConversion(
                stored_objects, client, ident, command.envelope, self._note_envelope
            )
            for stored in stored_objects:
                stored.set_envelope(stored.envelope, job, size)
            self._converter.queue(job)
        else:
            for stored in stored_objects:
                stored.set_envelope(envelope)
                self._note_envelope(stored.name)
        self._require_all(command.names)
        return not heavy

    def _note_envelope(self, name: str) -> None:
        self.pending.note_changed(name, NEW_ENVELOPE)

    def _find_stored(self, names: tuple[str, ...]) -> Iterator[tuple[int, StoredObject]]:
        for i, name in enumerate(names):
            stored = self.objects.get(name)
            if stored is not None:
                yield i, stored

    def _require_all(self, names: tuple[str, ...]) -> None:
        for i, name in enumerate(names):
            if name not in self.objects:
                problem = f"there is no object {name!r}; the objects that exist were changed"
                raise CommandRejected("unknown", problem, f"$.names[{i}]")

    def remove(self, names: Iterable[str]) -> None:
        """Remove the objects with these names. Ignores names that do not exist."""
        for name in names:
            stored = self.objects.pop(name, None)
            if stored is not None:
                _count(stored, -1)
                stored.leave()
                self.pending.note_removed(name)

    def set_quiet(self, client: BusSession, zones: tuple[Zone, ...]) -> None:
        """Replace the quiet zones of a client. Raises CommandRejected."""
        others = sum(len(given) for who, given in self.zones.items() if who is not client)
        if others + len(zones) > MAX_ZONES:
            raise CommandRejected(
                "limit", f"would be more than {MAX_ZONES} zones in all", "$.zones"
            )
        self.zones[client] = zones
        self.pending.quiet = True


def reject_full(path: str) -> CommandRejected:
    """Return the error for a client that is over its memory limit."""
    return CommandRejected(
        "limit", f"would take more than {MAX_CLIENT_BYTES >> 20} MiB for one client", path
    )


def _count(stored: StoredObject, by: int) -> None:
    stored.placed = by > 0
    stored.owner.objects += by
    stored.owner.bytes += by * stored.size
