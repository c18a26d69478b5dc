"""Draw a picture of each built-in scene, at one moment. Needs Matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian import plot
from pacinian.gallery import SCENES
from pacinian.rendering.renderer import Renderer
from pacinian.scene.sampling.samples import join_samples, no_samples
from pacinian.testing import ManualClock

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from matplotlib.figure import Figure

    from pacinian.acoustics.array import Array

TICKS, TURN = 120, 10  # ticks of 1 ms; last ticks to average if a focus runs along a path
COLOURS = 256


def draw(array: Array, names: Sequence[str], folder: Path) -> Iterator[Path]:
    """Draw scenes as PNG files in `folder`, one after the other, but for the empty one. Raises MissingExtra."""
    for name in names:
        if name == "empty":
            continue
        path = folder / f"scene-{name}.png"
        plot.save(picture(array, name), path, COLOURS)
        yield path


def picture(array: Array, name: str) -> Figure:
    """Return a picture of a built-in scene, its samples and its field. Raises the error of a failed tick."""
    at, clock = SCENES[name], ManualClock()
    frames, felt, t = [], [no_samples()], 0.0
    with Renderer(array, at, adaptive=False, clock=clock) as renderer:
        for tick in range(TICKS):
            t = clock.time = tick * renderer.period
            renderer.tick(t)
            for fault in renderer.report.faults:
                raise fault.cause
            felt.append(renderer.samples or felt[-1])
            frames.append(renderer.cycle_gains)
    scene = at(t)
    if all(item.technique.keeps_places for item in scene.objects):
        samples, gains = felt[-1], frames[-1]
    else:
        samples, gains = join_samples(felt[-TURN:]), np.concatenate(frames[-TURN:])
    title = f"{name}: {at.__doc__}".rstrip(".")
    return plot.scene(
        array, scene, samples, gains, t=t, title=title, medium=renderer.session.medium
    )
