"""What all objects have in common: how strong, how over time, how hard, how it moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import force_setattr

from pacinian.checks import check_integer, check_kind, check_number
from pacinian.errors import ArgumentError
from pacinian.scene.material import FIRM, Material
from pacinian.scene.modulation.envelope import STEADY, Envelope, Wave, resolve
from pacinian.scene.modulation.technique import AM, LM, SIMULTANEOUS, STM, Simultaneous, Technique
from pacinian.scene.motion import Motion

if TYPE_CHECKING:
    from collections.abc import Iterator

MIN_AREA = 1e-12  # [m^2]
MAX_PRESSURE = 1e30  # [Pa], [N]
MAX_COUNT = 1_000_000


class HapticObject(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What all objects have.

    radiation_pressure: [Pa], or force: [N] over the whole of it, or of a point's focus; with a hand, the most that it
    presses with. envelope: over time, or a preset's name. technique: how its samples are presented in time.
    material: from depth to pressure. motion: since it was seen at its pose. priority: higher ones get
    samples first. name: what it is called in messages; a later object of the same name replaces it.
    """

    radiation_pressure: float | None = None
    force: float | None = None
    envelope: Envelope = STEADY
    technique: Technique = SIMULTANEOUS
    material: Material = FIRM
    motion: Motion | None = None
    priority: int = 0
    name: str = ""

    @property
    def focal(self) -> bool:
        """Whether its force is that of a focus, so that the pressure depends on the array: see `Sampler`."""
        return False

    def load(self) -> Iterator[str]:
        """Read its files, if it has any: tells of each field before it is looked at. Raises ArgumentError."""
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
        if self.material is not FIRM:
            check_kind("material", self.material, Material)
        if self.motion is not None:
            check_kind("motion", self.motion, Motion)
        if self.priority != 0:
            force_setattr(
                self, "priority", check_integer("priority", self.priority, low=-MAX_COUNT)
            )
        if type(self.name) is not str:
            raise ArgumentError("name", f"must be a text, not {self.name!r}")

    def _pressure(self, area: float) -> float:
        """Radiation pressure [Pa] over `area` [m^2]."""
        if self.radiation_pressure is not None:
            return self.radiation_pressure
        return (self.force or 0.0) / max(area, MIN_AREA)
