"""Check that every public name has a docstring with the shapes and units of its arguments."""

import inspect
import re
from typing import Any

import pytest

import pacinian as pc

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
