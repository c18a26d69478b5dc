"""Error paths: where in a message a value is invalid."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from pacinian.errors import ArgumentError, WireError

if TYPE_CHECKING:
    from collections.abc import Callable

A = TypeVar("A")
B = TypeVar("B")

BROKEN = ValueError, ArithmeticError, MemoryError


def locate_errors(path: str, convert: Callable[[A], B], value: A) -> B:
    """Return `convert(value)` of a value at `path`. Raises WireError, which carries the whole path."""
    try:
        return convert(value)
    except BROKEN as error:
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
