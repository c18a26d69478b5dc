"""Weight sound by its angle of incidence on the skin, and by the hand's occlusion.

Sound presses skin along its normal. A plane wave of energy density E that is reflected at an angle theta from the
normal presses with 2 E cos^2(theta), which is twice its momentum flux along the normal. The same pressure follows from
|sum_n w_mn B_mn g_n|, with

    w_mn = max(0, cos(theta_mn)) s_mn

theta_mn: angle between the skin's outward normal at sample m and the direction to transducer n. s_mn, 0..1: fraction of
the sound on this path that the hand does not block. In the far field of each transducer, the sum is rho c times the
particle velocity along the normal. If waves from several directions meet, this holds only on average over some
wavelengths of skin, because their interference along the skin raises or lowers the pressure locally.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.argument_checks import MAX_LENGTH, check_length, check_numbers
from pacinian.errors import ArgumentError

if TYPE_CHECKING:
    from pacinian.acoustics.propagation import KernelData
    from pacinian.types import ArrayLike, Complexes, Flags, Floats, Indices, Singles

NO_HAND = np.empty((0, 8))
QUARTER = 2.125e-3  # a quarter of the wavelength at 40 kHz and 340 m/s [m]
MIN_WEIGHT = 1e-3  # smallest ||w_m||; smaller weights of a sample are set to 0
TILE = 256  # transducers per tile, so that the kernel's data fit the first-level cache
MIN_DIVISOR = 1e-30  # smallest divisor


@dataclass(frozen=True, eq=False)
class SkinFacing:
    """The orientation of the skin at M samples, and the hand that may occlude them.

    normals: outward, of unit length, (M, 3); zero for samples at which sound from all sides counts.
    capsules: tapered capsules of the hand, (C, 8) [m]: both ends of the axis, then the radius at each; none by default.
    edge: width of the soft edge of occlusion [m]. A ray that passes this far below a capsule's surface is blocked
    entirely; closer to the surface, it is blocked partly. Therefore gains do not jump when the hand moves. A sharper
    edge would not be more accurate, because sound bends around a hand.

    A convex body does not occlude its own outward side. A sample inside a capsule, which is possible for a mesh, is
    treated as if it were on the capsule's surface. Raises ArgumentError.
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
            longest <= MAX_LENGTH
            and 0.0 <= c[:, 6:].min(initial=0.0) <= c[:, 6:].max(initial=0.0) <= MAX_LENGTH
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
        """Make a `SkinFacing` from valid float64 arrays, without checks and copies, for use in each tick."""
        made = object.__new__(cls)
        made.__dict__.update(normals=normals, capsules=capsules, edge=QUARTER)
        return made

    def __len__(self) -> int:
        return len(self.normals)

    def only(self, rows: Indices | slice) -> SkinFacing:
        """Return the facing of samples `rows`, with the same hand."""
        return SkinFacing(self.normals[rows], self.capsules, self.edge)

    def weights(self, points: Floats, positions: Floats) -> Floats:
        """Return the weights w, (M, N), in double precision; the reference for the kernel.

        points: the samples, (M, 3) [m]. positions: of the transducers, (N, 3) [m].
        """
        w = self._cosines(points, positions) * self._compute_transmission(points, positions)
        w[(w * w).sum(axis=1) < MIN_WEIGHT * MIN_WEIGHT] = 0.0
        return w

    def compute_arrival(self, points: Floats, positions: Floats) -> Floats:
        """Like `weights`, but independent of the angle: s_mn for sound from the front, 0 from behind, (M, N)."""
        return (self._cosines(points, positions) > 0.0) * self._compute_transmission(
            points, positions
        )

    def weigh(self, points: Floats, wave: KernelData, rows: Indices, out: Complexes) -> None:
        """Multiply rows of B, `out`, (M, N), by their weights in place. points: (K, 3), for `rows`, (K,)."""
        if out.dtype == np.complex64:
            from pacinian.native.acoustics import weigh

            q = np.ascontiguousarray(points)
            n, c, boxes = self.normals, self.capsules, _boxes(wave)
            weigh(q, n, c, self.edge, wave.origin, wave.r, boxes, rows, out)
        else:
            out[rows] *= self.only(rows).weights(points, wave.array.positions)

    def find_changed(self, before: SkinFacing, points: Floats) -> Flags:
        """Return whether the weights of each sample at `points`, (M, 3), may differ from those of `before`, (M,)."""
        new, old = self.capsules, before.capsules
        if len(new) == len(old) and self.edge == before.edge:
            other = np.not_equal(new, old).any(axis=1)
            new, old = new[other], old[other]
        turned = np.not_equal(self.normals, before.normals).any(axis=1)
        return np.asarray(turned | self._under(new, points) | self._under(old, points))

    def _under(self, capsules: Floats, points: Floats) -> Flags:
        """Return whether any of these capsules rises above the skin's tangent plane, (M,)."""
        n, a, b = self.normals, capsules[:, :3], capsules[:, 3:6]
        top = np.maximum(n @ a.T + capsules[:, 6], n @ b.T + capsules[:, 7])  # (M, C)
        height = top - (n * points).sum(axis=1)[:, None]
        return np.asarray((height > 0.0).any(axis=1))

    def _cosines(self, points: Floats, positions: Floats) -> Floats:
        """Return max(0, cos(theta)), (M, N); 1 for samples without a normal."""
        d = positions - points[:, None]  # (M, N, 3) [m]
        along = np.einsum("mnk,mk->mn", d, self.normals)
        cosine = along / np.maximum(np.sqrt((d * d).sum(axis=2)), MIN_DIVISOR)
        return np.where(self.normals.any(axis=1, keepdims=True), np.maximum(cosine, 0.0), 1.0)

    def _compute_transmission(self, points: Floats, positions: Floats) -> Floats:
        """Return s, (M, N), the product of the fractions that the capsules let through, for sound from the front."""
        s = np.ones((len(points), len(positions)))
        for capsule in self.capsules:
            above = np.flatnonzero(
                self._under(capsule[None], points)
            )  # others are in no sound's way
            if not len(above):
                continue
            q = points[above]
            a, b, r, grows = capsule[:3], capsule[3:6], capsule[6], capsule[7] - capsule[6]
            w, e, d = (
                (q - a)[:, None],
                b - a,
                positions - q[:, None],
            )  # (K, 1, 3), (3,), (K, N, 3) [m]
            inside = np.maximum(_depth(w, np.zeros_like(w), e, r, grows), 0.0)
            deep = (_depth(w, d, e, r, grows) - inside) / self.edge
            s[above] *= smoothstep(1.0 - deep)
        return s


