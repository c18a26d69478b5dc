"""The pose of the array in the level that the Unreal plugin plays, and conversions between both frames."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

PLACE, YAW = np.array([120.0, -40.0, 75.0]), 30.0  # of the array in the level [cm], [deg]
MIRROR = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def turn(yaw: float) -> NDArray[np.float64]:
    """Return Unreal's rotation about its z-axis: from x towards y, which is to the right."""
    c, s = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def level(points: Any) -> NDArray[np.float64]:
    """Convert from the array's frame [m] to the level [cm], (N, 3)."""
    local = 100.0 * np.atleast_2d(points) @ MIRROR.T
    return np.asarray(local @ turn(YAW).T + PLACE)


def array(points: Any) -> NDArray[np.float64]:
    """Convert from the level [cm] to the array's frame [m], (N, 3)."""
    return np.asarray((np.atleast_2d(points) - PLACE) @ turn(YAW) @ MIRROR / 100.0)


def numbers(given: Any) -> str:
    return " ".join(f"{x:.6f}" for x in np.ravel(given))
