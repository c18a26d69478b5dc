"""A cache of objects' samples in their own frames, so that a moved object costs only a transform."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pacinian.scene.objects import Body, Path, Volume

if TYPE_CHECKING:
    from pacinian.scene.objects import Object
    from pacinian.scene.shapes.local_samples import LocalSamples

MAX_ENTRIES = 1024  # largest number of cached sets of samples


class SampleCache:
    """Samples by shape and spacing. The least recently used are evicted first."""

    def __init__(self) -> None:
        self._covers: dict[tuple[object, ...], tuple[object, LocalSamples]] = {}

    def get(self, item: Object, spacing: float) -> LocalSamples:
        """Return the samples of `item`, about `spacing` [m] apart."""
        what = getattr(item, "shape", item)
        how = item.felt if isinstance(item, Volume) else getattr(item, "width", None)
        key = id(what), how, spacing if what is not item else 0.0
        kept = self._covers.pop(key, None)
        if kept is None:
            while len(self._covers) >= MAX_ENTRIES:
                del self._covers[next(iter(self._covers))]
            made = item.sample_surface(spacing)
            for values in made:
                values.flags.writeable = False
            kept = what, made  # holds the shape, so that no other object can get its id
        self._covers[key] = kept
        return kept[1]


def estimate_samples(item: Object, spacing: float) -> float:
    """Estimate the number of samples of an object, `spacing` [m] apart, without making them."""
    if isinstance(item, Path):
        return max(1.0, item.shape.length / spacing)
    if not isinstance(item, Body):
        return 1.0
    if isinstance(item, Volume) and item.felt == "interior":
        return max(1.0, 8.0 * math.prod(item.shape.extent) / spacing**3)
    return max(1.0, item.shape.area / spacing**2)
