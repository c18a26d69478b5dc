"""The newest value of a shared file, decoded once: most looks find nothing new, and cost next to nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.serving.ipc.shared_memory import Latest

T = TypeVar("T")


class Watched(Generic[T]):
    """One file. decode: of its bytes. value: what holds until there is one."""

    def __init__(self, file: Latest, decode: Callable[[bytes], T], value: T) -> None:
        self.value = value
        self._file, self._decode = file, decode
        self._number = 0

    def look(self) -> bool:
        """Whether there was something new. Raises what `decode` raises, once for each value."""
        if self._file.number == self._number:
            return False
        read = self._file.read(self._number)
        if read is None:
            return False
        self._number, data = read
        self.value = self._decode(data)
        return True

    def skip(self) -> None:
        """What is there now is old."""
        self._number = self._file.number
