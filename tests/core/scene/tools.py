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
    """Signed distance of each point to each capsule, (points, capsules) [m]."""
    a, b = capsules[:, :3], capsules[:, 3:6]
    axis = b - a
    square = np.maximum((axis**2).sum(axis=1), 1e-300)
    along = np.clip(((points[:, None] - a) * axis).sum(axis=2) / square, 0.0, 1.0)
    nearest = a + along[..., None] * axis
    return np.asarray(np.linalg.norm(points[:, None] - nearest, axis=2) - capsules[:, 6])


def mesh_of(mesh: trimesh.Trimesh) -> pc.Mesh:
    """The same triangles as a shape."""
    return pc.Mesh(vertices=mesh.vertices, faces=mesh.faces)  # type: ignore[arg-type]
