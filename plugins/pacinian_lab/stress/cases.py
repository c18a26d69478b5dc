"""All problems, family by family."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian_lab.stress.extreme_problems import extreme, limits, moves, saturated, size
from pacinian_lab.stress.ill_conditioned_problems import (
    coincident,
    condition,
    duplicate,
    media,
    mirror,
    offset,
    rank,
    touching,
)
from pacinian_lab.stress.region_problems import regions

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from pacinian_lab.stress.case import Case

FAMILIES: dict[str, Callable[[], Iterable[Case]]] = {
    make.__name__: make
    for make in (
        coincident, touching, mirror, duplicate, rank, condition, offset, media,
        extreme, saturated, limits, size, moves,
        regions,
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
