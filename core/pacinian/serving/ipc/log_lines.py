"""Lines of the log: readable text, or JSON. They hold no character that controls a terminal."""

from __future__ import annotations

import json
import traceback
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from pacinian.errors import describe_error, replace_unprintable, shorten

if TYPE_CHECKING:
    from collections.abc import Callable

    Formatter = Callable[[str, str, dict[str, Any], BaseException | None], str]

# Maximum number of exceptions of a chain that are logged, and of calls of each.
MAX_EXCEPTIONS, MAX_CALLS = 4, 20
# Widths of the columns of event and level in a readable line [characters].
EVENT_WIDTH, LEVEL_WIDTH = 30, 9
QUOTED = frozenset("='\"")  # a text with one of these, or with a space, is quoted
BOLD, PLAIN = "\x1b[1m", "\x1b[0m"
COLOURS = {
    "debug": "\x1b[32m",
    "info": "\x1b[32m",
    "warning": "\x1b[33m",
    "error": "\x1b[31m",
}


def format_json(level: str, event: str, values: dict[str, Any], error: BaseException | None) -> str:
    """Return an event as a JSON object in one line. Values that JSON lacks become text."""
    fields = {name: make_printable(value) for name, value in {**values, "event": event}.items()}
    fields |= {"level": level, "timestamp": tell_time()}
    if error is not None:
        fields["exception"] = describe_exceptions(error)
    return json.dumps(fields, default=repr)


def format_text(level: str, event: str, values: dict[str, Any], error: BaseException | None) -> str:
    """Return an event as a readable line, followed by the exception."""
    return _format_text(level, event, values, error, ("", "", ""))


def format_coloured_text(
    level: str, event: str, values: dict[str, Any], error: BaseException | None
) -> str:
    """Return the same for a terminal that shows colours."""
    return _format_text(level, event, values, error, (COLOURS[level], BOLD, PLAIN))


def _format_text(
    level: str, event: str, values: dict[str, Any], error: BaseException | None,
    colours: tuple[str, str, str],
) -> str:  # fmt: skip
    colour, bold, plain = colours
    shown = (f"{name}={_quote(make_printable(value))}" for name, value in sorted(values.items()))
    line = (
        f"{tell_time()} [{colour}{level:{LEVEL_WIDTH}}{plain}] "
        f"{bold}{make_printable(event):{EVENT_WIDTH}}{plain} {' '.join(shown)}"
    ).rstrip()
    return line if error is None else f"{line}\n{describe_exceptions(error)}"


def tell_time() -> str:
    """Return the time in UTC, as in ISO 8601."""
    return datetime.now(UTC).isoformat(timespec="microseconds").replace("+00:00", "Z")


def make_printable(value: Any) -> Any:
    """Return a text, such as a client's name, bounded and without characters that cannot be printed."""
    if not isinstance(value, str):
        return value
    return replace_unprintable(shorten(value))


def _quote(value: Any) -> str:
    if isinstance(value, str) and not any(c.isspace() or c in QUOTED for c in value):
        return value
    return repr(value)


def describe_exceptions(error: BaseException) -> str:
    """Return the last calls of an exception and its causes.

    Local variables are left out, because they may be secret.
    """
    lines: list[str] = []
    link: BaseException | None = error
    while link is not None and len(lines) < MAX_EXCEPTIONS:
        calls = traceback.format_tb(link.__traceback__, -MAX_CALLS)
        lines.append("".join([*calls, describe_error(link)]))
        link = link.__cause__ or (None if link.__suppress_context__ else link.__context__)
    return "\n".join(reversed(lines))
