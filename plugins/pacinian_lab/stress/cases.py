"""All problems, family by family."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian_lab.stress import demands, places, regions

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from pacinian_lab.stress.case import Case

FAMILIES: dict[str, Callable[[], Iterable[Case]]] = {
    make.__name__: make
    for make in (
        places.coincident, places.touching, places.mirror, places.duplicate, places.rank,
        places.condition, places.offset, places.media,
        demands.extreme, demands.saturated, demands.limits, demands.size, demands.moves,
        regions.regions,
    )
}  # fmt: skip
EVERY = 5  # a quick run takes one problem of so many of each family, of those that are not slow


def cases(quick: bool = False) -> list[Case]:
    """All problems, or a sample of them."""
    found: list[Case] = []
    for make in FAMILIES.values():
        family = list(make())
        found += [case for case in family if not case.slow][::EVERY] if quick else family
    return found


def find(name: str) -> Case:
    """The problem of that name. Raises KeyError."""
    return {case.name: case for case in cases()}[name]
