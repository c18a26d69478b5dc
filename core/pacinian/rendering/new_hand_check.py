"""Check whether a hand that no solution knows might get more than the limit of the pressure on skin.

Such a hand may be anywhere in the field, so that the output must be silent until a solution knows it (decision 88).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pacinian.scene.sampling.hand_tracking import is_gone

if TYPE_CHECKING:
    from pacinian.rendering.playback import Playback
    from pacinian.rendering.skin_limit import SkinLimit
    from pacinian.rendering.solution_sequence import SolveResult
    from pacinian.scene.scene import Scene


class NewHandCheck:
    """Checks the hands of each tick.

    limit: of the pressure on skin [Pa]; infinite for none. playback: knows what may be emitted. skin_limit: bounds the
    pressure of that on a hand.
    """

    def __init__(self, limit: float, playback: Playback, skin_limit: SkinLimit) -> None:
        self._limit, self._playback, self._skin_limit = limit, playback, skin_limit
        # the last scene and result for which no hand might get more than the limit
        self._harmless: tuple[Scene | None, SolveResult | None] = None, None

    def may_exceed_limit(self, scene: Scene, played: SolveResult, t: float) -> bool:
        """Return whether a hand that `played` does not know might get more than the limit at time t [s]."""
        if self._limit == math.inf or (self._harmless[0] is scene and self._harmless[1] is played):
            return False
        new = [hand for hand in scene.hands if not (is_gone(hand, t) or played.knows(hand))]
        if new:
            amplitudes = self._playback.find_highest_amplitudes(played.solutions)
            if not all(self._skin_limit.holds_for(hand, amplitudes, self._limit) for hand in new):
                return True
        self._harmless = scene, played
        return False
