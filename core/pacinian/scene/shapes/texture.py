"""Pressure that varies over a surface."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.checks import check_length, check_number
from pacinian.errors import ArgumentError
from pacinian.scene.shapes.arrays import check_within, decode_array, encode_array

if TYPE_CHECKING:
    from pacinian.types import ArrayLike, Floats

    Values = ArrayLike
else:  # what a scene file may hold
    Values = bytes | tuple[tuple[float, ...], ...]

LINES = 64  # across one period of a grating


class Texture(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, dict=True):
    """A factor on pressure over x and y of an object's own frame, the same at every z.

    values: 0..1, in rows as in a picture that is looked at from +z, the first row at the far end of y; or
    file: a .npy file, or a picture (white is 1); in a scene file from that file's folder. size: of the
    whole in x and y, about the origin [m]. repeat: beyond that it is repeated; or else as on its rim.
    Raises ArgumentError.
    """

    values: Values | None = None
    size: tuple[float, float]
    repeat: bool = True
    file: str = ""

    def __post_init__(self) -> None:
        try:
            width, height = self.size
        except (TypeError, ValueError):
            raise ArgumentError("size", f"must be two lengths, not {self.size!r}") from None
        force_setattr(self, "size", (check_length("size", width), check_length("size", height)))
        force_setattr(self, "values", encode_array("values", self.values, self.file, 2))
        if not self.file:
            _ = self.factors

    @cached_property
    def factors(self) -> Floats:
        """Its values, (R, C); y grows with the row, x with the column."""
        values = decode_array("values", self.values, self.file, 2)
        check_within("values", values)
        factors = values[::-1].astype(np.float64)
        factors.setflags(write=False)
        return factors

    def at(self, points: Floats) -> Floats:
        """The factor at points of the object's own frame, (K, 3) [m], (K,); bilinear."""
        from scipy.ndimage import map_coordinates

        (R, C), (width, height) = self.factors.shape, self.size
        at = np.empty((2, len(points)))
        at[0] = points[:, 1] * (R / height) + (R - 1) / 2.0
        at[1] = points[:, 0] * (C / width) + (C - 1) / 2.0
        return map_coordinates(
            self.factors, at, order=1, mode="grid-wrap" if self.repeat else "nearest"
        )


def grating(period: float, duty: float = 0.5) -> Texture:
    """Stripes along y, `period` [m] apart in x, of which a share `duty` presses. Raises ArgumentError."""
    pressed = check_number("duty", duty, low=0.0, high=1.0) * LINES
    stripe = np.clip(pressed - np.arange(LINES), 0.0, 1.0)
    return Texture(values=stripe[None], size=(check_length("period", period), period))
