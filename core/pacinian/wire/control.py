"""Control: what a client sends to the control socket, which answers whatever the loop does.

Each but `hello` and `stop` has its session's key; each is answered, with its `id`.
"""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from pacinian.wire.protocol import (
    MAX_OPTIONS,
    Id,
    Name,
    Seconds,
    Sequence,
    Session,
    Share,
    Text,
)
from pacinian.wire.time import Technique

Option = bool | int | Annotated[float, Meta(ge=-1e300, le=1e300)] | Text


class Hello(Struct, frozen=True, kw_only=True, tag_field="type", tag="hello"):
    """The first message: who is there, and which protocol it speaks; answered by `welcome`, or by `error`.

    protocol: major, minor. client: who, for people. version: of the client, for people.
    scene: clients of one name share a scene; one of its own
    unless given. lease: within which the game must renew [s]; the server's own unless given, and at most that.
    """

    id: Id = 0
    protocol: tuple[Annotated[int, Meta(ge=0, le=65535)], Annotated[int, Meta(ge=0, le=65535)]]
    client: Name
    version: Text = ""
    scene: Annotated[str, Meta(max_length=64)] = ""
    lease: Annotated[float, Meta(ge=0.02, le=10.0, description="[s]")] | None = None


class Request(Struct, frozen=True, kw_only=True, tag_field="type"):
    """What all the others have."""

    session: Session
    id: Id = 0


class Renew(Request, frozen=True, kw_only=True, tag="renew"):
    """The lease goes on: to be sent from the game's own tick. Answered by `renewed`.

    sequence: counts up with each renewal. time: of the client's steady clock; the lease counts from then.
    """

    sequence: Sequence
    time: Seconds


class Arm(Request, frozen=True, kw_only=True, tag="arm"):
    """This client's scene is to be felt. take: from its owner, if there is another and the server allows it."""

    take: bool = False


class Disarm(Request, frozen=True, kw_only=True, tag="disarm"):
    """Silence, softly. The owner lets go of the output."""


class Stop(Struct, frozen=True, kw_only=True, tag_field="type", tag="stop"):
    """Emergency stop: silence at once, whoever owns the output, until `reset`. Needs no session."""

    id: Id = 0


class Reset(Request, frozen=True, kw_only=True, tag="reset"):
    """After an emergency stop or a fault: the output may be armed again."""


class Choice(Struct, frozen=True, kw_only=True):
    """A solver or a backend. name: by which it is. options: of those that it lets clients set."""

    name: Name
    options: Annotated[dict[Name, Option], Meta(max_length=MAX_OPTIONS)] = {}


class Select(Request, frozen=True, kw_only=True, tag="select"):
    """Another solver, backend, technique (of objects that have none of their own) or strength, while running.

    What is not given stays. For the owner, or anyone while nobody is. Answered when it is done, or could not be.
    solver, backend: by name. technique: of all objects without one. intensity: factor on all radiation pressures.
    """

    solver: Choice | None = None
    backend: Choice | None = None
    technique: Technique | None = None
    intensity: Share | None = None


class Capabilities(Request, frozen=True, kw_only=True, tag="capabilities"):
    """Asks what there is: the array, solvers, backends, limits."""


class Status(Request, frozen=True, kw_only=True, tag="status"):
    """Asks for the state as it is published."""


class Bye(Request, frozen=True, kw_only=True, tag="bye"):
    """The client goes: its objects with it; silence, if it owns the output."""


CONTROLS = Hello, Renew, Arm, Disarm, Stop, Reset, Select, Capabilities, Status, Bye
AnyControl = Hello | Renew | Arm | Disarm | Stop | Reset | Select | Capabilities | Status | Bye
