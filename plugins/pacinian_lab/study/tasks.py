"""The tasks of a study: their inputs, their labels, and the keys of all that their results depend on."""

from __future__ import annotations

import functools
import hashlib
import importlib.metadata
import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import msgspec
import numpy as np
from msgspec.structs import replace

from pacinian.errors import ArgumentError, PacinianError, SceneFileError
from pacinian.plugins import registry
from pacinian_lab.study.sweep import Entry, entries
from pacinian_lab.study.worker import Batch, Job

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    import pacinian as pc
    from pacinian_lab.study.layouts import Layout
    from pacinian_lab.study.patterns import Pattern, PatternPoints
    from pacinian_lab.study.planes import Plane
    from pacinian_lab.study.study_file import Method, Study

MAX_TASKS = 100_000  # maximum number of tasks
# points times transducers; several copies of B are held, 16 bytes per element
MAX_ELEMENTS = 10_000_000
BATCH = 8  # maximum number of tasks in a batch

T = TypeVar("T")


@dataclass(frozen=True)
class Place:
    """The place of a task: a layout, a plane and a pattern."""

    layout: Entry[Layout]
    plane: Entry[Plane]
    pattern: Entry[Pattern]


@dataclass(frozen=True)
class Task:
    """One row of the results.

    key: of all that the results depend on, and of nothing else. level: as in `Study.levels`.
    """

    key: str
    place: Place
    method: Entry[Method]
    level: float


class Plan:
    """The tasks of a study.

    tasks: all of them, layout by layout, with the levels varying fastest. path: the name of the study in errors.
    Raises SceneFileError, which names the key and the fix, before anything runs.
    """

    def __init__(self, study: Study, path: str = "study") -> None:
        self.study, self._path = _convert_types(study, path), path
        study = self.study
        layouts = self._expand_part("layouts", study.layouts, entries)
        planes = self._expand_part("planes", study.planes, entries)
        patterns = self._expand_part("patterns", study.patterns, lambda p: entries(p, p.whole))
        methods = self._expand_part("solvers", study.methods, lambda m: m.entries())
        parts = (layouts, planes, patterns, methods)
        if (count := math.prod(map(len, (*parts, study.levels)))) > MAX_TASKS:
            raise SceneFileError(path, "$", f"makes {count} tasks: more than {MAX_TASKS}")
        self._check_items(methods, lambda m: m.make())
        N = max(self._check_items(layouts, lambda layout: len(self.array(layout))))
        M = max(self._check_items(patterns, self._count))
        if N * M > MAX_ELEMENTS:
            problem = f"asks for {M} points of {N} transducers: more than {MAX_ELEMENTS} of both multiplied"
            raise SceneFileError(path, "$", problem)
        hows = [
            (method, level, [msgspec.to_builtins(method.value), _source(method.value.name), level])
            for method, level in itertools.product(methods.values(), study.levels)
        ]
        self.tasks: list[Task] = []
        for where in itertools.product(layouts.values(), planes.values(), patterns.values()):
            place = Place(*where)
            said = digest([self._world, *(self._list_inputs(part.value) for part in where)]).hex()
            for method, level, how in hows:
                self.tasks.append(Task(digest([said, *how]).hex(), place, method, level))
        self._twice()

    @functools.cached_property
    def digest(self) -> str:
        """Digest of all tasks' keys; it identifies the study."""
        return digest(sorted(task.key for task in self.tasks)).hex()

    def array(self, layout: Layout) -> pc.Array:
        """Return the array of a layout, the same in every task. Raises ArgumentError."""
        return layout.make(self.study.transducer.make(), self._rng(layout))

    def points(self, pattern: Pattern) -> PatternPoints:
        """Return the points and proportions of a pattern. Raises ArgumentError."""
        return pattern.make(self._rng(pattern))

    def batches(self, keys: Iterable[str] | None = None) -> list[Sequence[Task]]:
        """Return the tasks, or only those with given keys, in batches of one place each."""
        wanted = None if keys is None else set(keys)
        todo = [task for task in self.tasks if wanted is None or task.key in wanted]
        made: list[Sequence[Task]] = []
        for _, group in itertools.groupby(todo, lambda task: id(task.place)):
            same = list(group)
            made += [same[first : first + BATCH] for first in range(0, len(same), BATCH)]
        return made

    def batch(self, tasks: Sequence[Task]) -> Batch:
        """Return the message to a worker for tasks of one place."""
        place, study = tasks[0].place, self.study
        uv, proportions = self.points(place.pattern.value)
        return Batch(
            array=self.array(place.layout.value),
            plane=place.plane.value,
            uv=uv,
            proportions=proportions,
            medium=study.medium.make(),
            gain=None if study.gain == math.inf else study.gain,
            emitted=study.emitted,
            picture=study.picture,
            jobs=tuple(Job(task.key, task.method.value, task.level) for task in tasks),
        )

    @functools.cached_property
    def _world(self) -> list[Any]:
        study = self.study
        shared = (study.medium, study.transducer, study.gain, study.emitted, study.picture)
        return [importlib.metadata.version("pacinian"), *map(msgspec.to_builtins, shared)]

    def _list_inputs(self, item: Layout | Plane | Pattern) -> list[Any]:
        """Return what the results depend on, including the seed if the item is random."""
        return [_plain(item), self.study.seed if item.drawn else None]

    def _rng(self, item: Layout | Pattern) -> np.random.Generator:
        """Return a generator that depends only on the study's seed and on the item, not on any order."""
        own = int.from_bytes(digest(_plain(item)))
        return np.random.default_rng(np.random.SeedSequence([self.study.seed, own]))

    def _count(self, pattern: Pattern) -> int:
        """Return the number of points, and check that all of them are within the picture."""
        uv, _ = self.points(pattern)
        half, reach = self.study.picture.side / 2.0, float(np.abs(uv).max())
        if reach > half * (1.0 + 1e-9):
            raise ArgumentError(
                "picture.side",
                f"of {2.0 * half:g} m is too small: the pattern needs {2.0 * reach:g} m",
            )
        return len(uv)

    def _expand_part(
        self, part: str, items: Sequence[Any], expand: Callable[[Any], list[Entry[Any]]]
    ) -> dict[str, Entry[Any]]:
        """Expand a part of the file. Returns the items, by the name for errors: the key and the label."""
        made: dict[str, Entry[Any]] = {}
        labels: set[str] = set()
        for i, item in enumerate(items):
            key = f"$.{part}[{i}]"
            try:
                found = expand(item)
            except ArgumentError as error:
                raise SceneFileError(self._path, key, str(error)) from error
            for entry in found:
                if entry.label in labels:
                    problem = f"is called {entry.label!r}, as another one is: set `name`"
                    raise SceneFileError(self._path, key, problem)
                labels.add(entry.label)
                made[f"{key}: {entry.label}" if len(found) > 1 else key] = entry
        return made

    def _check_items(self, made: dict[str, Entry[Any]], check: Callable[[Any], T]) -> list[T]:
        """Return the results of a check of each item. Raises SceneFileError."""
        results: list[T] = []
        for key, entry in made.items():
            try:
                results.append(check(entry.value))
            except PacinianError as error:
                raise SceneFileError(self._path, key, str(error)) from error
        return results

    def _twice(self) -> None:
        first: dict[str, Task] = {}
        for task in self.tasks:
            if (same := first.setdefault(task.key, task)) is not task:
                labels = " and ".join(
                    f"{t.place.layout.label}, {t.place.pattern.label}, "
                    f"{t.method.label}, level {t.level:g}"
                    for t in (same, task)
                )
                raise SceneFileError(self._path, "$", f"has the same task twice: {labels}")


