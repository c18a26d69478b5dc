"""From penetration to pressure: how hard an object feels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.checks import FAR, check_number

if TYPE_CHECKING:
    from pacinian.types import Floats

DEPTH = 0.002  # [m] at which an object presses with all its pressure, unless told otherwise


class Material(Struct, frozen=True, forbid_unknown_fields=True):
    """A bed of springs (Winkler's foundation): pressure in proportion to depth, up to the object's own.

    stiffness: [Pa/m]; unless given, the object's whole pressure is felt 2 mm deep. reach: how far
    outside of the object it is felt already [m]. Raises ArgumentError.
    """

    stiffness: float | None = None
    reach: float = 0.0

    def __post_init__(self) -> None:
        if self.stiffness is not None:
            stiffness = check_number("stiffness", self.stiffness, low=0.0, above=True)
            force_setattr(self, "stiffness", stiffness)
        force_setattr(self, "reach", check_number("reach", self.reach, low=0.0, high=FAR))

    def per_metre(self, most: float) -> float:
        """Its stiffness [Pa/m] where the object presses with `most` [Pa]."""
        return most / DEPTH if self.stiffness is None else self.stiffness

    def enough(self, most: float) -> float:
        """The depth [m] below its surface from which an object presses with `most` [Pa]."""
        return max(0.0, most / self.per_metre(most) - self.reach)

    def pressure(self, depth: Floats, most: float) -> Floats:
        """Radiation pressure [Pa] at `depth` [m] below where it begins, 0 to `most` [Pa]."""
        return np.asarray(np.minimum(np.maximum(depth, 0.0) * self.per_metre(most), most))


FIRM = Material()
