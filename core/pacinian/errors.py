"""Every error that Pacinian raises.

    PacinianError
    ├── ArgumentError (ValueError)          an invalid argument; carries its name
    │   └── PointOnTransducer               a point lies on a transducer; carries the indices
    ├── SceneFileError (ValueError)         a scene file; names the file, the key and the fix
    ├── PluginError                         a plug-in that is missing, broken or not unique
    │   └── UnknownPlugin (ValueError)      no plug-in has that name; lists the known ones
    ├── UnsupportedLimit (ValueError)       the chosen solver cannot enforce a requested limit
    ├── BackendError                        a device refuses, stalls or is gone
    ├── ServerError                         the server cannot be started or reached, or refuses
    │   ├── Refused                         it refuses a request; carries code, path and advice
    │   └── ConnectionLost (ConnectionError)   the connection was lost, or never existed
    ├── WireError (ValueError)              bytes that are no message; carries the field's path
    ├── RecordingError (ValueError)         a recording that cannot be read
    ├── SolutionFileError (ValueError)      a solution's file that cannot be read or written
    └── MissingExtra (ImportError)          an optional library is not installed; names the extra

The loop raises nothing: the outcome of a tick is a value (`pacinian.Status`, `pacinian.Fault`).

Plug-ins may raise any exception, with a text of any length. Code that catches one keeps only the result of
`describe_error`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path


MAX_TEXT = 500  # length to which texts from plug-ins and clients are cut [characters]


def describe_error(error: BaseException) -> str:
    """Return the text of an error, at most `MAX_TEXT` characters.

    If `__str__` of an error is slow or returns a huge text, only this call pays for it.
    """
    kind = shorten(type(error).__name__)
    try:
        text = str(error)
    except (Exception, SystemExit):
        return kind
    if not text:
        return kind
    return shorten(text if isinstance(error, PacinianError) else f"{kind}: {text[:MAX_TEXT]}")


def shorten(text: str) -> str:
    """Return the first `MAX_TEXT` characters of a text, as valid Unicode."""
    return text[:MAX_TEXT].encode(errors="replace").decode()


def replace_unprintable(text: str) -> str:
    """Return a text with a question mark for each character that cannot be printed, or that moves a cursor."""
    return "".join(c if c.isprintable() else "?" for c in text)


class PacinianError(Exception):
    """Base class of all errors raised by Pacinian. They can be pickled with their attributes."""

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
    """An invalid argument.

    argument: name of the argument, as in the call.
    """

    def __init__(self, argument: str, problem: str) -> None:
        super().__init__(f"`{argument}` {problem}")
        self.argument = argument


class PointOnTransducer(ArgumentError):
    """Points so close to a transducer that the sound pressure is infinite there.

    indices: indices of the points.
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

    path: path of the file. key: place in the file, such as `$.objects[0].shape`; empty for the whole file.
    """

    def __init__(self, path: Path | str, key: str, problem: str) -> None:
        super().__init__(f"{path}: {key + ': ' if key else ''}{problem}")
        self.path, self.key = path, key


class PluginError(PacinianError):
    """A plug-in does not load, or two plug-ins share a name."""


class UnknownPlugin(PluginError, ValueError):
    """No plug-in has the requested name.

    kind: "solver" or "backend". name: requested name. known: names of the installed plug-ins.
    """

    def __init__(self, kind: str, name: str, known: Sequence[str], advice: str = "") -> None:
        super().__init__(
            f"no {kind} is called {name!r}; there are: {', '.join(known) or 'none'}."
            f"{advice} `pacinian plugins` lists them"
        )
        self.kind, self.name, self.known = kind, name, tuple(known)


class UnsupportedLimit(PacinianError, ValueError):
    """The chosen solver cannot enforce a requested limit.

    solver, limit: names of the solver and the limit.
    """

    def __init__(self, solver: str, limit: str) -> None:
        super().__init__(f"solver {solver!r} cannot keep `limits.{limit}`: leave it None")
        self.solver, self.limit = solver, limit


class BackendError(PacinianError):
    """A device refuses, stalls or is gone."""


class ServerError(PacinianError):
    """The server cannot be started or reached, or refuses a request."""


class Refused(ServerError):
    """The server refuses a request.

    code: one of `pacinian.wire.replies.Code`. path: path of the field that is wrong. advice: remedy. request: number
    of the refused request; 0 if it has none.
    """

    def __init__(
        self, code: str, message: str, path: str = "", advice: str = "", request: int = 0
    ) -> None:
        where = f"{path}: " if path else ""
        super().__init__(f"{where}{message}" + (f"; {advice}" if advice else ""))
        self.code, self.path, self.advice, self.request = code, path, advice, request


class ConnectionLost(ServerError, ConnectionError):
    """The connection to the server was lost, or never existed. Nothing is sent again automatically."""


class WireError(PacinianError, ValueError):
    """Bytes that are no message of the protocol.

    path: path of the field that is wrong, such as `$.objects[...].shape`. problem: description of the error.
    """

    def __init__(self, problem: str, path: str = "") -> None:
        super().__init__(f"{path}: {problem}" if path else problem)
        self.path, self.problem = path, problem


class RecordingError(PacinianError, ValueError):
    """A recording that cannot be read.

    path: path of the file.
    """

    def __init__(self, path: Path | str, problem: str) -> None:
        super().__init__(f"{path}: {problem}")
        self.path = path


class SolutionFileError(PacinianError, ValueError):
    """A file of a solution that cannot be read or written.

    path: path of the file.
    """

    def __init__(self, path: Path | str, problem: str) -> None:
        super().__init__(f"{path}: {problem}")
        self.path = path


class MissingExtra(PacinianError, ImportError):
    """An optional library is not installed.

    extra: name of the extra to install, as in `pip install "SOURCE[extra]"`.
    """

    def __init__(self, library: str, extra: str) -> None:
        super().__init__(f"{library} is not installed: {suggest_install(extra)}")
        self.extra = extra


def suggest_install(extras: str) -> str:
    """Return the command that installs extras of Pacinian, as in "plot,view".

    Pacinian is not on PyPI yet. The command names the folder or the wheel that Pacinian was installed from, if that is
    known and still exists; otherwise the text says what to give in its place.
    """
    import importlib.metadata
    import json
    from pathlib import Path
    from urllib.parse import urlsplit
    from urllib.request import url2pathname

    try:
        text = importlib.metadata.distribution("pacinian").read_text("direct_url.json")
        origin = json.loads(text or "{}")
        source = Path(url2pathname(urlsplit(origin["url"]).path))
        editable = "-e " if origin.get("dir_info", {}).get("editable") else ""
        if source.is_file() or (source / "pyproject.toml").exists():
            return f'python -m pip install {editable}"{source}[{extras}]"'
    except (importlib.metadata.PackageNotFoundError, KeyError, ValueError, OSError):
        pass
    return f'python -m pip install "SOURCE[{extras}]", where SOURCE is the wheel or the source folder of Pacinian'
