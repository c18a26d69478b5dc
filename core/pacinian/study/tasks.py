"""The tasks of a study: what is to be done, what each is called, and what its numbers depend on."""

from __future__ import annotations

import functools
import hashlib
import importlib.metadata
import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
from msgspec.structs import replace

from pacinian.errors import ArgumentError, PacinianError, SceneFileError
from pacinian.plugins import registry
from pacinian.study.measuring import Batch, Job
from pacinian.study.sweep import Entry, entries

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    import pacinian as pc
    from pacinian.study.file import Method, Study
    from pacinian.study.layouts import Layout
    from pacinian.study.patterns import Made, Pattern
    from pacinian.study.planes import Plane

MOST = 100_000  # tasks
BATCH = 8  # tasks at most


@dataclass(frozen=True)
class Place:
    """Where something is asked: a layout, a plane, a pattern."""

    layout: Entry[Layout]
    plane: Entry[Plane]
    pattern: Entry[Pattern]


@dataclass(frozen=True)
class Task:
    """One row of the results.

    key: of all that its numbers depend on, and of nothing else. level: as in `Study.levels`.
    """

    key: str
    place: Place
    method: Entry[Method]
    level: float


class Plan:
    """What a study comes to.

    tasks: all of them, layout by layout, the levels quickest. path: what errors name.
    Raises SceneFileError, which names the key and the fix, before anything is begun.
    """

    def __init__(self, study: Study, path: str = "study") -> None:
        self.study, self._path = _typed(study, path), path
        study = self.study
        layouts = self._checked("layouts", study.layouts, entries, self.array)
        planes = self._checked("planes", study.planes, entries, lambda plane: plane.origin)
        patterns = self._checked(
            "patterns", study.patterns, lambda p: entries(p, p.whole), self._within
        )
        methods = self._checked("solvers", study.methods, lambda m: m.entries(), lambda m: m.make())
        count = math.prod(map(len, (layouts, planes, patterns, methods, study.levels)))
        if count > MOST:
            raise SceneFileError(path, "$", f"makes {count} tasks: more than {MOST}")
        hows = [
            (method, level, [msgspec.to_builtins(method.value), _source(method.value.name), level])
            for method, level in itertools.product(methods, study.levels)
        ]
        self.tasks: list[Task] = []
        for parts in itertools.product(layouts, planes, patterns):
            place = Place(*parts)
            where = digest([self._world, *(self._said(part.value) for part in parts)]).hex()
            for method, level, how in hows:
                self.tasks.append(Task(digest([where, *how]).hex(), place, method, level))
        self._twice()

    @functools.cached_property
    def digest(self) -> str:
        """Of all tasks' keys: another one is another study."""
        return digest(sorted(task.key for task in self.tasks)).hex()

    def array(self, layout: Layout) -> pc.Array:
        """The array of a layout, the same in whatever task. Raises ArgumentError."""
        return layout.make(self.study.transducer.make(), self._rng(layout))

    def points(self, pattern: Pattern) -> Made:
        """The points and proportions of a pattern. Raises ArgumentError."""
        return pattern.make(self._rng(pattern))

    def batches(self, keys: Iterable[str] | None = None) -> list[Sequence[Task]]:
        """The tasks, or only those of some keys, in batches of one place each."""
        wanted = None if keys is None else set(keys)
        todo = [task for task in self.tasks if wanted is None or task.key in wanted]
        made: list[Sequence[Task]] = []
        for _, group in itertools.groupby(todo, lambda task: id(task.place)):
            same = list(group)
            made += [same[first : first + BATCH] for first in range(0, len(same), BATCH)]
        return made

    def batch(self, tasks: Sequence[Task]) -> Batch:
        """What a worker is told of tasks of one place."""
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

    def _said(self, item: Layout | Plane | Pattern) -> list[Any]:
        """What numbers depend on: the seed, too, of what is drawn at random."""
        return [_plain(item), self.study.seed if item.drawn else None]

    def _rng(self, item: Layout | Pattern) -> np.random.Generator:
        """A generator that follows from the study's seed and from what is drawn, not from any order."""
        own = int.from_bytes(digest(_plain(item)))
        return np.random.default_rng(np.random.SeedSequence([self.study.seed, own]))

    def _within(self, pattern: Pattern) -> None:
        uv, _ = self.points(pattern)
        half, reach = self.study.picture.side / 2.0, float(np.abs(uv).max())
        if reach > half * (1.0 + 1e-9):
            raise ArgumentError(
                "picture.side",
                f"of {2.0 * half:g} m is too small: the pattern needs {2.0 * reach:g} m",
            )

    def _checked(
        self,
        part: str,
        items: Sequence[Any],
        expand: Callable[[Any], list[Entry[Any]]],
        check: Callable[[Any], object],
    ) -> list[Entry[Any]]:
        made: list[Entry[Any]] = []
        for i, item in enumerate(items):
            key = f"$.{part}[{i}]"
            try:
                found = expand(item)
            except ArgumentError as error:
                raise SceneFileError(self._path, key, str(error)) from error
            for entry in found:
                try:
                    check(entry.value)
                except PacinianError as error:
                    which = f"{entry.label}: " if len(found) > 1 else ""
                    raise SceneFileError(self._path, key, f"{which}{error}") from error
                if any(entry.label == other.label for other in made):
                    problem = f"is called {entry.label!r}, as another one: give `name`"
                    raise SceneFileError(self._path, key, problem)
                made.append(entry)
        return made

    def _twice(self) -> None:
        first: dict[str, Task] = {}
        for task in self.tasks:
            if (same := first.setdefault(task.key, task)) is not task:
                labels = " and ".join(
                    f"{t.place.layout.label}, {t.place.pattern.label}, "
                    f"{t.method.label}, level {t.level:g}"
                    for t in (same, task)
                )
                raise SceneFileError(self._path, "$", f"asks for the same twice: {labels}")


def _typed(study: Study, path: str) -> Study:
    """A study with the types that its fields have: 1 is 1.0 where a length is meant."""
    try:
        return msgspec.convert(msgspec.to_builtins(study), type(study))
    except msgspec.ValidationError as error:
        raise SceneFileError(path, "", str(error)) from error


def digest(value: Any) -> bytes:
    """16 bytes that follow from a value that JSON can hold."""
    return hashlib.blake2b(msgspec.json.encode(value, order="sorted"), digest_size=16).digest()


def _plain(item: Layout | Plane | Pattern) -> Any:
    """A part without what it is called."""
    return msgspec.to_builtins(replace(item, name=""))


def _source(solver: str) -> str:
    """Who ships a solver, and which version."""
    return registry.installed().find("solver", solver).distribution
