"""The client in C# without a server."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from . import tools

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.deep("mono", "mcs")


def test_the_pure_parts(tmp_path: Path) -> None:
    tests = [*tools.SERVER_SIDE.glob("*.cs"), *(tools.CSHARP / "tests").glob("ClientUnit*.cs")]
    sources = [*tools.CORE.rglob("*.cs"), *tests]
    program = tools.csharp(tmp_path / "ClientUnit.exe", sources)
    assert tools.run("mono", "--debug", program).splitlines()[-1].endswith(" passed")


def test_the_readmes_game_compiles(csharp_core: Path, tmp_path: Path) -> None:
    (game,) = tools.read_examples(tools.CSHARP / "README.md", "csharp", "static void Main")
    source = tmp_path / "Ball.cs"
    source.write_text(game, encoding="utf-8")
    tools.csharp(source.with_suffix(".exe"), [source], csharp_core)


def test_the_transport_by_netmq_compiles(tmp_path: Path) -> None:
    sources = [*tools.CORE.rglob("*.cs"), tools.CSHARP / "tests" / "ClientNetMqStub.cs"]
    tools.csharp(tmp_path / "Pacinian.dll", sources, defines=["PACINIAN_NETMQ"])
