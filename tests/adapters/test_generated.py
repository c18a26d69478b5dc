"""The generated messages of the adapters match `pacinian.wire`."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest
from msgspec.structs import fields

from pacinian.wire import commands, control, modulation, objects, replies, shapes, state

from . import tools

if TYPE_CHECKING:
    from pathlib import Path

GENERATE = tools.ADAPTERS / "generate"
UNITY = tools.ADAPTERS / "unity"
MODULES = commands, control, objects, replies, shapes, state, modulation
KINDS: dict[str, Any] = {
    name: kind
    for module in MODULES
    for name, kind in vars(module).items()
    if isinstance(kind, type)
}


def generate(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, folder / "main.py", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_the_generated_files_are_what_is_generated() -> None:
    done = generate(GENERATE, "--check")
    assert (done.returncode, done.stdout + done.stderr) == (0, "")


def test_all_is_written_from_nothing_and_nothing_more(tmp_path: Path) -> None:
    adapters = tmp_path / "adapters"
    shutil.copytree(GENERATE, adapters / "generate", ignore=shutil.ignore_patterns("__pycache__"))
    assert generate(adapters / "generate", "--check").returncode == 1
    assert {path.name for path in tmp_path.iterdir()} == {"adapters"}
    assert {path.name for path in adapters.iterdir()} == {"generate"}
    assert generate(adapters / "generate").returncode == 0
    files = {path for path in adapters.rglob("*.[ch]*") if path.suffix != ".pyc"}
    made = {path.relative_to(adapters) for path in files if path.is_file()}
    marked = [path for path in tools.ADAPTERS.rglob("*.[ch]*") if is_generated(path)]
    marked += [path.with_name(f"{path.name}.meta") for path in marked if path.is_relative_to(UNITY)]
    assert made == {path.relative_to(tools.ADAPTERS) for path in marked}
    assert generate(adapters / "generate").stdout == ""


def is_generated(path: Path) -> bool:
    if path.suffix not in (".cs", ".h", ".cpp") or "build" in path.parts:
        return False
    head = path.read_text(encoding="utf-8").split("\n", 1)[0].lower()
    return "generated" in head and "do not edit" in head


@pytest.fixture(scope="module")
def model() -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(GENERATE)
        import wire  # type: ignore[import-not-found]

        return wire.read()


def test_every_class_is_in_the_model_with_all_its_fields(model: Any) -> None:
    seen = {message.name: message for message in model.messages}
    bases = {base.name for base in model.bases}
    wanted = {name for name, kind in KINDS.items() if hasattr(kind, "__struct_fields__")}
    assert wanted - {"Struct"} == seen.keys() | bases
    for name, message in seen.items():
        known = fields(KINDS[name])
        assert [(f.name, f.needed) for f in message.fields] == [(f.name, f.required) for f in known]
        assert message.tag == str(KINDS[name].__struct_config__.tag or "")
        assert message.text


def test_messages_come_after_those_that_they_hold(model: Any) -> None:
    before: set[str] = set()
    for message in model.messages:
        for field in message.fields:
            assert held(field.type) <= before, (message.name, field.name)
        before.add(message.name)


def test_the_cores_have_only_what_a_client_needs(model: Any) -> None:
    """They neither read what a client sends (except objects), nor write what it receives."""
    core = tools.ADAPTERS / "unreal" / "Pacinian" / "Source" / "PacinianCore"
    cpp = "".join(path.read_text(encoding="utf-8") for path in core.rglob("*.h"))
    files = (tools.CORE / "Wire").glob("Messages*.cs")
    csharp = "".join(path.read_text(encoding="utf-8") for path in files)
    parts = re.split(r"\n    public (?:sealed|abstract) (?:partial )?class ", csharp)
    bodies = {
        re.sub("^Haptic", "", part.split()[0]): part.split("\n    }\n")[0] for part in parts[1:]
    }
    for message in model.messages:
        is_read, is_written = message.name in model.heard, message.name in model.written
        assert f"{message.name}& message);" in cpp
        assert is_read == (f"std::uint32_t left, {message.name}& message);" in cpp)
        assert is_written == (f"write(Writer& out, const {message.name}& message);" in cpp)
        assert is_read == ("bool Read(Reader r)" in bodies[message.name])
        assert is_written == ("void Write(Writer w)" in bodies[message.name])
    kinds = {socket: set(union.kinds) for socket, (union, _) in model.sockets.items()}
    assert kinds["reply"] | kinds["state"] <= model.heard
    assert kinds["command"] | kinds["control"] <= model.written
    assert not (kinds["command"] | kinds["control"]) & model.heard
    assert not (kinds["reply"] | kinds["state"]) & model.written


def held(t: Any) -> set[str]:
    """Return the messages that a type names."""
    kind = type(t).__name__
    if kind == "Part":
        return {t.name}
    return set(t.kinds) if kind == "Union" else held(t.item) if hasattr(t, "item") else set()


def test_rules_are_about_fields_that_there_are(model: Any) -> None:
    count = 0
    for message in model.messages:
        types = {field.name: type(field.type).__name__ for field in message.fields}
        for rule in message.bulk:
            count += 1
            assert types[rule.name] == "Bin"
            assert types.get(getattr(rule, "each", "") or "names", "Array") == "Array"
            assert types.get(getattr(rule, "into", rule.name)) == "Bin"
            assert type(rule).__name__ != "Grid" or types["grid"] == "Fixed"
    assert count == sum(len(getattr(kind, "BULK", ())) for kind in KINDS.values())


def test_all_of_a_union_can_be_told_apart(model: Any) -> None:
    tags = {message.name: message.tag for message in model.messages}
    for union in model.unions:
        each = [tags[kind] for kind in union.kinds]
        assert all(each)
        assert len(set(each)) == len(each)
