"""What to warn about before a scene is rendered, by the name of the object."""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure
from pacinian.acoustics.propagation import matrix
from pacinian.errors import PointOnTransducer
from pacinian.scene.objects import Particles, Path
from pacinian.scene.sampling.sample_counts import label_object
from pacinian.scene.sampling.sample_sources import lacks_surface
from pacinian.scene.sampling.sampler import OFF

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.sampler import Sampler
    from pacinian.scene.scene import Scene
    from pacinian.session import Session

MAX_OBJECTS = 1000  # largest number of objects that are checked
PLACES = 8  # number of places of a path, or of particles, at which a focus is computed
FAR = 5.0  # distance from the array from which a warning says that positions are in metres [m]
MAX_NAMED = 3  # largest number of objects named in one warning


def find_warnings(
    scene: Scene, sampler: Sampler, session: Session, gain: float, rate: float
) -> Iterator[str]:
    """Yield a sentence about the objects of a scene that cannot be rendered as they ask, for each reason.

    gain: largest amplitude of a transducer, 0..1. rate: of the device [Hz]. Raises ArgumentError if a texture's file
    cannot be read.
    """
    outside, weak, empty, fast = list[str](), list[str](), list[str](), list[str]()
    for i, item in islice(enumerate(scene.objects), MAX_OBJECTS):
        if not item.pressure > 0.0 or item.envelope == OFF:
            continue
        label = repr(label_object(item, i))
        if lacks_surface(item):
            empty.append(label)
        if is_too_fast(item, rate):
            fast.append(f"{label} ({find_highest_frequency(item):.4g} Hz)")
        away = 0.0 if scene.workspace is None else scene.workspace.distance(item.pose.position)
        if away > 0.0 and away > item.bounding_radius:
            outside.append(f"{label} ({away:.3g} m outside)")
        elif not item.focal and (most := _focus(item, session, gain)) < item.pressure:
            far = float(np.linalg.norm(np.asarray(item.pose.position) - session.array.centre))
            unit = f"; it is {far:.3g} m away, and positions are in metres" if far > FAR else ""
            weak.append(
                f"{label} ({item.pressure:.3g} Pa, where the array makes at most {most:.2g} Pa{unit})"
            )
    if outside:
        yield (
            f"outside the workspace, and so not rendered: {_name(outside)}. Move what should be felt, or widen the "
            "workspace"
        )
    if weak:
        yield (
            f"stronger than the array can be at that place: {_name(weak)}. Move nearer to the array, ask for less, or "
            "add units"
        )
    if empty:
        yield (
            f"without a surface: {_name(empty)}. An `SDF` must be 0 somewhere within its `extent`, in "
            "metres; an intersection needs parts that overlap, and a difference something that is left"
        )
    if fast:
        yield (
            f"faster than the device can play: {_name(fast)}. With {rate:.4g} frames a second, a frequency of "
            f"{rate / 2.0:.4g} Hz or more becomes another one, or none. Use a lower one, or a faster device"
        )
    for i, period, resolved in sampler.find_fine_textures(scene):
        yield (
            f"the texture of {label_object(scene.objects[i], i)!r} has a period of {1e3 * period:.1f} mm, and "
            f"the array resolves {1e3 * resolved:.1f} mm there: its ridges will blur. Use a longer period, a "
            "wider array, or a place nearer to it"
        )


def is_too_fast(item: Object, rate: float) -> bool:
    """Return whether a device of `rate` [Hz] cannot play the vibration of an object: from half of the rate on."""
    return find_highest_frequency(item) >= 0.5 * rate


def find_highest_frequency(item: Object) -> float:
    """Return the highest frequency of an object's envelope and technique [Hz]; 0 if it is not known, as of waves."""
    return max(
        float(getattr(each, name, 0.0))
        for each in (item.envelope, item.technique)
        for name in ("frequency", "high_frequency")
    )


def _name(labels: list[str]) -> str:
    """List the first of the labels, and say how many more there are."""
    more = len(labels) - MAX_NAMED
    return ", ".join(labels[:MAX_NAMED]) + (f" and {more} more" if more > 0 else "")


def _focus(item: Object, session: Session, gain: float) -> float:
    """Return the radiation pressure of the strongest focus [Pa] at the object's place, or at the weakest of several."""
    places = np.zeros((1, 3))  # of a body, whose samples may lie on the far side
    if isinstance(item, Particles) and item.positions:
        places = np.array(item.positions[:: -(-len(item.positions) // PLACES)])
    elif isinstance(item, Path):
        places = item.shape.sample_surface(item.shape.length / PLACES).points
    try:
        rows = matrix(session.array, item.pose.points(places), session.medium)
    except PointOnTransducer:
        return np.inf
    return float(radiation_pressure(gain * np.abs(rows).sum(axis=1), session.medium).min())
