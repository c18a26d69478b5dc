"""`pacinian new`: makes the package of a plug-in from a template."""

from __future__ import annotations

import importlib.util
import keyword
import os
import re
import shutil
import tempfile
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Literal

import click

from pacinian.cli.options import NonEmptyPath

if TYPE_CHECKING:
    from importlib.resources.abc import Traversable

MAX_NAME = 50  # characters
DEVICES = {
    "con",
    "prn",
    "aux",
    "nul",
    *(f"{port}{i}" for port in ("com", "lpt") for i in range(10)),
}
FILES = {
    "pyproject.toml": "pyproject.toml.txt",
    "README.md": "{kind}/README.md.txt",
    "src/{module}/__init__.py": "{kind}/module.py.txt",
    "src/{module}/py.typed": "",
    "tests/test_{module}.py": "{kind}/test.py.txt",
}
"""Files of a package, with their templates; empty files have none."""
MODEL = {"tests/device.py": "backend/device.py.txt"}
"""The model of a backend's device."""

FOLDER = click.option(
    "--folder",
    default=Path(),
    type=NonEmptyPath(path_type=Path, file_okay=False, exists=True),
    help="Folder in which to make it; the current one by default.",
)


@click.group()
def new() -> None:
    """Make the package of a solver or a backend."""


@new.command()
@click.argument("name")
@FOLDER
def solver(name: str, folder: Path) -> None:
    """Make the package NAME with a solver, which adds up foci."""
    _make("solver", name, folder)


@new.command()
@click.argument("name")
@FOLDER
def backend(name: str, folder: Path) -> None:
    """Make the package NAME with a backend, which drives an array on UDP, and a model of that array."""
    _make("backend", name, folder)


def _make(kind: Literal["solver", "backend"], name: str, folder: Path) -> None:
    """Write the package to a folder beside its place, then rename that: all of it is there, or nothing."""
    _check_name(name)
    target = folder / name
    if target.exists() or target.is_symlink():
        raise click.UsageError(f"{target} exists: choose another name, or remove it")
    made = render_package(kind, name)
    try:
        beside = Path(tempfile.mkdtemp(prefix=f".{name}.", dir=folder))
    except OSError as error:
        problem = f"nothing can be written to {folder}: {error.strerror}"
        raise click.BadParameter(problem, param_hint="--folder") from error
    try:
        for path, text in made.items():
            (beside / path).parent.mkdir(parents=True, exist_ok=True)
            (beside / path).write_text(text, encoding="utf-8", newline="\n")
        beside.chmod(0o777 & ~_read_umask())
        beside.rename(target)
    except BaseException:  # a full disk, or Ctrl-C
        shutil.rmtree(beside, ignore_errors=True)
        raise
    click.echo(f"{target} has a {kind} that works. Next:\n")
    click.echo(f"    cd {target}")
    click.echo('    python -m pip install -e ".[test]"')
    click.echo("    pacinian plugins")
    click.echo("    python -m pytest")


def render_package(kind: Literal["solver", "backend"], name: str) -> dict[str, str]:
    """Return the texts of the package's files by path. name: lower-case words with hyphens."""
    words = {
        "kind": kind,
        "name": name,
        "distribution": f"pacinian-{name}",
        "module": f"pacinian_{name}".replace("-", "_"),
        "class": "".join(part.capitalize() for part in name.split("-")),
    }
    root: Traversable = files("pacinian.cli") / "templates"
    made: dict[str, str] = {}
    for path, template in (FILES | (MODEL if kind == "backend" else {})).items():
        text = (root / template.format(**words)).read_text(encoding="utf-8") if template else ""
        made[path.format(**words)] = Template(text).substitute(words)
    return made


def _check_name(name: str) -> None:
    """Raise BadParameter if a plug-in cannot have this name."""
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", name):
        words = re.findall(r"[A-Z]?[a-z0-9]+|[A-Z]+", name)
        close = "-".join(word.lower() for word in words).lstrip("0123456789-")
        advice = f": did you mean `{close}`?" if close else ""
        raise click.BadParameter(
            f"{name!r} must be lower-case words, joined by hyphens, that begin with a letter{advice}",
            param_hint="NAME",
        )
    if len(name) > MAX_NAME:
        raise click.BadParameter(f"must have at most {MAX_NAME} characters", param_hint="NAME")
    module = f"pacinian_{name}".replace("-", "_")
    if name in DEVICES or keyword.iskeyword(name.capitalize()):
        whose = "Windows" if name in DEVICES else "Python"
        raise click.BadParameter(f"{name!r} is a word of {whose}", param_hint="NAME")
    from pacinian.plugins.registry import discover_plugins

    for offer in discover_plugins().list():
        if offer.name == name:
            raise click.BadParameter(
                f"{name!r} is a {offer.kind} already, from {offer.distribution}", param_hint="NAME"
            )
    if importlib.util.find_spec(module) is not None:
        raise click.BadParameter(f"a module {module} is installed already", param_hint="NAME")


def _read_umask() -> int:
    """Return the mask of new files' permissions, which `mkdtemp` ignores."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
