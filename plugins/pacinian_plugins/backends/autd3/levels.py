"""Conversion of Pacinian's levels to those of AUTD3."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian_plugins.backends.autd3.units import UNIT

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from pacinian.types import Levels
    from pacinian_plugins.backends.autd3.units import Layout

PHASES, INTENSITIES = 256, 256
PERIOD = 512  # steps of pulse width per period of the ultrasound

_intensities = np.arange(INTENSITIES)
WIDTHS = np.round(PERIOD * np.arcsin(_intensities / (INTENSITIES - 1)) / np.pi).astype(int)
"""Pulse width of each intensity [steps], as in the device's own table."""
_widths, _first = np.unique(WIDTHS, return_index=True)
SIZES: tuple[float, ...] = tuple(np.sin(np.pi * _widths / PERIOD).tolist())
"""Distinct sound pressures, relative to the strongest; some of the weaker intensities make the same pulse."""
LEVELS = len(SIZES)
INTENSITY: NDArray[np.uint8] = _intensities[_first].astype(np.uint8)
"""Intensity of each distinct sound pressure."""


class Packer:
    """Converts rows of levels to the phases and intensities of the units, (rows, units, 249)."""

    def __init__(self, layout: Layout) -> None:
        self._units, self._places = len(layout.units), layout.places
        self._all = len(self._places) == UNIT * self._units

    def pack(self, phase: Levels, amplitude: Levels) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
        """Pack rows, (K, N). AUTD3 phases are lags, ours are leads. Raises ValueError for levels out of range."""
        if (
            phase.shape[1] != len(self._places)
            or phase.max() >= PHASES
            or amplitude.max() >= LEVELS
        ):
            raise ValueError(f"levels of {phase.shape[1]} transducers")
        delay = (-phase.astype(np.int16)).astype(np.uint8)  # modulo 256, one turn
        return self._place_levels(delay), self._place_levels(INTENSITY[amplitude])

    def _place_levels(self, levels: NDArray[np.uint8]) -> NDArray[np.uint8]:
        if not self._all:
            made = np.zeros((len(levels), UNIT * self._units), np.uint8)
            made[:, self._places] = levels
            levels = made
        return levels.reshape(len(levels), self._units, UNIT)
