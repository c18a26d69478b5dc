"""`pacinian unity` and `pacinian unreal`: install the whole package or nothing; never overwrite a user's changes."""

from __future__ import annotations

import json
import re
import sys
import sysconfig
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

from pacinian.cli import engine_package
from pacinian.cli.engine_package import LIST, WORK, Package, PackageError, find_package, install
from pacinian.cli.main import cli
from pacinian.cli.package_links import complete_links

if TYPE_CHECKING:
    from collections.abc import Callable

    Files = dict[str, bytes]

UNITY = Path("Packages") / "com.pacinian.haptics"
UNREAL = Path("Plugins") / "Pacinian"


def read(folder: Path) -> Files:
    return {
        p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*") if p.is_file()
    }


def run(*arguments: object, code: int = 0) -> str:
    result = CliRunner().invoke(cli, [str(word) for word in arguments])
    text = result.output + (
        str(result.exception) if isinstance(result.exception, PackageError) else ""
    )
    assert (result.exit_code != 0) == bool(code), text
    return text


@pytest.fixture
def unity(tmp_path: Path) -> Path:
    project = tmp_path / "game"
    (project / "Assets").mkdir(parents=True)
    (project / "ProjectSettings").mkdir()
    (project / "ProjectSettings" / "ProjectVersion.txt").write_text("m_EditorVersion: 2022.3.5f1\n")
    return project


@pytest.fixture
def unreal(tmp_path: Path) -> Path:
    project = tmp_path / "level"
    (project / "Source").mkdir(parents=True)
    (project / "Source" / "Level.Target.cs").touch()
    (project / "Level.uproject").write_text('{"EngineAssociation": "5.5"}')
    return project


@pytest.fixture
def package(tmp_path: Path) -> Package:
    """Make a small package of version 2.0."""
    made = Package(tmp_path / "package", "package.json", "version")
    (made.folder / "Source").mkdir(parents=True)
    (made.folder / "package.json").write_text('{"version": "2.0"}')
    (made.folder / "Source" / "a.cs").write_text("new")
    return made


def older(package: Package, target: Path, version: str = "1.9") -> None:
    """Install an older version, which has another file."""
    manifest, file, old = (
        package.folder / name for name in ("package.json", "Source/a.cs", "Source/old.cs")
    )
    manifest.write_text(json.dumps({"version": version}))
    file.write_text("old")
    old.write_text("gone")
    install(package, target, replace=False)
    manifest.write_text('{"version": "2.0"}')
    file.write_text("new")
    old.unlink()


def test_a_project_of_unity_gets_the_package(unity: Path) -> None:
    said = run("unity", unity)
    made = read(unity / UNITY)
    made.pop(LIST)
    for path, data in read(find_package("unity")).items():
        assert path.endswith(".md") or made[path] == data
    assert f"is in {unity / UNITY} now" in said
    assert "pacinian serve" in said
    assert "nothing was changed" in run("unity", unity)
    (unity / "Packages" / "manifest.json").write_text('{"com.pacinian.haptics": "file:../x"}')
    assert "Remove that line" in run("unity", unity)


def test_links_of_the_pages_work_in_the_project(unity: Path) -> None:
    """Pictures come along; a page that stays in the repository is named."""
    run("unity", unity)
    pages = sorted((unity / UNITY).rglob("*.md"))
    links = [
        (page, target)
        for page in pages
        for target in re.findall(r"\]\(([^)#\s]+)", page.read_text(encoding="utf-8"))
        if "://" not in target
    ]
    assert [target for page, target in links if not (page.parent / target).exists()] == []
    assert any(target == "pictures/unity-walkthrough-play.png" for _, target in links)
    text = (unity / UNITY / "Documentation~" / "index.md").read_text(encoding="utf-8")
    assert "the server without Python (`docs/standalone.md` in Pacinian's repository)" in text
    assert "the table (`adapters/FEATURES.md` in Pacinian's repository)" in text


def test_a_picture_that_is_not_there_is_replaced_by_its_words(tmp_path: Path) -> None:
    pages = {"a.md": b"![a ball](../b.png), ![c](c.png), [d](https://d.org/../e.md), [f](#f)"}
    made = complete_links(pages, tmp_path / "package")
    assert made == {"a.md": b"*a ball*, ![c](c.png), [d](https://d.org/../e.md), [f](#f)"}


