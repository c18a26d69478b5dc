"""The Unity package, compiled with stubs of the engine's types, which can also play it."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from . import tools

if TYPE_CHECKING:
    from collections.abc import Iterable

PACKAGE = tools.ADAPTERS / "unity"
STUBS = tools.CSHARP / "stubs"
SYSTEMS = {  # Unity's input systems
    "manager": ["ENABLE_LEGACY_INPUT_MANAGER"],
    "system": ["ENABLE_INPUT_SYSTEM", "PACINIAN_INPUT_SYSTEM"],
}
STUBS_ONLY = "PACINIAN_STUBS"  # defined for tests that need more than Unity has
MARKED = re.compile(r"(Not in Unity\.\s*(?:///\s*)?</summary>\s*)public\b")  # a member
VERSIONS = {  # of other packages
    "older": [],
    "newer": ["PACINIAN_XRI_3", "PACINIAN_ULTRALEAP_7"],
}


class Built(NamedTuple):
    """The compiled programs. player: plays a level by commands. runner: runs tests.

    packages: test other packages. mouse: test each input system, beside a runner of their own.
    """

    player: Path
    runner: Path
    tests: Path
    editor_tests: Path
    packages: tuple[Path, ...]
    mouse: tuple[Path, ...]


def build(folder: Path) -> Built:
    """Compile all of the package's assemblies, with the references of its asmdefs."""
    core = tools.csharp(folder / "Pacinian.Core.dll", tools.CORE.rglob("*.cs"))
    shutil.copy(tools.CSHARP / "Pacinian.dll.config", folder / "Pacinian.Core.dll.config")
    engine, editor = _engine(folder, STUBS)
    runner = tools.csharp(folder / "nunit.framework.exe", (STUBS / "NUnit").glob("*.cs"), engine)
    layer, tests, of_editor = _package(folder, core, engine, editor, runner, [STUBS_ONLY])
    mouse = tuple(
        _with_input(folder / system, defines, core, engine, runner)
        for system, defines in SYSTEMS.items()
    )
    packages = tuple(
        _with_packages(folder / version, defines, core, engine, layer, runner)
        for version, defines in VERSIONS.items()
    )
    player = tools.csharp(
        folder / "Player.exe",
        [*(STUBS / "Play").glob("*.cs"), tools.CSHARP / "tests" / "ClientJson.cs"],
        core, engine, layer, editor,
    )  # fmt: skip
    return Built(player, runner, tests, of_editor, packages, mouse)


def build_for_unity(folder: Path) -> None:
    """Compile the package, its tests and its sample against the stubs without what Unity does not have."""
    strict = folder / "stubs"
    for source in [*(STUBS / "UnityEngine").glob("*.cs"), *(STUBS / "UnityEditor").glob("*.cs")]:
        text = source.read_text(encoding="utf-8")
        hidden, count = MARKED.subn(r"\1internal", text)
        assert count == text.count("Not in Unity"), source
        copy = strict / source.parent.name / source.name
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_text(hidden, encoding="utf-8")
    core = tools.csharp(folder / "Pacinian.Core.dll", tools.CORE.rglob("*.cs"))
    engine, editor = _engine(folder, strict)
    nunit = tools.csharp(folder / "nunit.framework.dll", [STUBS / "NUnit" / "Framework.cs"])
    layer, *_ = _package(folder, core, engine, editor, nunit, [])
    _part(folder, ".Samples", "Samples~/TouchABall", core, engine, layer)


def _engine(folder: Path, stubs: Path) -> tuple[Path, Path]:
    """Compile UnityEngine.dll and UnityEditor.dll."""
    engine = tools.csharp(folder / "UnityEngine.dll", (stubs / "UnityEngine").glob("*.cs"))
    editor = tools.csharp(folder / "UnityEditor.dll", (stubs / "UnityEditor").glob("*.cs"), engine)
    return engine, editor


def _package(
    folder: Path, core: Path, engine: Path, editor: Path, nunit: Path, defines: list[str]
) -> tuple[Path, Path, Path]:
    """Compile the package's components, their tests, and the tests of its editor part. defines: for the tests."""
    layer = _part(folder, "", "Runtime", core, engine)
    _part(folder, ".XRHands", "Runtime/XRHands", engine, layer)
    editing = _part(folder, ".Editor", "Editor", core, engine, layer, editor)
    tests = _part(folder, ".Tests", "Tests/Runtime", core, engine, layer, nunit, defines=defines)
    of_editor = _part(
        folder, ".Editor.Tests", "Tests/Editor", core, engine, layer, editor, editing, nunit,
        defines=defines,
    )  # fmt: skip
    return layer, tests, of_editor


def _with_packages(folder: Path, defines: list[str], *libraries: Path) -> Path:
    """Compile tests of the components for other packages, with one version of each."""
    made = list(libraries)
    for stub, part in (("XRInteraction", "XRInteraction"), ("Ultraleap", "Ultraleap")):
        source = STUBS / "Packages" / f"{stub}.cs"
        made.append(tools.csharp(folder / f"{stub}.dll", [source], *libraries, defines=defines))
        sources = (PACKAGE / "Runtime" / part).glob("*.cs")
        name = folder / f"Pacinian.Haptics.{part}.dll"
        made.append(tools.csharp(name, sources, *made, defines=defines))
    source = STUBS / "Packages" / "Tests.cs"
    name = folder / "Pacinian.Haptics.Tests.dll"  # sees internal members
    return tools.csharp(name, [source], *made, defines=defines)


def _with_input(folder: Path, defines: list[str], *libraries: Path) -> Path:
    """Compile the components, the sample and tests of the mouse with one of the input systems."""
    folder.mkdir()
    made = [Path(shutil.copy(library, folder)) for library in libraries]
    source = STUBS / "Packages" / "InputSystem.cs"
    made.append(tools.csharp(folder / "Unity.InputSystem.dll", [source], *made))
    for name, sources in {
        "Pacinian.Haptics.dll": (PACKAGE / "Runtime").glob("*.cs"),
        "Pacinian.Samples.TouchABall.dll": (PACKAGE / "Samples~").rglob("*.cs"),
        "Pacinian.Haptics.Tests.dll": [STUBS / "Packages" / "MouseTests.cs"],
    }.items():
        made.append(tools.csharp(folder / name, sources, *made, defines=defines))
    return made[-1]


def _part(
    folder: Path, name: str, sources: str, *libraries: Path, defines: Iterable[str] = ()
) -> Path:
    return tools.csharp(
        folder / f"Pacinian.Haptics{name}.dll", (PACKAGE / sources).glob("*.cs"), *libraries,
        defines=[*SYSTEMS["manager"], *defines],
    )  # fmt: skip
