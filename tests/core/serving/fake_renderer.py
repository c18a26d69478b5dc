"""A fake renderer that stores what it receives, and commands to send."""

from __future__ import annotations

from concurrent.futures import Executor, Future
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from pacinian.serving.bus.conversion_queue import Converter
from pacinian.serving.bus.message_admission import BusSession
from pacinian.serving.bus.shared_scene import SharedScene
from pacinian.serving.ipc.messages import (
    AnyChange,
    Changes,
    ChangesAck,
    MoveObject,
    PutObject,
    RemoveObject,
    ResetScene,
    SessionInfo,
    SetEnvelope,
    SetHands,
    SetQuiet,
)
from pacinian.serving.settings import Settings
from pacinian.wire import objects
from pacinian.wire.commands import AnyCommand, Envelopes, Hands, Move, Put, Quiet, Remove
from pacinian.wire.convert import to_scene
from pacinian.wire.modulation import Constant
from pacinian.wire.protocol import MAX_TIME_TO_LIVE

if TYPE_CHECKING:
    from pacinian.serving.bus.change_batcher import ChangeBatcher
    from pacinian.wire.replies import Reply

KEY = b"k" * 16
# so that no delay makes them too old
HEAD: dict[str, Any] = {"session": KEY, "sequence": 1, "time": 0.0, "ttl": MAX_TIME_TO_LIVE}


class AtOnce(Executor):
    """An executor that runs each job at once."""

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:  # as an executor does
            future.set_exception(error)
        return future


def room_of(settings: Settings | None = None) -> SharedScene:
    made = settings or Settings()
    return SharedScene(made, Converter(made.safety.pressure, AtOnce()))


def converted(room: SharedScene) -> list[tuple[BusSession, Reply]]:
    """Finish all conversions; return the replies."""
    return list(room._converter.run_round())


class FakeRenderer:
    """Applies changes to plain values. scene: object, pose and envelope by name, in order."""

    def __init__(self, run: int = 1) -> None:
        self.run = run
        self.scene: dict[str, list[object]] = {}
        self.hands: SetHands | None = None
        self.quiet: SetQuiet | None = None
        self.begins = 0
        self.last = ChangesAck(0, run, 0)

    def take(self, changes: Changes) -> ChangesAck:
        for change in changes.changes:
            self.apply(change)
        self.last = ChangesAck(changes.number, self.run, changes.run)
        return self.last

    def apply(self, change: AnyChange) -> None:
        if isinstance(change, ResetScene):
            self.scene, self.hands, self.quiet = {}, None, None
            self.begins += 1
        elif isinstance(change, PutObject):
            self.scene[change.name] = [change.item, None, None]
        elif isinstance(change, MoveObject | SetEnvelope) and change.name not in self.scene:
            pass  # for an earlier renderer; all changes are sent again
        elif isinstance(change, MoveObject):
            self.scene[change.name][1] = change.position[0]
        elif isinstance(change, SetEnvelope):
            self.scene[change.name][2] = change.envelope
        elif isinstance(change, RemoveObject):
            self.scene.pop(change.name, None)
        elif isinstance(change, SetHands):
            self.hands = change
        else:
            self.quiet = change

    def drain(self, batcher: ChangeBatcher) -> None:
        """Take changes until there are none."""
        for _ in range(10_000):
            if batcher.scene is not None:
                converted(batcher.scene)
            changes = batcher.make_batch()
            if changes is not None:
                batcher.acknowledge(self.take(changes))
            elif batcher.scene is None or not batcher.scene.pending:
                return
        raise AssertionError("it never ends")


class Model:
    """Reference: applies all commands of a scene in order."""

    def __init__(self) -> None:
        self.scene: dict[str, list[object]] = {}
        self.owner: dict[str, BusSession] = {}

    def do(self, client: BusSession, command: AnyCommand, seen: float) -> None:
        if isinstance(command, Put):
            for name, item in command.objects.items():
                packed = msgspec.msgpack.encode(to_scene(name, item, time=seen))
                self.scene[name] = [packed, None, None]
                self.owner[name] = client
        elif isinstance(command, Move):
            poses = np.frombuffer(command.poses, "<f4").reshape(-1, 7)
            for name, pose in zip(command.names, poses.tolist(), strict=True):
                if name in self.scene:
                    self.scene[name][1] = pose[0]
        elif isinstance(command, Envelopes):
            for name in command.names:
                if name in self.scene:
                    self.scene[name][2] = msgspec.msgpack.encode(command.envelope)
        elif isinstance(command, Remove):
            for name in command.names:
                self.scene.pop(name, None)

    def leave(self, client: BusSession) -> None:
        for name in [name for name in self.scene if self.owner[name] is client]:
            del self.scene[name]


def client(number: int = 1, scene: str = "s") -> BusSession:
    return BusSession(SessionInfo(bytes([number]) * 16, f"c{number}", scene, "pacinian"), number)


def point(pressure: float = 10.0, x: float = 0.0, **given: object) -> objects.Point:
    return objects.Point(radiation_pressure=pressure, position=(x, 0.0, 0.2), **given)  # type: ignore[arg-type]


def put(items: dict[str, objects.Object], **given: object) -> Put:
    return Put(**{**HEAD, **given}, objects=items)  # type: ignore[arg-type]


def move(names: tuple[str, ...], x: float, **given: object) -> Move:
    poses = np.array([[x, 0, 0.2, 0, 0, 0, 1]] * len(names), "<f4").tobytes()
    return Move(**{**HEAD, **given}, names=names, poses=poses)  # type: ignore[arg-type]


def remove(*names: str) -> Remove:
    return Remove(**HEAD, names=names)


def wrap(names: tuple[str, ...], level: float) -> Envelopes:
    return Envelopes(**HEAD, names=names, envelope=Constant(level))


def hands(*frames: object, **given: object) -> Hands:
    return Hands(**{**HEAD, **given}, hands=frames)  # type: ignore[arg-type]


def quiet(*zones: object) -> Quiet:
    return Quiet(**HEAD, zones=zones)  # type: ignore[arg-type]
