"""Keep the radiation pressure on the skin that is seen at or below `peak`, also where no target was set.

`peak` is the limit that a `Renderer` is given. "Highest" pressures are those that are found.

The skin is that of the hands in the scene, where they were last seen, as far as a transducer may see it. It is
evaluated at points half a wavelength apart, then near the strongest of these at points closer and closer together.
Without a hand, no skin is seen, and nothing is evaluated.

While the highest pressure is far below the limit, only every eighth solution that is like the last is evaluated. The
others are not final: if nothing moves any more, they are solved again, and evaluated.

On skin, the pressure is that along its normal, as in targets; see `pacinian.SkinFacing`.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure, sound_pressure
from pacinian.acoustics.propagation import KernelData
from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.errors import PointOnTransducer
from pacinian.native import solving as kernels
from pacinian.region_numbers import ISOLATED

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.rendering.cached_solution import CachedSolution
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.sampling.posed_skin import PosedSkin
    from pacinian.scene.sampling.samples import Samples
    from pacinian.session import Session
    from pacinian.types import Complexes, Flags, Floats, Gains, Indices

SPACING = 0.58  # spacing of the first points on the skin, over the wavelength
# Largest ratio of the pressure between the first points to the pressure at the nearest of them.
MAX_HIDDEN_RATIO = 8.0
# A first point is skipped if the cosine between its normal and the direction to every transducer is below this.
MIN_COSINE = -0.5
# Number of transducers that represent the array where a point's view of it is tested, besides the corners of its box.
VIEWPOINTS = 32
RINGS = 3  # number of rings of points around each of the strongest points, in the last steps
FINEST = 0.05  # spacing of the points in the last step, over the wavelength
# Size of a hand, over the usual one, above which a step with wider rings comes first.
MIN_LARGE_SIZE = 1.25
MAX_STRONGEST = 16  # largest number of points around which the last steps search
# Smallest pressure of such a point, relative to the highest pressure so far, or to the limit if that is higher. Near
# weaker points, there is no higher pressure.
MIN_STRONGEST_SHARE = 0.6
CHUNK = 64  # number of points that are evaluated at a time
# Number of phases at which the sum of groups is evaluated to find its largest amplitude.
SUM_PHASES = 16
MARGIN = (
    1.03  # factor on the highest pressure found, because a higher one may lie between the points
)
MIN_LENGTH = 1e-9  # smallest length of a vector used as a divisor
# If the highest pressure is at most this share of the limit, the next solutions that are like it are not evaluated.
MAX_UNEVALUATED_SHARE = 0.25
MAX_NOT_EVALUATED = 7  # largest number of successive solutions that are not evaluated
# A solution is like the last evaluated one only if neither the sum of its gains' amplitudes nor its highest target is
# larger by more than this factor, and if the middle of its samples, and each hand, are less than a wavelength away.
MAX_LIKE_RATIO = 1.2


class _Summary(NamedTuple):
    """Describes an evaluated solution, so that the next ones can be compared with it.

    peak: limit of the pressure on skin [Pa]. drive: sum of the gains' amplitudes. asked: highest target [Pa]. middle:
    of the samples, (3,) [m]. hands: their centres by name, (3,) [m].
    """

    peak: float
    drive: float
    asked: float
    middle: Floats
    hands: dict[str, Floats]


class SkinLimit:
    """Evaluates solutions on skin.

    session: has the array and the air.
    """

    def __init__(self, session: Session) -> None:
        array, medium = session.array, session.medium
        self._medium, self._wave = medium, KernelData.prepare(array, medium)
        self._wavelength = medium.wavelength(array.transducer.frequency)  # [m]
        self._response = 1.0 if array.response is None else np.abs(array.response)
        self._positions = array.positions
        low, high = array.positions.min(axis=0), array.positions.max(axis=0)
        corners = list(product(*zip(low, high, strict=True)))
        every = -(-len(array) // VIEWPOINTS)
        some = array.positions[::every]
        self._viewpoints = np.concatenate([corners, some])  # stand for all, (V, 3) [m]
        self._B: Gains = np.empty((CHUNK, len(array)), np.complex64)
        self.reset()

    def reset(self) -> None:
        """Evaluate the next solution, whatever was found before."""
        self._last: _Summary | None = None  # whose pressure was far below the limit
        self._passed = 0  # solutions since then

    def enforce(
        self, made: CachedSolution, skins: Sequence[PosedSkin], peak: float, *, again: bool = False
    ) -> CachedSolution:
        """Return a solution, scaled down if its pressure on skin would exceed `peak` [Pa].

        again: whether the samples are the same as for the previous solution; then this one is always evaluated.
        Otherwise, if it is like the last evaluated one, it may be returned unevaluated, and as not final.
        """
        if peak == math.inf or not len(made.samples):
            return made
        if not skins:
            self.reset()  # a hand that comes back is evaluated at once
            return made
        contributions = made.gains[None] if made.contributions is None else made.contributions
        highest = self.find_highest_pressure(contributions, skins, made.samples, peak, again=again)
        if highest is None:
            return replace(made, evaluated=False, final=False, steady=False)
        return scale_to_peak(made, peak, highest) if highest > peak else made

    def holds_for(self, hand: Hand, amplitudes: Floats, peak: float) -> bool:
        """Return whether transducers with these amplitudes, (N,), cannot exceed `peak` [Pa] at a hand, at any phases.

        hand: one that is not lost; its skin need not be known.
        """
        thick = 0.0 if hand.joints is None else float(hand.radii.max())
        q = hand.carriers
        low, high = q.min(axis=0) - thick, q.max(axis=0) + thick
        return self._is_below(amplitudes[None], low, high, peak)

    def find_highest_pressure(
        self, contributions: Gains, skins: Sequence[PosedSkin], samples: Samples, peak: float,
        *, again: bool = False,
    ) -> float | None:  # fmt: skip
        """Return the highest radiation pressure on the skins [Pa] that gains can cause.

        Returns 0 if it is clearly below `peak` [Pa], and None if the gains are not evaluated, because they are like
        the last ones that were. again: as for `enforce`.

        contributions: to the gains, (V, N), each of which sounds with a factor from 0 to 1 of its own.
        """
        contributions = np.ascontiguousarray(contributions, np.complex64)
        asked = float(samples.radiation_pressure.max(initial=0.0))
        middle = samples.positions.mean(axis=0)
        hands = {skin.hand.name: np.array(skin.centre) for skin in skins}
        summary = _Summary(peak, float(np.abs(contributions).sum()), asked, middle, hands)
        if not again and self._is_like_last(summary):
            self._passed += 1
            return None
        highest = self._evaluate_skins(contributions, skins, samples, peak)
        self._last, self._passed = (summary if highest <= MAX_UNEVALUATED_SHARE * peak else None), 0
        return highest

    def _is_like_last(self, summary: _Summary) -> bool:
        """Return whether a solution is not evaluated, because it is like the last one that was."""
        last = self._last
        if last is None or self._passed == MAX_NOT_EVALUATED:
            return False
        if summary.hands.keys() != last.hands.keys():
            return False
        moved = [summary.middle - last.middle]
        moved += [centre - last.hands[name] for name, centre in summary.hands.items()]
        more = (
            summary.drive > MAX_LIKE_RATIO * last.drive
            or summary.asked > MAX_LIKE_RATIO * last.asked
        )
        near = all(float(d @ d) < self._wavelength**2 for d in moved)
        return summary.peak == last.peak and not more and near

    def _evaluate_skins(
        self, contributions: Gains, skins: Sequence[PosedSkin], samples: Samples, peak: float
    ) -> float:
        """Return the highest radiation pressure [Pa]; 0 if the transducers' pressures cannot add up to `peak`."""
        capsules = np.concatenate([np.empty((0, 8)), *(skin.capsules for skin in skins)])
        skins = [
            skin
            for skin in skins
            if not self._is_below(contributions, skin.box[:3], skin.box[3:], peak)
        ]
        if not skins:
            return 0.0
        points, normals, owner, P = self._find_strong(contributions, skins, samples, peak, capsules)
        highest, stretch = float(P.max(initial=0.0)), max(map(_stretch, skins))
        for step in (stretch, 1.0) if stretch > MIN_LARGE_SIZE else (1.0,):
            best = np.argsort(P)[-MAX_STRONGEST:]
            best = best[P[best] >= MIN_STRONGEST_SHARE * max(highest, peak)]
            if not len(best):
                break
            points, normals = spread(
                points[best], normals[best], RINGS, step * FINEST * self._wavelength
            )
            owner = np.repeat(owner[best], len(points) // len(best))
            # The skin is curved. Where it turns towards sound that arrives at a slant, the pressure is much higher.
            for k, skin in enumerate(skins):
                own = owner == k
                points[own], normals[own], _ = skin.closest(points[own])
            P = self._evaluate(contributions, points, SkinFacing.of(normals, capsules))
            highest = max(highest, float(P.max()))
        return MARGIN * highest

    def _find_strong(
        self, contributions: Gains, skins: Sequence[PosedSkin], samples: Samples, peak: float,
        capsules: Floats,
    ) -> tuple[Floats, Floats, Indices, Floats]:  # fmt: skip
        """Return points of skin near those whose pressure is high, and isolated samples.

        Returns points, normals, the index of each point's skin, -1 for samples, and pressures [Pa]. capsules: of all
        hands, (C, 8) [m].
        """
        alone = samples.regions == ISOLATED
        found = [(samples.positions[alone], samples.normals[alone])]
        for skin in skins:
            level = skin.skin.level(round(SPACING * self._wavelength / _stretch(skin), 6))
            nodes, owners = skin.skin.counts[level], skin.skin.share[level].indices
            P = np.zeros(nodes)
            shown = self._find_shown(skin, np.arange(nodes), MIN_COSINE)
            P[shown] = self._evaluate(contributions, skin.points[shown])
            # Skin that a bent joint uncovers has none of the first points near it, so it is always evaluated.
            near = np.flatnonzero(
                (peak / MAX_HIDDEN_RATIO <= P)[owners].any(axis=1) | skin.skin.hidden
            )
            near = self._find_shown(skin, near, 0.0)
            found.append((skin.points[near], skin.normals[near]))
        owner = np.repeat(np.arange(-1, len(skins)), [len(points) for points, _ in found])
        points, normals = (np.concatenate(each) for each in zip(*found, strict=True))
        P = self._evaluate(contributions, points, SkinFacing.of(normals, capsules))
        return points, normals, owner, P

    def _find_shown(self, skin: PosedSkin, which: Indices, least: float) -> Indices:
        """Return those of the points `which`, (I,), that are on the outside and that a transducer may see.

        least: cosine of the angle between their normal and the direction to it.
        """
        which = which[skin.find_exposed(which)]
        return which[self._may_see(skin, which, least)]

    def _may_see(self, skin: PosedSkin, which: Indices, least: float) -> Flags:
        """Return whether the cosine of a normal and the direction to a transducer exceeds `least`, about, (I,).

        which: points, (I,).
        """
        q, n, r = skin.points[which], skin.normals[which], self._viewpoints
        along = n @ r.T - np.einsum("ij,ij->i", n, q)[:, None]
        squared = (q * q).sum(axis=1)[:, None] + (r * r).sum(axis=1) - 2.0 * (q @ r.T)
        return np.asarray((along > least * np.sqrt(np.maximum(squared, 0.0))).any(axis=1))

    def _is_below(
        self, contributions: Gains | Floats, low: Floats, high: Floats, peak: float
    ) -> bool:
        """Return whether the sum of the transducers' pressures is below `peak` [Pa] in a whole box, and just around it.

        low, high: corners of the box, (3,) [m].
        """
        wave, r = self._wave, self._positions
        away = np.maximum(np.maximum(low - r, r - high), 0.0)
        distance = np.sqrt((away * away).sum(axis=1)) - self._wavelength
        if distance.min() <= 0.0:
            return False
        _, power, beta, pressure = (float(value) for value in wave.law)
        reach = pressure * float(np.abs(wave.table).max()) * self._response
        each = reach * distance**-power * np.exp(-beta * distance)
        return bool(
            each @ np.abs(contributions).sum(axis=0) < float(sound_pressure(peak, self._medium))
        )

    def _evaluate(
        self, contributions: Gains, points: Floats, facing: SkinFacing | None = None
    ) -> Floats:
        """Return the highest radiation pressure that the contributions can have at points, (K, 3) [m], (K,) [Pa].

        facing: of the skin there; None to count all sound.
        """
        p = np.empty(len(points))
        for first in range(0, len(points), CHUNK):
            some = points[first : first + CHUNK]
            B = self._B[: len(some)]
            try:
                self._wave.matrix(some, B)
            except PointOnTransducer as error:  # where no skin can be
                B[error.indices] = 0.0
            if facing is not None:
                part = SkinFacing.of(facing.normals[first : first + CHUNK], facing.capsules)
                part.weigh(some, self._wave, np.arange(len(some)), B)
            z = np.empty((len(contributions), len(some)), np.complex128)
            for each, out in zip(contributions, z, strict=True):
                kernels.apply(B, each, out)
            p[first : first + CHUNK] = np.abs(z[0]) if len(contributions) == 1 else sum_up(z)
        return radiation_pressure(p, self._medium)


def _stretch(skin: PosedSkin) -> float:
    """Return how much farther apart the points of a hand are than those of a hand of usual size, at least 1."""
    return max(1.0, math.sqrt(float(skin.area.sum() / skin.skin.area.sum())))


def sum_up(z: Complexes) -> Floats:
    """Return the largest |sum_v a_v z_v| over all 0 <= a_v <= 1, from above by at most 2 %, (K,). z: (V, K)."""
    turn = np.exp(-2j * np.pi * np.arange(SUM_PHASES) / SUM_PHASES)
    along = (turn[:, None, None] * z).real  # (SUM_PHASES, V, K)
    largest = np.maximum(along, 0.0).sum(axis=1).max(axis=0)
    return np.asarray(largest / math.cos(math.pi / SUM_PHASES))


def spread(points: Floats, normals: Floats, rings: int, spacing: float) -> tuple[Floats, Floats]:
    """Return a hexagonal patch around each of K points, in the plane across its normal.

    points, normals: (K, 3). rings: around each point. spacing: [m]. Returns points and normals, both (K n, 3), of
    patches of n = 1 + 3 rings (rings + 1) points.
    """
    i, j = np.mgrid[-rings : rings + 1, -rings : rings + 1].reshape(2, -1)
    i, j = (each[np.abs(i + j) <= rings] for each in (i, j))
    x, y = spacing * (i + 0.5 * j), spacing * math.sqrt(0.75) * j
    axis = np.eye(3)[np.abs(normals).argmin(axis=1)]
    a = np.cross(normals, axis)
    a /= np.maximum(np.sqrt((a * a).sum(axis=1, keepdims=True)), MIN_LENGTH)
    b = np.cross(normals, a)
    made = points[:, None] + x[:, None] * a[:, None] + y[:, None] * b[:, None]
    return made.reshape(-1, 3), np.repeat(normals, len(x), axis=0)


def scale_to_peak(made: CachedSolution, peak: float, highest: float) -> CachedSolution:
    """Return a solution, all of it scaled down so that its highest radiation pressure on skin is `peak` [Pa].

    highest: this pressure before scaling [Pa].
    """
    share = peak / highest
    note = (
        f"{highest:.3g} Pa on the skin would exceed the limit of {peak:.3g} Pa: "
        f"all pressures are {share:.0%} of the solver's"
    )
    return replace(made.scale(math.sqrt(share), note), limited=True)
