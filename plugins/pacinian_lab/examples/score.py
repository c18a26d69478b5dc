"""Evaluate the gains of an example: peaks near its foci, and sound in its quiet place.

The field is computed with NumPy and SciPy in double precision, by code that no solver uses. The peaks are searched, so
that a solver gains nothing from being exact only at the given points.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pacinian.types import Complexes, Floats
    from pacinian_lab.examples.examples import Example

NEAR = 0.25  # horizontal distance from a focus within which its peak is searched [wavelengths]
QUIET_RADIUS = 0.001  # of a quiet place [m]: 2 mm is a bead
SEARCHED_PLACES, ROUNDS = 100, 5  # places of one search; searches, each in a third of the radius


@dataclass(frozen=True)
class Score:
    """The quality of the foci that gains produce.

    strength: mean height of the peaks in the horizontal planes of the foci [Pa]. error: rms deviation of the peaks from
    the requested amplitude. If the example requests as much as possible: from the mean of the foci of one pattern, or
    of all patterns if each has one focus. offset: largest distance of a peak from its focus [m]. quiet: highest
    pressure in the quiet place, relative to `strength`; NaN if there is none.
    """

    strength: float
    error: float
    offset: float
    quiet: float


def field(example: Example, gains: Complexes, points: Floats) -> Complexes:
    """Return the sound pressure, (M,) [Pa], of gains (N,) at points (M, 3)."""
    from scipy.special import j1

    d = points[:, None] - example.positions
    r = np.linalg.norm(d, axis=2)
    B = example.pressure / r * np.exp(-1j * example.wavenumber * r)
    if example.radius:
        cosine = np.einsum("mnk,nk->mn", d, example.normals) / r
        x = example.wavenumber * example.radius * np.sqrt(np.maximum(1.0 - cosine**2, 1e-24))
        B = np.where(cosine > 0.0, 2.0 * j1(x) / x, 0.0) * B
    return np.asarray(B @ gains)


def score(example: Example, gains: Complexes) -> Score:
    """Score gains, (K, N), after clipping to |g| <= 1."""
    g = np.asarray(gains, np.complex128)
    g = g / np.maximum(1.0, np.abs(g))
    peaks: Floats = np.empty(example.points.shape[:2])
    offset, quiet = 0.0, math.nan
    for row, heights, foci in zip(g, peaks, example.points, strict=True):
        for m, focus in enumerate(foci):
            place, heights[m] = find_peak(example, row, focus)
            offset = max(offset, float(np.linalg.norm(place - focus)))
    strength = float(peaks.mean())
    asked = peaks.mean(axis=1 if peaks.shape[1] > 1 else None, keepdims=True)
    if not math.isnan(example.amplitude):
        asked[:] = example.amplitude
    if example.quiet is not None:
        quiet = (
            np.abs(field(example, g[0], example.quiet + QUIET_RADIUS * _ball())).max() / strength
        )
    return Score(
        strength, float(np.sqrt(np.mean((peaks / asked - 1.0) ** 2))), offset, float(quiet)
    )


def find_peak(example: Example, gains: Complexes, focus: Floats) -> tuple[Floats, float]:
    """Return where |p| is highest beside a focus, as on skin that lies there, and that pressure [Pa]."""
    place, radius = focus, NEAR * 2.0 * math.pi / example.wavenumber
    limit, disc = radius, _ball() * [1.0, 1.0, 0.0]
    for _ in range(ROUNDS):
        places = place + radius * disc
        places = places[np.linalg.norm(places - focus, axis=1) <= limit]
        place = places[np.abs(field(example, gains, places)).argmax()]
        radius /= 3.0
    return place, float(np.abs(field(example, gains, place[None]))[0])


def _ball() -> Floats:
    """Return points in the unit ball, (SEARCHED_PLACES, 3)."""
    rng = np.random.default_rng(0)
    d = rng.normal(size=(SEARCHED_PLACES, 3))
    return np.asarray(
        np.cbrt(rng.random((SEARCHED_PLACES, 1))) * d / np.linalg.norm(d, axis=1, keepdims=True)
    )
