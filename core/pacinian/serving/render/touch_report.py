"""What a hand touches, and if nothing, the nearest object: the renderer's part of why the output is silent."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.scene.hands.capsules import distance_to_skin, find_bounds, make_capsules
from pacinian.scene.objects import Surface, Volume
from pacinian.scene.sampling.perception_thresholds import find_vibration, lowest_threshold
from pacinian.scene.sampling.sample_counts import OUTSIDE
from pacinian.wire.silence_cause import UNTOUCHED, Silence
from pacinian.wire.state import TouchState

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.sample_counts import ObjectSampleCounts
    from pacinian.scene.sampling.samples import Samples
    from pacinian.types import Floats

BONE_POINTS = 5  # number of places on each bone at which the distance to an object is computed
MAX_NAMED = 3  # largest number of objects named in one text
# Largest number of objects whose distance is computed: those nearest by their bounding spheres.
MAX_MEASURED = 8
UNSEEN = "the touched skin faces away from the array, or hardly touches: turn the palm to the array, or press deeper"


class Nearest(NamedTuple):
    """The object nearest to a hand. gap: distance from the skin [m]; negative if the hand touches the object."""

    item: Object
    gap: float


def find_touches(samples: Samples, hands: Sequence[Hand]) -> tuple[TouchState, ...]:
    """Return which of the hands feel which objects, from the samples on their skin. Lost hands feel nothing."""
    seen = [hand for hand in hands if not hand.lost]
    if not seen or not len(samples):
        return ()
    P, nearest = samples.radiation_pressure, np.zeros(len(samples), dtype=np.intp)
    if len(seen) > 1:
        away = [distance_to_skin(make_capsules(hand), samples.positions) for hand in seen]
        nearest = np.argmin(away, axis=0)
    felt = P > 0.0
    pairs = sorted({*zip(nearest[felt].tolist(), samples.objects[felt].tolist(), strict=True)})
    touches: list[TouchState] = []
    for hand, item in pairs:
        here = felt & (nearest == hand) & (samples.objects == item)
        x, y, z = np.average(samples.positions[here], axis=0, weights=P[here]).tolist()
        touches.append(
            TouchState(
                object=samples.items[item].name,
                hand=seen[hand].name.rsplit("@", 1)[
                    0
                ],  # without the client's number, if it has one
                position=(x, y, z),
                pressure=float(P[here].max()),
                strength=min(1.0, float((P[here] / samples.most[here]).max())),
            )
        )
    return tuple(touches)


def explain_contact(hands: Iterable[Hand], objects: Iterable[Object]) -> Silence:
    """Return why no skin of the hands can be pressed. objects: with the pressures that are rendered."""
    nearest = find_nearest(hands, objects)
    if nearest is None:
        return Silence("nothing in reach", UNTOUCHED)
    name, pressure = nearest.item.name, nearest.item.pressure
    if nearest.gap > 0.0:
        away = f'"{name}" is nearest, {1e3 * nearest.gap:.0f} mm away'
        return Silence("nothing in reach", f"{UNTOUCHED}: {away}")
    if not pressure > 0.0:
        return Silence("no pressure", f'"{name}" is touched, but its pressure is 0')
    least = lowest_threshold(find_vibration(nearest.item))
    if pressure < least:
        text = f'"{name}" is touched, but its {pressure:.2g} Pa are below the {least:.2g} Pa that can be felt'
        return Silence("too faint", text)
    return Silence("out of the array's reach", f'"{name}" is touched, but {UNSEEN}')


def explain_loading(names: Iterable[str]) -> Silence | None:
    """Return the cause if objects of these names are prepared for the first time."""
    new = [f'"{name}"' for name in names]
    if not new:
        return None
    listed = ", ".join(new[:MAX_NAMED]) + (" and others" if len(new) > MAX_NAMED else "")
    return Silence(
        "not ready",
        f"being prepared: {listed}; meshes, textures and sounds take up to some seconds",
    )


def explain_outside(counts: Mapping[str, ObjectSampleCounts]) -> Silence | None:
    """Return the cause if objects that need no hand lie outside the workspace. counts: of each object, by its label."""
    outside = [f'"{label}"' for label, one in counts.items() if OUTSIDE in one.reasons]
    if not outside:
        return None
    names = ", ".join(outside[:MAX_NAMED]) + (" and others" if len(outside) > MAX_NAMED else "")
    advice = "move what should be felt, or widen `workspace` in the server's settings"
    return Silence("no pressure", f"outside the workspace: {names}; {advice}")


def find_nearest(hands: Iterable[Hand], objects: Iterable[Object]) -> Nearest | None:
    """Return the object nearest to any hand; None without hands that are seen, or without objects."""
    bones = [make_capsules(hand) for hand in hands if not hand.lost]
    capsules, items = np.concatenate([np.empty((0, 8)), *bones]), list(objects)
    if not len(capsules) or not items:
        return None
    points, radii = _sample_bones(capsules)
    bounds = _bound_gaps(items, capsules)
    nearest: Nearest | None = None
    for i in np.argsort(bounds)[:MAX_MEASURED].tolist():
        if nearest is not None and bounds[i] >= nearest.gap:
            break
        if (gap := _measure_gap(items[i], points, radii)) < (nearest.gap if nearest else math.inf):
            nearest = Nearest(items[i], gap)
    return nearest


def _sample_bones(capsules: Floats) -> tuple[Floats, Floats]:
    """Return points on the axes of capsules (C, 8), (P, 3) [m], and the radius of the flesh at each, (P,) [m]."""
    along = np.linspace(0.0, 1.0, BONE_POINTS)[:, None, None]
    first, last, radii = capsules[:, :3], capsules[:, 3:6], capsules[:, 6:]
    points = (1.0 - along) * first + along * last
    around = (1.0 - along[..., 0]) * radii[:, 0] + along[..., 0] * radii[:, 1]
    return points.reshape(-1, 3), around.ravel()


def _bound_gaps(items: Sequence[Object], capsules: Floats) -> Floats:
    """Return lower bounds of the gaps between skin and each of K objects, from bounding spheres, (K,) [m]."""
    spheres = find_bounds(capsules)
    bones, c = spheres[:, :3], np.array([item.pose.position for item in items])
    squares = (c**2).sum(axis=1)[:, None] + (bones**2).sum(axis=1) - 2.0 * c @ bones.T
    away = np.sqrt(np.maximum(squares, 0.0)) - spheres[:, 3]
    return np.asarray(away.min(axis=1) - np.array([item.bounding_radius for item in items]))


def _measure_gap(item: Object, points: Floats, radii: Floats) -> float:
    """Return the gap between skin and object [m]."""
    local = (points - np.array(item.pose.position)) @ item.pose.matrix
    if isinstance(item, (Surface, Volume)):
        return float((item.distance(local, math.inf, math.inf) - radii).min(initial=math.inf))
    places = item.sample_surface(item.radius).points
    gaps = [
        math.sqrt(((places - point) ** 2).sum(axis=1).min(initial=math.inf)) - radius
        for point, radius in zip(local, radii.tolist(), strict=True)
    ]
    return min(gaps, default=math.inf) - item.radius
