"""Why objects have no samples: they are silent, outside the workspace, too far away, or on skin that faces away."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.scene.modulation.waves import Constant
from pacinian.scene.objects import Surface, Volume
from pacinian.scene.sampling.contact import touches_unseen
from pacinian.scene.sampling.sample_cache import estimate_samples
from pacinian.scene.sampling.sample_counts import FACES_AWAY, FAR, OUTSIDE
from pacinian.scene.sampling.sample_keys import number_contact, number_object
from pacinian.scene.sampling.spacing import compute_spacing

if TYPE_CHECKING:
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.array_resolution import ArrayResolution
    from pacinian.scene.sampling.distance_cache import DistanceCache
    from pacinian.scene.sampling.pose_prediction import PosePredictor
    from pacinian.scene.sampling.posed_skin import PosedSkin
    from pacinian.scene.sampling.sample_counts import SampleCounts
    from pacinian.scene.scene import Scene

OFF = Constant(0.0)
MAX_UNSEEN = 8  # largest number of objects that are checked for skin that faces away


def is_silent(item: Object) -> bool:
    """Return whether the pressure or the envelope of an object is always 0."""
    return not item.pressure > 0.0 or item.envelope == OFF


def note_outside(scene: Scene, near: list[int], spacing: float | None, counts: SampleCounts) -> int:
    """Count the samples of objects that need no hand, but lie outside the workspace or too far from the array.

    near: indices of the other objects. spacing: of samples [m], or None for the default. Returns the number of objects
    outside the workspace that are not silent.
    """
    outside = 0
    for i in sorted(set(range(len(scene.objects))) - set(near)):
        item = scene.objects[i]
        if is_silent(item):
            continue
        apart = spacing or compute_spacing(item, item.pose.position, None)
        count = round(estimate_samples(item, apart))
        counts.ask(i, count)
        counts.note(FAR if scene.workspace is None else OUTSIDE, i, count)
        outside += scene.workspace is not None
    return outside


def note_unseen(
    scene: Scene, t: float, near: list[int], hands: list[PosedSkin], poses: PosePredictor,
    resolving: ArrayResolution, distances: DistanceCache, counts: SampleCounts,
) -> None:  # fmt: skip
    """Note objects that touch only skin that faces away from the array, where nothing is felt.

    near: indices of the objects near the hands; the first MAX_UNSEEN are checked.
    """
    for i in near[:MAX_UNSEEN]:
        item = scene.objects[i]
        if not isinstance(item, (Surface, Volume)) or is_silent(item):
            continue
        pose, number = poses.pose(item, t), number_object(item, i)
        if any(
            touches_unseen(item, pose, number_contact(number, hand), hand, resolving, distances)
            for hand in hands
        ):
            counts.note_object(FACES_AWAY, i)