def _convert_types(study: Study, path: str) -> Study:
    """Return a study with its values converted to the fields' types, so that 1 becomes 1.0 for a length."""
    try:
        return msgspec.convert(msgspec.to_builtins(study), type(study))
    except msgspec.ValidationError as error:
        raise SceneFileError(path, "", str(error)) from error


def digest(value: Any) -> bytes:
    """Return a 16-byte digest of a value that JSON can represent."""
    return hashlib.blake2b(msgspec.json.encode(value, order="sorted"), digest_size=16).digest()


def _plain(item: Layout | Plane | Pattern) -> Any:
    """Return a part without its name, as plain data."""
    return msgspec.to_builtins(replace(item, name=""))


def _source(solver: str) -> str:
    """Return the distribution that ships a solver, with its version."""
    return registry.discover_plugins().find("solver", solver).distribution


def describe_task(task: Task) -> dict[str, Any]:
    """Return the row of a task before it runs: its key, labels and settings."""
    place = task.place
    row: dict[str, Any] = {
        "key": task.key,
        "layout": place.layout.label,
        "plane": place.plane.label,
        "pattern": place.pattern.label,
        "solver": task.method.label,
        "level": task.level,
    }
    for part, item in (
        ("layout", place.layout.value),
        ("plane", place.plane.value),
        ("pattern", place.pattern.value),
    ):
        if tag := item.__struct_config__.tag:
            row[f"{part}.type"] = tag
        for name in item.__struct_fields__:
            value = getattr(item, name)
            if name != "name" and isinstance(value, (int, float, str)):
                row[f"{part}.{name}"] = value
    return row
