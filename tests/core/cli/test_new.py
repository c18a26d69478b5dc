"""`pacinian new`: packages that install, are found, and pass their own tests; or nothing."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sysconfig
import tomllib
import venv
from pathlib import Path
from typing import Any, Literal

import pytest
from click.testing import CliRunner

from pacinian.cli import new
from pacinian.cli.main import cli

ROOT = Path(__file__).parents[3]
KINDS: tuple[Literal["solver", "backend"], ...] = ("solver", "backend")


def run(*words: object) -> tuple[int, str]:
    done = CliRunner().invoke(cli, ["new", *map(str, words)])
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    return done.exit_code, done.output


@pytest.mark.parametrize("kind", KINDS)
def test_a_package_is_complete(kind: str, tmp_path: Path) -> None:
    code, told = run(kind, "soft-touch2", "--folder", tmp_path)
    assert code == 0, told
    made = tmp_path / "soft-touch2"
    assert [path.name for path in tmp_path.iterdir()] == ["soft-touch2"]
    texts = {p.relative_to(made).as_posix(): p.read_text() for p in made.rglob("*") if p.is_file()}
    assert set(texts) >= {"pyproject.toml", "README.md", "src/pacinian_soft_touch2/__init__.py"}
    assert not any("$" in text for text in texts.values())  # nothing is left to fill in
    project: Any = tomllib.loads(texts["pyproject.toml"])["project"]
    assert project["entry-points"]["pacinian"] == {"soft-touch2": "pacinian_soft_touch2"}
    for path, text in texts.items():
        if path.endswith(".py"):
            compile(text, path, "exec")
    assert f"cd {made}" in told


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("SoftTouch", "did you mean `soft-touch`"),
        ("soft_touch", "did you mean `soft-touch`"),
        ("soft touch", "did you mean `soft-touch`"),
        ("3d", "did you mean `d`"),
        ("../evil", "did you mean `evil`"),
        ("a/b", "did you mean `a-b`"),
        ("", "must be lower-case"),
        ("ümlaut", "must be lower-case"),
        ("-x", "No such option|must be lower-case"),
        ("x-", "must be lower-case"),
        ("x" * 51, "at most 50"),
        ("none", "a word of Python"),
        ("con", "a word of Windows"),
        ("gs", "'gs' is a solver already, from pacinian_plugins.solvers.gs"),
        ("simulated", "is a backend already"),
        ("lab", "module pacinian_lab is installed already"),
    ],
)
def test_names_that_cannot_be_are_refused(name: str, told: str, tmp_path: Path) -> None:
    code, said = run("solver", name, "--folder", tmp_path)
    assert code == 2
    assert re.search(told, said), said
    assert not list(tmp_path.iterdir())


def test_what_exists_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "b").write_text("mine")
    (tmp_path / "c").symlink_to("nowhere")
    for name in "abc":
        code, told = run("backend", name, "--folder", tmp_path)
        assert (code, "exists: choose another name" in told) == (2, True)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a", "b", "c"]
    assert (tmp_path / "b").read_text() == "mine"
    assert run("backend", "d", "--folder", tmp_path / "no")[0] == 2


@pytest.mark.parametrize("error", [OSError("No space left on device"), KeyboardInterrupt()])
def test_a_write_that_is_interrupted_leaves_nothing(
    error: BaseException, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write, count = Path.write_text, iter(range(9))

    def fail(self: Path, *arguments: Any, **options: Any) -> int:
        if next(count) == 2:
            raise error
        return write(self, *arguments, **options)

    monkeypatch.setattr(Path, "write_text", fail)
    done = CliRunner().invoke(cli, ["new", "solver", "soft-touch", "--folder", str(tmp_path)])
    assert done.exit_code != 0
    assert not list(tmp_path.iterdir())


def test_the_page_for_builders_shows_the_backend_that_is_made() -> None:
    page = (ROOT / "docs/start/builders.md").read_text("utf-8")
    text = new.render_package("backend", "my-wall")["src/pacinian_my_wall/__init__.py"]
    assert text[text.index("HEAD =") : text.index("@pc.hookimpl")].rstrip() in page


@pytest.mark.deep
def test_packages_install_are_found_and_pass_their_tests(tmp_path: Path) -> None:
    """Each package has its own environment, which sees this one's libraries. There is no network."""
    venv.create(tmp_path / "venv", with_pip=False, symlinks=os.name != "nt")
    inside = tmp_path / "venv" / ("Scripts" if os.name == "nt" else "bin") / "python"
    at = {"base": str(tmp_path / "venv"), "platbase": str(tmp_path / "venv")}
    site = Path(sysconfig.get_path("purelib", vars=at))
    outer = sysconfig.get_path("purelib")
    (site / "outer.pth").write_text(f"import site; site.addsitedir({outer!r})\n")
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}

    def call(*words: str, cwd: Path = tmp_path) -> str:
        done = subprocess.run(
            [str(inside), "-m", *words], cwd=cwd, env=environment, capture_output=True, text=True,
            timeout=400, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    for kind in KINDS:
        assert run(kind, f"my-{kind}", "--folder", tmp_path)[0] == 0
        call(
            "pip", "install", "--quiet", "--no-deps", "--no-build-isolation", "--no-index",
            "--disable-pip-version-check", "-e", str(tmp_path / f"my-{kind}"),
        )  # fmt: skip
    found = json.loads(call("pacinian", "plugins", "--json"))
    assert not found["failed"]
    assert {(f"{kind}", f"my-{kind}") for kind in KINDS} <= {
        (one["kind"], one["name"]) for one in found["plugins"]
    }
    for kind in KINDS:
        assert " passed" in call(
            "pytest", "-q", "-p", "no:cacheprovider", cwd=tmp_path / f"my-{kind}"
        )


@pytest.mark.parametrize("kind", KINDS)
def test_a_folder_that_cannot_be_written_to_is_named(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(prefix: str, dir: Path) -> str:  # noqa: A002
        raise PermissionError(13, "Permission denied", str(dir / prefix))

    monkeypatch.setattr(new.tempfile, "mkdtemp", refuse)
    code, told = run(kind, "soft-touch", "--folder", tmp_path)
    assert code == 2
    assert "--folder" in told
    assert ".soft-touch" not in told
