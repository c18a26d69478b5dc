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
QUICK_STRIDE = 5  # a quick run takes every fifth problem of each family, without the slow ones


def cases(quick: bool = False) -> list[Case]:
    """Return all problems, or a sample of them."""
    found: list[Case] = []
    for make in FAMILIES.values():
        family = list(make())
        found += [case for case in family if not case.slow][::QUICK_STRIDE] if quick else family
    return found


def find(name: str) -> Case:
    """Return the problem of this name. Raises KeyError."""
    return {case.name: case for case in cases()}[name]
