"""Where in a message an argument is that cannot be meant."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from pacinian.errors import ArgumentError, WireError

if TYPE_CHECKING:
    from collections.abc import Callable

A = TypeVar("A")
B = TypeVar("B")

BROKEN = ValueError, ArithmeticError, MemoryError


def locate_errors(path: str, convert: Callable[[A], B], value: A) -> B:
    """What `convert` makes of a value that is at `path`. Raises WireError, which has the whole path."""
    try:
        return convert(value)
    except BROKEN as error:
        raise locate(path, value, error) from error


def locate(path: str, value: object, error: Exception) -> WireError:
    """An error about a value that is at `path`, with the path of the field that is wrong."""
    if isinstance(error, WireError):
        return WireError(error.problem, path + error.path)
    if isinstance(error, ArgumentError):
        return WireError(str(error), path + _field(value, error.argument))
    return WireError(str(error) or type(error).__name__, path)


def _field(value: object, argument: str) -> str:
    """Which field of a value an argument is: the one of that name, or the one that holds such a thing."""
    names = getattr(value, "__struct_fields__", ())
    if argument.partition("[")[0] in names:
        return f".{argument}"
    for name in names:
        config = getattr(getattr(value, name), "__struct_config__", None)
        if config is not None and config.tag == argument:
            return f".{name}"
    return ""
