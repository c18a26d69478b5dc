"""The histogram of tick times that a page shows."""

from __future__ import annotations

import numpy as np

from pacinian.viewing.messages import Histogram

EDGES = tuple(float(f"{edge:.4g}") for edge in 10.0 ** (np.arange(65) / 16.0 - 2.0))  # [ms]


def make_histogram(counts: bytes, rate: float) -> Histogram:
    """Make the histogram of `State.tick_counts`. rate: ticks per second [Hz]."""
    bins = tuple(np.frombuffer(counts, "<u4").tolist())
    return Histogram(edges_ms=EDGES[: len(bins) + 1], counts=bins, deadline_ms=1e3 / rate)
