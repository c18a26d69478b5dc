"""Check that every public name has a docstring with the shapes and units of its arguments."""

import ast
import inspect
import re
from pathlib import Path
from typing import Any

import pytest

import pacinian as pc

ROOT = Path(__file__).parents[1]
PACKAGES = sorted(file for top in ("core", "plugins") for file in (ROOT / top).rglob("__init__.py"))
NAMES = sorted(pc.__all__)
PARTS = [
    name for name in NAMES if inspect.isclass(getattr(pc, name)) or callable(getattr(pc, name))
]


def documented(thing: Any) -> str:
    return inspect.getdoc(thing) or ""


@pytest.mark.parametrize("name", PARTS)
def test_a_public_name_has_a_docstring(name: str) -> None:
    thing = getattr(pc, name)
    assert len(documented(thing)) > 10
    if inspect.isclass(thing):
        for member, value in vars(thing).items():
            if member.startswith("_") or not (
                inspect.isfunction(value) or isinstance(value, property)
            ):
                continue
            assert documented(value), f"{name}.{member}"


@pytest.mark.parametrize(
    "name",
    [n for n in PARTS if inspect.isfunction(getattr(pc, n)) and n not in ("solver", "backend")],
)
def test_a_public_function_names_its_arguments_with_units_or_shapes(name: str) -> None:
    function = getattr(pc, name)
    text = documented(function)
    for argument in inspect.signature(function).parameters:
        if name == "solve":
            text += documented(pc.Session) + documented(pc.Session.solve)
        assert re.search(rf"\b{argument}\b", text), f"{name}: {argument}"
    assert re.search(r"\[[^\]]+\]|\(\w+,", text), f"{name} gives no unit or shape"


@pytest.mark.parametrize("file", PACKAGES, ids=lambda file: str(file.parent.relative_to(ROOT)))
def test_a_package_lists_files_that_it_has(file: Path) -> None:
    """A list in a package's docstring has columns: `name.py, name/   what they are`."""
    text = ast.get_docstring(ast.parse(file.read_text("utf-8"))) or ""
    for line in text.splitlines()[1:]:
        for column in re.split(r" {2,}", line):
            for name in column.split(", "):
                if re.fullmatch(r"[a-z_0-9*]+(\.py|\.hpp|\.md|/)", name):
                    assert any(file.parent.glob(name)), f"there is no {name}"


@pytest.mark.parametrize("file", PACKAGES, ids=lambda file: str(file.parent.relative_to(ROOT)))
def test_a_list_of_files_is_whole(file: Path) -> None:
    text = ast.get_docstring(ast.parse(file.read_text("utf-8"))) or ""
    listed = re.findall(r"[a-z_0-9*]+\.(?:py|hpp)\b", text)
    if len(listed) > 1:
        for path in (*file.parent.glob("*.py"), *file.parent.glob("*.hpp")):
            known = path.name in {"__init__.py", "__main__.py"}
            assert known or any(path.match(name) for name in listed), path.name
