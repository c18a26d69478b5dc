"""`pacinian unity` and `pacinian unreal`: put the engine's package into a project."""

from __future__ import annotations

import codecs
import json
import re
import shutil
import sys
import sysconfig
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pacinian.atomic_file import replace_file
from pacinian.cli.engine_package import Package, PackageError, find_package, install
from pacinian.cli.options import NonEmptyPath

if TYPE_CHECKING:
    from collections.abc import Callable

UNITY = "com.pacinian.haptics"
# In a project of Unity, where its Haptic Server looks for the program: Unity's folder for what concerns one user.
UNITY_PROGRAM = Path("UserSettings") / "PacinianProgram.txt"
# In a project of Unreal: the file of its settings, and the section of the class UPacinianSettings.
UNREAL_SETTINGS = Path("Config") / "DefaultGame.ini"
UNREAL_SECTION = "[/Script/Pacinian.PacinianSettings]"
MIN_UNITY = (2021, 3)
MIN_UNREAL = (5, 5)
MAX_DEPTH = 2  # levels of folders below the given one in which a project is looked for

PROJECT = click.argument("path", type=NonEmptyPath(path_type=Path))
REPLACE = click.option(
    "--replace",
    is_flag=True,
    help="Even if the package there is newer, or somebody has changed it.",
)


@click.command()
@PROJECT
@REPLACE
def unity(path: Path, replace: bool) -> None:
    """Put the Unity package into the project PATH.

    PATH is the folder that has Assets. Run it again after an update of Pacinian.
    """
    project = _find_project(
        path, "Unity", "Assets and ProjectSettings/ProjectVersion.txt", _is_unity
    )
    _check_unity(project)
    target = project / "Packages" / UNITY
    _install(Package(find_package("unity"), "package.json", "version"), target, replace)
    _note_unity_program(project / UNITY_PROGRAM)
    _warn_of_manifest(project)
    click.echo(
        "\nNext:\n"
        "  1. Start a server:    pacinian serve\n"
        "  2. In Unity, wait for the import, then Window > Package Manager > In Project >\n"
        "     Pacinian Mid-Air Haptics > Samples > Touch a ball > Import. Open its scene, and press play.\n"
        "     The screen says `Sounding`, or why it is silent.\n"
        "  3. In your scene:     GameObject > Pacinian > Array, Ball, Hands\n"
        f"  Manual: {target / 'Documentation~' / 'index.md'}"
    )


@click.command()
@PROJECT
@REPLACE
def unreal(path: Path, replace: bool) -> None:
    """Put the Unreal plugin into the project PATH.

    PATH is the folder that has the .uproject file, or that file. Run it again after an update of Pacinian.
    """
    project = _find_project(
        path.parent if path.suffix == ".uproject" else path,
        "Unreal",
        "a .uproject file",
        _is_unreal,
    )
    _check_unreal(project)
    target = project / "Plugins" / "Pacinian"
    plugin = find_package("unreal") / "Pacinian"
    _install(Package(plugin, "Pacinian.uplugin", "VersionName"), target, replace)
    _note_unreal_program(project / UNREAL_SETTINGS)
    click.echo(
        "\nNext:\n"
        "  1. Start a server:    pacinian serve\n"
        "  2. Generate the project files again, build, and open the editor.\n"
        "  3. In your level: place a Haptic Array, add a Haptic Volume to a sphere 17.5 cm above it,\n"
        "     and a Haptic Hand to an empty actor 21.5 cm above it. Without a headset, set its Source\n"
        "     to Mouse, and choose a game mode without a pawn, which would take the mouse.\n"
        "  4. Press Play and hold the left mouse button. The screen says why it is silent.\n"
        f"  Tutorial: {find_package('unreal') / 'docs' / 'touch-a-ball.md'}"
    )


def _install(package: Package, target: Path, replace: bool) -> None:
    """Install, and say what was done. Raises PackageError."""
    done = install(package, target, replace=replace)
    if not done.copied:
        click.echo(f"Pacinian {package.version} is in {target} already: nothing was changed.")
    elif done.before is None:
        click.echo(f"Pacinian {package.version} is in {target} now.")
    else:
        click.echo(
            f"Pacinian {package.version} is in {target} now, in place of {done.before or 'another'}."
        )


def _find_project(path: Path, engine: str, has: str, fits: Callable[[Path], bool]) -> Path:
    """Return the folder of a project. Raises PackageError, which names a project nearby if there is one."""
    article = "an" if engine == "Unreal" else "a"
    if not path.is_dir():
        raise PackageError(
            f"{path} is not a folder: give the folder of {article} {engine} project, which contains {has}"
        )
    if fits(path):
        return path
    near = [folder for folder in path.resolve().parents if fits(folder)][:1]
    for depth in range(1, MAX_DEPTH + 1):
        near += [
            folder
            for folder in sorted(path.glob("/".join("*" * depth)))
            if folder.is_dir() and fits(folder)
        ]
    advice = f"; did you mean {near[0]}?" if near else ""
    raise PackageError(
        f"{path} is not {article} {engine} project, because it does not contain {has}{advice}"
    )


