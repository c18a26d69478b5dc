"""The plug-in options that a server's clients may set: those whose annotations in the constructor bound the value.

    bool                                    yes
    Literal["a", "b"], an Enum              yes: one of these values
    Annotated[int, Meta(ge=1, le=256)]      yes, within both bounds; also for float (`msgspec.Meta`)
    X | Y, X | None                         the values that any of the members allows
    int, float, str, Path, anything else    no: only the server's configuration can set it

This keeps a plug-in safe even if its author did not think of clients: a string may be a path or an address, and a
number without bounds may request all of the memory.
"""

from __future__ import annotations

import enum
import inspect
import math
import sys
import types
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union, get_args, get_origin

import msgspec

from pacinian.errors import ArgumentError, shorten

if TYPE_CHECKING:
    from collections.abc import Mapping


def find_client_options(cls: type) -> dict[str, tuple[Any, ...]]:
    """Return the options of a class that clients may set, each with the types that it accepts."""
    found = {
        name: tuple(kind for kind in _members(_kind(cls, parameter)) if _is_bounded(kind))
        for name, parameter in inspect.signature(cls).parameters.items()
    }
    return {name: kinds for name, kinds in found.items() if kinds}


def check_options(cls: type, options: Mapping[str, Any]) -> dict[str, Any]:
    """Convert a client's options to the types of the constructor. Raises ArgumentError for one that it may not set."""
    allowed = find_client_options(cls)
    for name in options:
        if name not in allowed:
            whose = "can only be set in the server's configuration; clients may set: "
            raise ArgumentError(shorten(name), whose + (", ".join(allowed) or "none"))
    return {name: _convert_option(name, value, allowed[name]) for name, value in options.items()}


def _convert_option(name: str, value: Any, kinds: tuple[Any, ...]) -> Any:
    if isinstance(value, float) and value.is_integer():
        value = int(value)  # some languages have only one number type
    problem = ""
    for kind in kinds:
        try:
            return msgspec.convert(value, kind)
        except msgspec.ValidationError as error:
            problem = str(error)
    raise ArgumentError(name, f"is not what clients may set it to: {problem}")


def _kind(cls: type, parameter: inspect.Parameter) -> Any:
    """Return the annotation of a parameter, or None if it names something that does not exist at run time."""
    if not isinstance(parameter.annotation, str):
        return parameter.annotation
    try:
        return eval(parameter.annotation, vars(sys.modules[cls.__module__]))
    except Exception:
        return None


def _members(kind: Any) -> tuple[Any, ...]:
    return get_args(kind) if get_origin(kind) in (Union, types.UnionType) else (kind,)


def _is_bounded(kind: Any) -> bool:
    if get_origin(kind) is Annotated:
        number, *notes = get_args(kind)
        metas = [note for note in notes if isinstance(note, msgspec.Meta)]
        low = any(_finite(meta.ge) or _finite(meta.gt) for meta in metas)
        high = any(_finite(meta.le) or _finite(meta.lt) for meta in metas)
        return number in (int, float) and low and high
    if get_origin(kind) is Literal:
        return all(type(value) in (int, str) for value in get_args(kind))
    return kind is bool or (isinstance(kind, type) and issubclass(kind, enum.Enum))


def _finite(end: float | None) -> bool:
    return end is not None and math.isfinite(end)
