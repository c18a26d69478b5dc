"""The convex problems at the heart of `lagrange`: phases fixed, any of its limits together, with a proof."""

from __future__ import annotations

from pacinian_plugins.solvers.lagrange.convex.answer import Answer
from pacinian_plugins.solvers.lagrange.convex.least_squares import least_squares
from pacinian_plugins.solvers.lagrange.convex.max_scale import maximise_scale

__all__ = ["Answer", "least_squares", "maximise_scale"]
