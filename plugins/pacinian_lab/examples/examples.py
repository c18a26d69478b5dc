"""What the peers' examples ask for: array, air and places, as in their sources."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.array import autd

if TYPE_CHECKING:
    from pacinian.types import Floats

FREQUENCY = 40_000.0  # [Hz]


@dataclass(frozen=True, eq=False)
class Example:
    """One example of a peer: K patterns for one array, each with M foci.

    source: the file, in a repository of the peer. title: a short description. positions, normals: of N
    transducers, (N, 3). radius: of a piston [m]; 0 for omnidirectional ones. pressure: of a transducer [Pa m].
    speed: of sound [m/s]. points: foci, (K, M, 3) [m]. amplitude: sound pressure of all foci [Pa]; NaN for as strong
    as possible. quiet: a place to keep quiet, (3,) [m], if any.
    """

    name: str
    source: str
    title: str
    positions: Floats
    normals: Floats
    points: Floats
    pressure: float
    speed: float
    radius: float = 0.0
    amplitude: float = math.nan
    quiet: Floats | None = None

    @property
    def wavenumber(self) -> float:
        """The wavenumber [rad/m]."""
        return 2.0 * math.pi * FREQUENCY / self.speed

    def message(self) -> dict[str, Any]:
        """Return the example as a message for a worker."""
        return {
            "positions": self.positions.tolist(),
            "normals": self.normals.tolist(),
            "points": self.points.tolist(),
            "pressure": self.pressure,
            "speed": self.speed,
            "radius": self.radius,
            "amplitude": None if math.isnan(self.amplitude) else self.amplitude,
            "quiet": None if self.quiet is None else self.quiet.tolist(),
        }


def make_examples() -> list[Example]:
    """Return all examples."""
    return [*_from_autd3(), *_from_acoustools(), _from_levitate()]


def _from_autd3() -> list[Example]:
    """One unit, and places 150 mm above its centre; 340 m/s, 4.386 Pa m."""
    r = autd().positions
    above = r.mean(axis=0) + np.array([0.0, 0.0, 0.15])
    aside, angle = np.array([0.03, 0.0, 0.0]), 2.0 * np.pi * np.arange(50) / 50
    circle = above + 0.03 * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=-1)
    made = {
        "focus": ("focus.rs", "one focus, full drive", above[None, None], math.nan),
        "foci": ("holo.rs", "two foci of 2500 Pa", np.array([[above + aside, above - aside]]), 2500.0),
        "circle": ("stm.rs", "50 foci in turn on a circle", circle[:, None], math.nan),
    }  # fmt: skip
    return [
        Example(
            name, f"autd3-rs/examples/src/tests/{file}", title,
            r, np.tile([0.0, 0.0, 1.0], (len(r), 1)), points, 4.386, 340.0, amplitude=amplitude,
        )
        for name, (file, title, points, amplitude) in made.items()
    ]  # fmt: skip


def _from_acoustools() -> list[Example]:
    """Two boards of 16 x 16 pistons that face each other, and random points between them; 343 m/s, 3.4 Pa m."""
    x = 0.0105 * (np.arange(16) - 7.5)
    board = np.stack(np.meshgrid(x, x, [0.11825], indexing="ij"), axis=-1).reshape(-1, 3)
    r, n = np.concatenate([board, board * [1, 1, -1]]), np.repeat([[0, 0, -1.0], [0, 0, 1]], 256, 0)
    rng = np.random.default_rng(0)
    eight = rng.uniform(-0.06, 0.06, (1, 8, 3)) * [1, 0, 1]
    many = rng.uniform(-0.06, 0.06, (32, 3, 3))
    made = {
        "eight": ("AcousTools_Paper/solvers.py", "8 equal points in a plane", eight),
        "batch": (
            "AcousticExperiments/AcousTools_Examples/test_GSPAT_speed.py",
            "32 problems of 3 equal points", many,
        ),
    }  # fmt: skip
    return [
        Example(name, file, title, r, n, points, 3.4, 343.0, radius=0.0045)
        for name, (file, title, points) in made.items()
    ]


def _from_levitate() -> Example:
    """The haptic part of a superposition: a focus, and little sound at the trap; 343.24 m/s, 6 Pa m."""
    x, y = 0.01 * (np.arange(21) - 10.0), 0.01 * (np.arange(12) - 5.5)
    r = np.stack(np.meshgrid(x, y, [0.0]), axis=-1).reshape(-1, 3)
    return Example(
        "beside a trap", "levitate/docs/examples/Field superposition.ipynb",
        "a focus, quiet at a trap", r, np.tile([0.0, 0.0, 1.0], (len(r), 1)),
        np.array([[[0.04, 0.0, 0.09]]]), 6.0, 343.23714360505863,
        quiet=np.array([-0.02, 0.0, 0.06]),
    )  # fmt: skip
