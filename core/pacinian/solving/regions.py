"""Regions: samples of one surface, whose phases belong together.

Where phases of neighbours differ by pi there is a zero between them, however near they are. So the samples
of a region have the phases of one wave, and only the region's phase as a whole is free. Of all waves that come
from the array to the region we take one that converges beyond it, because many transducers then share the work:
phases as of a wave from the array's centre make those near the centre do most of it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import Array
from pacinian.checks import check_kind, check_numbers
from pacinian.native import solving as kernels
from pacinian.solving.factor import Factor
from pacinian.solving.phases import initial_phases
from pacinian.solving.problem import BESIDE, ISOLATED
from pacinian.solving.propagator import gram_matrix

if TYPE_CHECKING:
    from pacinian.solving.problem import Targets
    from pacinian.solving.propagator import Propagator
    from pacinian.solving.solution import Solution
    from pacinian.types import ArrayLike, Complexes, Flags, Floats, Longs


STILL = 5e-4  # [m]: samples that have moved by no more are the same ones
NEAR = 3e-3  # [m]: a sample goes on from one that is so near
MIN_CONVERGENCE = 0.25  # times the region's distance: where its wave converges at least, beyond it
ON_SKIN = 0.4  # the nearest where samples lie on skin, less evenly
MAX_SUBSET = 128  # transducers that stand for all
ASIDE = 0.1  # of the mean square that full drive makes: mu in the steps that turn a wave aside from quiet zones
TURNS = 16  # such steps
LITTLE_SAVED = 0.07  # of what is costly: where the first step saves no more, none is made
MUCH_SAVED = 0.17  # where it saves as much, steps are whole


def joint_phases(
    array: Array,
    points: ArrayLike,
    medium: Air | None = None,
    *,
    radiation_pressure: ArrayLike | None = None,
) -> Floats:
    """Phases of a region's points, phi_m = k |q_m - f| [rad], (M,): of a wave that converges to a point beyond.

    The point f = m + (d'/d) (m - c) lies d' beyond the region's middle m, which is d from the array's centre c. The
    wave comes from transducers within w (1 + d/d') of c, w being the region's width (root mean square, across the
    wave): d'/d is such that this is 0.4 of the array's radius, but 0.25 to 1, so that many transducers share the work
    (a solve with `facing`, for samples on skin: 0.4 to 1).
    A wave grows stronger on its way to f. So a region with a thickness s (root mean square along its thinnest axis),
    as the shell of a ball, needs d' >= 64 s, up to d'/d = 4. With these phases a field is even between points at most
    half a wavelength apart.

    array: as its radius counts the root mean square, each transducer weighted by its power at m. points: q, of one
    region, (M, 3) [m]. medium: `Air()` unless given. radiation_pressure: asked at the points, (M,), by which they are
    weighted, so that a point which comes or goes with little of it changes little; all alike unless given.
    Raises ArgumentError.
    """
    check_kind("array", array, Array)
    q = check_numbers("points", points, (None, 3))
    k = (Air() if medium is None else medium).wavenumber(array.transducer.frequency)
    P = np.ones(len(q))
    if radiation_pressure is not None:
        P = check_numbers("radiation_pressure", radiation_pressure, (len(q),))
    return _converging(q, P, array.positions, array.centre, k) if len(q) else np.empty(0)


def _converging(
    q: Floats, P: Floats, positions: Floats, centre: Floats, k: float, least: float = MIN_CONVERGENCE,
    tilt: float = 0.0,
) -> Floats:  # fmt: skip
    """As `joint_phases`.

    positions: of the transducers, (N, 3) [m], and their centre, (3,). least: d'/d at least. tilt: by how much the point
    f is moved aside, over the array's radius times d'/d.
    """
    phases = np.empty(len(q))
    kernels.converge(
        q,
        P,
        positions[:: -(-len(positions) // MAX_SUBSET)].copy(),
        centre.copy(),
        k,
        least,
        tilt,
        phases,
    )
    return phases


def settle_phases(
    propagator: Propagator, targets: Targets, warm: Solution | None, tilt: float = 0.0
) -> Targets:
    """The same targets with every phase given, for points where some belong to regions.

    Within a region the phases are those of `joint_phases`, turned aside from quiet zones, and turned as a whole by the
    region's own phase. That, and the phases of isolated samples, are chosen by Gerchberg-Saxton steps, as in `phases`:
    from those that `warm` made, so that none jumps. Phases that were given stay. tilt: by how much the waves come from
    aside, over the array's radius; 0 for none.
    """
    assert targets.regions is not None
    positions, centre = propagator.array.positions, propagator.origin
    least = MIN_CONVERGENCE if propagator.facing is None else ON_SKIN
    t, given = targets.amplitudes, ~targets.free
    M = len(t)
    k = propagator.medium.wavenumber(propagator.array.transducer.frequency)
    wave = np.zeros(M)
    for number in range(int(targets.regions.max()) + 1):
        own = targets.regions == number
        wave[own] = _converging(
            propagator.points[own], t[own] ** 2, positions, centre, k, least, tilt
        )
        if propagator.nulls is not None:
            wave[own] = _aside(gram_matrix(propagator.B[own]), t[own], wave[own])
    group, count = _groups(targets.regions, given)
    alone = (targets.regions == ISOLATED) & ~given
    start, steps = initial_phases(M, None if warm is None else _phases(warm))
    if warm is None:
        start = np.where(alone, start, wave)
    phi = np.where(given, targets.phases, np.where(alone, start, wave))
    # squares in single precision must not overflow
    p = t / (targets.norm or 1.0) * np.exp(1j * phi)
    # by how much each group is turned: the mean over its samples of what `start` has beyond `phi`
    z = np.zeros(count, np.complex128)
    np.add.at(z, group, t * np.exp(1j * (start - phi)))
    size = np.abs(z)
    z = np.where(size > 0.0, z / np.where(size > 0.0, size, 1.0), 1.0)
    fixed = bool(given.any())
    if fixed:
        z[0] = 1.0
    if count > 1:
        rows = np.empty((count, len(propagator.array)), propagator.dtype)
        kernels.stand_for(propagator.B, p.astype(np.complex128), group, rows)
        turns = np.ones(count, np.bool_)
        turns[0] = not fixed
        kernels.gerchberg_saxton(gram_matrix(rows), turns, steps, z)
    phases = np.where(given, targets.phases, phi + np.angle(z)[group])
    phases.flags.writeable = False
    return replace(targets, phases=phases)


def _aside(G: Complexes, t: Floats, wave: Floats) -> Floats:
    """Phases like those of a wave, (M,) [rad], which gains that keep zones quiet can make with less strength.

    The wave may go on to a zone. Steps p <- t exp(j arg(p - mu (G + mu I)^-1 p)) turn it aside: what it takes strength
    to make is left out of p. It is less even between the points then, so the steps are shorter where the first saves
    little, and none where that is no more than steps save without any zone. G: B B^H, (M, M). t: amplitudes, (M,).
    """
    mu = ASIDE * float(G.diagonal().real.mean())
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
    step = float(np.clip((saved - LITTLE_SAVED) / (MUCH_SAVED - LITTLE_SAVED), 0.0, 1.0))
    for _ in range(TURNS if step else 0):
        p = turned(np.angle(p - step * costly(p)))
    return np.asarray(np.angle(p), np.float64)


def carry_phases(
    propagator: Propagator, targets: Targets, warm: Solution, before: Floats
) -> Solution:
    """The last solution's phases for the points of now, where other samples may have come and gone.

    before: its points, (M', 3) [m]. Each point goes on from the nearest of its kind, if that is at most 3 mm away;
    others from the sound that is there. Multipliers are kept for the same samples only: they are rough where the
    array resolves little, so that those of other samples are worse than none.
    """
    q, asked = propagator.points, warm.asked_phases
    now, were = targets.regions, warm.targets.regions
    assert asked is not None
    assert now is not None
    assert were is not None
    same = len(q) == len(before) and np.array_equal(now, were)
    if same and float(np.abs(q - before).max()) < STILL:
        return warm
    known, nearest = np.zeros(len(q), np.bool_), np.zeros(len(q), np.intp)
    for kind_now, kind_then in (
        (now == ISOLATED, were == ISOLATED),
        (now >= 0, were >= 0),
    ):
        here, there = np.flatnonzero(kind_now), np.flatnonzero(kind_then)
        if len(here) and len(there):
            away, which = KDTree(before[there]).query(q[here])
            known[here], nearest[here] = np.asarray(away) < NEAR, there[np.asarray(which)]
    p = propagator.apply(warm.gains)
    phases = np.where(known, asked[nearest], np.angle(p))
    return replace(warm, sound_pressure=p, asked_phases=phases, multipliers=None)


def _phases(warm: Solution) -> Floats:
    """What was asked last, if that is known, else what was made of it [rad], (M,)."""
    return warm.phases if warm.asked_phases is None else warm.asked_phases


def _groups(regions: Longs, given: Flags) -> tuple[Longs, int]:
    """What turns as one: the group of each sample, (M,), and how many there are.

    Samples of given phase are group 0, if there are any.
    """
    regions = np.where(regions == BESIDE, 0, regions)  # silence has no phase
    own = np.where(regions == ISOLATED, regions.max() + 1 + np.arange(len(regions)), regions)
    names, group = np.unique(np.where(given, ISOLATED, own), return_inverse=True)
    return group.astype(np.int64), len(names)
