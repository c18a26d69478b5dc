"""The baseline that the paper improves on (section 3): the image in a plane by the inverse Fourier transform.

For a plane at distance z, parallel to an array on the xy-plane, and small angles,

    |q - r| = z + (|q|^2 + |r|^2) / 2 z - q.r / z,

so that with a lens phase on the gains, g(r) = h(r) exp(j k |r|^2 / 2 z), the amplitude in the plane is the Fourier
transform of h:  |p(q)| = | sum_r h(r) exp(j k q.r / z) |.  With the lattice's pitch d, the image repeats every lambda
z / d, so the region must be smaller than that.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

import pacinian as pc
from pacinian_lab.paper import experiment

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.types import Complexes, Floats
    from pacinian_lab.paper.experiment import Case, Outcome

FAR_HEIGHT = 0.6  # [m]; at this height the image repeats every 510 mm, beyond the region's 400 mm
FAR_CUT = 1e-3  # B is nearly singular at FAR: smaller singular values only make the gains huge
PLACES = {  # name: height [m], cut
    "1a": (experiment.DISTANCE, experiment.CUT),
    "1a far": (FAR_HEIGHT, FAR_CUT),
    "2a": (experiment.DISTANCE, experiment.CUT),
}


@dataclass(frozen=True, eq=False)
class Comparison:
    """Both methods for one pattern in one place.

    place: a case's name; "1a far" is case 1a with its region at `FAR_HEIGHT`. amplitude: |p| [Pa] of the Fourier
    method, shape (41, 41), scaled to be closest to the target. correlation: with the target. maximum: [Pa].
    pseudo_inverse: the outcome of the other method.
    """

    place: str
    pattern: str
    amplitude: Floats
    correlation: float
    maximum: float
    pseudo_inverse: Outcome


def gains(
    positions: Floats, points: Floats, amplitudes: Floats, distance: float, wavenumber: float
) -> Complexes:
    """Return the gains of the Fourier method, in the right proportions, shape (N,).

        g(r) = exp(j k |r|^2 / 2 z) sum_q t(q) exp(-j k q.r / z),

    with r and q in x and y only, because the method treats every sample as if it were in the plane at `distance`.

    positions: r [m], shape (N, 3), on the xy-plane. points: q [m], shape (M, 3). amplitudes: t [Pa], shape (M,).
    distance: z [m]. wavenumber: k [rad/m].
    """
    r, q = positions[:, :2], points[:, :2]
    k, z = wavenumber, distance
    lens = np.exp(0.5j * k / z * (r * r).sum(axis=1))  # (N,)
    return np.asarray(lens * (np.exp(-1j * k / z * (r @ q.T)) @ amplitudes))


def amplitude(case: Case, target: Floats, distance: float) -> Floats:
    """Return |p| [Pa] of the Fourier method for a target (41, 41), scaled to be closest to it; same shape."""
    k = experiment.MEDIUM.wavenumber(case.array.transducer.frequency)
    g = gains(case.array.positions, case.points, target.ravel(), distance, k)
    p = pc.field(case.array, g, case.points, experiment.MEDIUM, precision="double")
    size = np.abs(p).astype(np.float64).reshape(target.shape)
    return np.asarray(size * ((size * target).sum() / (size * size).sum()))


def compare(place: str, name: str, known: Outcome | None = None) -> Comparison:
    """Compare both methods for the pattern `name` in a place. known: the pseudo-inverse's outcome, if available."""
    distance, cut = PLACES[place]
    case = experiment.case(place[:2], distance)
    outcome = known or experiment.solve(case, name, cut)
    size = amplitude(case, outcome.target, distance)
    close = experiment.correlation(size, outcome.target)
    return Comparison(place, name, size, close, float(size.max()), outcome)


def run(
    outcomes: dict[tuple[str, str], Outcome], advance: Callable[[], object] = lambda: None
) -> dict[tuple[str, str], Comparison]:
    """Compare all patterns in all places, by (pattern, place). advance: called after each of them.

    outcomes: of the experiment, by (pattern, case), so that nothing is solved twice.
    """
    comparisons: dict[tuple[str, str], Comparison] = {}
    for place in PLACES:
        for name in experiment.PATTERNS:
            comparisons[name, place] = compare(place, name, outcomes.get((name, place)))
            advance()
    return comparisons
