"""Shared parts of the conformance kits: trying rules one by one, calls with a time limit, and the report."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    Rule = Callable[[], None]

T = TypeVar("T")


class NotConforming(AssertionError):
    """A plug-in breaks rules. broken: name of each broken rule to the observation."""

    def __init__(self, what: str, broken: Mapping[str, str]) -> None:
        details = "".join(f"\n  {rule}: {seen}" for rule, seen in broken.items())
        super().__init__(f"{what} breaks {len(broken)} of its rules:{details}")
        self.broken = dict(broken)


class Broken(AssertionError):
    """A rule is broken."""


class Hangs(Broken):
    """A call does not return, so no further rule can be tried."""


def require(holds: bool, seen: str) -> None:
    """Raise Broken with the observation `seen`, unless `holds`."""
    if not holds:
        raise Broken(seen)


def require_kind(kind: type, value: object, what: str) -> None:
    """Raise Broken unless `value` is an instance of `kind`."""
    require(isinstance(value, kind), f"{what} is {value!r}, not a pacinian.{kind.__name__}")


def check_class(kind: type, made: object) -> None:
    """Raise Broken unless a plug-in is of that kind, with a name and a docstring."""
    require_kind(kind, made, "what is made")
    name = getattr(type(made), "name", None)
    require(isinstance(name, str) and bool(name), f"its `name` is {name!r}")
    require(bool((type(made).__doc__ or "").strip()), "it has no docstring")


def call_with_limit(what: str, action: Callable[[], T], limit: float) -> T:
    """Run `action` in a thread of its own and return its result. Re-raises its error; Hangs after `limit` [s]."""
    made: list[T] = []
    raised: list[BaseException] = []

    def work() -> None:
        try:
            made.append(action())
        except BaseException as error:  # raised again below
            raised.append(error)

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    thread.join(limit)
    if thread.is_alive():
        raise Hangs(f"{what} has not returned after {limit:g} s")
    if raised:
        raise raised[0]
    return made[0]


def check_rules(what: str, rules: Mapping[str, Rule]) -> None:
    """Try each rule. Raises NotConforming with all broken rules."""
    broken: dict[str, str] = {}
    for name, rule in rules.items():
        try:
            rule()
        except Hangs as error:
            broken[name] = str(error)
            break
        except Broken as error:
            broken[name] = str(error)
        except Exception as error:  # whatever a plug-in raises is the finding
            broken[name] = f"raises {type(error).__name__}: {error}"
    if broken:
        raise NotConforming(what, broken)
