"""Another solver, backend, technique or strength while running: orders, and whose answer waits. Pure: time is given."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from pacinian.errors import WireError
from pacinian.serving.ipc.messages import RequestedSettings
from pacinian.wire.control import Choice
from pacinian.wire.convert_time import technique_to_scene
from pacinian.wire.replies import Error, Ok

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pacinian.serving.control.output_lease import Session
    from pacinian.serving.settings import Settings
    from pacinian.wire.control import Select
    from pacinian.wire.replies import Reply

MAX_SELECTION_TIME = 10.0  # [s] for a solver to be made or a device to be opened
SUSPECT = 10.0  # [s] after its selection in which a solver is blamed for a renderer that ends
KINDS = "solver", "backend", "technique", "intensity"
SETTINGS = "technique", "intensity"  # of which the newest one stands for those before
MAX_PENDING = 8  # selections that wait


@dataclass
class PendingSelection:
    """Who asked, and which results have not come yet."""

    peer: bytes
    request: int
    missing: set[str]
    until: float


class Selection:
    """What was selected last. orders: what the renderer and the guard are to be told."""

    def __init__(self, settings: Settings) -> None:
        self.orders = RequestedSettings()
        solver = settings.solver  # its options are with who makes it
        self._configured = Choice(name=solver if isinstance(solver, str) else solver.name)
        self._waiting: list[PendingSelection] = []
        self._suspect = -float("inf")  # [s] until when the solver is suspected
        self._ends = 0

    def ask(
        self, session: Session, message: Select, known: Mapping[str, tuple[str, ...]], now: float
    ) -> Reply | None:
        """Order what a session selects; return why it cannot be, or None: it is answered when it is done.

        known: names by kind, "solver" and "backend".
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
        replaced = {f"{kind} {getattr(self.orders, kind)[0]}" for kind in SETTINGS if kind in given}
        if sum(bool(waiting.missing - replaced) for waiting in self._waiting) >= MAX_PENDING:
            return Error(
                id=message.id, code="busy", message=f"{MAX_PENDING} selections wait already"
            )
        for waiting in self._waiting:
            waiting.missing -= replaced
        missing = {self._order(kind, value) for kind, value in given.items()}
        self._waiting.append(
            PendingSelection(session.peer, message.id, missing, now + MAX_SELECTION_TIME)
        )
        if message.solver is not None:
            self._suspect, self._ends = now + SUSPECT, 0
        return None

    def reset(self, count: int) -> None:
        """Order as many resets in all."""
        self.orders = replace(self.orders, reset=count)

    def answers(self, results: Mapping[str, str], now: float) -> list[tuple[bytes, Reply]]:
        """What is to be told now, given all `results` by "kind number"."""
        told: list[tuple[bytes, Reply]] = []
        for waiting in list(self._waiting):
            came = {name: results[name] for name in waiting.missing if name in results}
            problem = "; ".join(f"{name.split()[0]}: {why}" for name, why in came.items() if why)
            waiting.missing -= came.keys()
            if waiting.missing and not problem and now < waiting.until:
                continue
            self._waiting.remove(waiting)
            if waiting.missing and not problem:
                names = ", ".join(sorted(name.split()[0] for name in waiting.missing))
                problem = f"{names}: not done within {MAX_SELECTION_TIME:g} s"
            reply = (
                Error(id=waiting.request, code="fault", message=problem[:1000])
                if problem
                else Ok(id=waiting.request)
            )
            told.append((waiting.peer, reply))
        return told

    def renderer_ended(self, now: float) -> bool:
        """The renderer crashed or hung: the second time soon after a selection, its solver is given up; whether so."""
        self._ends += now < self._suspect
        if self._ends < 2:
            return False
        self._suspect, self._ends = -float("inf"), 0
        self._order("solver", self._configured)
        return True

    def _order(self, kind: str, value: object) -> str:
        """Its name among the results."""
        number = getattr(self.orders, kind)[0] + 1
        self.orders = replace(self.orders, **{kind: (number, value)})
        return f"{kind} {number}"
