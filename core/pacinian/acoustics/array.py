"""Arrays of transducers: positions, normals, type and responses."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.pose import Pose, vector
from pacinian.acoustics.transducer import IDEAL, T4010A1, Transducer
from pacinian.argument_checks import (
    check_angle,
    check_integer,
    check_kind,
    check_length,
    check_near,
    check_number,
    check_numbers,
    refuse_masked,
)
from pacinian.errors import ArgumentError
from pacinian.notebook import Card, card

if TYPE_CHECKING:
    from pacinian.types import ArrayLike, Complexes, Floats

PITCH = 0.01016  # spacing of transducers in an AUTD unit [m]
UNIT = (0.1920, 0.1514)  # size of an AUTD unit's board [m]
HINGE_TOLERANCE = 1e-9  # distance within which a transducer is on the hinge [m]
MIN_STRENGTH = 1e-3  # smallest |response|; a weaker transducer counts as dead
MAX_COORDINATE = 1e7  # largest coordinate; beyond, positions are rounded to more than 2 nm [m]
MAX_CARD_DOTS = 5000  # most transducers drawn in a notebook's card
MISSING = ((1, 1), (2, 1), (16, 1))  # empty (column, row) of the 18 x 14 grid


class CoincidentTransducers(UserWarning):
    """Some transducers have the same position, which is impossible in a real array."""


@dataclass(frozen=True, eq=False)
class Array:
    """An array of N transducers.

    positions: [m], shape (N, 3), within 1e7 m of the origin. normals: directions of the transducers, shape (N, 3);
        normalised here.
    transducer: their type; ideal (omnidirectional, 1 Pa at 1 m) by default.
    response: complex factor by which each transducer differs from its type, (N,): relative strength and phase lead
        [rad]. None if none differs. The factors multiply the columns of B, so that solvers compensate for them.
    Raises ArgumentError; warns of coincident transducers.
    """

    positions: Floats
    normals: Floats
    transducer: Transducer = IDEAL
    response: Complexes | None = None

    def __init__(
        self,
        positions: ArrayLike,
        normals: ArrayLike = (0.0, 0.0, 1.0),
        transducer: Transducer = IDEAL,
        response: ArrayLike | None = None,
    ) -> None:
        r = check_numbers("positions", positions, (None, 3)).copy()
        if not len(r):
            raise ArgumentError("positions", "must hold at least one transducer")
        if (farthest := np.abs(r).max()) > MAX_COORDINATE:
            raise ArgumentError(
                "positions",
                f"reach {farthest:.4g} m from the origin, more than {MAX_COORDINATE:g} m, where rounding would "
                "make phases wrong: choose an origin closer to the array",
            )
        check_near("positions", r, r.mean(axis=0))
        refuse_masked("normals", normals)
        try:
            n = check_numbers(
                "normals", np.broadcast_to(np.asarray(normals, dtype=np.float64), r.shape), r.shape
            )
        except (TypeError, ValueError):
            raise ArgumentError(
                "normals", f"must be finite and have shape {r.shape} or (3,)"
            ) from None
        largest = np.abs(n).max(axis=1, keepdims=True)
        if not (largest > 1e-12).all():
            raise ArgumentError("normals", f"has zero length at {int(np.argmin(largest))}")
        n = n / largest
        n /= np.sqrt((n * n).sum(axis=1, keepdims=True))
        _, first, count = np.unique(r, axis=0, return_index=True, return_counts=True)
        if (count > 1).any():
            where = ", ".join(map(str, sorted(first[count > 1].tolist())[:5]))
            warnings.warn(
                f"{int((count - 1).sum())} transducers share the position of others (first: {where})",
                CoincidentTransducers,
                stacklevel=2,
            )
        r.flags.writeable = n.flags.writeable = False
        object.__setattr__(self, "positions", r)
        object.__setattr__(self, "normals", n)
        object.__setattr__(self, "transducer", transducer)
        object.__setattr__(self, "response", _response(response, len(r)))

    def __len__(self) -> int:
        return len(self.positions)

    def __repr__(self) -> str:
        size = " x ".join(f"{1e3 * s:.0f}" for s in np.ptp(self.positions, axis=0))
        return f"<Array of {len(self)} transducers, {size} mm, {self.transducer.frequency / 1e3:g} kHz>"

    @card
    def _repr_html_(self) -> Card:
        size = " x ".join(f"{1e3 * s:.0f}" for s in np.ptp(self.positions, axis=0))
        kind = self.transducer
        rows = {
            "size": f"{size} mm",
            "centre": " ".join(f"{1e3 * s:.0f}" for s in self.centre) + " mm",
            "frequency": f"{kind.frequency / 1e3:g} kHz",
            "strength of each": f"{kind.pressure:g} Pa at 1 m",
            "differences": "none" if self.response is None else "calibrated",
        }
        return Card(f"Array of {len(self)} transducers", rows, draw=self._draw)

    def _draw(self, panel: Any) -> None:
        """Plot the positions, viewed along the axis closest to the normals."""
        along = int(np.abs(self.normals).mean(axis=0).argmax())
        i, j = (k for k in range(3) if k != along)
        r = 1e3 * self.positions[:: 1 + len(self) // MAX_CARD_DOTS]
        panel.plot(r[:, i], r[:, j], ".", ms=1.5)
        panel.set(xlabel=f"{'xyz'[i]} [mm]", ylabel=f"{'xyz'[j]} [mm]", aspect="equal")

    def __add__(self, other: object) -> Array:
        """Return an array with the transducers of both, in order; their type must be the same."""
        if not isinstance(other, Array):
            return NotImplemented
        if other.transducer != self.transducer:
            raise ArgumentError("other", "has another type of transducer: an array has one type")
        return Array(
            np.concatenate([self.positions, other.positions]),
            np.concatenate([self.normals, other.normals]),
            self.transducer,
            np.concatenate([self.responses, other.responses]),
        )

    @property
    def centre(self) -> Floats:
        """Mean position of the transducers [m], shape (3,)."""
        return np.asarray(self.positions.mean(axis=0))

    @property
    def responses(self) -> Complexes:
        """`response`, (N,); all ones if it is None."""
        return np.ones(len(self), np.complex128) if self.response is None else self.response

    def transform(self, pose: Pose) -> Array:
        """Return this array rotated about the world's origin and shifted, by `pose`. Raises ArgumentError."""
        check_kind("pose", pose, Pose)
        r, n = pose.points(self.positions), pose.directions(self.normals)
        return replace(self, positions=r, normals=n)

    def translate(self, offset: ArrayLike) -> Array:
        """Return this array shifted by `offset`, (3,) [m]. Raises ArgumentError."""
        return replace(self, positions=self.positions + vector("offset", offset))

    def remove_transducers(self, dead: ArrayLike) -> Array:
        """Return this array without the transducers `dead`: indices, or a flag for each. Raises ArgumentError."""
        N, given = len(self), np.asarray(dead)
        keep = np.ones(N, dtype=np.bool_)
        if given.dtype.kind == "b" and given.shape == (N,):
            keep = ~given
        elif not given.size or (given.dtype.kind in "iu" and given.min() >= -N and given.max() < N):
            keep[given.astype(np.intp)] = False
        else:
            raise ArgumentError("dead", f"must be indices below {N}, or {N} flags")
        if not keep.any():
            raise ArgumentError("dead", "leaves no transducer")
        return Array(
            self.positions[keep], self.normals[keep], self.transducer, self.responses[keep]
        )

    def fold(self, hinge: str = "x", angle: float = math.pi / 4.0) -> Array:
        """Return this planar array folded towards +z about the centre line of its bounding box.

        hinge: "x" or "y", the axis parallel to the fold. angle: by which each half is raised [rad], up to pi.
        Transducers on the hinge keep their normals. Raises ArgumentError.
        """
        if hinge not in ("x", "y"):
            raise ArgumentError("hinge", f'must be "x" or "y", not {hinge!r}')
        bent = 1 if hinge == "x" else 0  # coordinate across the hinge
        angle = check_number("angle", check_angle("angle", angle), low=-math.pi, high=math.pi)
        r, n = self.positions.copy(), self.normals.copy()
        low, high = r.min(axis=0), r.max(axis=0)
        line = (low + high) / 2.0
        u, w = r[:, bent] - line[bent], r[:, 2] - line[2]  # [m] from the hinge
        side = np.where(np.abs(u) < HINGE_TOLERANCE, 0.0, np.sign(u))
        c, s = np.cos(side * angle), np.sin(side * angle)
        r[:, bent], r[:, 2] = line[bent] + c * u - s * w, line[2] + s * u + c * w
        n[:, bent], n[:, 2] = c * n[:, bent] - s * n[:, 2], s * n[:, bent] + c * n[:, 2]
        return replace(self, positions=r, normals=n)

    def replace_transducer(self, transducer: Transducer) -> Array:
        """Return this array with another type of transducer. Raises ArgumentError."""
        check_kind("transducer", transducer, Transducer)
        return replace(self, transducer=transducer)


