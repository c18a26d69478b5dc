"""Whether quiet zones can be kept yet: they are prepared beside the loop, which is silent until then."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.errors import ArgumentError
from pacinian.solving.nulls import Preparation
from pacinian.solving.problem import Budget

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.solving.problem import Limits

AT_ONCE = Budget.until(0.0)


class Quieting:
    """Prepares quiet zones for an array in a medium. note: what people should know while they are not ready."""

    def __init__(self, array: Array, medium: Air) -> None:
        self.note = ""
        self._array, self._medium = array, medium
        self._preparation = Preparation()

    def is_ready(self, limits: Limits) -> bool:
        """Whether the zones of these limits are prepared; it does not wait."""
        self.note = ""
        if not limits.zones:
            return True
        rms = limits.rms(len(self._array))
        try:
            made = self._preparation.nulls(self._array, self._medium, limits.zones, rms, AT_ONCE)
        except ArgumentError as error:
            self.note = f"silent: {error}"
            return False
        if made is None:
            self.note = "silent: the quiet zones are being prepared"
        return made is not None
