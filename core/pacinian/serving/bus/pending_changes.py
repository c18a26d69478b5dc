"""What the renderer does not know yet of the scene that is felt: names alone, so the newest always wins.

However much comes while nothing is taken, there is at most one entry for each object that is there, and one for
each that the renderer still has.
"""

from __future__ import annotations

MOVED, WRAPPED, REMOVED = 1, 2, 4  # flags: what is new of an object that the renderer has


class PendingChanges:
    """Names by what is new.

    light: of objects that the renderer has. puts: of those it has not, in order; true where it still has another
    of that name, to be removed first. known: all that it has. begin, hands, quiet: whether these are new.
    superseded: updates that something newer replaced before they were sent.
    """

    def __init__(self) -> None:
        self.light: dict[str, int] = {}
        self.puts: dict[str, bool] = {}
        self.known: set[str] = set()
        self.begin = self.hands = self.quiet = False
        self.superseded = 0

    def __len__(self) -> int:
        return len(self.light) + len(self.puts) + self.begin + self.hands + self.quiet

    def all(self, names: list[str]) -> None:
        """The renderer has nothing; this is there."""
        self.known.clear()
        self.light.clear()
        self.puts = dict.fromkeys(names, False)
        self.begin = self.hands = self.quiet = True

    def put(self, name: str, *, there: bool) -> None:
        """An object was put; there: in the place of one of that name."""
        replaced = self.light.pop(name, None)
        self.superseded += name in self.puts or (there and replaced is not None)
        if there:
            self.puts.setdefault(name, False)
        else:  # it comes last, even if the renderer has one of that name
            self.puts[name] = name in self.known

    def new(self, name: str, what: int) -> None:
        """An object that is there was moved or wrapped (flags): one that is to be put yet comes with it."""
        before = self.light.get(name, 0)
        self.superseded += bool(before & what)
        if name not in self.puts:
            self.light[name] = before | what

    def removed(self, name: str) -> None:
        """An object is gone."""
        self.superseded += self.puts.pop(name, None) is not None
        if name in self.known:
            self.superseded += name in self.light
            self.light[name] = REMOVED

    def hand(self) -> None:
        """The hands have changed."""
        self.superseded += self.hands
        self.hands = True
