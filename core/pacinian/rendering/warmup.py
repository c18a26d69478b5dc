"""Warm up before the first tick: load and compile what it needs, so that it is as fast as the others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.skin_facing import SkinFacing
from pacinian.scene.modulation.envelope import resolve
from pacinian.session import Session
from pacinian.solving.solution_status import Status

if TYPE_CHECKING:
    from pacinian.scene.scene import Scene
    from pacinian.solving.solution import Solution
    from pacinian.types import Floats


def try_out(session: Session) -> Solution:
    """Solve for one point, then for two on skin, in a spare session. Return the first that failed, or the last.

    Raises any exception of the solver.
    """
    spare = Session(session.array, session.medium, session.solver)
    points = spare.propagator.origin + np.array([[0.02, 0.0, 0.2], [-0.02, 0.0, 0.2]])
    up = np.array([[0.0, 0.0, -1.0]] * 2)
    first = spare.solve(points[:1], [1.0])
    if first.status is Status.failed:
        return first
    return spare.solve(points, [1.0, 1.0], facing=SkinFacing(up))


def load_envelopes(scene: Scene, times: Floats) -> None:
    """Load the envelopes of a scene, because a recorded wave takes 0.3 s; times: of a tick's rows, (K,) [s]."""
    held = {id(item.envelope): resolve(item.envelope) for item in scene.objects}
    for envelope in held.values():
        envelope.at(times.copy())
