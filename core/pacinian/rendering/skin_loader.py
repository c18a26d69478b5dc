"""Build the skin of a kind of hand when the first of its hands comes, before sampling needs it in a tick."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from pacinian.errors import PacinianError
from pacinian.scene.hands.hand import Hand
from pacinian.scene.hands.skin_cache import MAX_SKINS, find_kind, get_skin, is_built

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from pacinian.scene.scene import Scene


class SkinLoader:
    """Loads the skins of hands, and knows the kinds of hands that a renderer has seen last.

    The kinds are remembered for each renderer, not for the process, so that a recording is rendered again exactly.
    limited: whether the pressure on skin has a limit.
    """

    def __init__(self, *, limited: bool) -> None:
        self._limited = limited
        self._seen: dict[bytes | None, None] = {}  # the one seen last is the last

    def load_first(self, scene: Scene | None, *, any_time: bool) -> None:
        """Load the skins of the first scene's hands, and that of joints if hands may come at any time.

        scene: None if it could not be made.
        """
        if any_time:
            self.load([Hand.open()])
        if scene is not None:
            with suppress(PacinianError):  # of a hand; the first tick will raise and report it
                self.load(hand for hand in scene.hands if not hand.lost)

    def load_new(
        self,
        hands: Iterable[Hand],
        record_decision: Callable[[Callable[[], float]], float],
        silence: Callable[[], None],
    ) -> None:
        """Load the skins of new kinds of hands. The output is silent meanwhile, because that can take seconds.

        record_decision: that of a `RecordingClock`. silence: silences the output.
        """
        new = self.find_new(hands)
        if not new:
            return
        if record_decision(lambda: float(takes_long(new))):
            silence()
        self.load(new)

    def find_new(self, hands: Iterable[Hand]) -> list[Hand]:
        """Return the first hand of each kind that was not among those seen last, and note all kinds as seen.

        Lost hands are left out.
        """
        new: list[Hand] = []
        for hand in hands:
            if hand.lost:
                continue
            kind = find_kind(hand)
            if kind not in self._seen:
                new.append(hand)
            self._seen.pop(kind, None)
            self._seen[kind] = None
            if len(self._seen) > MAX_SKINS:
                del self._seen[next(iter(self._seen))]
        return new

    def load(self, hands: Iterable[Hand]) -> None:
        """Build the skins of these hands, and load what the limit of the pressure needs. Raises ArgumentError."""
        for hand in hands:
            skin = get_skin(hand)
            if self._limited:
                skin.closest(hand, skin.place(hand).points[:1])


def takes_long(hands: Iterable[Hand]) -> bool:
    """Return whether loading takes much longer than a tick, because the skin of one of the hands is not built yet."""
    return not all(is_built(find_kind(hand)) for hand in hands)
