"""Reads the public members of the Unity and Unreal layers, and of their clients, from the sources.

This knows the style of these sources, not the languages. Members of both engines are the same feature if their names
are equal, except for the conventions in `plain`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

SETTING, STATUS, ACTION, EVENT = "setting", "status", "action", "event"


@dataclass(frozen=True)
class Member:
    """A member that a game can use. name: as in the source. default: of a setting, as `default` returns it."""

    name: str
    kind: str
    default: str = ""


Surface = dict[str, dict[str, Member]]  # members by feature, by class


def plain(name: str, kind: str) -> str:
    """Return a feature's name without Unreal's `b` of a flag, `On` of an event, `Get`, `Is` and `Set` of a function."""
    bare = "".join(word[:1].upper() + word[1:] for word in name.split("_"))
    bare = re.sub(
        r"^(?:B(?=[A-Z][a-z])|Get(?=[A-Z])|Is(?=[A-Z])|Set(?=[A-Z])|On(?=[A-Z]))", "", bare
    )
    return f"{bare} ({EVENT})" if kind == EVENT else bare


def default(text: str, scale: float = 1.0) -> str:
    """Return a default in a common form: numbers in SI units, the last name of a path; "" for nothing."""
    text = text.strip()
    if re.fullmatch(r"(?:[\w.:]+(?:::|\.))?[A-Za-z]\w*", text) and text not in {"true", "false"}:
        return re.split(r"::|\.", text)[-1]
    quoted = re.search(r'"(.*)"', text)
    if quoted:
        return quoted[1]
    numbers = re.findall(r"(?<![\w\]])-?\d+\.?\d*(?:e-?\d+)?", re.sub(r"\[\d*\]", "", text))
    values = [round(scale * float(number), 9) for number in numbers]
    if any(values):
        return " x ".join(f"{value:g}" for value in values)
    return "yes" if text == "true" else ""


def _add(surface: Surface, owner: str, member: Member) -> None:
    features = surface.setdefault(owner, {})
    feature = plain(member.name, member.kind)
    known = features.get(feature)
    if known is None or member.kind == SETTING:
        name = known.name if known is not None and known.kind != SETTING else member.name
        features[feature] = Member(name, member.kind, member.default)


def _bodies(text: str) -> Iterator[tuple[str, str]]:
    """Return the public classes of a C# file, and their bodies. Structs are values that members have."""
    heads = list(re.finditer(r"^    public (?:\w+ )*class (\w+)", text, re.MULTILINE))
    for head in heads:
        end = text.find("\n    }\n", head.end())
        yield head[1], text[head.end() : end]


def unity(sources: Iterable[Path]) -> Surface:
    """Read C# files: serialized and public fields, properties, methods and events."""
    found: Surface = {}
    for source in sorted(sources):
        text = re.sub(r'Tooltip\("[^"]*"\)', "Tooltip", source.read_text(encoding="utf-8"))
        for owner, body in _bodies(text):
            found.setdefault(owner, {})
            public = r"^        (?:\[[^\]]*\] )?public (?!const|override|abstract)"
            kept = r"\[SerializeField[^;]*?private [\w.\[\]]+ (\w+)(?: = ([^;]*))?;"
            for name, value in re.findall(kept, body, re.DOTALL):
                pascal = name[:1].upper() + name[1:]
                _add(found, owner, Member(pascal, SETTING, default(value)))
            for name, value in re.findall(
                public + r"[\w.<>\[\]]+ (\w+)(?: = ([^;]*))?;", body, re.M
            ):
                _add(found, owner, Member(name, SETTING, default(value)))
            for names in re.findall(
                public + r"[\w.<>]+ (\w+(?: = \"\", \w+)+) = \"\";", body, re.M
            ):
                for name in re.findall(r"(\w+) = |(\w+)$", names):
                    _add(found, owner, Member("".join(name), SETTING))
            for name in re.findall(public + r"event [\w.<>]+ (\w+);", body, re.M):
                _add(found, owner, Member(name, EVENT))
            for name in re.findall(
                public + r"(?:static )?[\w.<>\[\]]+ (\w+)(?: \{|\n)", body, re.M
            ):
                _add(found, owner, Member(name, STATUS))
            for name in re.findall(public + r"(?:static )?[\w.<>\[\]]+ (\w+)\(", body, re.M):
                _add(found, owner, Member(name, ACTION))
    return found


def unreal(headers: Iterable[Path]) -> Surface:
    """Read C++ headers with UPROPERTY and UFUNCTION."""
    found: Surface = {}
    for header in sorted(headers):
        text = header.read_text(encoding="utf-8")
        head = re.search(
            r"^(?:class|struct) PACINIAN_API [UAF](\w+?)(?:Component)?(?: :|\s*\{)", text, re.M
        )
        if head is None:
            continue
        owner = head[1]
        found.setdefault(owner, {})
        shown = r"(/\*\*(?:(?!\*/).)*?\*/\s*)?UPROPERTY\(([^\n]*)\)\n  ([^;]*);"
        for comment, how, text_ in re.findall(shown, text, re.DOTALL):
            match = re.match(r"[\w<>*]+ (\w+)(?: = (.*))?$", text_)
            if match is None or not re.search(r"Edit|BlueprintAssignable|VisibleAnywhere", how):
                continue
            if "BlueprintAssignable" in how:
                _add(found, owner, Member(match[1], EVENT))
            else:
                scale = 0.01 if "[cm]" in comment else 1.0
                _add(found, owner, Member(match[1], SETTING, default(match[2] or "", scale)))
        for name in re.findall(r"UFUNCTION\([^\n]*\)\n  [^;]*?(\w+)\([^;]*;", text):
            _add(found, owner, Member(name, STATUS if name.startswith(("Get", "Is")) else ACTION))
        for name in re.findall(r"^  pacinian::Client\* (\w+)\(\) const;", text, re.M):
            _add(found, owner, Member(name, STATUS))
    return found


def core(header: Path, options: Path, events: Path) -> Surface:
    """Read the client in C++."""
    if not header.is_file():
        return {}
    found: Surface = {"Client": {}, "Options": {}}
    body = header.read_text(encoding="utf-8").split("private:")[0]
    for name, arguments in re.findall(
        r"PACINIANCORE_API [^;~]*?(\w+)\(([^;]*)\)(?: const)?;", body
    ):
        if name != "Client":
            kind = (
                ACTION
                if arguments or f"bool {name}(" in body or f"void {name}(" in body
                else STATUS
            )
            _add(found, "Client", Member(name, kind))
    for names in re.findall(r"^  std::function<[^;]*> ([\w, ]+);", events.read_text("utf-8"), re.M):
        for name in names.split(", "):
            _add(found, "Client", Member(name, EVENT))
    for name, value in re.findall(
        r"^  [\w:<>()]+ (\w+)(?: = ([^;]*))?;", options.read_text("utf-8"), re.M
    ):
        _add(found, "Options", Member(name, SETTING, default(value)))
    return found


def choices(sources: Iterable[Path]) -> dict[str, list[str]]:
    """Return enumerations, in C# or C++, and their words."""
    found: dict[str, list[str]] = {}
    for source in sorted(sources):
        text = re.sub(
            r"/\*.*?\*/|//[^\n]*", "", source.read_text(encoding="utf-8"), flags=re.DOTALL
        )
        for name, body in re.findall(r"enum (?:class )?(\w+)[^{;]*\{(.*?)\}", text, re.DOTALL):
            found[name] = re.findall(r"(\w+)\s*(?:,|$)", body.strip())
    return found
