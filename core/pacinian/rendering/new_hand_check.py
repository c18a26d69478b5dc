"""Check whether a new hand might get more than the highest pressure allowed on skin.

A hand is new until its skin has been evaluated for a solution, see `SolveResult.knows`. It may be anywhere in the
field, so the output must be silent until then (decision 88).
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

    peak: highest radiation pressure on skin [Pa]; infinite for no limit. playback: has the highest amplitudes that may
    be emitted. skin_limit: tells whether these may exceed `peak` at a hand.
    """

    def __init__(self, peak: float, playback: Playback, skin_limit: SkinLimit) -> None:
        self._peak, self._playback, self._skin_limit = peak, playback, skin_limit
        # the last scene and result for which no hand might get more than `peak`
        self._harmless: tuple[Scene | None, SolveResult | None] = None, None

    def may_exceed_limit(self, scene: Scene, played: SolveResult, t: float) -> bool:
        """Return whether a hand that `played` does not know might get more than `peak` at time t [s]."""
        if self._peak == math.inf or (self._harmless[0] is scene and self._harmless[1] is played):
            return False
        new = [hand for hand in scene.hands if not (is_gone(hand, t) or played.knows(hand))]
        if new:
            amplitudes = self._playback.find_highest_amplitudes(played.solutions)
            if not all(self._skin_limit.holds_for(hand, amplitudes, self._peak) for hand in new):
                return True
        self._harmless = scene, played
        return False
