"""How each object is covered with samples, in its own frame: kept, so that a moved one costs a transform."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pacinian.scene.objects import Body, Path, Volume

if TYPE_CHECKING:
    from pacinian.scene.objects import Object
    from pacinian.scene.shapes.local_samples import LocalSamples

MAX_ENTRIES = 1024


class SampleCache:
    """Coverings by shape and spacing; those not used for longest go first."""

    def __init__(self) -> None:
        self._covers: dict[tuple[object, ...], tuple[object, LocalSamples]] = {}

    def get(self, item: Object, spacing: float) -> LocalSamples:
        """The covering of `item`, `spacing` [m] apart."""
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
            kept = what, made  # the shape too: its id stays taken
        self._covers[key] = kept
        return kept[1]


def estimate_samples(item: Object, spacing: float) -> float:
    """About how many samples an object has, `spacing` [m] apart, without making them."""
    if isinstance(item, Path):
        return max(1.0, item.shape.length / spacing)
    if not isinstance(item, Body):
        return 1.0
    if isinstance(item, Volume) and item.felt == "interior":
        return max(1.0, 8.0 * math.prod(item.shape.extent) / spacing**3)
    return max(1.0, item.shape.area / spacing**2)
