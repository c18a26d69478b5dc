"""Sweeps: a list in place of a value in a study file stands for each of its values in turn."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeAlias, TypeVar

from msgspec import Struct
from msgspec.structs import replace

from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

Number: TypeAlias = float | tuple[float, ...]
Count: TypeAlias = int | tuple[int, ...]
Word: TypeAlias = str | tuple[str, ...]

MAX_COMBINATIONS = 100_000  # maximum number of combinations

T = TypeVar("T")
S = TypeVar("S", bound=Struct)


@dataclass(frozen=True)
class Entry(Generic[S]):
    """One of the items that a part of a study file stands for.

    label: its name or its type, with the swept values. value: the item, without sweeps.
    """

    label: str
    value: S


def check_single(value: T | tuple[T, ...]) -> T:
    """Return a value that is not swept. Raises ArgumentError."""
    if isinstance(value, tuple):
        raise ArgumentError("value", f"must be one, not a sweep: {value}")
    return value


def check_each(name: str, values: T | tuple[T, ...], check: Callable[[str, T], object]) -> None:
    """Check a value, or all swept values. Raises ArgumentError."""
    if not isinstance(values, tuple):
        check(name, values)
        return
    if not values:
        raise ArgumentError(name, "is swept over nothing: give at least one value")
    for i, value in enumerate(values):
        check(f"{name}[{i}]", value)
        if value in values[:i]:
            raise ArgumentError(name, f"has {value!r} twice")


def iterate_combinations(values: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield all combinations of the swept values, with the last one varying fastest. Raises ArgumentError."""
    swept = {name: value for name, value in values.items() if isinstance(value, tuple)}
    if (count := math.prod(map(len, swept.values()))) > MAX_COMBINATIONS:
        raise ArgumentError(
            ", ".join(swept), f"are swept over {count} combinations: more than {MAX_COMBINATIONS}"
        )
    for each_of in itertools.product(*swept.values()):
        yield dict(zip(swept, each_of, strict=True))


def entries(item: S, whole: Iterable[str] = ()) -> list[Entry[S]]:
    """Return all items that a part of a study file stands for.

    whole: fields whose tuples are values, not sweeps.
    """
    fields = {n: getattr(item, n) for n in item.__struct_fields__ if n not in whole}
    name = fields.get("name") or item.__struct_config__.tag or type(item).__name__.lower()
    return [
        Entry(format_label(str(name), values), replace(item, **values))
        for values in iterate_combinations(fields)
    ]


def format_label(label: str, values: dict[str, Any]) -> str:
    """Return a label with values: `lattice pitch=0.01, width=0.2`."""
    texts = [f"{k}={v:g}" if isinstance(v, float) else f"{k}={v}" for k, v in values.items()]
    return f"{label} {', '.join(texts)}" if texts else label