def _response(given: ArrayLike | None, count: int) -> Complexes | None:
    """Check `given` and return a read-only response, (count,); None if it is 1 everywhere."""
    if given is None:
        return None
    try:
        made = np.array(given, dtype=np.complex128)
    except (TypeError, ValueError):
        raise ArgumentError("response", "must be complex numbers") from None
    if made.shape != (count,):
        raise ArgumentError("response", f"must have shape ({count},), not {made.shape}")
    size = np.abs(made)
    if not ((size >= MIN_STRENGTH) & (size <= 1.0 / MIN_STRENGTH)).all():
        worst = int(np.argmax(~((size >= MIN_STRENGTH) & (size <= 1.0 / MIN_STRENGTH))))
        raise ArgumentError(
            "response",
            f"must be {MIN_STRENGTH:g} to {1.0 / MIN_STRENGTH:g} in size: [{worst}] is {size[worst]:g}; "
            "remove dead transducers with `remove_transducers`",
        )
    made.flags.writeable = False
    return None if (made == 1.0).all() else made


def lattice(
    width: float, height: float, pitch: float = 0.01, transducer: Transducer = IDEAL
) -> Array:
    """Make a planar lattice in the xy-plane, centred on the origin and pointing to +z.

    width, height: its extent in x and y [m], both ends included, rounded to multiples of the pitch. pitch: [m].
    transducer: their type, ideal by default.
    `lattice(0.2, 0.4)` has 21 x 41 transducers. Raises ArgumentError.
    """
    pitch = check_length("pitch", pitch)
    if pitch < 1e-4:
        raise ArgumentError(
            "pitch", f"is {pitch:g} m: lengths are in metres, and transducers are larger"
        )
    counts = [
        1 + round(check_length(name, extent) / pitch)
        for name, extent in (("width", width), ("height", height))
    ]
    if counts[0] * counts[1] > 1_000_000:
        raise ArgumentError(
            "pitch", f"makes {counts[0]} x {counts[1]} transducers: more than a million"
        )
    x, y = ((np.arange(n) - (n - 1) / 2.0) * pitch for n in counts)
    X, Y = np.meshgrid(x, y)
    return Array(np.stack([X, Y, np.zeros_like(X)], axis=-1).reshape(-1, 3), transducer=transducer)


def autd(columns: int = 1, rows: int = 1, transducer: Transducer = T4010A1) -> Array:
    """Make a grid of AUTD units side by side, 249 transducers each, centred on the origin and pointing to +z.

    columns, rows: number of units in x and y. `autd(3, 3)` is the paper's array: 2241 transducers, 57 x 45 cm.
    transducer: their type. Positions [m] are those of the AUTD3 board, 10.16 mm apart.
    The transducers are ordered by unit, first along x, then along y, and within a unit by row. Raises ArgumentError.
    """
    columns, rows = check_integer("columns", columns, low=1), check_integer("rows", rows, low=1)
    if columns * rows > 1000:
        raise ArgumentError("columns", f"x rows is {columns * rows} units: more than 1000")
    grid = [(i, j) for j in range(14) for i in range(18) if (i, j) not in MISSING]
    unit = np.array([[(i - 8.5) * PITCH, (j - 6.5) * PITCH, 0.0] for i, j in grid])
    corners = [
        ((i - (columns - 1) / 2.0) * UNIT[0], (j - (rows - 1) / 2.0) * UNIT[1], 0.0)
        for j in range(rows)
        for i in range(columns)
    ]
    return Array(np.concatenate([unit + corner for corner in corners]), transducer=transducer)
