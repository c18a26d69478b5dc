"""The wire protocol as two Markdown pages: prose from guide.md and messages.md, tables from the message classes."""

from __future__ import annotations

import re
from importlib.resources import files
from typing import TYPE_CHECKING, Any, get_args

from pacinian.wire import commands, control, modulation, objects, protocol, replies, shapes, state
from pacinian.wire.message_docs import (
    GROUPS,
    describe_fields,
    link_class,
    list_classes,
    name_class,
    summarise,
)
from pacinian.wire.silence_cause import CAUSES

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from msgspec import Struct

    Kinds = Iterable[type[Struct]]


def make_guide(lease: float) -> str:
    """Return the page that says how to talk to the server, in Markdown. lease: the server's default lease [s]."""
    return _fill("guide.md", lease=f"{lease:g}")


def make_reference() -> str:
    """Return the page of all messages, in Markdown."""
    return _fill("messages.md")


def _fill(name: str, **more: str) -> str:
    text = (files("pacinian.wire") / name).read_text(encoding="utf-8")
    parts = _parts() | more
    return re.sub(r"\{\{(.+?)\}\}", lambda match: parts[match[1]], text)


def _parts() -> dict[str, str]:
    shown: set[type[Struct]] = set()

    def sections(kinds: Kinds, base: type[Struct] | None = None) -> str:
        new = [kind for kind in kinds if kind not in shown]
        shown.update(new)
        return "\n\n".join(_section(kind, base) for kind in new)

    made = {
        "version": f"{protocol.MAJOR}.{protocol.MINOR}",
        "codes": _meanings("code", replies.CODES),
        "outputs": _meanings("output", state.OUTPUTS),
        "causes": _meanings("cause", CAUSES),
        "presets": ", ".join(f'`"{name}"`' for name in get_args(modulation.PresetName)),
        "command fields": _format_table(commands.Command),
        "commands": sections(commands.COMMANDS, commands.Command),
        "command parts": sections([commands.HandFrame, commands.Zone]),
        "request fields": _format_table(control.Request),
        "controls": sections([*control.CONTROLS, control.Choice], control.Request),
        "reply fields": _format_table(replies.Reply),
        "replies": sections([*replies.REPLIES, replies.Plugin, replies.Sound], replies.Reply),
        "states": sections([*state.STATES, state.ClientState, state.TouchState]),
        "felt fields": _format_table(objects.HapticObject),
        "objects": sections(objects.OBJECTS, objects.HapticObject),
        "object parts": sections([shapes.Pose, objects.Texture, objects.Material, objects.Motion]),
        "shells": sections(list_classes(shapes.Shell)),
        "solids": sections(list_classes(shapes.Solid)),
        "curves": sections(list_classes(shapes.Curve)),
        "envelopes": sections(list_classes(modulation.Envelope)),
        "techniques": sections(list_classes(modulation.Technique)),
    }
    numbers = (
        "MAX_COMMAND_BYTES",
        "MAX_CONTROL_BYTES",
        "HEARTBEAT_INTERVAL_MS",
        "HEARTBEAT_TIMEOUT_MS",
    )
    limits = {name: f"{getattr(protocol, name):,}" for name in numbers}
    groups = {
        f"group {name}": ", ".join(map(link_class, list_classes(group)))
        for name, group in GROUPS.items()
    }
    return made | limits | groups


def _section(kind: type[Struct], base: type[Struct] | None) -> str:
    inherited = base if base and issubclass(kind, base) else None
    return f"### `{name_class(kind)}`\n\n{summarise(kind)}\n\n{_format_table(kind, inherited)}".rstrip()


def _format_table(kind: type[Struct], base: type[Struct] | None = None) -> str:
    said = describe_fields(kind, but=base)
    if not said:
        return ""
    rows = [("field", "type", "bounds", "default", "meaning"), ("---",) * 5]
    rows += [(f"`{s.name}`", s.type, s.bounds, s.default or "needed", s.meaning) for s in said]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _meanings(title: str, words: Mapping[Any, str]) -> str:
    rows = [f"| `{word}` | {meaning} |" for word, meaning in words.items()]
    return "\n".join([f"| {title} | meaning |", "| --- | --- |", *rows])
