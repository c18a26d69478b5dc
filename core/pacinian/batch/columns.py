"""Solutions as columns, one for each attribute: to send many of them costs little more than to send one.

Pickled one by one, solutions of a few points take half as long to send as to compute.
"""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pacinian.solving.solution import Solution
from pacinian.solving.targets import Targets

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

SOLUTION, TARGETS = ({field.name: None for field in fields(kind)} for kind in (Solution, Targets))


class Column(NamedTuple):
    """One attribute of n objects: `rows` is an array, (n, ...), or a list; or `same` is that of all of them."""

    rows: Any
    same: Any
    writeable: bool

    def cells(self, count: int) -> Iterable[Any]:
        """Return the attribute of each object."""
        if self.rows is None:
            return [self.same] * count
        if isinstance(self.rows, list):
            return self.rows
        self.rows.flags.writeable = self.writeable
        views: Iterable[Any] = self.rows
        return views


def to_columns(solutions: Sequence[Solution]) -> list[dict[str, Column]]:
    """Return the attributes of one or more solutions, and those of their targets, as columns."""
    targets = [one.targets for one in solutions]
    made = {name: _make_column(solutions, name) for name in SOLUTION if name != "targets"}
    return [made, {name: _make_column(targets, name) for name in TARGETS}]


def from_columns(columns: Sequence[dict[str, Column]], count: int) -> list[Solution]:
    """Return the solutions of `to_columns`."""
    made, asked = columns
    targets = _make_objects(Targets, asked, count)
    solutions = _make_objects(Solution, made, count)
    for one, target in zip(solutions, targets, strict=True):
        vars(one)["targets"] = target
    return solutions


def _make_column(objects: Sequence[object], name: str) -> Column:
    cells = [vars(one)[name] for one in objects]
    first = cells[0]
    if all(cell is first for cell in cells):
        return Column(None, first, writeable=True)
    if isinstance(first, np.ndarray):
        kind = first.shape, first.dtype, first.flags.writeable
        if all(
            isinstance(cell, np.ndarray) and (cell.shape, cell.dtype, cell.flags.writeable) == kind
            for cell in cells
        ):
            return Column(np.array(cells), None, first.flags.writeable)
    return Column(cells, None, writeable=True)


def _make_objects(kind: type[Any], columns: dict[str, Column], count: int) -> list[Any]:
    """Make objects from their attributes, which were checked where they come from."""
    rows = zip(*(column.cells(count) for column in columns.values()), strict=True)
    made: list[Any] = []
    for row in rows:
        one = object.__new__(kind)
        vars(one).update(zip(columns, row, strict=True))
        made.append(one)
    return made
