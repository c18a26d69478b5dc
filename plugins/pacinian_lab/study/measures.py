"""The measures: functions of the target and achieved pressures, and of the field."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.directivity import omni

if TYPE_CHECKING:
    import pacinian as pc
    from pacinian.types import Complexes, Flags, Floats

TURNS = 4096  # steps of cos(theta) for the integral of a directivity


@dataclass(frozen=True)
class Measure:
    """A column of the results.

    unit: "" if it has none. better: "low", "high", or "" for neither. meaning: a short description.
    """

    unit: str
    better: str
    meaning: str


MEASURES = {
    "error": Measure("", "low", "||a - t|| / ||t||, achieved and target amplitudes"),
    "shape_error": Measure("", "low", "||a - s t|| / ||s t||, with the best multiple s"),
    "scale": Measure("", "high", "s = a.t / t.t"),
    "correlation": Measure("", "high", "Pearson's, of a and t"),
    "maximum": Measure("Pa", "high", "largest a"),
    "reach": Measure("Pa", "high", "highest |p| that one focus could make, over the points"),
    "efficiency": Measure("", "high", "fraction of the picture's |p|^2 in the pattern's main lobes"),
    "yield": Measure("Pa/W", "high", "mean radiation pressure at the points, per sound power emitted"),
    "side_lobe": Measure("dB", "low", "highest |p| outside the main lobes, over the highest inside"),
    "contrast": Measure("", "high", "(P_in - P_out) / (P_in + P_out), mean radiation pressures"),
    "width_along": Measure("m", "low", "full width of a focus at half its radiation pressure, along the sound"),
    "width_across_x": Measure("m", "low", "the same, perpendicular to the sound and to y"),
    "width_across_y": Measure("m", "low", "the same, perpendicular to both"),
    "condition": Measure("", "low", "of B: s_1 / s_min(M, N)"),
    "saturation": Measure("", "low", "fraction of transducers at the limit"),
    "run_time": Measure("", "low", "of the solver, over that of a fixed matrix product on the same machine"),
}  # fmt: skip


def amplitudes(a: Floats, t: Floats, *, exact: bool) -> dict[str, float]:
    """Return error, shape error, scale, correlation and maximum of amplitudes a for targets t [Pa], (M,).

    exact: whether the targets are absolute; if only proportions are, error and scale are NaN.
    """
    size = float(np.linalg.norm(t))
    s = float(a @ t) / size**2
    varies = min(float(np.ptp(a)), float(np.ptp(t))) > 1e-9 * size
    return {
        "error": float(np.linalg.norm(a - t)) / size if exact else math.nan,
        "shape_error": float(np.linalg.norm(a - s * t)) / (s * size) if s > 0.0 else math.nan,
        "scale": s if exact else math.nan,
        "correlation": float(np.corrcoef(a, t)[0, 1]) if varies else math.nan,
        "maximum": float(a.max()),
    }


def image(a: Floats, field: Floats, lobes: Flags) -> dict[str, float]:
    """Return efficiency, side lobe and contrast of a picture.

    a: |p| at the points with a target [Pa], (M,). field: |p| [Pa], (K, K), NaN where it does not count. lobes: which
    pixels are in main lobes, (K, K). Returns NaN if there is no sound, or no pixel outside.
    """
    P, counts = field**2, np.isfinite(field)
    inside, outside = P[lobes & counts], P[~lobes & counts]
    total = float(inside.sum() + outside.sum())
    if not total > 0.0 or not len(outside):
        return dict.fromkeys(("efficiency", "side_lobe", "contrast"), math.nan)
    loudest = max(float((a * a).max()), float(inside.max(initial=0.0)))
    within, without = float((a * a).mean()), float(outside.mean())
    quiet = float(outside.max())
    return {
        "efficiency": float(inside.sum()) / total,
        "side_lobe": 10.0 * math.log10(quiet / loudest) if quiet and loudest else math.nan,
        "contrast": (within - without) / (within + without),
    }


def compute_emitted_power(array: pc.Array, gains: Complexes, medium: pc.Air) -> float:
    """Return the sound power that transducers of these gains, (N,), emit, as if each were alone [W].

        W = P0^2 / (2 rho c) sum_n |g_n s_n|^2 int D^2 dOmega

    NaN if sound does not decay as 1/r, because this power is then undefined.
    """
    if medium.exponent != 1.0:
        return math.nan
    kind = array.transducer
    cosine = (np.arange(TURNS) + 0.5) / TURNS * 2.0 - 1.0
    solid = 4.0 * math.pi  # [sr]
    if kind.directivity is not omni:
        solid *= float((np.asarray(kind.directivity(cosine)) ** 2).mean())
    drive = float((np.abs(gains * array.responses) ** 2).sum())
    return kind.pressure**2 / (2.0 * medium.density * medium.speed_of_sound) * drive * solid
