"""Transducer types: frequency, strength and directivity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from pacinian.acoustics.directivity import omni, t4010a1
from pacinian.argument_checks import check_number

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.types import Floats


@dataclass(frozen=True, kw_only=True)
class Transducer:
    """A type of transducer.

    frequency: [Hz].
    pressure: P0, peak sound pressure at 1 m on the axis at full drive [Pa m]. Published values for a
        T4010A1: 3.4, 4.386 (AUTD3 software, taken as peak), 6.0, 8.02.
    directivity: D(cos(theta)), any function of an array. All directivities except `omni` are zero behind.
    Raises ArgumentError.
    """

    frequency: float = 40_000.0
    pressure: float = 1.0
    directivity: Callable[[Floats], Floats] = omni

    def __post_init__(self) -> None:
        frequency = check_number("frequency", self.frequency, low=1.0, high=1e9)
        object.__setattr__(self, "frequency", frequency)
        object.__setattr__(
            self, "pressure", check_number("pressure", self.pressure, low=1e-6, high=1e6)
        )


IDEAL = Transducer()
"""Omnidirectional, 1 Pa at 1 m."""

T4010A1 = Transducer(pressure=4.386, directivity=t4010a1)
"""The transducer type of the AUTD units."""
