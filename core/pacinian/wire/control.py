"""Control requests: the messages from a client to the control socket, which answers whatever the loop is doing.

All but `hello` and `stop` carry the session's key. Each is answered with its `id`.
"""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta, Struct

from pacinian.wire.modulation import Technique
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

Option = bool | int | Annotated[float, Meta(ge=-1e300, le=1e300)] | Text


class Hello(Struct, frozen=True, kw_only=True, tag_field="type", tag="hello"):
    """Open a session. The first message; answered by `welcome`, or by `error`.

    protocol: protocol version of the client, major and minor. client: name of the client, for people. version: version
    of the client, for people. scene: name of the scene, which clients that give the same name share; by default the
    client has a scene of its own. lease: time within which the client must renew [s]; by default the server's, which
    is also the maximum.
    """

    id: Id = 0
    protocol: tuple[Annotated[int, Meta(ge=0, le=65535)], Annotated[int, Meta(ge=0, le=65535)]]
    client: Name
    version: Text = ""
    scene: Annotated[str, Meta(max_length=64)] = ""
    lease: Annotated[float, Meta(ge=0.05, le=10.0, description="[s]")] | None = None


class Request(Struct, frozen=True, kw_only=True, tag_field="type"):
    """Fields of all other requests."""

    session: Session
    id: Id = 0


class Renew(Request, frozen=True, kw_only=True, tag="renew"):
    """Renew the lease. Send this from the game's own tick. Answered by `renewed`.

    sequence: increases with each renewal. time: reading of the client's steady clock, from which the lease counts.
    """

    sequence: Sequence
    time: Seconds


class Arm(Request, frozen=True, kw_only=True, tag="arm"):
    """Own the output and make this client's scene active.

    take: take the output from another owner, if allowed. resume: after a lease that ran out, the next renewal lets the
    output sound again, if this client still owns it and there was no stop and no fault; since protocol 1.1.
    """

    take: bool = False
    resume: bool = False


class Disarm(Request, frozen=True, kw_only=True, tag="disarm"):
    """Fade to silence and release the output. For the owner."""


class Stop(Struct, frozen=True, kw_only=True, tag_field="type", tag="stop"):
    """Emergency stop: silence the output at once, whoever owns it, until `reset`. Needs no session.

    The answer is `ok` once the device is silent. If no guard has confirmed silence within 0.5 s, it is the error
    `fault`: switch the array off if it sounds.
    """

    id: Id = 0


class Reset(Request, frozen=True, kw_only=True, tag="reset"):
    """Allow the output to be armed again after an emergency stop or a fault."""


class Choice(Struct, frozen=True, kw_only=True):
    """A solver or a backend. name: name of the plug-in. options: values of options that clients may set."""

    name: Name
    options: Annotated[dict[Name, Option], Meta(max_length=MAX_OPTIONS)] = {}


class Select(Request, frozen=True, kw_only=True, tag="select"):
    """Change the solver, the backend, the technique or the intensity while the server runs.

    Settings that are not given stay. Only the owner may change them, or any client while there is no owner. The answer
    comes after the change was made or has failed. solver, backend: new plug-in. technique: new technique of all objects
    that have none of their own. intensity: factor on all radiation pressures.
    """

    solver: Choice | None = None
    backend: Choice | None = None
    technique: Technique | None = None
    intensity: Share | None = None


class Capabilities(Request, frozen=True, kw_only=True, tag="capabilities"):
    """Request the properties of the server: its array, solvers, backends and limits."""


class Status(Request, frozen=True, kw_only=True, tag="status"):
    """Request the state, as it is published."""


class Bye(Request, frozen=True, kw_only=True, tag="bye"):
    """End the session and remove its objects. The output falls silent if this client owns it."""


CONTROLS = Hello, Renew, Arm, Disarm, Stop, Reset, Select, Capabilities, Status, Bye
AnyControl = Hello | Renew | Arm | Disarm | Stop | Reset | Select | Capabilities | Status | Bye
