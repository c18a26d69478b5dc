"""What the conformance kits share: rules that are tried one by one, calls that must come back, what was broken."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    Rule = Callable[[], None]

T = TypeVar("T")


class NotConforming(AssertionError):
    """A plug-in that breaks rules. broken: rule to what was seen."""

    def __init__(self, what: str, broken: Mapping[str, str]) -> None:
        told = "".join(f"\n  {rule}: {seen}" for rule, seen in broken.items())
        super().__init__(f"{what} breaks {len(broken)} of its rules:{told}")
        self.broken = dict(broken)


class Broken(AssertionError):
    """One rule is broken."""


class Hangs(Broken):
    """A call that does not come back: nothing more can be tried."""


def require(true: bool, seen: str) -> None:
    """Raise Broken with what was seen, unless it is true."""
    if not true:
        raise Broken(seen)


def a(kind: type, value: object, what: str) -> None:
    """Raise Broken unless the value is of that kind."""
    require(isinstance(value, kind), f"{what} is {value!r}, not a pacinian.{kind.__name__}")


def called(what: str, action: Callable[[], T], limit: float) -> T:
    """Do it in a thread of its own. Raises what it raises; Hangs if that takes more than `limit` seconds."""
    made: list[T] = []
    raised: list[BaseException] = []

    def work() -> None:
        try:
            made.append(action())
        except BaseException as error:  # it is raised again below
            raised.append(error)

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    thread.join(limit)
    if thread.is_alive():
        raise Hangs(f"{what} has not come back after {limit:g} s")
    if raised:
        raise raised[0]
    return made[0]


def tried(what: str, rules: Mapping[str, Rule]) -> None:
    """Try each rule. Raises NotConforming with all that were broken."""
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
