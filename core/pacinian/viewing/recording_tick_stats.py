"""Statistics of the ticks of a renderer's recording, as far as it has been read."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

import numpy as np

from pacinian.rendering.rerender import are_equal
from pacinian.viewing.messages import Histogram
from pacinian.viewing.tick_histogram import EDGES

if TYPE_CHECKING:
    from pacinian.rendering.recording import Tick
    from pacinian.rendering.renderer import Renderer
    from pacinian.types import Floats


class TickStats:
    """Counts ticks. ticks: all. late: ticks that ended after the next one was due. different: frames that changed.

    A frame has changed if rendering it again gives another result. period: period of a tick [s].
    """

    def __init__(self, period: float) -> None:
        self.ticks = self.late = self.different = 0
        self._period = period
        self._took = deque[float](maxlen=max(1, round(1.0 / period)))  # of the last second [s]

    def add(self, tick: Tick, renderer: Renderer | None) -> None:
        """Add a tick. renderer: the renderer that has just rendered it again."""
        self.ticks += 1
        if tick.clock:
            self.late += tick.clock[-1] > tick.frame.time + self._period
            self._took.append(tick.clock[-1] - tick.clock[0])
        self.different += renderer is not None and not are_equal(tick.frame, renderer.last_frame)

    @property
    def tick_ms(self) -> tuple[float, float, float]:
        """Median, 99th percentile and maximum of the tick times of the last second [ms]; zeros if unknown."""
        if not self._took:
            return 0.0, 0.0, 0.0
        half, most, worst = np.percentile(self._milliseconds, (50, 99, 100)).tolist()
        return half, most, worst

    @property
    def histogram(self) -> Histogram:
        """Histogram of the tick times of the last second."""
        within = np.clip(self._milliseconds, EDGES[0], EDGES[-1])
        counts = tuple(np.histogram(within, EDGES)[0].tolist())
        return Histogram(edges_ms=EDGES, counts=counts, deadline_ms=1e3 * self._period)

    @property
    def _milliseconds(self) -> Floats:
        return 1e3 * np.array(self._took)
