"""Shared by tests of scenes: rigid motions by SciPy, distances from capsules, meshes."""

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
    """Return a pose with any rotation, up to `size` from the origin along each axis [m]."""
    rng = np.random.default_rng(seed)
    turn = Rotation.random(rng=rng).as_quat()
    return pc.Pose(tuple(rng.uniform(-size, size, 3)), tuple(turn.tolist()))


def moved(item: Any, pose: pc.Pose) -> Any:
    """Return an object after a rigid motion."""
    turn = Rotation.from_quat(pose.rotation)
    if isinstance(item, pc.Point):
        return replace(item, position=tuple(turn.apply(item.position) + pose.position))
    position = turn.apply(item.pose.position) + pose.position
    rotation = (turn * Rotation.from_quat(item.pose.rotation)).as_quat()
    return replace(item, pose=pc.Pose(tuple(position), tuple(rotation)))


def to_capsules(capsules: Floats, points: Floats) -> Floats:
    """Return the signed distance of each point to each tapered capsule, (points, capsules) [m].

    It is the minimum of |p - c(s)| - r(s), which is convex in s: at a zero of its derivative, or at an end.
    """
    axis, grows = capsules[:, 3:6] - capsules[:, :3], capsules[:, 7] - capsules[:, 6]
    aa, w = np.maximum((axis * axis).sum(axis=1), 1e-30), points[:, None] - capsules[:, :3]
    foot = np.einsum("pcx,cx->pc", w, axis) / aa
    beside = np.linalg.norm(w - foot[..., None] * axis, axis=2)
    steep = aa - grows * grows  # not positive if one sphere contains the other
    beyond = grows * beside / np.sqrt(aa * np.where(steep > 0.0, steep, 1.0))
    s = np.clip(foot + np.where(steep > 0.0, beyond, np.copysign(np.inf, grows)), 0.0, 1.0)
    return np.asarray(np.hypot(beside, (foot - s) * np.sqrt(aa)) - capsules[:, 6] - s * grows)


def mesh_of(mesh: trimesh.Trimesh) -> pc.Mesh:
    """Return the same triangles as a shape."""
    return pc.Mesh(vertices=mesh.vertices, faces=mesh.faces)  # type: ignore[arg-type]
