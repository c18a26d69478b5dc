"""The client in C# without a server."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from . import tools

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.deep("mono", "mcs")


def test_the_pure_parts(tmp_path: Path) -> None:
    sources = [*tools.CORE.rglob("*.cs"), *(tools.CSHARP / "tests").glob("ClientUnit*.cs")]
    program = tools.csharp(tmp_path / "ClientUnit.exe", sources)
    assert tools.run("mono", "--debug", program).splitlines()[-1].endswith(" passed")


def test_the_transport_by_netmq_compiles(tmp_path: Path) -> None:
    sources = [*tools.CORE.rglob("*.cs"), tools.CSHARP / "tests" / "ClientNetMqStub.cs"]
    tools.csharp(tmp_path / "Pacinian.dll", sources, defines=["PACINIAN_NETMQ"])
