"""A hand as a tracker reports it: 26 joints, or a mesh of its skin."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np

from pacinian.acoustics.pose import Pose
from pacinian.argument_checks import check_kind, check_number, check_numbers
from pacinian.errors import ArgumentError
from pacinian.scene.hands import default_hand

if TYPE_CHECKING:
    from pacinian.types import ArrayLike, Floats, Indices

Side = Literal["left", "right"]

MAX_SIZE = 1.0  # largest extent of a hand [m]
MIN_SIZE = 0.01  # smallest extent of a hand; a smaller hand is lost [m]
MAX_COORDINATE = 1e6  # larger coordinates [m] and velocities [m/s] count as not measured
MAX_RADIUS = 0.1  # largest radius of a joint [m]
HERE = Pose()
# Indices of joints. KNUCKLE is the middle finger's metacarpal joint; its proximal joint follows.
PALM, WRIST, KNUCKLE = 0, 1, 11


@dataclass(frozen=True, eq=False)
class Hand:
    """A hand at one moment, in the world's frame.

    joints: (26, 3) [m], in the order of OpenXR's XrHandJointEXT: palm, wrist, four of the thumb (metacarpal, proximal,
    distal, tip), and five of each finger from the index on (metacarpal, proximal, intermediate, distal, tip). radii:
    from each joint to the skin, (26,) [m]; by default those of an adult. side: "left" or "right". velocities: of the
    joints, (26, 3) [m/s], or (3,) for all; unknown unless given and finite. time: when the hand was measured [s].
    vertices, faces: a mesh of the skin, (V, 3) [m] and (F, 3), which replaces joints and radii. name: by default, the
    side.

    A tracker that loses the hand may report joints or vertices that are NaN, infinite, 1000 km away, or all within a
    centimetre (for example, zeros). Such a hand is `lost`: its radii are ignored, and it must not be placed. Raises
    ArgumentError for other invalid values.
    """

    joints: Floats | None
    radii: Floats
    side: Side
    velocities: Floats | None
    time: float | None
    vertices: Floats | None
    faces: Indices | None
    name: str
    lost: bool = field(init=False, repr=False)

    def __init__(
        self,
        joints: ArrayLike | None = None,
        radii: ArrayLike | None = None,
        *,
        side: Side = "right",
        velocities: ArrayLike | None = None,
        time: float | None = None,
        vertices: ArrayLike | None = None,
        faces: ArrayLike | None = None,
        name: str = "",
    ) -> None:
        if side not in ("left", "right"):
            raise ArgumentError("side", f'must be "left" or "right", not {side!r}')
        if (vertices is None) != (faces is None):
            raise ArgumentError("vertices", "and `faces` must be given together")
        if joints is None and vertices is None:
            raise ArgumentError("joints", "or `vertices` and `faces` must be given")
        J, lost = _read_points("joints", joints, (default_hand.JOINTS, 3))
        V, gone = _read_points("vertices", vertices, (None, 3))
        self._set(
            joints=J,
            radii=RADII if radii is None or (J is not None and lost) else _radii(radii),
            side=side,
            velocities=None if velocities is None else _velocities(velocities),
            time=None if time is None else check_number("time", time),
            vertices=V,
            faces=None if faces is None or V is None else _faces(faces, len(V)),
            name=name or side,
            lost=lost or gone,
        )

    @classmethod
    def open(cls, side: Side = "right", pose: Pose = HERE, **given: Any) -> Hand:
        """Make an adult's flat hand with straight, slightly spread fingers. Its palm joint is at the pose's position.

        In the pose's frame, the fingers point along +y and the palm faces -z. Without a rotation, the palm therefore
        faces an array that emits upwards. Seen from above, the thumb of a right hand is at -x, and that of a left hand
        at +x. given: radii, velocities, time or name.
        """
        check_kind("pose", pose, Pose)
        local = default_hand.rest_joints()
        if side == "left":
            local[:, 0] *= -1.0
        return cls(pose.points(local), side=side, **given)

    @classmethod
    def leap(
        cls, bones: ArrayLike, widths: ArrayLike, wrist: ArrayLike, side: Side, **given: Any
    ) -> Hand:
        """Make a hand from the layout of Ultraleap's LeapC (LEAP_HAND), with lengths in metres (LeapC's times 1e-3).

        bones: both ends (prev_joint, next_joint) of the four bones (metacarpal, proximal, intermediate, distal) of the
        five digits from the thumb on, (5, 4, 2, 3) [m]. The thumb's metacarpal is ignored, because it has no length in
        LeapC; the anatomical one is LeapC's proximal. widths: of the flesh around each bone, (5, 4) [m]; the radius of
        a joint is a quarter of the sum of the widths of its two bones. wrist: the arm's next_joint, (3,) [m]; its
        radius is that of an adult, because LeapC reports only the width of the forearm. given: velocities, time or
        name.

        The palm joint is the middle of the middle finger's metacarpal, as in OpenXR, which differs a little from
        LEAP_PALM.
        """
        B, lost = _mask_unmeasured("bones", bones, (5, 4, 2, 3))
        W = np.full((5, 4), 0.02) if lost else check_numbers("widths", widths, (5, 4))
        joints, radii = np.zeros((default_hand.JOINTS, 3)), RADII.copy()
        joints[WRIST] = _mask_unmeasured("wrist", wrist, (3,))[0]
        first = 2
        for digit in range(5):
            chain, width = (B[0, 1:], W[0, 1:]) if digit == 0 else (B[digit], W[digit])
            last = first + len(chain)
            joints[first:last], joints[last] = chain[:, 0], chain[-1, 1]
            around = np.concatenate([width[:1], width, width[-1:]])
            radii[first : last + 1] = (around[:-1] + around[1:]) / 4.0
            first = last + 1
        joints[PALM] = (joints[KNUCKLE] + joints[KNUCKLE + 1]) / 2.0
        radii[PALM] = radii[KNUCKLE]
        return cls(joints, radii, side=side, **given)

    def transform(self, pose: Pose) -> Hand:
        """Return this hand, rotated about the world's origin and then shifted by `pose`. Its velocities are rotated.

        Raises ArgumentError.
        """
        check_kind("pose", pose, Pose)
        return self._with(
            joints=None if self.joints is None else pose.points(self.joints),
            velocities=None if self.velocities is None else pose.directions(self.velocities),
            vertices=None if self.vertices is None else pose.points(self.vertices),
        )

    def extrapolate(self, seconds: float) -> Hand:
        """Return this hand `seconds` later, at constant velocities, or the hand itself if these are unknown.

        All vertices move with the velocity of the palm joint.
        """
        if self.velocities is None:
            return self
        J, V, v = self.joints, self.vertices, self.velocities * seconds
        return self._with(
            joints=None if J is None else J + v,
            vertices=None if V is None else V + v[PALM],
            time=None if self.time is None else self.time + seconds,
        )

    @property
    def carriers(self) -> Floats:
        """The points that carry the skin: the vertices or, without a mesh, the joints, (P, 3) [m]."""
        points = self.joints if self.vertices is None else self.vertices
        assert points is not None  # one of them was given
        return points

    def same(self, other: Hand) -> bool:
        """Return whether this hand equals `other` in all its values, time and name included."""
        return (self.side, self.time, self.name) == (other.side, other.time, other.name) and all(
            a is b or (a is not None and b is not None and np.array_equal(a, b, equal_nan=True))
            for a, b in (
                (self.joints, other.joints),
                (self.vertices, other.vertices),
                (self.velocities, other.velocities),
                (self.radii, other.radii),
                (self.faces, other.faces),
            )
        )

    def translate(self, offset: ArrayLike) -> Hand:
        """Return this hand shifted by `offset` [m]: (3,), or one for each of its carriers, (P, 3).

        A shift of each carrier leaves joints that carry no skin where they are. Raises ArgumentError.
        """
        if not _is_vector(offset):
            name = "joints" if self.vertices is None else "vertices"
            d = check_numbers("offset", offset, self.carriers.shape)
            return self._with(**{name: self.carriers + d})
        d = check_numbers("offset", offset, (3,))
        return self._with(
            joints=None if self.joints is None else self.joints + d,
            vertices=None if self.vertices is None else self.vertices + d,
        )

    def _with(self, **changes: Any) -> Hand:
        """Return this hand with `changes`, which are not checked."""
        hand = object.__new__(Hand)
        hand._set(**{**self.__dict__, **changes})
        return hand

    def _set(self, **values: Any) -> None:
        for value in values.values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
        self.__dict__.update(values)


def _mask_unmeasured(
    name: str, value: ArrayLike, shape: tuple[int | None, ...]
) -> tuple[Floats, bool]:
    """Return a copy of `value` with NaN for each number that was not measured, and whether there are any."""
    try:
        known = np.abs(cast("Floats", value)) < MAX_COORDINATE  # False for NaN
    except (TypeError, ValueError):
        return check_numbers(name, value, shape).copy(), False
    array = check_numbers(name, np.where(known, cast("Floats", value), 0.0), shape)
    return np.where(known, array, np.nan), not known.all()


def _is_vector(value: ArrayLike) -> bool:
    try:
        return np.ndim(value) == 1
    except ValueError:  # ragged
        return False


def _read_points(
    name: str, value: ArrayLike | None, shape: tuple[int | None, ...]
) -> tuple[Floats | None, bool]:
    """Return positions, if given, and whether they are those of a lost hand. Raises ArgumentError."""
    if value is None:
        return None, False
    points, lost = _mask_unmeasured(name, value, shape)
    return points, lost or _is_collapsed(name, points)


def _is_collapsed(name: str, points: Floats) -> bool:
    """Return whether the points are too small for a hand. Raises ArgumentError if they are too large (millimetres)."""
    across = float(np.ptp(points, axis=0).max(initial=0.0)) if len(points) else 0.0
    if across > MAX_SIZE:  # False for NaN
        raise ArgumentError(
            name, f"span {across:.4g} m: lengths are in metres (were millimetres given?)"
        )
    return across < MIN_SIZE


def _radii(value: ArrayLike) -> Floats:
    radii = check_numbers("radii", value, (default_hand.JOINTS,)).copy()
    if radii.min() <= 0.0:
        raise ArgumentError("radii", f"must be more than 0, not {radii.min():g}")
    if radii.max() > MAX_RADIUS:
        raise ArgumentError(
            "radii", f"reach {radii.max():.4g} m: lengths are in metres (were millimetres given?)"
        )
    return radii


def _velocities(value: ArrayLike) -> Floats | None:
    shape = (3,) if _is_vector(value) else (default_hand.JOINTS, 3)
    v, unknown = _mask_unmeasured("velocities", value, shape)
    return None if unknown else np.broadcast_to(v, (default_hand.JOINTS, 3)).copy()


def _faces(value: ArrayLike, vertices: int) -> Indices:
    faces = check_numbers("faces", value, (None, 3))
    if not len(faces) or (faces % 1.0).any() or faces.min() < 0 or faces.max() >= vertices:
        raise ArgumentError("faces", f"must be whole numbers from 0 to {vertices - 1}, of vertices")
    return faces.astype(np.intp)


RADII = default_hand.rest_radii()
