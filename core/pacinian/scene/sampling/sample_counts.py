"""Counts of samples: what each object asks for, and what becomes of it."""

from __future__ import annotations

from collections import Counter, defaultdict
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.region_numbers import BESIDE
from pacinian.scene.sampling.samples import no_samples

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Flags, Indices

COARSENED = "coarsened"
OVER_BUDGET = "over budget"
MERGED = "merged"
FAINT = "too faint to feel"
OUTSIDE = "outside the workspace"
FAR = "out of reach"
ON_TRANSDUCER = "on a transducer"
LEFT_OUT = frozenset({COARSENED, OVER_BUDGET, MERGED, FAINT, OUTSIDE, FAR, ON_TRANSDUCER})
"""Reasons why samples are left out. Every other reason changes what is rendered."""
PRESSURE_LIMITED = "pressure limited"
TOO_FINE = "texture too fine"
TOO_FAST = "too fast for the device"
FACES_AWAY = "on skin that faces away"
NO_SURFACE = "no surface found"
HAND_LOST = "lost"
HAND_FADING = "fading"


class ObjectSampleCounts(NamedTuple):
    """What one object asks for at one time.

    asked: samples at the intended spacing that press; estimated from the area for objects of more than twice the
    budget. rendered: samples that the solver is given. force: of these, at full envelope [N]. reasons: why samples are
    left out or changed, and how many; `asked` minus `rendered` is the sum over the reasons in `LEFT_OUT`.
    """

    asked: int
    rendered: int
    force: float
    reasons: dict[str, int]

    @property
    def left_out(self) -> int:
        """Number of samples that are left out."""
        return sum(count for reason, count in self.reasons.items() if reason in LEFT_OUT)


class SampleCounts:
    """Counts the samples that the objects of a scene ask for, and those that are left out or changed.

    items: the scene's objects. samples: those that are rendered, before ramps.
    """

    def __init__(self, items: tuple[Object, ...] = ()) -> None:
        self.samples = no_samples(items)
        self._items = items
        self._asked: Counter[int] = Counter()
        self._reasons: defaultdict[str, Counter[int]] = defaultdict(Counter)
        self._hands: dict[str, dict[str, int]] = {}
        self._dropped: Flags | None = None

    def ask(self, index: int, count: int) -> None:
        """Count samples that the object of this index asks for."""
        self._asked[index] += count

    def note(self, reason: str, index: int, count: int = 1) -> None:
        """Count samples of the object of this index that are left out or changed for a reason."""
        if count:
            self._reasons[reason][index] += count

    def note_object(self, reason: str, index: int) -> None:
        """Note that the object of this index is changed as a whole."""
        self._reasons[reason][index] = 1

    def note_rows(self, reason: str, samples: Samples, rows: Flags | Indices) -> None:
        """Count these rows of samples, (M,), by their objects."""
        for index, count in Counter(samples.objects[rows].tolist()).items():
            self.note(reason, index, count)

    def drop(self, reason: str, rows: Flags) -> None:
        """Count these rows of `samples`, (M,), as left out."""
        self.note_rows(reason, self.samples, rows & (self.samples.radiation_pressure > 0.0))
        self._dropped = rows if self._dropped is None else self._dropped | rows

    def note_hand(self, reason: str, name: str) -> None:
        """Note that all that a hand feels is left out or changed."""
        self._hands[f"hand {name}".rstrip()] = {reason: 1}

    def total(self, reason: str) -> int:
        """Return the number of samples of all objects for a reason."""
        return self._reasons[reason].total() if reason in self._reasons else 0

    @property
    def clean(self) -> bool:
        """Whether nothing is left out or changed."""
        return not self._reasons and not self._hands

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """Labels of the objects that ask for samples, see `label_object`."""
        return tuple(label_object(self._items[i], i) for i in self._asked)

    @cached_property
    def objects(self) -> dict[str, ObjectSampleCounts]:
        """The counts of each object that asks for samples, by label."""
        samples = self.samples
        own = samples.regions != BESIDE
        own = own if self._dropped is None else own & ~self._dropped
        force = samples.radiation_pressure[own] * samples.area[own]
        forces = np.bincount(samples.objects[own], force, len(self._items)).tolist()
        made: dict[str, ObjectSampleCounts] = {}
        for i, label in zip(self._asked, self.labels, strict=True):
            reasons = {reason: rows[i] for reason, rows in self._reasons.items() if rows[i]}
            one = ObjectSampleCounts(self._asked[i], 0, forces[i], reasons)
            made[label] = one._replace(rendered=one.asked - one.left_out)
        return made

    @cached_property
    def deviations(self) -> dict[str, dict[str, int]]:
        """The reasons of each object or hand that has any, by label."""
        found: defaultdict[str, dict[str, int]] = defaultdict(dict)
        for reason, rows in self._reasons.items():
            for i, count in rows.items():
                found[label_object(self._items[i], i)][reason] = count
        return {**found, **self._hands}


def label_object(item: Object, index: int) -> str:
    """Return the name of an object, or its type and its index in the scene if it has none."""
    return item.name or f"{type(item).__name__.lower()} {index}"


def label_samples(samples: Samples) -> Iterator[str]:
    """Yield the label of each object that has samples, those that have left the scene included."""
    for i in set(samples.objects.tolist()):
        yield label_object(samples.items[i], i)
