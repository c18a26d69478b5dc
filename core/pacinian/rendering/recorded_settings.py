"""A renderer's settings as plain values, for recordings."""

from __future__ import annotations

from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any, Protocol

from pacinian.acoustics import array_record
from pacinian.acoustics.air import Air

if TYPE_CHECKING:
    from pacinian.rendering.loop_settings import LoopSettings
    from pacinian.scene.sampling.sampler import Sampler
    from pacinian.session import Session

# Attributes of the sampler that a recording contains.
SAMPLER = "budget", "spacing", "ramp", "perception"


class HasSettings(Protocol):
    """The part of a `Renderer` that holds its settings."""

    session: Session
    sampler: Sampler
    settings: LoopSettings


def to_config(renderer: HasSettings) -> dict[str, Any]:
    """Return all settings except scene, solver and limits, which may change from tick to tick.

    `rerender.from_config` makes a renderer of them.
    """
    session, sampler, settings = renderer.session, renderer.sampler, renderer.settings
    medium = {f.name: getattr(session.medium, f.name) for f in fields(Air) if f.init}
    return {
        "rate": 1.0 / settings.period,
        "adaptive": settings.adaptive,
        "strict": settings.strict,
        "max_cycle_frames": settings.max_cycle_frames,
        "peak": settings.peak,
        "smoothing": asdict(settings.smoothing),
        "sampler": {name: getattr(sampler, name) for name in SAMPLER},
        "medium": medium,
        **array_record.to_map(session.array),
    }