def test_a_project_of_unreal_gets_the_plugin_and_is_told_what_is_missing(unreal: Path) -> None:
    said = run("unreal", unreal / "Level.uproject")
    assert (unreal / UNREAL / "Pacinian.uplugin").is_file()
    assert "Generate the project files" in said
    assert "set its Source\n     to Mouse" in said  # without it, nothing is felt
    tutorial = re.search(r"Tutorial: (.*)", said)
    assert tutorial
    assert Path(tutorial[1]).is_file()
    assert "nothing was changed" in run("unreal", unreal)


def test_a_project_of_unreal_without_code_is_told_before_it_gets_the_plugin(unreal: Path) -> None:
    (unreal / "Source" / "Level.Target.cs").unlink()  # an empty folder Source is no code
    said = run("unreal", unreal, code=2)
    assert "Tools > New C++ Class" in said
    assert "run this again" in said
    assert not (unreal / "Plugins").exists()


def test_what_is_no_project_is_refused_and_one_nearby_named(unity: Path, unreal: Path) -> None:
    assert f"did you mean {unity}?" in run("unity", unity.parent, code=2)
    assert f"did you mean {unity.resolve()}?" in run("unity", unity / "Assets", code=2)
    assert f"did you mean {unreal}?" in run("unreal", unreal.parent, code=2)
    assert "is not a folder" in run("unity", unity / "none", code=2)
    assert not (unity / UNITY).exists()


def test_an_engine_that_is_too_old_is_refused(unity: Path, unreal: Path) -> None:
    (unity / "ProjectSettings" / "ProjectVersion.txt").write_text("m_EditorVersion: 2020.3.48f1\n")
    assert "needs 2021.3 or newer" in run("unity", unity, code=2)
    project = unreal / "Level.uproject"
    project.write_text('{"EngineAssociation": "5.3"}')
    assert "needs 5.5 or newer" in run("unreal", unreal, code=2)
    project.write_text('{"EngineAssociation": "{8F0A-built-from-source}"}')
    run("unreal", unreal)


def test_an_older_version_is_replaced_and_what_was_added_stays(
    package: Package, tmp_path: Path
) -> None:
    target = tmp_path / "there"
    older(package, target)
    for name in (
        "Source/ThirdParty/Lib/a.lib",
        "Binaries/ThirdParty/z.so",
        "Binaries/Linux/a.so",
        "Intermediate/x",
    ):
        (target / name).parent.mkdir(parents=True, exist_ok=True)
        (target / name).write_text("added")
    assert install(package, target, replace=False) == ("1.9", True)
    assert set(read(target)) == {
        "package.json", "Source/a.cs", "Source/ThirdParty/Lib/a.lib", "Binaries/ThirdParty/z.so", LIST,
    }  # fmt: skip
    assert (target / "Source" / "a.cs").read_text() == "new"
    assert install(package, target, replace=False) == ("2.0", False)


def change(target: Path) -> None:
    (target / "Source" / "a.cs").write_text("mine")


def copy_by_hand(target: Path) -> None:
    (target / LIST).unlink()


@pytest.mark.parametrize(
    ("version", "does", "says"),
    [
        ("1.9", change, "somebody has changed Source/a.cs"),
        ("1.9", copy_by_hand, "was not put there by this command"),
        ("10.0", lambda _: None, "is version 10.0, and this Pacinian has 2.0"),
    ],
)
def test_nothing_is_replaced_that_somebody_may_miss(
    package: Package, tmp_path: Path, version: str, does: Callable[[Path], None], says: str
) -> None:
    target = tmp_path / "there"
    older(package, target, version)
    does(target)
    before = read(target)
    with pytest.raises(PackageError, match=re.escape(says)):
        install(package, target, replace=False)
    assert read(target) == before
    assert install(package, target, replace=True).copied
    assert (target / "Source" / "a.cs").read_text() == "new"


