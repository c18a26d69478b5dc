"""A renderer's settings as plain values, and a renderer from them: for recordings."""

from __future__ import annotations

from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.array import Array
from pacinian.acoustics.directivity import Piston, omni, t4010a1
from pacinian.acoustics.transducer import Transducer
from pacinian.rendering.renderer import Renderer
from pacinian.rendering.smooth import Smoothing
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.scene import Scene

if TYPE_CHECKING:
    from pacinian.plugins.backend import Backend
    from pacinian.rendering.clock import Clock
    from pacinian.types import Floats

NAMED = {"omni": omni, "t4010a1": t4010a1}
SAMPLER = "budget", "spacing", "ramp", "perception"


def written(renderer: Renderer) -> dict[str, Any]:
    """Everything but the scene, the solver and the limits, which may change from tick to tick.

    A directivity that is not one of ours is left out: it cannot be read again.
    """
    session, sampler = renderer.session, renderer.sampler
    kind, response = session.array.transducer, session.array.response
    D = kind.directivity
    names = [name for name, function in NAMED.items() if function is D]
    medium = {f.name: getattr(session.medium, f.name) for f in fields(Air) if f.init}
    return {
        "rate": 1.0 / renderer.period,
        "governed": renderer.governor is not None,
        "smoothing": asdict(renderer.smoothing),
        "sampler": {name: getattr(sampler, name) for name in SAMPLER},
        "medium": medium,
        "transducer": {
            "frequency": kind.frequency,
            "pressure": kind.pressure,
            "directivity": asdict(D) if isinstance(D, Piston) else names[0] if names else None,
        },
        "response": None if response is None else response.astype("<c16").tobytes(),
    }


def read(
    settings: dict[str, Any], positions: Floats, normals: Floats, backend: Backend, clock: Clock
) -> Renderer:
    """A renderer with these settings, of an empty scene. Raises Exceptions of all kinds."""
    told: dict[str, Any] = settings["transducer"]
    D: Any = told["directivity"]
    kind = Transducer(
        frequency=told["frequency"],
        pressure=told["pressure"],
        directivity=Piston(**D) if isinstance(D, dict) else NAMED[D],
    )
    given = settings.get("response")
    response = None if given is None else np.frombuffer(given, "<c16")
    array = Array(positions, normals, kind, response)
    object.__setattr__(array, "normals", normals)  # bit for bit: they were of length 1 already
    return Renderer(
        array,
        Scene(),
        medium=Air(**settings["medium"]),
        backend=backend,
        rate=settings["rate"],
        sampler=Sampler(**settings["sampler"]),
        smoothing=Smoothing(**settings["smoothing"]),
        governed=settings["governed"],
        clock=clock,
    )
