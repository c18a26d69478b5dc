"""Materials: how hard an object feels, as radiation pressure over penetration depth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.argument_checks import MAX_LENGTH, check_number

if TYPE_CHECKING:
    from pacinian.types import Floats

FULL_PRESSURE_DEPTH = 0.002  # depth of full pressure if no stiffness is given [m]


class Material(Struct, frozen=True, forbid_unknown_fields=True):
    """A bed of springs (Winkler's foundation): pressure is proportional to depth, up to the object's own pressure.

    stiffness: [Pa/m]. By default, the full pressure is reached at a depth of 2 mm. reach: margin outside the object
    where the pressure begins [m]. Raises ArgumentError.
    """

    stiffness: float | None = None
    reach: float = 0.0

    def __post_init__(self) -> None:
        if self.stiffness is not None:
            stiffness = check_number("stiffness", self.stiffness, low=0.0, above=True)
            force_setattr(self, "stiffness", stiffness)
        force_setattr(self, "reach", check_number("reach", self.reach, low=0.0, high=MAX_LENGTH))

    def compute_stiffness(self, most: float) -> float:
        """Return the stiffness [Pa/m] for an object whose full pressure is `most` [Pa]."""
        return most / FULL_PRESSURE_DEPTH if self.stiffness is None else self.stiffness

    def compute_full_depth(self, most: float) -> float:
        """Return the depth below the surface at which an object reaches its full pressure `most` [Pa]: [m]."""
        return max(0.0, most / self.compute_stiffness(most) - self.reach)

    def pressure(self, depth: Floats, most: float) -> Floats:
        """Return the radiation pressure [Pa], 0 to `most`, at `depth` [m] below the level where it begins.

        Points, paths and particles use it. `press` in scene/sampling/posed_skin.hpp is the same law for surfaces and
        volumes: change both.
        """
        return np.asarray(np.minimum(np.maximum(depth, 0.0) * self.compute_stiffness(most), most))


DEFAULT_MATERIAL = Material()
