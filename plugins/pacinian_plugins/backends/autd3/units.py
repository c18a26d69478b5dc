"""Poses of an array's AUTD3 units, and the mapping of its transducers to their channels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

import pacinian as pc
from pacinian_plugins.backends.autd3.packages import NAME, import_package

if TYPE_CHECKING:
    from pacinian.types import Floats, Indices

UNIT = 249  # transducers
POSITION_TOLERANCE = 1e-4  # position tolerance of a transducer [m]
ACROSS, UP = 17, 231  # last transducer of the first row, and of the first column
PLACES = pc.autd().positions - pc.autd().positions[0]  # positions in a unit [m], (249, 3)


@dataclass(frozen=True)
class UnitPose:
    """A unit: position of its first transducer [m], and rotation, a quaternion (w, x, y, z)."""

    origin: tuple[float, float, float]
    rotation: tuple[float, float, float, float]

    def positions(self) -> Floats:
        """Return the positions of its transducers [m], (249, 3)."""
        w, x, y, z = self.rotation
        return pc.Pose(self.origin, (x, y, z, w)).points(PLACES)


@dataclass(frozen=True, eq=False)
class Layout:
    """The units of an array of N transducers. places: unit * 249 + channel of each, (N,)."""

    units: tuple[UnitPose, ...]
    places: Indices

    def geometry(self) -> Any:
        """Return the geometry for the AUTD3 packages, which use millimetres. Raises BackendError, MissingExtra."""
        core = import_package("autd3_core")
        made = core.Geometry(
            [
                core.Autd3(1e3 * np.array(unit.origin), np.array(unit.rotation))
                for unit in self.units
            ]
        )
        for theirs, unit in zip(made, self.units, strict=True):
            if np.abs(1e-3 * theirs.positions() - unit.positions()).max() > POSITION_TOLERANCE:
                raise pc.BackendError(
                    f"{NAME}: its packages place transducers elsewhere: report this"
                )
        return made


def layout_of_array(array: pc.Array) -> Layout:
    """Find the units of an array from the positions of its transducers. Raises BackendError."""
    N = len(array)
    if N % UNIT:
        raise pc.BackendError(
            f"{NAME}: {N} transducers are no whole units of {UNIT}: use `pc.autd(...)`, or a `description`"
        )
    units = tuple(
        _unit(k, array.positions[start : start + UNIT], array.normals[start : start + UNIT])
        for k, start in enumerate(range(0, N, UNIT))
    )
    return Layout(units, np.arange(N))


def layout_of_description(description: pc.DeviceDescription, array: pc.Array) -> Layout:
    """Return the units of a description, which must describe this array. Raises BackendError."""
    described = description.array()
    same = len(described) == len(array)
    if not same or np.abs(described.positions - array.positions).max() > POSITION_TOLERANCE:
        raise pc.BackendError(f"{NAME}: the array is not that of the `description`")
    units: list[UnitPose] = []
    places = np.zeros(len(array), np.intp)
    for k, (board, wiring) in enumerate(zip(description.boards, description.wiring, strict=True)):
        local = board.layout.positions()
        if (
            board.layout.count != UNIT
            or np.abs(local - local[0] - PLACES).max() > POSITION_TOLERANCE
        ):
            raise pc.BackendError(f'{NAME}: board {k} must have the layout {{ type = "autd" }}')
        if (board.drives != np.arange(UNIT)).any():
            raise pc.BackendError(
                f"{NAME}: board {k} must have no `order`: the units have their own"
            )
        x, y, z, w = board.pose.rotation
        units.append(UnitPose(_triple(board.pose.points(local[:1])[0]), (w, x, y, z)))
        places[wiring.indices] = UNIT * k + wiring.channels
    return Layout(tuple(units), places)


def _unit(k: int, positions: Floats, normals: Floats) -> UnitPose:
    """Return the unit that has these transducers. Raises BackendError."""
    x, y = (_direction(positions[end] - positions[0]) for end in (ACROSS, UP))
    z = np.cross(x, y)
    problem = f"{NAME}: transducers {UNIT * k} to {UNIT * (k + 1) - 1} are not those of a unit"
    if abs(x @ y) > POSITION_TOLERANCE or np.abs(normals - z).max() > 1e-3:
        raise pc.BackendError(problem)
    from scipy.spatial.transform import Rotation

    x, y, z, w = Rotation.from_matrix(np.stack([x, y, z], axis=1)).as_quat().tolist()
    unit = UnitPose(_triple(positions[0]), (w, x, y, z))
    off = float(np.abs(unit.positions() - positions).max())
    if off > POSITION_TOLERANCE:
        raise pc.BackendError(f"{problem}: one is {1e3 * off:.2g} mm from its place")
    return unit


def _triple(r: Floats) -> tuple[float, float, float]:
    x, y, z = r.tolist()
    return x, y, z


def _direction(v: Floats) -> Floats:
    return np.asarray(v / max(float(np.sqrt(v @ v)), 1e-30))
