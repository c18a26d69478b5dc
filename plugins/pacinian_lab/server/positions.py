"""Where the objects of the load are: a place tells when it was sent, so what is felt tells how old it is.

Objects come in groups of 16. Those of the group that is felt go along x within a cell of their own, 4 mm in
10 s, again and again; all others go outside of the workspace.
"""

from __future__ import annotations

import numpy as np

from pacinian.wire import binary_arrays, objects

CELLS = 16  # 4 x 4
APART = 0.03  # [m] from cell to cell
HEIGHT = 0.2  # [m]
AWAY = 0.6  # [m], outside of the workspace
WAY, PERIOD = 0.004, 10.0  # [m] in [s]
WITHIN = 1e-6  # [m] that float32 may take
WORKSPACE = (-0.15, -0.15, 0.05), (0.15, 0.15, 0.4)  # [m]


def name(index: int) -> str:
    """Of an object."""
    return f"point {index}"


def cell(index: int) -> tuple[float, float]:
    """Where the way of an object begins, x and y [m]."""
    row, column = divmod(index % CELLS, 4)
    return APART * (column - 1.5), APART * (row - 1.5)


def place(index: int, t: float, group: int = 0) -> tuple[float, float, float]:
    """Of an object that is moved at time t [s], when that group is felt [m]."""
    x, y = cell(index)
    felt = index // CELLS == group
    return x + WAY * (t / PERIOD % 1.0), y, HEIGHT if felt else AWAY


def pose(index: int, t: float, group: int = 0) -> bytes:
    """As on the wire."""
    return binary_arrays.pack([*place(index, t, group), 0.0, 0.0, 0.0, 1.0])


def point(index: int, t: float) -> objects.Point:
    """The object."""
    return objects.Point(position=place(index, t), radiation_pressure=5.0)


def sent(points: bytes, now: float) -> dict[int, float]:
    """When each that is felt was sent [s], by its cell; now: a time less than 10 s later [s]."""
    found = dict[int, float]()
    for x, y, _ in binary_arrays.unpack(points, 3).astype(np.float64).tolist():
        row = round(y / APART + 1.5)
        column = round((x - WAY / 2.0) / APART + 1.5)
        number = 4 * row + column
        t = (x - cell(number)[0]) / WAY * PERIOD
        found[number] = now - (now - t) % PERIOD
    return found


def missing(points: bytes, indices: range, t: float) -> list[int]:
    """Which of these are not felt exactly where they were put at time t [s], when theirs is the group felt."""
    P = binary_arrays.unpack(points, 3).astype(np.float64)
    gone = list[int]()
    for index in indices:
        at = np.array(place(index, t, index // CELLS))
        if not len(P) or np.abs(P - at).max(axis=1).min() > WITHIN:
            gone.append(index)
    return gone
