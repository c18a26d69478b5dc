"""Textures: pressure that varies over a surface.

The factor on the pressure depends on the place alone, not on time: a finger that rests on ridges feels them, and one
that sweeps across them vibrates, at its speed divided by the texture's period.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.argument_checks import check_length, check_number
from pacinian.errors import ArgumentError
from pacinian.scene.shapes.array_data import check_within, decode_array, encode_array

if TYPE_CHECKING:
    from pacinian.types import ArrayLike, Floats

    Values = ArrayLike
else:  # the types that a scene file may hold
    Values = bytes | tuple[tuple[float, ...], ...]

MAX_SIDE = 1024  # largest part of a picture whose period is computed, in rows and in columns
MIN_POWER = 1e-12  # smallest variance of factors that counts as a texture
LINES = 64  # number of values per period of a grating


class Texture(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, dict=True):
    """A factor on the pressure over x and y of an object's own frame, the same at every z.

    values: 0..1, in rows as in a picture seen from +z, so that the first row is at the largest y. file: a .npy file or
    a picture (white is 1), instead of values; a scene file gives it relative to its own folder. size: of the texture in
    x and y, centred on the origin [m]. repeat: whether the texture repeats outside this size; if not, its edge values
    continue. Raises ArgumentError.
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
        """Values, (R, C); y increases with the row, x with the column."""
        values = decode_array("values", self.values, self.file, 2)
        check_within("values", values)
        factors = values[::-1].astype(np.float64)
        factors.setflags(write=False)
        return factors

    @cached_property
    def period(self) -> float:
        """Period of the texture's detail [m]: half of its variance has longer periods, half has shorter ones.

        Of stripes of equal widths it is their period. Infinite if the texture is even. Of large pictures, only the
        middle counts.
        """
        R, C = self.factors.shape
        rows, columns = min(R, MAX_SIDE), min(C, MAX_SIDE)
        top, left = (R - rows) // 2, (C - columns) // 2
        part = self.factors[top : top + rows, left : left + columns]
        power = np.abs(np.fft.fft2(part - part.mean())) ** 2
        across = np.fft.fftfreq(rows, self.size[1] / R)[:, None]
        frequency = np.hypot(across, np.fft.fftfreq(columns, self.size[0] / C)).ravel()  # [1/m]
        order = np.argsort(frequency)
        shares = np.cumsum(power.ravel()[order])
        if not shares[-1] > MIN_POWER * part.size:
            return math.inf
        half = int(np.searchsorted(shares, 0.5 * shares[-1]))
        return float(1.0 / frequency[order[half]])

    def at(self, points: Floats) -> Floats:
        """Return the factor, interpolated bilinearly, at points of the object's own frame, (K, 3) [m]: (K,)."""
        from scipy.ndimage import map_coordinates

        (R, C), (width, height) = self.factors.shape, self.size
        at = np.empty((2, len(points)))
        at[0] = points[:, 1] * (R / height) + (R - 1) / 2.0
        at[1] = points[:, 0] * (C / width) + (C - 1) / 2.0
        return map_coordinates(
            self.factors, at, order=1, mode="grid-wrap" if self.repeat else "nearest"
        )


def apply_texture(texture: Texture | None, points: Floats, pressed: Floats) -> None:
    """Multiply pressures [Pa] or forces [N], (K,), in place, by the texture's factor at their points.

    texture: None leaves them as they are. points: in the object's own frame, (K, 3) [m].
    """
    if texture is not None:
        pressed *= texture.at(points)


def grating(period: float, duty: float = 0.5) -> Texture:
    """Make stripes along y that repeat every `period` [m] in x. The fraction `duty` presses. Raises ArgumentError."""
    pressed = check_number("duty", duty, low=0.0, high=1.0) * LINES
    stripe = np.clip(pressed - np.arange(LINES), 0.0, 1.0)
    return Texture(values=stripe[None], size=(check_length("period", period), period))
