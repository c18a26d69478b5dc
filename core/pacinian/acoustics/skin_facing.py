"""From which side the sound comes: skin is pressed along its normal, and a hand hides what is behind it.

A plane wave of energy density E that meets skin at theta from its normal and is turned back presses with
2 E cos^2(theta), twice its flux of momentum along the normal. So does |sum_n w_mn B_mn g_n|, with

    w_mn = max(0, cos(theta_mn)) s_mn

theta_mn: between the skin's outward normal at sample m and the way from there to transducer n. s_mn, 0..1:
what passes the hand on that way. In the far field of each transducer the sum is rho c times the particle
velocity along the normal. Where waves of several directions meet, it holds on the average over some
wavelengths of skin: from place to place, what they do along the skin makes pressure higher or lower.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.checks import FAR, check_length, check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.acoustics.propagation import KernelData
    from pacinian.types import ArrayLike, Complexes, Flags, Floats, Indices, Singles

NO_HAND = np.empty((0, 8))
QUARTER = 2.125e-3  # [m]: of the wavelength at 40 kHz in 340 m/s
FAINT = 1e-3  # a sample whose weights are smaller than this, ||w_m||, faces nothing: they are 0
TILE = 256  # transducers at a time: what the kernel needs of them stays in the first-level cache
TINY = 1e-30  # keeps quotients finite


@dataclass(frozen=True, eq=False)
class SkinFacing:
    """Which way the skin faces at M samples, and the hand that may be in the way.

    normals: outward, of unit length, (M, 3); zero where sound counts from every side.
    capsules: tapered, (C, 8) [m], both ends of the axis and the radius at either; none unless given.
    edge: [m]; a ray that passes this far below a capsule's surface is lost, and less of it the nearer
    it passes to the surface: gains do not jump as the hand moves, and sound bends around a hand, so
    that a harder edge would be no truer.
    A convex body hides nothing from its own outward side. A sample inside a capsule, as that of a mesh
    may be, is taken to be on its surface: the capsule counts up to there. Raises ArgumentError.
    """

    normals: Floats
    capsules: Floats
    edge: float

    def __init__(
        self, normals: ArrayLike, capsules: ArrayLike = NO_HAND, edge: float = QUARTER
    ) -> None:
        n = check_numbers("normals", normals, (None, 3))
        size = np.sqrt(np.einsum("mk,mk->m", n, n))[:, None]
        if not ((np.abs(size - 1.0) < 0.01) | (size == 0.0)).all():
            raise ArgumentError("normals", "must be unit vectors, or zero where all sides count")
        n = n / np.maximum(size, 0.5)
        c = check_numbers("capsules", capsules, (None, 8)).copy()
        longest = np.abs(c[:, 3:6] - c[:, :3]).max(initial=0.0)
        if not (
            longest <= FAR and 0.0 <= c[:, 6:].min(initial=0.0) <= c[:, 6:].max(initial=0.0) <= FAR
        ):
            raise ArgumentError(
                "capsules", "must be lengths [m] of a hand, and the radii 0 or more"
            )
        n.flags.writeable = c.flags.writeable = False
        object.__setattr__(self, "normals", n)
        object.__setattr__(self, "capsules", c)
        object.__setattr__(self, "edge", check_length("edge", edge))

    @classmethod
    def of(cls, normals: Floats, capsules: Floats) -> SkinFacing:
        """As the constructor, of float64 that is known to be right, and not copied: for each tick."""
        made = object.__new__(cls)
        made.__dict__.update(normals=normals, capsules=capsules, edge=QUARTER)
        return made

    def __len__(self) -> int:
        return len(self.normals)

    def only(self, rows: Indices | slice) -> SkinFacing:
        """Those samples, with the same hand."""
        return SkinFacing(self.normals[rows], self.capsules, self.edge)

    def weights(self, points: Floats, positions: Floats) -> Floats:
        """W, (M, N), in double precision: the reference for the kernel.

        points: the samples, (M, 3) [m]. positions: of the transducers, (N, 3) [m].
        """
        w = self._cosines(points, positions) * self._passing(points, positions)
        w[(w * w).sum(axis=1) < FAINT * FAINT] = 0.0
        return w

    def arriving(self, points: Floats, positions: Floats) -> Floats:
        """As `weights`, of sound that meets the skin at any angle: s_mn, 0 from behind, (M, N)."""
        return (self._cosines(points, positions) > 0.0) * self._passing(points, positions)

    def weigh(self, points: Floats, wave: KernelData, rows: Indices, out: Complexes) -> None:
        """Multiply rows of B in place by their weights. points: (K, 3) for `rows`, (K,). out: (M, N)."""
        if out.dtype == np.complex64:
            from pacinian.native.acoustics import weigh

            q = np.ascontiguousarray(points)
            n, c, boxes = self.normals, self.capsules, _boxes(wave)
            weigh(q, n, c, self.edge, wave.origin, wave.r, boxes, rows, out)
        else:
            out[rows] *= self.only(rows).weights(points, wave.array.positions)

    def moved(self, before: SkinFacing, points: Floats) -> Flags:
        """Samples at `points`, (M, 3), for which other sound may count than `before`, (M,)."""
        new, old = self.capsules, before.capsules
        if len(new) == len(old) and self.edge == before.edge:
            other = np.not_equal(new, old).any(axis=1)
            new, old = new[other], old[other]
        turned = np.not_equal(self.normals, before.normals).any(axis=1)
        return np.asarray(turned | self._under(new, points) | self._under(old, points))

    def _under(self, capsules: Floats, points: Floats) -> Flags:
        """Whether any of those capsules rises above the skin's tangent plane, (M,)."""
        n, a, b = self.normals, capsules[:, :3], capsules[:, 3:6]
        top = np.maximum(n @ a.T + capsules[:, 6], n @ b.T + capsules[:, 7])  # (M, C)
        height = top - (n * points).sum(axis=1)[:, None]
        return np.asarray((height > 0.0).any(axis=1))

    def _cosines(self, points: Floats, positions: Floats) -> Floats:
        """max(0, cos(theta)), (M, N); 1 for samples without a normal."""
        d = positions - points[:, None]  # (M, N, 3) [m]
        along = np.einsum("mnk,mk->mn", d, self.normals)
        cosine = along / np.maximum(np.sqrt((d * d).sum(axis=2)), TINY)
        return np.where(self.normals.any(axis=1, keepdims=True), np.maximum(cosine, 0.0), 1.0)

    def _passing(self, points: Floats, positions: Floats) -> Floats:
        """s, (M, N): the product of what each capsule lets through."""
        d = positions - points[:, None]  # (M, N, 3) [m]
        s = np.ones(d.shape[:2])
        for capsule in self.capsules:
            a, b, r, grows = capsule[:3], capsule[3:6], capsule[6], capsule[7] - capsule[6]
            w, e = (points - a)[:, None], b - a  # (M, 1, 3), (3,) [m]
            inside = np.maximum(_depth(w, np.zeros_like(w), e, r, grows), 0.0)
            deep = (_depth(w, d, e, r, grows) - inside) / self.edge
            s *= smoothstep(1.0 - deep)
        return s


