"""Warn about what cannot be rendered as requested, before a scene is rendered. A warning names its objects."""

from __future__ import annotations

import logging
from contextlib import suppress
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure
from pacinian.acoustics.propagation import matrix
from pacinian.errors import PacinianError, PointOnTransducer
from pacinian.rendering.playback import find_ceiling
from pacinian.rendering.row_times import describe_mismatch
from pacinian.scene.objects import Particles, Path
from pacinian.scene.sampling.sample_counts import label_object
from pacinian.scene.sampling.sample_sources import lacks_surface
from pacinian.scene.sampling.unsampled_objects import is_silent

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from pacinian.plugins.backend import Capability
    from pacinian.rendering.report import Report
    from pacinian.scene.objects import Object
    from pacinian.scene.sampling.sampler import Sampler
    from pacinian.scene.scene import Scene
    from pacinian.session import Session
    from pacinian.solving.limits import Limits

MAX_OBJECTS = 1000  # largest number of objects that are checked
# Largest number of places of a path, or of particles, at which a focus is computed.
MAX_FOCUS_PLACES = 8
# Distance from the array beyond which positions are probably not in metres [m]. Farther objects probably have positions
# in another unit; the warning then names the unit.
PROBABLY_NOT_METRES = 5.0
MAX_NAMED = 3  # largest number of objects named in one warning


def add_warnings(report: Report, warnings: Iterable[str]) -> None:
    """Log warnings, and keep them in the report. An error in a file ends them: the first tick will report it."""
    with suppress(PacinianError):
        for text in warnings:
            report.warnings += (text,)
            logging.getLogger("pacinian").warning("%s", text)


def find_warnings(
    scene: Scene, sampler: Sampler, session: Session, limits: Limits, capability: Capability, period: float
) -> Iterator[str]:  # fmt: skip
    """Yield one sentence for each reason why some objects cannot be rendered as requested; it names these objects.

    Also warns if the rate of the device does not fit that of the loop. limits: of the gains. capability: of the device.
    period: of a tick [s]. Raises ArgumentError if a texture's file cannot be read.
    """
    gain, rate = find_ceiling(limits), capability.rate
    outside, mute, weak = list[str](), list[str](), list[str]()
    empty, fast = list[str](), list[str]()
    for i, item in islice(enumerate(scene.objects), MAX_OBJECTS):
        if is_silent(item):
            continue
        label = repr(label_object(item, i))
        if lacks_surface(item):
            empty.append(label)
        if is_too_fast(item, rate):
            fast.append(f"{label} ({find_highest_frequency(item):.4g} Hz)")
        away = 0.0 if scene.workspace is None else scene.workspace.distance(item.pose.position)
        if away > 0.0 and away > item.bounding_radius:
            outside.append(f"{label} ({away:.3g} m outside)")
        elif not item.focal:
            most = _focus(item, session, gain)
            far = float(np.linalg.norm(np.asarray(item.pose.position) - session.array.centre))
            if most == 0.0 and far <= PROBABLY_NOT_METRES:
                mute.append(label)
            elif most < item.pressure:
                unit = (
                    f"; it is {far:.3g} m away, and positions are in metres"
                    if far > PROBABLY_NOT_METRES
                    else ""
                )
                weak.append(
                    f"{label} ({item.pressure:.3g} Pa, where the array produces at most {most:.2g} Pa{unit})"
                )
    if outside:
        yield (
            f"outside the workspace, and therefore not rendered: {_name(outside)}. Move these objects into the "
            "workspace, or enlarge the workspace"
        )
    if mute:
        yield (
            f"where the array makes no sound, in its plane or behind it: {_name(mute)}. Move these objects to the "
            "front of the array"
        )
    if weak:
        yield (
            f"stronger than the array can produce at the place of the object: {_name(weak)}. Move the object nearer to "
            "the array, reduce its `radiation_pressure` or `force`, or add units to the array"
        )
    if empty:
        yield (
            f"without a surface: {_name(empty)}. The distance of an `SDF` must be 0 somewhere within its `extent` [m]. "
            "The parts of an intersection must overlap. A difference must leave a part of its solid `of`"
        )
    if fast:
        yield (
            f"faster than the device can play: {_name(fast)}. With {rate:.4g} rows a second, a frequency of "
            f"{rate / 2.0:.4g} Hz or more is played at a wrong, lower frequency (aliasing), or not at all. Use a lower "
            "frequency, or a faster device"
        )
    for i, ridges, resolved in sampler.find_fine_textures(scene):
        yield (
            f"the texture of {label_object(scene.objects[i], i)!r} has a period of {1e3 * ridges:.1f} mm, and "
            f"the array resolves only {1e3 * resolved:.1f} mm there, so the ridges will blur. Use a longer period or a "
            "wider array, or move the object nearer to the array"
        )
    if (text := describe_mismatch(capability, period)) is not None:
        yield text


def is_too_fast(item: Object, rate: float) -> bool:
    """Return whether an object vibrates at half the device's `rate` [Hz] or faster, which the device cannot play."""
    return find_highest_frequency(item) >= 0.5 * rate


def find_highest_frequency(item: Object) -> float:
    """Return the highest frequency of an object's envelope and technique [Hz]; 0 if unknown, for example for a wave."""
    return max(
        float(getattr(each, name, 0.0))
        for each in (item.envelope, item.technique)
        for name in ("frequency", "high_frequency")
    )


def _name(labels: list[str]) -> str:
    """Return the first `MAX_NAMED` labels as text, with the number of further labels."""
    more = len(labels) - MAX_NAMED
    return ", ".join(labels[:MAX_NAMED]) + (f" and {more} more" if more > 0 else "")


def _focus(item: Object, session: Session, gain: float) -> float:
    """Return the radiation pressure [Pa] of the strongest focus at an object, or at the weakest of several places.

    Infinite if a place lies on a transducer, or if there are no places.
    """
    places = np.zeros((1, 3))  # the centre of a body, because its samples may lie on the far side
    if isinstance(item, Particles):
        if not item.positions:
            return np.inf
        places = np.array(item.positions[:: -(-len(item.positions) // MAX_FOCUS_PLACES)])
    elif isinstance(item, Path):
        places = item.shape.sample_surface(item.shape.length / MAX_FOCUS_PLACES).points
    try:
        rows = matrix(session.array, item.pose.points(places), session.medium)
    except PointOnTransducer:
        return np.inf
    return float(radiation_pressure(gain * np.abs(rows).sum(axis=1), session.medium).min())
