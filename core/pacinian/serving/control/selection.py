"""Selecting another solver, backend, technique or intensity at run time. Pure: callers pass the time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from pacinian.errors import WireError
from pacinian.serving.ipc.messages import SUPERSEDED, Selections
from pacinian.wire.control import Choice
from pacinian.wire.convert_modulation import technique_to_scene
from pacinian.wire.replies import Error, Ok

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pacinian.serving.control.client_session import ClientSession
    from pacinian.serving.settings import Settings
    from pacinian.wire.control import Select
    from pacinian.wire.replies import Reply

MAX_SELECTION_TIME = 10.0  # time limit to make a solver or to open a device [s]
# Time after its selection during which a solver is blamed for the end of a renderer [s].
SUSPECT_TIME = 10.0
KINDS = "solver", "backend", "technique", "intensity"
# Kinds of which the newest value replaces earlier ones.
REPLACEABLE_KINDS = "technique", "intensity"
MAX_PENDING = 8  # maximum number of pending selections


@dataclass
class PendingSelection:
    """A selection that waits for its results. missing: keys of those that have not come. until: time limit [s]."""

    peer: bytes
    request: int
    missing: set[str]
    until: float


class SelectionManager:
    """Carries out requests to select. newest: the newest selections, for the renderer and the guard."""

    def __init__(self, settings: Settings) -> None:
        self.newest = Selections()
        solver = settings.solver  # its options stay with the process that makes it
        self._configured = Choice(name=solver if isinstance(solver, str) else solver.name)
        self._waiting: list[PendingSelection] = []
        self._suspect = -float("inf")  # end of the time in which the solver is suspected [s]
        self._ends = 0

    def select(
        self,
        session: ClientSession,
        message: Select,
        known: Mapping[str, tuple[str, ...]],
        now: float,
    ) -> Reply | None:
        """Select what a session asks for; return the reply, or None if it must wait for the results.

        known: names that can be selected, for the kinds "solver" and "backend".
        """
        for kind in ("solver", "backend"):
            choice = getattr(message, kind)
            if choice is not None and choice.name not in known[kind]:
                there = ", ".join(known[kind]) or "none yet"
                problem = f"no {kind} is called {choice.name!r}; there are: {there}"
                return Error(
                    id=message.id, code="unknown", message=problem[:1000], path=f"$.{kind}.name"
                )
        given: dict[str, Any] = {
            kind: value for kind in KINDS if (value := getattr(message, kind)) is not None
        }
        if not given:
            return Ok(id=message.id)
        if message.technique is not None:
            try:
                technique_to_scene(message.technique)
            except WireError as error:
                return Error(
                    id=message.id,
                    code="argument",
                    message=error.problem[:1000],
                    path=error.path[:200],
                )
        replaced = {
            f"{kind} {getattr(self.newest, kind)[0]}" for kind in REPLACEABLE_KINDS if kind in given
        }
        if sum(bool(waiting.missing - replaced) for waiting in self._waiting) >= MAX_PENDING:
            return Error(
                id=message.id, code="busy", message=f"{MAX_PENDING} selections are already pending"
            )
        for waiting in self._waiting:
            waiting.missing -= replaced
        missing = {self._select(kind, value) for kind, value in given.items()}
        self._waiting.append(
            PendingSelection(session.peer, message.id, missing, now + MAX_SELECTION_TIME)
        )
        if message.solver is not None:
            self._suspect, self._ends = now + SUSPECT_TIME, 0
        return None

    def set_reset_count(self, count: int) -> None:
        """Set the number of resets so far."""
        self.newest = replace(self.newest, reset=count)

    def take_replies(self, results: Mapping[str, str], now: float) -> list[tuple[bytes, Reply]]:
        """Return the replies that are due, given all `results` by "kind number".

        Selections of one kind end in the sequence in which they were made. If one has no result although a newer one of
        its kind has, the process has never read it.
        """
        replies: list[tuple[bytes, Reply]] = []
        newest: dict[str, int] = {}
        for kind, number in map(str.split, results):
            newest[kind] = max(newest.get(kind, 0), int(number))
        for waiting in list(self._waiting):
            came = {name: results[name] for name in waiting.missing if name in results}
            for kind, number in map(str.split, waiting.missing - came.keys()):
                if int(number) < newest.get(kind, 0):
                    came[f"{kind} {number}"] = SUPERSEDED
            problem = "; ".join(f"{name.split()[0]}: {why}" for name, why in came.items() if why)
            waiting.missing -= came.keys()
            if waiting.missing and not problem and now < waiting.until:
                continue
            self._waiting.remove(waiting)
            if waiting.missing and not problem:
                names = ", ".join(sorted(name.split()[0] for name in waiting.missing))
                problem = f"{names}: the selection did not finish within {MAX_SELECTION_TIME:g} s"
            reply = (
                Error(id=waiting.request, code="fault", message=problem[:1000])
                if problem
                else Ok(id=waiting.request)
            )
            replies.append((waiting.peer, reply))
        return replies

    def note_renderer_end(self, now: float) -> bool:
        """Note that the renderer crashed or hung; return whether its solver is given up.

        This happens at the second end within `SUSPECT_TIME` after a selection.
        """
        self._ends += now < self._suspect
        if self._ends < 2:
            return False
        self._suspect, self._ends = -float("inf"), 0
        self._select("solver", self._configured)
        return True

    def _select(self, kind: str, value: object) -> str:
        """Select a value; return the key of its result."""
        number = getattr(self.newest, kind)[0] + 1
        self.newest = replace(self.newest, **{kind: (number, value)})
        return f"{kind} {number}"