@functools.lru_cache(maxsize=16)
def _boxes(wave: KernelData) -> Singles:
    """Boxes around equal tiles of the transducers: the middle and half of the sides, (tiles, 6) [m]."""
    N = wave.r.shape[1]
    starts = np.arange(0, N, -(-N // -(-N // TILE)))
    low, high = (f.reduceat(wave.r, starts, axis=1) for f in (np.minimum, np.maximum))
    boxes = np.concatenate([(low + high) / 2.0, (high - low) / 2.0]).T
    return np.ascontiguousarray(boxes, dtype=np.float32)


def smoothstep(x: Floats) -> Floats:
    """3 x^2 - 2 x^3, from 0 at x = 0 to 1 at x = 1, and the same beyond."""
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def _depth(w: Floats, d: Floats, e: Floats, r: float, grows: float) -> Floats:
    """How deep the ways w + s d, 0 <= s <= 1, go into the capsule along e from the origin [m]; negative outside.

    The most of r + t grows less the distance of t e, 0 <= t <= 1, for w (M, 1, 3), d (M, N, 3): (M, N). As for
    `from_axis` of tapered.hpp, with e less its part along the way; where the way would be deepest before it begins, or
    after it ends, its end is deepest.
    """
    ee, dd, de = float(e @ e), (d * d).sum(axis=2), d @ e
    dw, we = (d * w).sum(axis=2), w @ e
    inverse = 1.0 / np.maximum(dd, TINY)

    def along(t: Floats) -> Floats:
        """Where on the way it is nearest to t e, if the way went on."""
        return np.asarray((t * de - dw) * inverse)

    def away(t: Floats, s: Floats) -> Floats:
        """How far t e is from w + s d."""
        gap = w + s[..., None] * d - t[..., None] * e
        return np.asarray(np.sqrt((gap * gap).sum(axis=2)))

    def deepest(t: Floats, s: Floats, across: Floats) -> Floats:
        """Where on the axis it is, if t e is nearest to w + s d. across: |e|^2 less its part along the way."""
        room = np.maximum(across * (across - grows * grows), TINY)
        return np.clip(t + grows * away(t, s) / np.sqrt(room), 0.0, 1.0)

    across = np.maximum(ee - de * de * inverse, TINY)
    t = (we - de * dw * inverse) / across
    t = deepest(t, along(t), across)
    s = np.clip(along(t), 0.0, 1.0)  # an end of the way is a point: all of e is across
    at_end = deepest((we + s * de) / max(ee, TINY), s, np.full_like(t, ee))
    t = np.where(along(t) == s, t, at_end)
    return np.asarray(r + t * grows - away(t, np.clip(along(t), 0.0, 1.0)))
