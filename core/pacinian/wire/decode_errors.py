"""Errors of decoded messages: each is a WireError with the path of the wrong field and what is wrong there.

`convert_error` turns an error of msgspec's decoder into one; `locate_errors` and `locate` do so for an error of the
conversion between messages and scene objects, which comes after decoding.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, TypeVar, get_args

import msgspec
from msgspec import Struct

from pacinian.errors import ArgumentError, WireError
from pacinian.wire import modulation, shapes

if TYPE_CHECKING:
    from collections.abc import Callable

A = TypeVar("A")
B = TypeVar("B")

# what a conversion between messages and scene objects raises
CONVERSION_ERRORS = ValueError, ArithmeticError, MemoryError
# what msgspec's encoder and decoder raise
CODEC_ERRORS = (
    msgspec.MsgspecError,
    ValueError,
    TypeError,
    OverflowError,
    RecursionError,
    MemoryError,
)
PROBLEM, PATH = 300, 200  # length of a problem and of a path in an error [characters]
FIELD = re.compile(r"(?:Object missing required field )?`(\w+)`")  # the field that a problem names


def _list_tags(*unions: Any) -> list[str]:
    """Return the types of the structs in some unions, in order and once."""
    structs = [kind for union in unions for kind in get_args(union) if isinstance(kind, type)]
    tags = [str(kind.__struct_config__.tag) for kind in structs if issubclass(kind, Struct)]
    return list(dict.fromkeys(tags))


TAGS = {
    "shape": _list_tags(shapes.Shell, shapes.Solid, shapes.Curve),
    "along": _list_tags(shapes.Curve),
    "envelope": _list_tags(modulation.Envelope),
    "technique": _list_tags(modulation.Technique),
}
"""Types of the parts of objects, by the name of the field."""


def convert_error(error: Any) -> WireError:
    """Convert an error of the encoder or the decoder, of a kind in `CODEC_ERRORS`, to a WireError.

    It has the path of the wrong field, such as `$.object.shape.type`. If the field has an unknown type, the problem
    lists the known ones. Both are cut to `PROBLEM` and `PATH` characters.
    """
    if isinstance(error, RecursionError):
        return WireError("is nested too deeply", "$")
    if isinstance(error, MemoryError):
        return WireError("is too large", "$")
    problem, _, path = str(error).rpartition(" - at `")
    problem, path = (problem, path) if problem else (str(error), "$")
    path = path.rstrip("`").removeprefix("key` in `")
    if field := FIELD.match(problem):
        path = f"{path}.{field[1]}"
    if problem.startswith("Invalid value '") and path.endswith(".type"):
        kind = path.removesuffix(".type").rpartition(".")[2]
        if known := TAGS.get(kind):
            problem = f"{problem[: PROBLEM // 3]}: there are {', '.join(known)}"
    return WireError(problem[:PROBLEM], path[:PATH])


def locate_errors(path: str, convert: Callable[[A], B], value: A) -> B:
    """Return `convert(value)` of a value at `path`. Raises WireError, which carries the whole path."""
    try:
        return convert(value)
    except CONVERSION_ERRORS as error:
        raise locate(path, value, error) from error


def locate(path: str, value: object, error: Exception) -> WireError:
    """Convert an error about the value at `path` to a WireError with the path of the wrong field."""
    if isinstance(error, WireError):
        return WireError(error.problem, path + error.path)
    if isinstance(error, ArgumentError):
        return WireError(str(error), path + _field(value, error.argument))
    return WireError(str(error) or type(error).__name__, path)


def _field(value: object, argument: str) -> str:
    """Return the path of the field for an argument: the field of that name, or one whose value has that tag."""
    names = getattr(value, "__struct_fields__", ())
    if argument.partition("[")[0] in names:
        return f".{argument}"
    for name in names:
        config = getattr(getattr(value, name), "__struct_config__", None)
        if config is not None and config.tag == argument:
            return f".{name}"
    return ""
