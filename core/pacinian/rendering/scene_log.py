"""Encode the changes of a scene from tick to tick, for recordings.

Values that are one Python object over several ticks are also one object when read back, because object identity
decides what is sampled again.
"""

from __future__ import annotations

import functools
from dataclasses import Field, asdict, astuple, dataclass, fields, is_dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import msgspec
import numpy as np

from pacinian.errors import ArgumentError, PacinianError, describe_error
from pacinian.plugins.registry import solver as solver_of
from pacinian.rendering.embedded_files import EmbeddedFileReader, EmbeddedFileWriter
from pacinian.scene.hands.hand import Hand
from pacinian.scene.objects import Object
from pacinian.scene.scene import Scene, Workspace
from pacinian.solving.limits import Limits
from pacinian.solving.quiet_zone import Zone

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.plugins.solver import Solver
    from pacinian.rendering.deviation_log import Reasons
    from pacinian.scene.sampling.sample_counts import SampleCounts

    News = dict[int, Any]  # by index in a list: the element's old index, or its encoding

T = TypeVar("T")

HAND = ("joints", "radii", "velocities", "vertices", "faces")
OPEN = "envelope", "technique"  # fields that may contain user-defined objects


@dataclass(frozen=True, eq=False)
class TickInput:
    """The inputs of one tick: scene, solver and limits."""

    scene: Scene
    solver: Solver
    limits: Limits


class TickOutcome(NamedTuple):
    """What became of one tick.

    sent: clock reading after the frame was sent [s]. late: whether that was after the next tick was due.
    sample_counts: what the objects asked for. deviations: what was not as asked, by label of the object and reason.
    """

    sent: float
    late: bool
    sample_counts: SampleCounts
    deviations: Reasons


class Writer:
    """Encodes the changes since the last tick. Raises ArgumentError for values that cannot be written."""

    def __init__(self) -> None:
        self._last: TickInput | None = None
        self._files = EmbeddedFileWriter()

    def prepare(self, scene: Scene) -> None:
        """Read the files of a scene now rather than in its first tick."""
        for item in scene.objects:
            self._files.name_files(item)

    def changes(self, asked: TickInput) -> dict[str, Any]:
        """Return the changes since the last call, as plain values."""
        new: dict[str, Any] = {}
        last, scene = self._last, asked.scene
        if last is None or scene is not last.scene:
            old = Scene() if last is None else last.scene
            new["count"] = len(scene.objects)
            new["objects"] = _news(scene.objects, old.objects, self._encode_object)
            new["hands"] = len(scene.hands), _news(scene.hands, old.hands, _hand)
            new["until"] = scene.moves_until
            if self._files.new:
                new["files"] = self._files.take()
            if scene.workspace != old.workspace:
                room = scene.workspace
                new["workspace"] = None if room is None else [room.lower, room.upper]
        if last is None or asked.solver is not last.solver:
            new["solver"] = asked.solver.name, _options(asked.solver)
        if last is None or asked.limits != last.limits:
            limits = {**asdict(asked.limits), "zones": [astuple(z) for z in asked.limits.zones]}
            new["limits"] = {k: _plain(v) for k, v in limits.items()}
        self._last = asked
        return new

    def _encode_object(self, item: Object, old: Object | None) -> Any:
        """Encode an object, or (in a list) only its changed fields, because shapes may be large."""
        try:
            whole = type(item) is not type(old)
            now = {name: getattr(item, name) for name in item.__struct_fields__}
            new = {k: v for k, v in now.items() if whole or v is not getattr(old, k)}
            for name in new.keys() & OPEN:
                _check_readable(new[name], _kinds(type(item))[name])
            if whole:
                return msgspec.msgpack.encode(self._files.name_files(item))
            return [msgspec.msgpack.encode({k: self._files.name_files(v) for k, v in new.items()})]
        except (TypeError, ValueError, OverflowError, RecursionError) as error:
            what = item.name or type(item).__name__
            raise ArgumentError(
                "scene", f"cannot be recorded: {what}: {describe_error(error)}"
            ) from error


