"""Regions: samples of one surface, whose phases are coupled.

If the phases of two neighbours differ by pi, the field has a zero between them, however close they are. Therefore the
samples of a region get the phases of a single wave, and only one phase for the whole region is free. The wave
converges beyond the region, so that many transducers share the work. With a wave from the array's centre, the
transducers near the centre would do most of it.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.array import Array
from pacinian.acoustics.propagation import check_medium
from pacinian.argument_checks import check_kind, check_numbers
from pacinian.native import solving as kernels
from pacinian.region_numbers import ISOLATED
from pacinian.solving.factor import Factor
from pacinian.solving.phases import initial_phases
from pacinian.solving.propagator import gram_matrix, mean_square
from pacinian.solving.skin_phases import relax_phases

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.solving.propagator import Propagator
    from pacinian.solving.solution import Solution
    from pacinian.solving.targets import Targets
    from pacinian.types import ArrayLike, Complexes, Floats, Indices


MIN_CONVERGENCE = 0.25  # smallest d'/d, see `joint_phases`
MIN_CONVERGENCE_ON_SKIN = 0.8  # smallest d'/d for samples on skin, which are less even
# Largest number of transducers whose power shows where the sound on skin comes from.
MAX_SOURCES = 256
# Samples of other regions count fully for the source of a region's wave up to this distance from the region's middle,
# and not at all from twice this distance [m].
MAX_SHARED_SOURCE = 0.03
# Golden ratio minus 1, whose multiples modulo 1 are evenly scattered.
GOLDEN_FRACTION = 0.5 * (5.0**0.5 - 1.0)
MAX_SUBSET = 128  # largest number of transducers used to compute the array's radius
# If the mean of the transducers' normals is shorter than this, parts of the array face in different directions.
MIN_COMMON_NORMAL = 0.75
# Transducers face in the same direction if the cosine between their normals is larger than the first of these, and in
# another one if it is at most the second. If some are in between, the array is curved.
SAME_COSINE, OTHER_COSINE = 0.7, 0.3
# mu in the steps that turn a wave away from quiet zones, relative to the mean of diag(G).
TURNING_MU = 0.1
TURNING_STEPS = 16  # number of steps that turn a wave away from quiet zones
# The steps that turn a wave away from quiet zones are skipped if the first saves at most this share of the cost.
MIN_SAVED_SHARE = 0.07
# The steps that turn a wave away from quiet zones have full length if the first saves at least this share of the cost.
FULL_STEP_SHARE = 0.17
# A region keeps its phases while they differ from those of a new wave by at most this, apart from a common phase (root
# mean square) [rad].
MAX_TURN = 1.0


def joint_phases(
    array: Array,
    points: ArrayLike,
    medium: Air,
    *,
    radiation_pressure: ArrayLike | None = None,
) -> Floats:
    """Return phases of a region's points, phi_m = k |q_m - f| [rad], (M,): those of a wave that converges beyond it.

    The wave's focus f = m + (d'/d) (m - c) lies d' beyond the region's middle m, which is d from the array's centre c.
    The wave then comes from transducers within w (1 + d/d') of c, where w is the region's root-mean-square width across
    the wave. d'/d is chosen so that this radius is 0.4 of the array's, and clipped to 0.25..1, so that many transducers
    share the work.
    The wave grows stronger towards f. Therefore a region of thickness s (root mean square along its thinnest axis),
    such as the shell of a ball, needs d' >= 64 s, up to d'/d = 4. With these phases, the field is even between points
    that are at most half a wavelength apart.

    array: if separate parts face in different directions, such as two units that face each other, only the largest one
    that faces in one counts, because the middle of all may lie in the region. Its radius is a root mean square, with
    each transducer weighted by its power at m. points: q, of one region, (M, 3) [m]. medium: the air.
    radiation_pressure: targets of the points, (M,), which serve as weights, so that a point with a small target has
    little influence when it appears or disappears; equal weights by default.
    Raises ArgumentError.
    """
    check_kind("array", array, Array)
    q = check_numbers("points", points, (None, 3))
    check_medium(medium)
    k = medium.wavenumber(array.transducer.frequency)
    P = np.ones(len(q))
    if radiation_pressure is not None:
        P = check_numbers("radiation_pressure", radiation_pressure, (len(q),))
    phases = np.empty(len(q))
    if len(q):
        kernels.converge(
            q, P, _choose_subset(array), _find_centre(array), k, MIN_CONVERGENCE, 0.0, phases
        )  # fmt: skip
    return phases


def settle_phases(
    propagator: Propagator,
    targets: Targets,
    warm: Solution | None,
    tilt: float = 0.0,
    *,
    relax: bool = True,
    keep: bool = False,
) -> Targets:
    """Return the same targets with every phase fixed, for points of which some belong to regions.

    The phases within a region are those of `joint_phases`, turned away from quiet zones, plus one phase for the region.
    For samples on skin, c is the middle of the transducers by the power that each sends there (`_find_sources`), and
    d'/d is at least 0.8. If `relax`, the phases of regions are then relaxed (`relax_phases`), unless the wave is tilted
    or turned away from zones, or the strength is free. If `keep`, regions keep the phases of `warm` if these differ
    little from those of the wave. Then its multipliers still fit (decision 76).
    Gerchberg-Saxton steps, as in `phases`, choose the regions' phases and those of isolated samples. They start from
    the phases of `warm`, so that no phase jumps. Given phases do not change. tilt: sideways shift of the waves' foci,
    relative to the array's radius times d'/d.
    """
    regions, t, given = targets.regions, targets.amplitudes, targets.phases
    assert regions is not None
    array, q, M = propagator.array, propagator.points, len(t)
    k = propagator.medium.wavenumber(array.transducer.frequency)
    some, wave, part = _choose_subset(array), np.zeros(M), np.empty(M)
    if propagator.facing is None:
        sources, least = _find_centre(array)[np.newaxis], MIN_CONVERGENCE
    else:
        sources, least = _find_sources(propagator, regions), MIN_CONVERGENCE_ON_SKIN
    for number, source in enumerate(sources):
        own = regions if len(sources) == 1 else np.where(regions == number, 0, ISOLATED)
        kernels.waves(q, t, own, some, source, k, least, tilt, part)
        wave += part
    if propagator.quiet_subspace is not None:
        for number in range(int(regions.max()) + 1):
            own = regions == number
            wave[own] = _turn_aside(gram_matrix(propagator.B[own]), t[own], wave[own])
    start, steps = initial_phases(M, None if warm is None else _find_phases(warm))
    if keep and propagator.quiet_subspace is None:
        for number in range(int(regions.max()) + 1):
            own = regions == number
            wave[own] = _keep_wave(t[own], wave[own], start[own])
    group, phases = np.empty(M, np.int64), np.empty(M)
    p, z = np.empty(M, np.complex128), np.empty(M + 1, np.complex128)
    # normalised, so that squares in single precision do not overflow
    norm = targets.norm or 1.0
    count = kernels.combine_regions(
        t, given, regions, wave, start, warm is not None, norm, group, phases, p, z
    )
    if count > 1:
        rows, z = np.empty((count, len(array)), propagator.dtype), z[:count]
        kernels.sum_group_rows(propagator.B, p, group, rows)
        turns = np.ones(count, np.bool_)
        turns[0] = targets.all_free
        kernels.gerchberg_saxton(gram_matrix(rows), turns, steps, z)
    kernels.rotate_phases(given, group, z, phases)
    if relax and _is_relaxed(propagator, targets, tilt):
        phases = relax_phases(propagator, targets, phases, None if warm is None else start)
    return targets.with_phases(phases)


def _is_relaxed(propagator: Propagator, targets: Targets, tilt: float) -> bool:
    """Return whether the phases of regions are relaxed: on skin, in one frame of the given strength."""
    plain = targets.scale == "exact" and not tilt and propagator.quiet_subspace is None
    return plain and propagator.facing is not None


@functools.lru_cache(maxsize=16)
def _choose_subset(array: Array) -> Floats:
    """Return the positions of at most MAX_SUBSET transducers, spread over the array, or its side, (V, 3) [m]."""
    side = _choose_side(array)
    return side[:: -(-len(side) // MAX_SUBSET)].copy()


@functools.lru_cache(maxsize=16)
def _choose_side(array: Array) -> Floats:
    """Return the positions of the transducers from which waves come, (V, 3) [m].

    If separate parts of the array face in different directions, these are those of the largest part that faces in one,
    because the middle of all may lie in a region. Of a curved array, these are all.
    """
    n = array.normals
    if not len(n) or float(np.linalg.norm(n.mean(axis=0))) >= MIN_COMMON_NORMAL:
        return array.positions
    cosines = n[:: -(-len(n) // MAX_SUBSET)] @ n.T
    own = cosines[(cosines > SAME_COSINE).sum(axis=1).argmax()]
    curved = ((own > OTHER_COSINE) & (own <= SAME_COSINE)).any()
    return array.positions if curved else np.asarray(array.positions[own > SAME_COSINE])


@functools.lru_cache(maxsize=16)
def _find_centre(array: Array) -> Floats:
    """Return the middle of the transducers from which waves come, (3,) [m]."""
    return np.asarray(_choose_side(array).mean(axis=0))


def _find_sources(propagator: Propagator, regions: Indices) -> Floats:
    """Return the sources of the regions' waves, one for each or one for all, (K, 3) [m].

    A source is the middle of the transducers, each weighted by the power that it sends to the samples. The samples of
    all regions nearby count, so that no wave jumps if a region splits or regions merge. Those of another hand do not:
    with a common source between two hands, each wave would come from the side, and be felt by the other hand, too
    (decision 94). Amplitudes do not count, because frames of one cycle, which each make what the others lack, would
    drift apart.
    """
    pressing, points = regions >= 0, propagator.points
    shares = np.tile(pressing.astype(np.float64), (max(int(regions.max()) + 1, 1), 1))
    for number, share in enumerate(shares if len(shares) > 1 else ()):
        other = pressing & (regions != number)
        distance = np.linalg.norm(points[other] - points[regions == number].mean(axis=0), axis=1)
        share[other] = np.clip(2.0 - distance / MAX_SHARED_SOURCE, 0.0, 1.0)
    if (shares == shares[0]).all():
        shares = shares[:1]
    some = _choose_scattered(len(propagator.array))
    rows = propagator.B.take(some, axis=1)
    parts = rows.view(rows.real.dtype)
    parts *= parts
    powers = (shares.astype(parts.dtype) @ parts).reshape(len(shares), -1, 2).sum(axis=2)
    sources = np.tile(propagator.origin, (len(shares), 1))
    for source, power in zip(sources, powers, strict=True):
        whole = float(power.sum())
        if 0.0 < whole < math.inf:
            source[:] = power @ propagator.array.positions[some] / whole
    return sources


@functools.lru_cache(maxsize=16)
def _choose_scattered(count: int) -> Indices:
    """Return at most MAX_SOURCES of `count` indices, in order, so scattered that they favour no row or column."""
    if count <= MAX_SOURCES:
        return np.arange(count)
    return np.unique((np.arange(MAX_SOURCES) * GOLDEN_FRACTION % 1.0 * count).astype(np.int64))


def _keep_wave(t: Floats, wave: Floats, last: Floats) -> Floats:
    """Return the last phases of a region's samples, (M,) [rad], or those of a new wave if these differ too much.

    t: amplitudes, (M,).
    """
    w = t * t
    turn = np.exp(1j * (wave - last))
    turned = np.angle(turn * np.conj(w @ turn))
    kept = float(w @ turned**2) <= MAX_TURN * MAX_TURN * float(w.sum())
    return last.copy() if kept else wave


def _turn_aside(G: Complexes, t: Floats, wave: Floats) -> Floats:
    """Return phases close to those of `wave`, (M,) [rad], for which quiet zones need weaker gains.

    The wave may run on into a zone. Steps p <- t exp(j arg(p - mu (G + mu I)^-1 p)) turn it away, because they remove
    the part of p that needs strong gains. They also make the field between the points less even. Therefore the steps
    are shorter if the first saves little. No step is taken if the first saves at most MIN_SAVED_SHARE, which it would
    also save without zones. G: B B^H, (M, M). t: amplitudes, (M,).
    """
    mu = TURNING_MU * mean_square(G)
    factor = Factor.of(G, mu)
    if not (factor.definite and t.any()):
        return wave

    def turned(phases: Floats) -> Complexes:
        return np.asarray(t * np.exp(1j * phases), np.complex128)

    def costly(p: Complexes) -> Complexes:
        return np.asarray(mu * factor.solve(p), np.complex128)

    p = turned(wave)
    rest = costly(p)
    after = turned(np.angle(p - rest))
    saved = 1.0 - float(np.vdot(after, costly(after)).real) / float(np.vdot(p, rest).real)
    step = float(np.clip((saved - MIN_SAVED_SHARE) / (FULL_STEP_SHARE - MIN_SAVED_SHARE), 0.0, 1.0))
    for _ in range(TURNING_STEPS if step else 0):
        p = turned(np.angle(p - step * costly(p)))
    return np.asarray(np.angle(p), np.float64)


def _find_phases(warm: Solution) -> Floats:
    """Return the phases given to the solver last, if known, else the achieved ones, (M,) [rad]."""
    return warm.phases if warm.asked_phases is None else warm.asked_phases
