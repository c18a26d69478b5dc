"""Convert a renderer's settings to and from plain values, for recordings."""

from __future__ import annotations

import math
from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any

from pacinian.acoustics import array_record
from pacinian.acoustics.air import Air
from pacinian.rendering.renderer import Renderer
from pacinian.rendering.slew_limiter import Smoothing
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.scene import Scene

if TYPE_CHECKING:
    from pacinian.acoustics.array import Array
    from pacinian.plugins.backend import Backend
    from pacinian.rendering.clock import Clock

SAMPLER = "budget", "spacing", "ramp", "perception"


def to_config(renderer: Renderer) -> dict[str, Any]:
    """Return all settings except scene, solver and limits, which may change from tick to tick."""
    session, sampler = renderer.session, renderer.sampler
    medium = {f.name: getattr(session.medium, f.name) for f in fields(Air) if f.init}
    return {
        "rate": 1.0 / renderer.period,
        "governed": renderer.governor is not None,
        "cycle": renderer.cycle,
        "peak": renderer.peak,
        "smoothing": asdict(renderer.smoothing),
        "sampler": {name: getattr(sampler, name) for name in SAMPLER},
        "medium": medium,
        **array_record.to_map(session.array),
    }


def from_config(settings: dict[str, Any], array: Array, backend: Backend, clock: Clock) -> Renderer:
    """Make a renderer with these settings and an empty scene; array: as recorded. May raise any Exception."""
    if settings["transducer"]["directivity"] is None:
        raise ValueError("the transducers had a user-defined directivity, which cannot be recorded")
    return Renderer(
        array,
        Scene(),
        medium=Air(**settings["medium"]),
        backend=backend,
        rate=settings["rate"],
        sampler=Sampler(**settings["sampler"]),
        smoothing=Smoothing(**settings["smoothing"]),
        governed=settings["governed"],
        cycle=settings.get("cycle", 1),
        peak=settings.get("peak", math.inf),
        clock=clock,
    )
