"""A cache of objects' samples in their own frames, so that a moved object costs only a transform."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.scene.objects import Body, Path, Volume
from pacinian.scene.sampling.textured_samples import TexturedSamples, lay_out
from pacinian.scene.shapes.sdf import SHELL_GAP

if TYPE_CHECKING:
    from pacinian.scene.objects import Object
    from pacinian.scene.shapes.local_samples import LocalSamples
    from pacinian.scene.shapes.texture import Texture

MAX_ENTRIES = 1024  # largest number of cached sets of samples


class SampleCache:
    """Samples by shape, texture and spacing. The least recently used are evicted first."""

    def __init__(self) -> None:
        self._samples: dict[tuple[object, ...], tuple[object, TexturedSamples]] = {}

    def get(self, item: Object, spacing: float) -> LocalSamples:
        """Return the samples of `item`, about `spacing` [m] apart."""
        return self._get(item, spacing, None).local

    def get_textured(self, item: Object, spacing: float) -> TexturedSamples:
        """Return the samples of `item`, about `spacing` [m] apart, and the factors of its texture."""
        return self._get(item, spacing, getattr(item, "texture", None))

    def _get(self, item: Object, spacing: float, texture: Texture | None) -> TexturedSamples:
        what = getattr(item, "shape", item)
        how = item.felt if isinstance(item, Volume) else getattr(item, "width", None)
        key = id(what), id(texture), how, spacing if what is not item else 0.0
        kept = self._samples.pop(key, None)
        if kept is None:
            while len(self._samples) >= MAX_ENTRIES:
                del self._samples[next(iter(self._samples))]
            if texture is None:
                local = item.sample_surface(spacing)
                K = len(local.points)
                made = TexturedSamples(local, np.ones(K), np.zeros(K, np.bool_))
            else:
                made = lay_out(texture, self.get(item, spacing), spacing)
            for values in (*made.local, made.factor, made.silent):
                values.flags.writeable = False
            # holds shape and texture, so that no other object can get their ids
            kept = (what, texture), made
        self._samples[key] = kept
        return kept[1]


def estimate_samples(item: Object, spacing: float) -> float:
    """Estimate the number of samples of an object, `spacing` [m] apart, without making them."""
    if isinstance(item, Path):
        return max(1.0, item.shape.length / spacing)
    if not isinstance(item, Body):
        return 1.0
    surface = item.shape.area / spacing**2
    if isinstance(item, Volume) and item.felt == "interior":
        inner = (max(0.0, half - SHELL_GAP * spacing) for half in item.shape.extent)
        return max(1.0, 8.0 * math.prod(inner) / spacing**3 + surface)
    return max(1.0, surface)
