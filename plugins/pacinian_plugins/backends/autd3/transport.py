"""What the backend needs of the units, wherever they are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Sequence

Due = tuple[Any, float | None]
"""Frames of the packages, and when they take effect on the units' clock [s]; None for at once."""


class Transport(Protocol):
    """A way to the units of an array, open and silent, until `close`."""

    failures: int
    """How often something that was posted did not arrive, or may not have."""

    @property
    def time(self) -> float:
        """The units' clock [s]. Raises BackendError."""
        ...

    @property
    def waits(self) -> bool:
        """Whether what was posted last still waits to be sent."""
        ...

    def post(self, told: Sequence[Due]) -> None:
        """Send these, in place of what still waits, without waiting; nothing to tell says that the host is alive."""
        ...

    def check(self) -> None:
        """Raise BackendError if the units do not take what they are sent."""
        ...

    def silence(self) -> None:
        """End all sound, and be sure of it. Raises BackendError."""
        ...

    def close(self) -> None:
        """Silence the units and let them go. Never raises."""
        ...