def _is_unity(folder: Path) -> bool:
    return (folder / "Assets").is_dir() and (
        folder / "ProjectSettings" / "ProjectVersion.txt"
    ).is_file()


def _is_unreal(folder: Path) -> bool:
    return any(folder.glob("*.uproject"))


def _check_unity(project: Path) -> None:
    """Raise PackageError if the project's Unity is too old for the package."""
    text = (project / "ProjectSettings" / "ProjectVersion.txt").read_text(
        encoding="utf-8", errors="replace"
    )
    found = re.search(r"m_EditorVersion:\s*(\d+)\.(\d+)\S*", text)
    if found and (int(found[1]), int(found[2])) < MIN_UNITY:
        least = ".".join(map(str, MIN_UNITY))
        raise PackageError(
            f"{project} is a project of Unity {found[1]}.{found[2]}: the package needs {least} or newer"
        )


def _check_unreal(project: Path) -> None:
    """Raise PackageError if the project's engine is too old, or if the project has no C++ code.

    An engine built from source has no number.
    """
    file = sorted(project.glob("*.uproject"))[0]
    try:
        engine = str(json.loads(file.read_text(encoding="utf-8-sig")).get("EngineAssociation", ""))
    except (ValueError, AttributeError) as error:
        raise PackageError(f"{file} cannot be read: {error}") from error
    found = re.fullmatch(r"(\d+)\.(\d+)", engine)
    if found and (int(found[1]), int(found[2])) < MIN_UNREAL:
        least = ".".join(map(str, MIN_UNREAL))
        raise PackageError(
            f"{file} is a project of Unreal Engine {engine}: the plugin needs {least} or newer"
        )
    if not any((project / "Source").glob("*.Target.cs")):
        raise PackageError(
            f"{project} has no C++ code, so the engine could not build the plugin; nothing was changed. In the editor "
            "choose Tools > New C++ Class, once. Close the editor, then run this again"
        )


def _find_program() -> Path | None:
    """Return the program `pacinian` of this installation; None if it has none."""
    name = "pacinian.exe" if sys.platform == "win32" else "pacinian"
    program = Path(sysconfig.get_path("scripts")) / name
    return program if program.is_file() else None


def _note_unity_program(file: Path) -> None:
    """Write the path of the program to a file, so that Unity's editor can start a server.

    If that is not possible, the user chooses the program in the editor.
    """
    program = _find_program()
    if program:
        with suppress(OSError):
            file.parent.mkdir(exist_ok=True)
            file.write_text(f"{program}\n", encoding="utf-8")


def _note_unreal_program(file: Path) -> None:
    """Write the path of the program to a project's settings, so that Unreal's Start Server finds it.

    If that is not possible, the user chooses the program in the project's settings.
    """
    program = _find_program()
    if not program:
        return
    with suppress(OSError, UnicodeError):
        data = file.read_bytes() if file.is_file() else b""
        encoding = "utf-8"
        if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
            encoding = "utf-16"
        elif data.startswith(codecs.BOM_UTF8):
            encoding = "utf-8-sig"
        text = data.decode(encoding)
        made = _set_server_command(text, program)
        if made != text:
            file.parent.mkdir(exist_ok=True)
            with replace_file(file) as out:
                out.write(made.encode(encoding))
            click.echo(f"Start Server of the plugin uses {program}: see {file}.")


def _set_server_command(settings: str, program: Path) -> str:
    """Return the text of an .ini file in which the plugin's ServerCommand names a program.

    A ServerCommand that names another program that exists stays.
    """
    newline = "\r\n" if "\r\n" in settings else "\n"
    setting = f"ServerCommand={program.as_posix()}{newline}"  # a backslash could begin an escape
    lines = settings.splitlines(keepends=True)
    if lines and not lines[-1].endswith("\n"):
        lines[-1] += newline
    headings = [line.strip() for line in lines]
    if UNREAL_SECTION not in headings:
        empty = [newline] if lines else []
        return "".join([*lines, *empty, UNREAL_SECTION + newline, setting])
    start = headings.index(UNREAL_SECTION) + 1
    for i in range(start, len(lines)):
        key, _, value = lines[i].partition("=")
        if key.startswith("["):
            break
        if key.strip() == "ServerCommand":
            if shutil.which(value.strip().strip('"')):
                return settings
            lines[i] = setting
            return "".join(lines)
    return "".join([*lines[:start], setting, *lines[start:]])


def _warn_of_manifest(project: Path) -> None:
    """Say so if the project also takes the package from elsewhere."""
    file = project / "Packages" / "manifest.json"
    if file.is_file() and f'"{UNITY}"' in file.read_text(encoding="utf-8", errors="replace"):
        click.echo(
            f"{file} names {UNITY}, too: Unity takes the copy in Packages. Remove that line."
        )
