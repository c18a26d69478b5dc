"""The base of all haptic objects: pressure or force, envelope, technique, material and motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.argument_checks import check_integer, check_kind, check_number
from pacinian.errors import ArgumentError
from pacinian.scene.material import DEFAULT_MATERIAL, Material
from pacinian.scene.modulation.envelope import STEADY, Envelope, Wave, resolve
from pacinian.scene.modulation.technique import AM, LM, SIMULTANEOUS, STM, Simultaneous, Technique
from pacinian.scene.motion import Motion

if TYPE_CHECKING:
    from collections.abc import Iterator

MIN_AREA = 1e-12  # smallest area of a point, and smallest area that a force is divided by [m^2]
MAX_PRESSURE = 1e30  # largest radiation pressure [Pa] or force [N]
MIN_PRIORITY = -1_000_000  # lowest priority


class HapticObject(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The parameters that all objects share.

    Give either radiation_pressure [Pa] or force [N]. The force is that of the whole object, or of the focus of a point.
    If the scene has a hand, this is the maximum with which the object presses. envelope: the amplitude over time, or
    the name of a preset. technique: how the samples are presented in time. material: pressure as a function of depth.
    motion: velocity since the object was seen at its pose. priority: objects of higher priority get samples first.
    name: identifies the object in messages; a later object of the same name replaces it.
    """

    radiation_pressure: float | None = None
    force: float | None = None
    envelope: Envelope = STEADY
    technique: Technique = SIMULTANEOUS
    material: Material = DEFAULT_MATERIAL
    motion: Motion | None = None
    priority: int = 0
    name: str = ""

    @property
    def focal(self) -> bool:
        """Whether the force is that of a focus, so that the pressure depends on the array (see `Sampler`)."""
        return False

    def load(self) -> Iterator[str]:
        """Read the object's files, if any. Yields the name of each field before checking it. Raises ArgumentError."""
        yield "envelope"
        if isinstance(self.envelope, Wave):
            self.envelope.at(np.zeros(1))

    def _check(self) -> None:
        if (self.radiation_pressure is None) == (self.force is None):
            raise ArgumentError("radiation_pressure", "or `force` must be given, and not both")
        for name in ("radiation_pressure", "force"):
            if (value := getattr(self, name)) is not None:
                force_setattr(self, name, check_number(name, value, low=0.0, high=MAX_PRESSURE))
        if self.envelope is not STEADY:
            force_setattr(self, "envelope", resolve(self.envelope))
        if self.technique is not SIMULTANEOUS:
            check_kind("technique", self.technique, Simultaneous, AM, STM, LM)
        if self.material is not DEFAULT_MATERIAL:
            check_kind("material", self.material, Material)
        if self.motion is not None:
            check_kind("motion", self.motion, Motion)
        if self.priority != 0:
            force_setattr(
                self, "priority", check_integer("priority", self.priority, low=MIN_PRIORITY)
            )
        if type(self.name) is not str:
            raise ArgumentError("name", f"must be a text, not {self.name!r}")

    def _pressure(self, area: float) -> float:
        """Radiation pressure [Pa] of the object, with a force spread over `area` [m^2]."""
        if self.radiation_pressure is not None:
            return self.radiation_pressure
        return (self.force or 0.0) / max(area, MIN_AREA)
