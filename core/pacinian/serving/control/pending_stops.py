"""Emergency stops that are carried out, but not confirmed yet: they wait until the guard has silenced the device."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Any

from pacinian.wire.replies import Error, Ok

if TYPE_CHECKING:
    from collections.abc import Callable

MAX_PENDING = 256  # largest number of stops of each kind that wait for silence
MAX_REMEMBERED = 1024  # largest number of confirmed stops whose repetitions are recognised
MAX_CONFIRM_TIME = 0.5  # longest time for which a stop waits for silence [s]
NOT_SILENCED = "all sound was ended, but no guard has confirmed that the device is silent"
ADVICE = "if the array sounds, switch it off"


class PendingStops:
    """Holds stops until they are confirmed. Pure: callers pass the time and send the answers.

    stopped_at: time of the first stop since the last permit [s]; only a status reported later proves silence.
    """

    def __init__(self) -> None:
        self.stopped_at = -float("inf")
        self._datagrams: dict[bytes, tuple[Any, float]] = {}  # sender and time [s], by nonce
        self._confirmed: deque[bytes] = deque(maxlen=MAX_REMEMBERED)  # nonces
        self._messages: list[tuple[bytes, int, float]] = []  # peer, id and time [s]

    def __bool__(self) -> bool:
        return bool(self._datagrams or self._messages)

    def add_datagrams(self, requests: list[tuple[bytes, Any]], now: float) -> None:
        """Add connectionless stops: nonce and sender of each. A sender that still waits sends its stop again."""
        for nonce, sender in requests:
            if nonce in self._datagrams or len(self._datagrams) < MAX_PENDING:
                self._datagrams[nonce] = sender, now

    def is_confirmed(self, request: tuple[bytes, Any]) -> bool:
        """Return whether a connectionless stop is a confirmed one that its sender sent again."""
        return request[0] in self._confirmed

    def waits(self, request: tuple[bytes, Any]) -> bool:
        """Return whether a connectionless stop is carried out, and waits for silence.

        If its sender sends it again, it must not be carried out again, because the output may have been reset since.
        """
        return request[0] in self._datagrams

    def add_message(self, peer: bytes, number: int, now: float) -> None:
        """Add a stop that came over a connection. number: its id.

        Beyond `MAX_PENDING`, the next round answers it: with an error, unless the device is silent by then.
        """
        late = len(self._messages) >= MAX_PENDING
        self._messages.append((peer, number, -float("inf") if late else now))

    def confirm_and_take_replies(
        self, silent: bool, now: float, confirm: Callable[[list[tuple[bytes, Any]]], None]
    ) -> list[tuple[bytes, Ok | Error]]:
        """Confirm all datagrams if the device is silent; return replies, also to peers that waited too long."""
        replies: list[tuple[bytes, Ok | Error]] = []
        if silent and self._datagrams:
            confirm([(nonce, sender) for nonce, (sender, _) in self._datagrams.items()])
            self._confirmed.extend(self._datagrams)
        self._datagrams = {
            nonce: (sender, since)
            for nonce, (sender, since) in self._datagrams.items()
            if not silent and now - since <= MAX_CONFIRM_TIME
        }
        waiting, self._messages = self._messages, []
        for peer, number, since in waiting:
            if silent:
                replies.append((peer, Ok(id=number)))
            elif now - since > MAX_CONFIRM_TIME:
                problem = Error(id=number, code="fault", message=NOT_SILENCED, advice=ADVICE)
                replies.append((peer, problem))
            else:
                self._messages.append((peer, number, since))
        return replies