@pytest.mark.parametrize("step", ["write_bytes", "rename"])
@pytest.mark.parametrize("error", [KeyboardInterrupt(), OSError(13, "Permission denied")])
def test_whatever_interrupts_it_leaves_the_old_one(
    package: Package,
    tmp_path: Path,
    step: str,
    error: BaseException,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The interruption comes at each step in turn."""
    target = tmp_path / "there"
    older(package, target)
    before, at = read(target), 0

    def interrupt() -> bool:
        calls = iter(range(1000))
        real = getattr(Path, step)

        def fails(path: Path, *more: object) -> object:
            if next(calls) == at:
                raise error
            return real(path, *more)

        with monkeypatch.context() as patch:
            patch.setattr(Path, step, fails)
            try:
                install(package, target, replace=False)
            except (KeyboardInterrupt, PackageError):
                return True
        return False

    while interrupt():
        assert read(target) == before
        assert not list(tmp_path.glob(f"{WORK}*"))
        at += 1
    assert at >= 2
    assert (target / "Source" / "a.cs").read_text() == "new"


def test_what_a_run_that_was_killed_has_left_is_undone(package: Package, tmp_path: Path) -> None:
    target, work = tmp_path / "there", tmp_path / f"{WORK}x"
    older(package, target)
    work.mkdir()
    target.rename(work / "old")  # killed between two renames
    assert install(package, target, replace=False) == ("1.9", True)
    assert not work.exists()


def test_a_link_is_refused_and_an_installation_without_packages_says_what_to_do(
    package: Package, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "there").symlink_to(package.folder)
    with pytest.raises(PackageError, match="is a link"):
        install(package, tmp_path / "there", replace=True)
    monkeypatch.setattr(engine_package, "__file__", str(tmp_path / "a" / "b" / "c" / "d.py"))
    with pytest.raises(PackageError, match="install Pacinian from"):
        find_package("unity")


@pytest.mark.parametrize("installed", [True, False])
def test_unity_is_told_where_the_program_is(
    unity: Path, tmp_path: Path, installed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    scripts, note = tmp_path / "bin ü", unity / "UserSettings" / "PacinianProgram.txt"
    scripts.mkdir()
    monkeypatch.setattr(sysconfig, "get_path", {"scripts": str(scripts)}.get)
    program = scripts / ("pacinian.exe" if sys.platform == "win32" else "pacinian")
    if installed:
        program.touch()
    for _ in range(2):  # also if the package is there already
        run("unity", unity)
        assert note.exists() is installed
        if installed:
            assert Path(note.read_text(encoding="utf-8").strip()) == program
            note.unlink()


def test_a_place_where_the_program_cannot_be_noted_changes_nothing(unity: Path) -> None:
    (unity / "UserSettings").touch()  # not a folder
    run("unity", unity)
    assert (unity / UNITY / "package.json").exists()


@pytest.fixture
def program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Make the program of an installation."""
    made = tmp_path / "bin ü" / ("pacinian.exe" if sys.platform == "win32" else "pacinian")
    made.parent.mkdir()
    made.touch(0o755)
    monkeypatch.setattr(sysconfig, "get_path", {"scripts": str(made.parent)}.get)
    return made


SECTION = "[/Script/Pacinian.PacinianSettings]"


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (None, f"{SECTION}\nServerCommand=HERE\n"),
        ("[A]\nB=1", f"[A]\nB=1\n\n{SECTION}\nServerCommand=HERE\n"),
        (f"{SECTION}\nC=1\n[A]\n", f"{SECTION}\nServerCommand=HERE\nC=1\n[A]\n"),
        (f"[A]\r\n{SECTION}\r\n", f"[A]\r\n{SECTION}\r\nServerCommand=HERE\r\n"),
        (f"{SECTION}\nC=1\nServerCommand=/gone\n", f"{SECTION}\nC=1\nServerCommand=HERE\n"),
        (f"[A]\nServerCommand=x\n{SECTION}", f"[A]\nServerCommand=x\n{SECTION}\nServerCommand=HERE\n"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_unreal_is_told_where_the_program_is(
    unreal: Path, program: Path, before: str | None, after: str, encoding: str
) -> None:
    settings = unreal / "Config" / "DefaultGame.ini"
    if before is None:
        encoding = "utf-8"
    else:
        settings.parent.mkdir()
        settings.write_bytes(before.encode(encoding))
    for _ in range(2):  # also if the plugin is there already; never twice
        run("unreal", unreal)
        made = settings.read_bytes()
        assert made == after.replace("HERE", program.as_posix()).encode(encoding)


def test_another_program_that_the_settings_of_unreal_name_stays(
    unreal: Path, program: Path
) -> None:
    settings = unreal / "Config" / "DefaultGame.ini"
    settings.parent.mkdir()
    text = f'{SECTION}\nServerCommand="{Path(sys.executable).as_posix()}"\n'
    settings.write_text(text, encoding="utf-8")
    run("unreal", unreal)
    assert settings.read_text(encoding="utf-8") == text


def test_settings_of_unreal_that_cannot_be_written_change_nothing(
    unreal: Path, program: Path
) -> None:
    (unreal / "Config").touch()  # not a folder
    run("unreal", unreal)
    assert (unreal / UNREAL / "Pacinian.uplugin").exists()
