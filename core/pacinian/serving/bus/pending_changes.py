"""Changes of the rendered scene that the renderer lacks. Only names are kept, so the newest value always wins.

However many changes arrive while the renderer takes none, there is at most one entry for each object of the scene, and
one for each object that the renderer still has.
"""

from __future__ import annotations

MOVED, NEW_ENVELOPE = 1, 2  # flags: what changed in an object of the scene that the renderer has


class PendingChanges:
    """Names by kind of change.

    light: changed objects that the renderer has, with flags; 0 for removed ones. puts: objects that it lacks, in order;
    True if it must first remove another of that name. known: all objects that it has. begin, hands, quiet: whether
    these changed. superseded: number of updates that were superseded before they were sent.
    """

    def __init__(self) -> None:
        self.light: dict[str, int] = {}
        self.puts: dict[str, bool] = {}
        self.known: set[str] = set()
        self.begin = self.hands = self.quiet = False
        self.superseded = 0

    def __len__(self) -> int:
        return len(self.light) + len(self.puts) + self.begin + self.hands + self.quiet

    def start_again(self, names: list[str]) -> None:
        """Start again: the renderer has nothing, and the scene holds `names`."""
        self.known.clear()
        self.light.clear()
        self.puts = dict.fromkeys(names, False)
        self.begin = self.hands = self.quiet = True

    def note_put(self, name: str, *, there: bool) -> None:
        """Note that an object was put. there: it replaces one of that name in the scene."""
        replaced = self.light.pop(name, None)
        self.superseded += name in self.puts or (there and replaced is not None)
        if there:
            self.puts.setdefault(name, False)
        else:  # goes last, even if the renderer has another of that name
            self.puts[name] = name in self.known

    def note_changed(self, name: str, what: int) -> None:
        """Note that an object was moved or got a new envelope (flags). If it waits to be put, the put includes this."""
        before = self.light.get(name, 0)
        self.superseded += bool(before & what)
        if name not in self.puts:
            self.light[name] = before | what

    def note_removed(self, name: str) -> None:
        """Note that an object was removed."""
        self.superseded += self.puts.pop(name, None) is not None
        if name in self.known:
            self.superseded += name in self.light
            self.light[name] = 0

    def note_hands(self) -> None:
        """Note that the hands changed."""
        self.superseded += self.hands
        self.hands = True