@functools.lru_cache(maxsize=16)
def _boxes(wave: KernelData) -> Singles:
    """Return boxes around equal tiles of the transducers: middle and half the sides, (tiles, 6) [m]."""
    N = wave.r.shape[1]
    starts = np.arange(0, N, -(-N // -(-N // TILE)))
    low, high = (f.reduceat(wave.r, starts, axis=1) for f in (np.minimum, np.maximum))
    boxes = np.concatenate([(low + high) / 2.0, (high - low) / 2.0]).T
    return np.ascontiguousarray(boxes, dtype=np.float32)


def smoothstep(x: Floats) -> Floats:
    """Return 3 x^2 - 2 x^3, which rises from 0 at x = 0 to 1 at x = 1; constant outside."""
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def _depth(w: Floats, d: Floats, e: Floats, r: float, grows: float) -> Floats:
    """Return how deep the paths w + s d, 0 <= s <= 1, go into a capsule, (M, N) [m]; negative outside.

    The capsule's axis is t e, 0 <= t <= 1, and its radius is r + t grows. The depth is the maximum over s and t of the
    radius minus the distance between path and axis. w: (M, 1, 3). d: (M, N, 3). As in `from_axis` of
    tapered_capsules.hpp, with the part of e along the path removed. If the infinite line is deepest outside the path,
    one end of the path is the deepest point.
    """
    ee, dd, de = float(e @ e), (d * d).sum(axis=2), d @ e
    ww, dw, we = (w * w).sum(axis=2), (d * w).sum(axis=2), w @ e
    inverse = 1.0 / np.maximum(dd, MIN_DIVISOR)

    def along(t: Floats) -> Floats:
        """Return the parameter s at which the path, extended to a line, is nearest to t e."""
        return np.asarray((t * de - dw) * inverse)

    def away(t: Floats, s: Floats) -> Floats:
        """Return the distance of t e from w + s d, correct to some nanometres."""
        square = ww + s * (s * dd + 2.0 * dw) + t * (t * ee - 2.0 * (we + s * de))
        return np.asarray(np.sqrt(np.maximum(square, 0.0)))

    def deepest(t: Floats, s: Floats, across: Floats) -> Floats:
        """Return the deepest t, if t e is nearest to w + s d. across: |e|^2 minus the part along the path."""
        room = np.maximum(across * (across - grows * grows), MIN_DIVISOR)
        return np.clip(t + grows * away(t, s) / np.sqrt(room), 0.0, 1.0)

    across = np.maximum(ee - de * de * inverse, MIN_DIVISOR)
    t = (we - de * dw * inverse) / across
    t = deepest(t, along(t), across)
    s = np.clip(along(t), 0.0, 1.0)  # for an end, a point, all of e is across
    at_end = deepest((we + s * de) / max(ee, MIN_DIVISOR), s, np.full_like(t, ee))
    t = np.where(along(t) == s, t, at_end)
    return np.asarray(r + t * grows - away(t, np.clip(along(t), 0.0, 1.0)))
