"""The scene: an immutable snapshot of objects and hands, with the bounding spheres of the objects."""

from __future__ import annotations

import functools
import math
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path as PathOfFile
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from msgspec import Struct

from pacinian.argument_checks import check_kind
from pacinian.errors import ArgumentError
from pacinian.notebook import MAX_ROWS, Card, card
from pacinian.scene.config_sections import Workspace
from pacinian.scene.hands.hand import Hand
from pacinian.scene.motion import MAX_EXTRAPOLATION, STILL
from pacinian.scene.objects import Object, Particles, Path, Point, Surface, Volume

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from pacinian.types import Floats

__all__ = ["Scene", "Workspace"]

MAX_DRAWN = 500  # largest number of objects drawn in a notebook
KINDS = Point, Path, Particles, Surface, Volume


@dataclass(frozen=True, eq=False)
class Scene:
    """Objects, and the hands that feel them. A change makes a new scene, which shares everything unchanged.

    objects: at equal priority, earlier ones come first. workspace: limits where objects are felt; by default there is
    no limit. hands: the objects are felt where these touch them; without hands, objects are rendered whole. Names,
    where given, must be unique. Raises ArgumentError.
    """

    objects: tuple[Object, ...] = ()
    workspace: Workspace | None = None
    hands: tuple[Hand, ...] = ()

    def __post_init__(self) -> None:
        for name in ("objects", "hands"):
            try:
                object.__setattr__(self, name, tuple(getattr(self, name)))
            except TypeError:
                given = getattr(self, name)
                raise ArgumentError(name, f"must be a list, not {given!r}") from None
        if self.workspace is not None:
            check_kind("workspace", self.workspace, Workspace)
        for i, item in enumerate(cast("tuple[object, ...]", self.objects)):
            if type(item) not in KINDS:  # fast path: `check_kind` is slower
                check_kind(f"objects[{i}]", item, *KINDS)
        for i, hand in enumerate(self.hands):
            check_kind(f"hands[{i}]", hand, Hand)
        _unique("objects", [item.name for item in self.objects if item.name])
        _unique("hands", [hand.name for hand in self.hands])

    def put(self, *items: Object) -> Scene:
        """Return the scene with these objects: each replaces the object of its name, or is appended."""
        objects, index, rows = list(self.objects), self._index, set[int]()
        for item in items:
            check_kind("items", item, *KINDS)
            i = index.get(item.name) if item.name else None
            if i is None:
                if item.name:
                    if index is self._index:  # shared with other scenes
                        index = index.copy()
                    index[item.name] = len(objects)
                objects.append(item)
            else:
                objects[i] = item
                rows.add(i)
        old = len(self.objects)
        bounds = np.concatenate([self.bounds, _bounds(objects[old:])])
        for i in rows:
            if i < old:
                bounds[i] = _bound(objects[i])
        until = max([self.moves_until, *(_until(item) for item in items)])
        return self._with(tuple(objects), _index=index, bounds=bounds, moves_until=until)

    def remove(self, *names: str) -> Scene:
        """Return the scene without the objects of these names. Unknown names are ignored."""
        gone = sorted({self._index[name] for name in names if name in self._index})
        if not gone:
            return self
        objects = list(self.objects)
        for i in reversed(gone):
            del objects[i]
        bounds = np.delete(self.bounds, gone, axis=0)
        return self._with(tuple(objects), bounds=bounds, moves_until=self.moves_until)

    def with_hands(self, *hands: Hand) -> Scene:
        """Return the scene with these hands instead of its own."""
        made = replace(self, objects=(), hands=hands)
        # computed on this scene, so that all scenes derived from it share the cached values
        made.__dict__.update(objects=self.objects, bounds=self.bounds, moves_until=self.moves_until)
        if "_index" in self.__dict__:
            made.__dict__["_index"] = self._index
        return made

    @functools.cached_property
    def bounds(self) -> Floats:
        """Bounding spheres of the objects, (objects, 8): centre [m], velocity [m/s], time [s], radius [m]."""
        return _bounds(self.objects)

    def check_files(self) -> None:
        """Refuse objects whose files (waves, meshes, pictures) do not exist. Raises ArgumentError, which names them."""
        for number, item in enumerate(self.objects):
            for field, file in _find_files(item):
                if not PathOfFile(file).is_file():
                    name = repr(item.name) if item.name else f"number {number}"
                    raise ArgumentError(
                        field, f"of object {name} needs {file}, which is not there, or not a file"
                    )

    @functools.cached_property
    def _index(self) -> dict[str, int]:
        return {item.name: i for i, item in enumerate(self.objects) if item.name}

    @functools.cached_property
    def moves_until(self) -> float:
        """Upper bound of the time when all objects have stopped, unless they are updated [s]."""
        return max(map(_until, self.objects), default=-math.inf)

    @card
    def _repr_html_(self) -> Card:
        box = self.workspace
        rows = {
            "hands": ", ".join(h.name + " (lost)" * h.lost for h in self.hands) or "none",
            "workspace": "everywhere" if box is None else f"{box.lower} to {box.upper} m",
        }
        head = "name", "what", "position [mm]", "pressure [Pa]"
        table = [
            (i.name or "-", _kind(i), _place(i), f"{i.pressure:.3g}")
            for i in self.objects[:MAX_ROWS]
        ]
        count = len(self.objects)
        draw = self._draw if count or self.hands else None
        return Card(f"Scene of {count} objects", rows, [head, *table], count, draw)

    def _draw(self, panel: Any) -> None:
        """Draw the objects' bounding spheres and the hands' joints from the side."""
        from matplotlib.patches import Circle

        for x, _, z, *_, radius in 1e3 * self.bounds[:MAX_DRAWN]:
            panel.add_patch(Circle((x, z), max(radius, 2.0), alpha=0.5))
        for hand in self.hands:
            if not hand.lost:
                panel.plot(*(1e3 * hand.carriers[:, [0, 2]].T), ".", color="tab:orange", ms=2)
        panel.autoscale_view()
        panel.set(xlabel="x [mm]", ylabel="z [mm]", aspect="equal", adjustable="datalim")

    def _with(self, objects: tuple[Object, ...], **cached: Any) -> Scene:
        """Return this scene with other objects, without checking them again."""
        made = object.__new__(Scene)
        made.__dict__.update(objects=objects, workspace=self.workspace, hands=self.hands, **cached)
        return made


