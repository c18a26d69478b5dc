"""Layouts of the transducers on a board. All transducers face +z."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct

from pacinian.acoustics.array import autd
from pacinian.acoustics.pose import Vector
from pacinian.argument_checks import check_integer, check_length, check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.types import Floats

MAX_TRANSDUCERS = 4096  # transducers of one board
AUTD = 249  # transducers of an AUTD unit


class AutdUnit(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="autd"):
    """An AUTD unit: 249 transducers, row by row along x."""

    @property
    def count(self) -> int:
        """Number of transducers, L."""
        return AUTD

    def positions(self) -> Floats:
        """Return the positions of the transducers [m], (L, 3)."""
        return autd().positions


class Grid(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="grid"):
    """A grid centred on the board, row by row along x. pitch: distance of neighbours [m]. Raises ArgumentError."""

    columns: int = 16
    rows: int = 16
    pitch: float = 0.0105

    def __post_init__(self) -> None:
        check_integer("columns", self.columns, low=1)
        check_integer("rows", self.rows, low=1)
        if self.count > MAX_TRANSDUCERS:
            raise ArgumentError(
                "columns", f"x rows must be at most {MAX_TRANSDUCERS}, not {self.count}"
            )
        check_length("pitch", self.pitch)

    @property
    def count(self) -> int:
        """Number of transducers, L."""
        return self.columns * self.rows

    def positions(self) -> Floats:
        """Return the positions of the transducers [m], (L, 3)."""
        X, Y = np.meshgrid(
            *((np.arange(n) - (n - 1) / 2.0) * self.pitch for n in (self.columns, self.rows))
        )
        return np.asarray(np.stack([X, Y, 0.0 * X], axis=-1).reshape(-1, 3), np.float64)


class Places(Struct, frozen=True, forbid_unknown_fields=True, tag_field="type", tag="places"):
    """Arbitrary places. places: positions [m], (L, 3). Raises ArgumentError."""

    places: tuple[Vector, ...]

    def __post_init__(self) -> None:
        if not 1 <= len(self.places) <= MAX_TRANSDUCERS:
            raise ArgumentError("places", f"must be 1 to {MAX_TRANSDUCERS}, not {len(self.places)}")
        check_numbers("places", self.places, (None, 3))

    @property
    def count(self) -> int:
        """Number of transducers, L."""
        return len(self.places)

    def positions(self) -> Floats:
        """Return the positions of the transducers [m], (L, 3)."""
        return np.array(self.places)
