"""The Unreal plugin without Unreal: what its header tool would write, and the plugin's parts as text."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from . import tools

if TYPE_CHECKING:
    from pathlib import Path

PLUGIN = tools.ADAPTERS / "unreal" / "Pacinian"
SOURCE = PLUGIN / "Source"
STUBS = tools.ADAPTERS / "cpp" / "stubs"
MODULES = "PacinianCore", "Pacinian", "PacinianEditor"

CLASS = re.compile(r"^(?:class|struct) (?:PACINIAN_API )?(\w+)(?: : public (\w+))? \{$")
MEMBER = re.compile(r"^ {2}(UPROPERTY|UFUNCTION)\((.*)\)$")
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
STRING = re.compile(r'"(?:[^"\\\n]|\\.)*"')


class Member(NamedTuple):
    """A property or function that Unreal knows. comment: the lines before it. text: its declaration."""

    kind: str
    specifiers: str
    comment: str
    text: str


class Class(NamedTuple):
    """A class or structure with GENERATED_BODY. base: "" for a structure. line: of that body, from 1."""

    name: str
    base: str
    line: int
    members: list[Member]


def layer() -> list[Path]:
    """Return the sources that need the engine."""
    files = [*(SOURCE / "Pacinian").rglob("*"), *(SOURCE / "PacinianEditor").rglob("*")]
    files.append(SOURCE / "PacinianCore" / "Private" / "PacinianCoreModule.cpp")
    return sorted(f for f in files if f.suffix in {".h", ".cpp"})


def code(path: Path) -> str:
    """Return a source without its comments and strings."""
    return STRING.sub('""', COMMENT.sub("", path.read_text(encoding="utf-8")))


def classes(header: Path) -> list[Class]:
    """Return the classes of a header that Unreal knows."""
    found: list[Class] = []
    lines = header.read_text(encoding="utf-8").splitlines()
    name = base = ""
    for i, line in enumerate(lines):
        if match := CLASS.match(line):
            name, base = match[1], match[2] or ""
        elif line.strip() == "GENERATED_BODY()":
            found.append(Class(name, base, i + 1, []))
        elif found and (match := MEMBER.match(line)):
            found[-1].members.append(_member(match[1], match[2], lines, i))
    return found


def _member(kind: str, specifiers: str, lines: list[str], at: int) -> Member:
    first = at
    while lines[first - 1].startswith(("  /**", "   *", "  //")):
        first -= 1
    last = at + 1
    while not lines[last].rstrip().endswith((";", "}")):
        last += 1
    text = " ".join(line.strip() for line in lines[at + 1 : last + 1])
    return Member(kind, specifiers, " ".join(lines[first:at]), text)


def generate(folder: Path) -> None:
    """Write the headers that the engine and its tool would provide; unchanged files stay."""
    for line in (STUBS / "headers.txt").read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            name, file = line.split()
            _write(folder / name, f'#include "{STUBS / "engine" / file}.h"\n')
    for header in sorted((SOURCE / "Pacinian" / "Public").glob("*.h")):
        made = f"#undef CURRENT_FILE_ID\n#define CURRENT_FILE_ID {header.stem}\n"
        for each in classes(header):
            body = f"STUB_BODY({each.name}, {each.base}) private:" if each.base else ""
            made += f"#define {header.stem}_{each.line}_GENERATED_BODY {body}\n"
        _write(folder / f"{header.stem}.generated.h", made)


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