def _find_files(part: Struct, field: str = "") -> Iterator[tuple[str, str]]:
    """Yield the files of an object and its parts, each with the object's field that needs it."""
    for name in part.__struct_fields__:
        value = getattr(part, name)
        if name == "file" and isinstance(value, str) and value:
            yield field, value
        for inner in value if isinstance(value, tuple) else (value,):
            if not isinstance(inner, Struct):
                break  # tuples are of one kind, and may be long
            yield from _find_files(inner, field or name)


def _kind(item: Object) -> str:
    return type(item).__name__.lower()


def _place(item: Object) -> str:
    return " ".join(f"{1e3 * v:.0f}" for v in item.pose.position)


def _bounds(objects: Iterable[Object]) -> Floats:
    return np.array([_bound(item) for item in objects]).reshape(-1, 8)


def _bound(item: Object) -> tuple[float, ...]:
    x, y, z = item.position if isinstance(item, Point) else item.pose.position
    radius = item.bounding_radius + item.material.reach
    if item.motion is None:
        return x, y, z, 0.0, 0.0, 0.0, 0.0, radius
    u, v, w = item.motion.velocity
    return x, y, z, u, v, w, item.motion.time, radius


def _until(item: Object) -> float:
    motion = item.motion
    if motion is None or motion.velocity == motion.angular_velocity == STILL:
        return -math.inf
    return motion.time + MAX_EXTRAPOLATION


def _unique(name: str, names: list[str]) -> None:
    if len(set(names)) != len(names):
        twice = next(word for word, n in Counter(names).items() if n > 1)
        raise ArgumentError(name, f"must have unique names: two are called {twice!r}")
