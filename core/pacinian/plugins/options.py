"""Which options of a plug-in clients of a server may set: those that its constructor's annotations bound.

    bool                                    yes
    Literal["a", "b"], an Enum              yes: one of these
    Annotated[int, Meta(ge=1, le=256)]      yes, within both ends; float, too (`msgspec.Meta`)
    X | Y, X | None                         what one of them allows
    int, float, str, Path, anything else    no: whoever runs the server sets it, in the configuration

So a plug-in that does not think of clients is safe from them: a text may be a path or an address, and a number without
bounds may ask for all the memory there is.
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
    """The options of a class that clients may set, each with the kinds of values that it may have."""
    found = {
        name: tuple(kind for kind in _members(_kind(cls, parameter)) if _bounded(kind))
        for name, parameter in inspect.signature(cls).parameters.items()
    }
    return {name: kinds for name, kinds in found.items() if kinds}


def check_options(cls: type, options: Mapping[str, Any]) -> dict[str, Any]:
    """What a client asks for, as the class takes it. Raises ArgumentError for what it may not ask for."""
    allowed = find_client_options(cls)
    for name in options:
        if name not in allowed:
            whose = "is for whoever runs the server to set, in its configuration; clients may set: "
            raise ArgumentError(shorten(name), whose + (", ".join(allowed) or "none"))
    return {name: _converted(name, value, allowed[name]) for name, value in options.items()}


def _converted(name: str, value: Any, kinds: tuple[Any, ...]) -> Any:
    if isinstance(value, float) and value.is_integer():
        value = int(value)  # some languages have one kind of numbers
    problem = ""
    for kind in kinds:
        try:
            return msgspec.convert(value, kind)
        except msgspec.ValidationError as error:
            problem = str(error)
    raise ArgumentError(name, f"is not what clients may set it to: {problem}")


def _kind(cls: type, parameter: inspect.Parameter) -> Any:
    """Its annotation; of one that names what is not there at run time, nothing."""
    if not isinstance(parameter.annotation, str):
        return parameter.annotation
    try:
        return eval(parameter.annotation, vars(sys.modules[cls.__module__]))
    except Exception:
        return None


def _members(kind: Any) -> tuple[Any, ...]:
    return get_args(kind) if get_origin(kind) in (Union, types.UnionType) else (kind,)


def _bounded(kind: Any) -> bool:
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
