"""The renderer's copy of the owner's scene. Changes from the bus are applied in order, all of a tick at once.

The bus has already checked positions, velocities and times. They are put into copies of the objects without another
check, because this happens at each tick.
"""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any, NamedTuple, cast
from weakref import WeakKeyDictionary

from msgspec.structs import force_setattr

from pacinian.errors import describe_error, shorten
from pacinian.scene.modulation.technique import SIMULTANEOUS
from pacinian.scene.objects import Object, Particles, Point
from pacinian.scene.scene import Scene
from pacinian.serving.ipc import messages
from pacinian.serving.ipc.logs import RateLimitedLog
from pacinian.serving.render import background_loader, change_decoding
from pacinian.serving.render.frame_output import Input
from pacinian.solving.quiet_zone import Zone

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.modulation.envelope import Timed
    from pacinian.scene.modulation.technique import Technique
    from pacinian.scene.scene import Workspace
    from pacinian.serving.render.background_loader import BackgroundLoader

# Number of refused objects remembered for reports.
MAX_REFUSALS = 256


class Given(NamedTuple):
    """The values an object was put with. The current intensity and default technique are applied to them."""

    radiation_pressure: float | None
    force: float | None
    default: bool


class SceneReplica:
    """Keeps a scene that follows the changes of the bus.

    workspace: of every scene. zones: quiet zones until the bus sends some. loader: for slow objects; until a new object
    is loaded, the one that it replaces is rendered.
    """

    def __init__(
        self, workspace: Workspace | None, loader: BackgroundLoader, zones: tuple[Zone, ...] = ()
    ) -> None:
        self.start = 0.0
        """Time 0 of the scene, by the clock of the changes [s]."""
        self.scene = Scene(workspace=workspace)
        self.zones: tuple[Zone, ...] | None = zones
        """The quiet zones; None if the last ones were invalid, so that there must be silence."""
        self.refused: dict[str, str] = {}
        """The last objects that could not be put, and why."""
        self._loader, self._log = loader, RateLimitedLog()
        self.number = 0
        """Number of the scene."""
        self.technique: Technique = SIMULTANEOUS
        """The technique of objects without their own. `present` sets it."""
        self.intensity = 1.0
        """The factor on all pressures. `present` sets it."""
        self._items: dict[str, Object] = {}
        self._given: dict[str, Given] = {}
        self._turn = 0
        # Turn, and the changes since then.
        self._loading: dict[str, tuple[int, list[messages.AnyChange]]] = {}
        self._new: dict[str, Object] = {}  # changed since the scene was last made
        self._gone: dict[str, None] = {}
        self._hands: tuple[Hand, ...] | None = None
        self._input = Input()
        self._inputs: WeakKeyDictionary[Scene, Input] = WeakKeyDictionary()
        self._hushed: tuple[Scene, Scene] = self.scene, self.scene
        self._appliers: dict[type, Callable[[Any], None]] = {
            messages.ResetScene: self._begin,
            messages.PutObject: self._put,
            messages.MoveObject: self._move,
            messages.SetEnvelope: self._wrap,
            messages.RemoveObject: self._remove,
            messages.SetHands: self._set_hands,
            messages.SetQuiet: self._set_quiet,
        }

    def apply(self, changes: Iterable[messages.AnyChange] = ()) -> None:
        """Apply changes, and take what has been loaded. Invalid changes are dropped and reported."""
        for done in self._loader.take_results():
            self._take(done)
        for change in changes:
            self._apply_change(change)
        scene = self.scene
        if self._gone:
            scene = scene.remove(*self._gone)
        if self._new:
            scene = self._with_new(scene)
        if self._hands is not None:
            scene = scene.with_hands(*self._hands)
        self._gone, self._new, self._hands = {}, {}, None
        if scene is not self.scene:
            self.scene = scene
            if self._input.input:
                self._inputs[scene] = self._input

    def _with_new(self, scene: Scene) -> Scene:
        """Return the scene with all new objects; an invalid object is dropped."""
        try:
            return scene.put(*self._new.values())
        except Exception:  # one of them is invalid
            for name, item in self._new.items():
                try:
                    scene = scene.put(item)
                except Exception as error:
                    self._drop(name)
                    self.refuse(name, describe_error(error))
            return scene

    @property
    def silenced(self) -> Scene:
        """The scene without its objects but with the same hands, so that sound fades. One instance for each scene."""
        if self._hushed[0] is not self.scene:
            names = [item.name for item in self.scene.objects]
            self._hushed = self.scene, self.scene.remove(*names)
        return self._hushed[1]

    @property
    def loading(self) -> bool:
        """Whether something is being loaded, so that `apply` must be called again."""
        return bool(self._loading)

    def find_awaited(self) -> list[str]:
        """Return the names of objects that are loaded for the first time, so that nothing is rendered for them yet."""
        return [name for name in self._loading if name not in self._items]

    def find_input(self, scene: Scene) -> Input:
        """Return the newest hand update in an earlier state of this scene."""
        return self._inputs.get(scene, Input())

    def present(self, technique: Technique, intensity: float) -> None:
        """Set the technique of objects without their own, and the factor on all pressures."""
        if (technique, intensity) == (self.technique, self.intensity):
            return
        self.technique, self.intensity = technique, intensity
        for item in list(self._items.values()):
            self._change(item)
            self._apply_settings(self._items[item.name])
        self.apply()

    def _apply_change(self, change: messages.AnyChange) -> None:
        name = getattr(change, "name", "")
        waiting = self._loading.get(name)
        if waiting is not None and isinstance(change, (messages.MoveObject, messages.SetEnvelope)):
            kept = [old for old in waiting[1] if type(old) is not type(change)]
            self._loading[name] = waiting[0], [*kept, change]
        try:
            self._appliers[type(change)](change)
        except Exception as error:  # whatever a change raises, the loop must go on
            self.refuse(name, describe_error(error))

    def _drop(self, name: str) -> None:
        self._forget(name)
        for there in (self._items, self._given):
            there.pop(name, None)

    def _forget(self, name: str) -> None:
        """Drop the pending load of that name."""
        if self._loading.pop(name, None) is not None:
            self._loader.drop(name)

    def refuse(self, name: str, problem: str) -> None:
        """Record that an object could not be put; "" for an error of no object in particular."""
        self._log.warning("change refused", object=name, why=shorten(problem))
        self.refused.pop(name, None)
        self.refused[name] = shorten(problem)
        while len(self.refused) > MAX_REFUSALS:
            del self.refused[next(iter(self.refused))]

    def _begin(self, change: messages.ResetScene) -> None:
        self._gone = dict.fromkeys(item.name for item in self.scene.objects)
        for name in list(self._loading):
            self._forget(name)
        for there in (self._items, self._given, self._new):
            there.clear()
        self.refused.clear()
        self.number = change.scene
        self._hands, self._input = (), Input()

    def _put(self, change: messages.PutObject) -> None:
        name, data, default = change.name, change.item, change.default
        self.refused.pop(name, None)
        self._forget(name)
        if len(data) > background_loader.MAX_LIGHT_BYTES:
            self._load(
                change, lambda: background_loader.load_object(background_loader.decode_object(data))
            )
            return
        item = background_loader.decode_object(data)
        if background_loader.is_light(item):
            self._enter(name, item, default)
        else:
            self._load(change, lambda: background_loader.load_object(item))

    def _enter(self, name: str, item: Object, default: bool) -> None:
        """Add an object that is ready. The replica owns it, so it is changed in place."""
        force_setattr(item, "name", name)
        if item.motion is not None:
            motion = copy.copy(item.motion)
            force_setattr(motion, "time", motion.time - self.start)
            force_setattr(item, "motion", motion)
        workspace = self.scene.workspace
        away = workspace.distance(item.pose.position) if workspace else 0.0
        if away > 0.0 and away > item.bounding_radius and name not in self._items:
            self._log.warning("object outside the workspace", object=name, metres=round(away, 3))
        self._given[name] = Given(item.radiation_pressure, item.force, default)
        self._new[name] = self._items[name] = self._apply_settings(item)

    def _apply_settings(self, item: Object) -> Object:
        given = self._given[item.name]
        if given.radiation_pressure is not None:
            force_setattr(item, "radiation_pressure", self.intensity * given.radiation_pressure)
        if given.force is not None:
            force_setattr(item, "force", self.intensity * given.force)
        if given.default:
            force_setattr(item, "technique", self.technique)
        return item

    def _load(self, change: messages.AnyChange, job: Callable[[], Object | Timed]) -> None:
        name = getattr(change, "name", "")
        self._turn += 1
        self._loading[name] = self._turn, [change]
        self._loader.queue(name, self._turn, job)

    def _take(self, done: background_loader.Loaded) -> None:
        turn, (change, *later) = self._loading.get(done.name, (0, [messages.ResetScene()]))
        if turn != done.turn:
            return  # a newer change has replaced it
        del self._loading[done.name]
        if done.made is None:
            self.refuse(done.name, done.problem)
        elif isinstance(change, messages.PutObject):
            self._enter(done.name, cast("Object", done.made), change.default)
        elif done.name in self._items:
            self._change(self._items[done.name], envelope=done.made)
        for change in later:
            self._apply_change(change)

    def _move(self, change: messages.MoveObject) -> None:
        item = self._items.get(change.name)
        if item is None:
            return
        motion = change_decoding.decode_motion(change, self.start)
        if isinstance(item, Point):
            self._change(item, position=change.position, motion=motion)
        else:
            self._change(item, pose=change_decoding.decode_pose(change), motion=motion)

    def _wrap(self, change: messages.SetEnvelope) -> None:
        item, data = self._items.get(change.name), change.envelope
        if item is None:
            return
        if len(data) > background_loader.MAX_LIGHT_BYTES:
            self._load_envelope(
                change,
                lambda: background_loader.load_envelope(background_loader.decode_envelope(data)),
            )
            return
        envelope = background_loader.decode_envelope(data)
        if isinstance(envelope, background_loader.SLOW):
            self._load_envelope(change, lambda: background_loader.load_envelope(envelope))
        else:
            self._change(item, envelope=envelope)

    def _load_envelope(self, change: messages.SetEnvelope, job: Callable[[], Timed]) -> None:
        """Load an envelope; if the object that it is for is being loaded, after that."""
        first = self._loading[change.name][1][0] if change.name in self._loading else None
        if not isinstance(first, messages.PutObject):  # `_apply_change` keeps the change for later
            self._load(change, job)

    def _change(self, item: Object, **fields: Any) -> None:
        """Set fields of an existing object, without checks."""
        changed = copy.copy(item)
        if isinstance(item, Particles):
            # Keep its bounding radius, which takes long to compute.
            vars(changed).update(vars(item))
        for field, value in fields.items():
            force_setattr(changed, field, value)
        self._new[item.name] = self._items[item.name] = changed

    def _remove(self, change: messages.RemoveObject) -> None:
        name = change.name
        self._drop(name)
        self._new.pop(name, None)
        self.refused.pop(name, None)
        self._gone[name] = None

    def _set_hands(self, change: messages.SetHands) -> None:
        self._hands = tuple(change_decoding.decode_hand(info, self.start) for info in change.hands)
        if change.felt and not self._hands:
            self._hands = (change_decoding.LOST,)
        self._input = Input(change.input, change.sent, change.received)

    def _set_quiet(self, change: messages.SetQuiet) -> None:
        self.zones = None
        self.zones = tuple(Zone(q, pressure=p, radius=r) for q, p, r in change.zones)
