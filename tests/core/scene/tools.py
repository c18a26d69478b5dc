"""What several tests of scenes share: rigid motions by SciPy, distances from capsules, meshes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import replace
from scipy.spatial.transform import Rotation

import pacinian as pc

if TYPE_CHECKING:
    import trimesh

    from pacinian.types import Floats


def random_pose(seed: int, size: float = 0.3) -> pc.Pose:
    """Turned in any way, and up to `size` from the origin along each axis [m]."""
    rng = np.random.default_rng(seed)
    turn = Rotation.random(rng=rng).as_quat()
    return pc.Pose(tuple(rng.uniform(-size, size, 3)), tuple(turn.tolist()))


def moved(item: Any, pose: pc.Pose) -> Any:
    """An object after a rigid motion."""
    turn = Rotation.from_quat(pose.rotation)
    if isinstance(item, pc.Point):
        return replace(item, position=tuple(turn.apply(item.position) + pose.position))
    position = turn.apply(item.pose.position) + pose.position
    rotation = (turn * Rotation.from_quat(item.pose.rotation)).as_quat()
    return replace(item, pose=pc.Pose(tuple(position), tuple(rotation)))


def to_capsules(capsules: Floats, points: Floats) -> Floats:
    """Signed distance of each point to each tapered capsule, (points, capsules) [m].

    The least of |p - c(s)| - r(s), which is convex in s: by ternary search.
    """
    axis, grows = capsules[:, 3:6] - capsules[:, :3], capsules[:, 7] - capsules[:, 6]
    aa, w = (axis * axis).sum(axis=1), points[:, None] - capsules[:, :3]
    wa, ww = (w * axis).sum(axis=2), (w * w).sum(axis=2)

    def away(s: Floats) -> Floats:
        square = ww - 2.0 * s * wa + s * s * aa
        return np.sqrt(np.maximum(square, 0.0)) - capsules[:, 6] - s * grows

    low, high = np.zeros_like(wa), np.ones_like(wa)
    for _ in range(45):  # what is left of s counts squared
        third = (high - low) / 3.0
        left = away(low + third) < away(high - third)
        low, high = np.where(left, low, low + third), np.where(left, high - third, high)
    s = np.where(away(np.zeros_like(wa)) < away(np.ones_like(wa)), 0.0, 1.0)  # where an end is best
    best = (low + high) / 2.0
    s = np.where(away(best) < away(s), best, s)
    return np.asarray(np.linalg.norm(w - s[..., None] * axis, axis=2) - capsules[:, 6] - s * grows)


def mesh_of(mesh: trimesh.Trimesh) -> pc.Mesh:
    """The same triangles as a shape."""
    return pc.Mesh(vertices=mesh.vertices, faces=mesh.faces)  # type: ignore[arg-type]
