"""Gerchberg-Saxton between points and transducers, plain (`gs`) and weighted (`weighted-gs`).

solver.py        both solvers: options, defaults
alternation.py   one run: starts from the last phases, takes steps, ends (`weighted-gs`: once it converges)
alternation.hpp  these steps: called by alternation.py
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pacinian as pc
from pacinian_plugins.solvers.gs.solver import Gs, WeightedGs

if TYPE_CHECKING:
    from collections.abc import Iterable


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """Return this plug-in's solvers."""
    return [Gs, WeightedGs]
