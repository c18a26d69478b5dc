"""The Unity package, compiled against stand-ins of the engine's types, which also play it."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING, NamedTuple

from . import tools

if TYPE_CHECKING:
    from pathlib import Path

PACKAGE = tools.ADAPTERS / "unity"
STUBS = tools.CSHARP / "stubs"


class Built(NamedTuple):
    """What was compiled. player: plays a level as it is told. runner: of tests."""

    player: Path
    runner: Path
    tests: Path
    editor_tests: Path


def build(folder: Path) -> Built:
    """Compile all of the package's assemblies, with references as its asmdefs have them."""
    core = tools.csharp(folder / "Pacinian.Core.dll", tools.CORE.rglob("*.cs"))
    shutil.copy(tools.CSHARP / "Pacinian.dll.config", folder / "Pacinian.Core.dll.config")
    engine = tools.csharp(folder / "UnityEngine.dll", (STUBS / "UnityEngine").glob("*.cs"))
    editor = tools.csharp(folder / "UnityEditor.dll", (STUBS / "UnityEditor").glob("*.cs"), engine)
    runner = tools.csharp(folder / "nunit.framework.exe", (STUBS / "NUnit").glob("*.cs"), engine)
    layer = _part(folder, "", "Runtime", core, engine)
    _part(folder, ".XRHands", "Runtime/XRHands", engine, layer)
    editing = _part(folder, ".Editor", "Editor", core, engine, layer, editor)
    tests = _part(folder, ".Tests", "Tests/Runtime", core, engine, layer, runner)
    of_editor = _part(
        folder, ".Editor.Tests", "Tests/Editor", core, engine, layer, editor, editing, runner
    )
    tools.csharp(
        folder / "Sample.dll", (PACKAGE / "Samples~").rglob("*.cs"), core, engine, layer,
        defines=["ENABLE_LEGACY_INPUT_MANAGER"],
    )  # fmt: skip
    player = tools.csharp(
        folder / "Player.exe",
        [*(STUBS / "Play").glob("*.cs"), tools.CSHARP / "tests" / "ClientJson.cs"],
        core, engine, layer, editor,
    )  # fmt: skip
    return Built(player, runner, tests, of_editor)


def _part(folder: Path, name: str, sources: str, *libraries: Path) -> Path:
    return tools.csharp(
        folder / f"Pacinian.Haptics{name}.dll", (PACKAGE / sources).glob("*.cs"), *libraries
    )
