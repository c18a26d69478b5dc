"""Every error that Pacinian raises.

    PacinianError
    ├── ArgumentError (ValueError)          an argument that cannot be meant; names it
    │   └── PointOnTransducer               the attenuation is singular there; carries the indices
    ├── SceneFileError (ValueError)         a scene file; names the file, the key and the fix
    ├── PluginError                         a plug-in that is missing, broken or named twice
    │   └── UnknownPlugin (ValueError)      no plug-in of that name; lists those there are
    ├── UnsupportedLimit (ValueError)       the chosen solver cannot keep a limit that was asked
    ├── BackendError                        a device that refuses, stalls or is gone
    ├── ServerError                         the server cannot be started, reached, or refuses
    │   ├── Refused                         it refuses a request; carries code, path and advice
    │   └── ConnectionLost (ConnectionError)   it is gone, or has never been there
    ├── WireError (ValueError)              bytes that are no message; carries the field's path
    ├── RecordingError (ValueError)         a recording that cannot be read
    └── MissingExtra (ImportError)          an optional library is not installed; says which extra

Inside the loop nothing is raised: a tick's outcome is a value (`pacinian.Status`, `pacinian.Fault`).

Plug-ins raise anything, of any length. Code that catches it keeps only what `describe_error` returns.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


MAX_TEXT = 500  # characters that are kept of a text of a plug-in or a client


def describe_error(error: BaseException) -> str:
    """The text of an error, at most `MAX_TEXT` characters.

    An error whose `__str__` is slow, or makes a huge text, costs that time and memory once: here.
    """
    kind = shorten(type(error).__name__)
    try:
        text = str(error)
    except (Exception, SystemExit):
        return kind
    return shorten(text if isinstance(error, PacinianError) else f"{kind}: {text[:MAX_TEXT]}")


def shorten(text: str) -> str:
    """The first `MAX_TEXT` characters of a text, as valid Unicode."""
    return text[:MAX_TEXT].encode(errors="replace").decode()


class PacinianError(Exception):
    """The root of all errors raised by Pacinian. They travel between processes with their evidence."""

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuilt, (type(self), self.args, self.__dict__)


def _rebuilt(
    kind: type[PacinianError], args: tuple[Any, ...], evidence: dict[str, Any]
) -> PacinianError:
    error = kind.__new__(kind)
    error.args = args
    error.__dict__.update(evidence)
    return error


class ArgumentError(PacinianError, ValueError):
    """An argument that cannot be meant.

    argument: its name, as in the call.
    """

    def __init__(self, argument: str, problem: str) -> None:
        super().__init__(f"`{argument}` {problem}")
        self.argument = argument


class PointOnTransducer(ArgumentError):
    """Points so close to a transducer that the attenuation is infinite there.

    indices: which points.
    """

    def __init__(self, indices: Sequence[int]) -> None:
        shown = ", ".join(map(str, indices[:5])) + (", ..." if len(indices) > 5 else "")
        super().__init__(
            "points",
            f"{shown} lie on a transducer, where the sound pressure of a point source is infinite: "
            'move them, or use Air(attenuation="none")',
        )
        self.indices = tuple(indices)


class SceneFileError(PacinianError, ValueError):
    """A scene file that cannot be used.

    path: the file. key: where in it, as `$.objects[0].shape`; empty if the whole file is meant.
    """

    def __init__(self, path: Path | str, key: str, problem: str) -> None:
        super().__init__(f"{path}: {key + ': ' if key else ''}{problem}")
        self.path, self.key = path, key


class PluginError(PacinianError):
    """A plug-in that does not load, or two of one name."""


class UnknownPlugin(PluginError, ValueError):
    """No plug-in of that name.

    kind: "solver" or "backend". name: what was asked. known: what there is.
    """

    def __init__(self, kind: str, name: str, known: Sequence[str], advice: str = "") -> None:
        super().__init__(
            f"no {kind} is called {name!r}; there are: {', '.join(known) or 'none'}."
            f"{advice} `pacinian plugins` lists them"
        )
        self.kind, self.name, self.known = kind, name, tuple(known)


class UnsupportedLimit(PacinianError, ValueError):
    """The chosen solver cannot keep a limit that was asked.

    solver, limit: their names.
    """

    def __init__(self, solver: str, limit: str) -> None:
        super().__init__(f"solver {solver!r} cannot keep `limits.{limit}`: leave it None")
        self.solver, self.limit = solver, limit


class BackendError(PacinianError):
    """A device that refuses, stalls or is gone."""


class ServerError(PacinianError):
    """The server cannot be started, reached, or refuses."""


class Refused(ServerError):
    """The server refuses a request.

    code: as in `pacinian.wire.replies.Code`. path: of the field that is wrong. advice: what to do. request: number of
    what was refused; 0 where it has none.
    """

    def __init__(
        self, code: str, message: str, path: str = "", advice: str = "", request: int = 0
    ) -> None:
        where = f"{path}: " if path else ""
        super().__init__(f"{where}{message}" + (f"; {advice}" if advice else ""))
        self.code, self.path, self.advice, self.request = code, path, advice, request


class ConnectionLost(ServerError, ConnectionError):
    """The server is gone, or has never been there; nothing is sent again by itself."""


class WireError(PacinianError, ValueError):
    """Bytes that are no message of the protocol.

    path: of the field that is wrong, as `$.objects[...].shape`. problem: what is wrong with it.
    """

    def __init__(self, problem: str, path: str = "") -> None:
        super().__init__(f"{path}: {problem}" if path else problem)
        self.path, self.problem = path, problem


class RecordingError(PacinianError, ValueError):
    """A recording that cannot be read.

    path: the file.
    """

    def __init__(self, path: Path | str, problem: str) -> None:
        super().__init__(f"{path}: {problem}")
        self.path = path


class MissingExtra(PacinianError, ImportError):
    """An optional library is not installed.

    extra: install `pacinian[extra]`.
    """

    def __init__(self, library: str, extra: str) -> None:
        super().__init__(f"{library} is not installed: pip install 'pacinian[{extra}]'")
        self.extra = extra
