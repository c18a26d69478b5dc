"""Evaluate what a hand feels over all touched skin, at points that are not the sampler's."""

from __future__ import annotations

import functools
from collections import Counter
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from pacinian.acoustics.pressure import radiation_pressure
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.rendering.reachability import ReachabilityFilter
from pacinian.scene.config_sections import MIN_SAMPLE_SPACING
from pacinian.scene.hands.capsule_skin import CapsuleSkin
from pacinian.scene.sampling.sampler import Sampler
from pacinian.session import Session
from pacinian.solving.felt_figures import MIN_FELT_SHARE, FeltRegion

if TYPE_CHECKING:
    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.scene.scene import Scene
    from pacinian.types import Floats, Gains

# of the evaluated skin, which has a point for each square millimetre [m]
SPACING, GRAIN = 7.5e-4, 3.75e-4
BUDGET = 1_000_000  # samples; more than a hand has points
# [m] distances from touched skin between which skin is beside it
BESIDE_FROM, BESIDE_TO = 3e-3, 30e-3


def measure_felt(
    array: Array, medium: Air, scene: Scene, t: float, gains: Gains
) -> FeltRegion | None:
    """Compare what a hand feels at time t [s] with the request of the materials. Returns None without contact.

    The figures cover the whole touched skin, weighted by its area, at points 1 mm apart that are not those of the
    sampler. gains: as emitted, (N,), or of frames whose mean counts, (K, N). Spill is the highest pressure on skin 3
    to 30 mm beside the touched skin.
    """
    sampler = Sampler(BUDGET, MIN_SAMPLE_SPACING, perception=False)
    sampler.skin = _fine()
    sampler.prepare(array, medium)
    samples = sampler.sample(scene, t)
    samples = samples.only(samples.regions >= 0)
    if samples.capsules is None or not len(samples):
        return None
    session = Session(array, medium)
    q, facing = samples.positions, SkinFacing(samples.normals, samples.capsules)
    asked = samples.radiation_pressure * ReachabilityFilter(session.propagator).weigh_targets(
        q, facing, Counter()
    )
    if not asked.any():
        return None
    session.propagator.set_points(q, facing)
    P, area = _compute_pressure(session, gains), samples.area
    e, mean = P - asked, float(asked @ area) / float(area.sum())
    return FeltRegion(
        force=float(P @ area) / float(asked @ area),
        rms=float(np.sqrt((e * e) @ area / ((asked * asked) @ area))),
        holes=float(area[MIN_FELT_SHARE * asked > P].sum() / area.sum()),
        spill=_beside(session, scene, q, gains) / mean,
    )


def _beside(session: Session, scene: Scene, touched: Floats, gains: Gains) -> float:
    """Return the highest pressure on untouched skin near touched skin [Pa]."""
    most, skin, tree = 0.0, _fine(), KDTree(touched)
    for hand in scene.hands:
        if hand.lost or hand.joints is None:
            continue
        placed = skin.place(hand)
        away = np.asarray(tree.query(placed.points)[0])
        beside = np.flatnonzero((away > BESIDE_FROM) & (away < BESIDE_TO))
        beside = beside[skin.find_exposed(placed, beside)]
        if len(beside):
            facing = SkinFacing(placed.normals[beside], placed.capsules)
            session.propagator.set_points(placed.points[beside], facing)
            most = max(most, float(_compute_pressure(session, gains).max()))
    return most


def _compute_pressure(session: Session, gains: Gains) -> Floats:
    """Return the radiation pressure at the session's points, (M,) [Pa], as the mean over several gains."""
    made = [session.propagator.apply(g) for g in np.atleast_2d(gains)]
    return np.asarray(np.mean([radiation_pressure(p, session.medium) for p in made], axis=0))


@functools.cache
def _fine() -> CapsuleSkin:
    return CapsuleSkin(SPACING, GRAIN)