class Reader:
    """Decodes the changes that a `Writer` encoded. Damaged values raise any Exception."""

    def __init__(self) -> None:
        self._asked: TickInput | None = None
        self._files = EmbeddedFileReader()

    def next(self, new: dict[str, Any]) -> TickInput:
        """Return the inputs of the next tick."""
        last = self._asked
        scene = Scene() if last is None else last.scene
        if "objects" in new:
            self._files.add(new.get("files", {}))
            objects = _merge_parts(new["objects"], new["count"], scene.objects, self._decode_object)
            count, changed = new["hands"]
            hands = _merge_parts(changed, count, scene.hands, _unhand)
            workspace = scene.workspace
            if "workspace" in new:
                room = new["workspace"]
                workspace = None if room is None else Workspace(tuple(room[0]), tuple(room[1]))
            scene = Scene(objects, workspace, hands)
            # not determined by the objects: `put` keeps the latest
            scene.__dict__["moves_until"] = float(new["until"])
        solver, limits = (None, None) if last is None else (last.solver, last.limits)
        if "solver" in new:
            name, options = new["solver"]
            solver = solver_of(name, **options)
        if "limits" in new:
            given: dict[str, Any] = {k: _array(v) for k, v in new["limits"].items()}
            zones = given.get("zones", ())
            given["zones"] = tuple(Zone(q, pressure=p, radius=r) for q, p, r in zones)
            limits = Limits(**given)
        if solver is None or limits is None:
            raise ValueError("the first tick lacks a solver or limits")
        if last is None or new:
            self._asked = last = TickInput(scene, solver, limits)
        return last

    def _decode_object(self, old: Object | None, packed: Any) -> Object:
        if isinstance(packed, bytes):
            made: Object = msgspec.msgpack.decode(packed, type=Object)
            return self._files.restore(made)
        if old is None:
            raise ValueError("there is no object that could have changed")
        new, kinds = msgspec.msgpack.decode(packed[0]), _kinds(type(old))
        parts = {k: self._files.restore(msgspec.convert(v, kinds[k])) for k, v in new.items()}
        return msgspec.structs.replace(old, **parts)


def _news(now: tuple[T, ...], old: tuple[T, ...], pack: Callable[[T, T | None], Any]) -> News:
    """Return for each element of `now` that moved or is new: its index in `old`, or the packed element."""
    if now is old:
        return {}
    changed = [i for i, part in enumerate(now) if i >= len(old) or part is not old[i]]
    if not changed:
        return {}
    place = {id(part): i for i, part in enumerate(old)}
    return {
        i: pack(part, old[i] if i < len(old) else None) if was is None else was
        for i, part, was in ((i, now[i], place.get(id(now[i]))) for i in changed)
    }


def _merge_parts(
    news: News, count: int, old: tuple[T, ...], unpack: Callable[[T | None, Any], T]
) -> tuple[T, ...]:
    parts = list(old[:count])
    for i, new in news.items():
        was = old[i] if i < len(old) else None
        part = old[new] if isinstance(new, int) else unpack(was, new)
        parts[i : i + 1] = [part]
    if len(parts) != count:
        raise ValueError(f"{len(parts)} parts are not {count}")
    return tuple(parts)


def _check_readable(value: Any, kind: Any) -> None:
    if msgspec.msgpack.decode(msgspec.msgpack.encode(value), type=kind) != value:
        raise TypeError(f"{value!r} is a user-defined object")


@functools.cache
def _kinds(cls: type[Object]) -> dict[str, Any]:
    return {field.name: field.type for field in msgspec.structs.fields(cls)}


def _hand(hand: Hand, old: Hand | None) -> dict[str, Any]:
    arrays = {k: getattr(hand, k) for k in HAND}
    new = {k: _plain(v) for k, v in arrays.items() if old is None or v is not getattr(old, k)}
    return {**new, "side": hand.side, "time": hand.time, "name": hand.name}


def _unhand(old: Hand | None, values: dict[str, Any]) -> Hand:
    arrays = {k: _array(values[k]) if k in values else getattr(old, k) for k in HAND}
    return Hand(**arrays, side=values["side"], time=values["time"], name=values["name"])


def _plain(value: Any) -> Any:
    """Encode an array as bytes, shape and dtype; also arrays nested in lists."""
    if isinstance(value, np.ndarray):
        return {"kind": value.dtype.str, "shape": list(value.shape), "bytes": value.tobytes()}
    if isinstance(value, (tuple, list)):
        return [_plain(part) for part in value]
    if isinstance(value, np.generic):
        return value.item()
    return value


def _array(value: Any) -> Any:
    if isinstance(value, dict):
        shape = tuple(value["shape"])
        return np.frombuffer(value["bytes"], value["kind"]).reshape(shape).copy()
    if isinstance(value, list):
        return tuple(_array(part) for part in value)
    return value


def _options(solver: Solver) -> dict[str, Any]:
    """Return the solver's options. Raises ArgumentError unless the plug-ins can make the same solver from them."""
    settings: tuple[Field[Any], ...] = fields(solver) if is_dataclass(solver) else ()
    options: dict[str, Any] = {f.name: getattr(solver, f.name) for f in settings if f.init}
    try:
        same = type(solver_of(solver.name, **options)) is type(solver)
        msgspec.msgpack.encode(options)
    except (PacinianError, TypeError) as error:
        raise ArgumentError("solver", f"cannot be recorded: {describe_error(error)}") from error
    if not same:
        raise ArgumentError("solver", f"cannot be recorded: {solver.name!r} is another class")
    return options
