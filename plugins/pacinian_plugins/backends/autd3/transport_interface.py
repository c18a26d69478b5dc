"""The interface between the backend and the units, wherever they are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Sequence

Due = tuple[Any, float | None]
"""Frames of the packages, and when they take effect on the units' clock [s]; None for at once."""


class Transport(Protocol):
    """A connection to the units of an array. It is open, and the units are silent, from the start."""

    failures: int
    """Number of posted frames that did not arrive, or may not have arrived."""

    @property
    def time(self) -> float:
        """The units' clock [s]. Raises BackendError."""
        ...

    @property
    def waits(self) -> bool:
        """Whether the last post is still waiting to be sent."""
        ...

    def post(self, updates: Sequence[Due]) -> None:
        """Queue these frames in place of waiting ones, without blocking. An empty post is a heartbeat."""
        ...

    def check(self) -> None:
        """Raise BackendError if the units do not accept frames."""
        ...

    def silence(self) -> None:
        """Stop all sound, and confirm it. Raises BackendError."""
        ...

    def close(self) -> None:
        """Silence the units and disconnect. Never raises."""
        ...
