"""The Unity package, compiled with stubs of the engine's types, which can also play it."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import NamedTuple

from . import tools

PACKAGE = tools.ADAPTERS / "unity"
STUBS = tools.CSHARP / "stubs"
SYSTEMS = {  # Unity's input systems
    "manager": ["ENABLE_LEGACY_INPUT_MANAGER"],
    "system": ["ENABLE_INPUT_SYSTEM", "PACINIAN_INPUT_SYSTEM"],
}
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


def _part(folder: Path, name: str, sources: str, *libraries: Path) -> Path:
    return tools.csharp(
        folder / f"Pacinian.Haptics{name}.dll", (PACKAGE / sources).glob("*.cs"), *libraries,
        defines=SYSTEMS["manager"],
    )  # fmt: skip
