"""The list of selectable plug-ins, even if plug-in modules misbehave."""

from __future__ import annotations

import sys
import threading
from importlib.metadata import EntryPoint
from types import ModuleType
from typing import TYPE_CHECKING

import pytest

from pacinian.errors import PluginError
from pacinian.plugins import registry
from pacinian.plugins.registry import Plugins
from pacinian.serving.ipc import plugin_list

from ....waiting import eventually

if TYPE_CHECKING:
    from pathlib import Path

    from pacinian.wire.replies import Plugin

    from ..conftest import Logged

SLOW = """
import pacinian as pc
import the_gate
the_gate.opened.wait()

class Slow(pc.Solver):
    name = "slow"
    def solve(self, propagator, targets, limits, warm, budget, out):
        raise NotImplementedError

@pc.hookimpl
def register_solvers():
    return [Slow]
"""


def test_a_plug_in_that_does_not_come_back_from_its_import_is_named_and_holds_nobody_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, logged: Logged
) -> None:
    gate = ModuleType("the_gate")
    opened = threading.Event()
    gate.__dict__["opened"] = opened
    monkeypatch.setitem(sys.modules, "the_gate", gate)
    (tmp_path / "slow_to_import.py").write_text(SLOW)
    monkeypatch.syspath_prepend(tmp_path)
    plugins = Plugins([EntryPoint("snail", "slow_to_import", "pacinian")])
    monkeypatch.setattr(registry, "discover_plugins", lambda: plugins)
    monkeypatch.setattr(plugin_list, "MAX_LISTING_TIME", 0.01)
    monkeypatch.setattr(plugin_list, "MAX_IMPORT_WAIT", 0.01)
    found: list[tuple[Plugin, ...]] = []
    try:
        plugin_list.publish_offers("solver", found.append)
        assert found == [()]
        logged.wait("still being imported", "snail")
        with pytest.raises(PluginError, match="imports the plug-in 'snail'"):
            plugin_list.find_plugin("solver", "slow")
    finally:
        opened.set()
    eventually(lambda: len(found) == 2)
    plugin_list.publish_offers("solver", found.append)
    eventually(lambda: len(found) == 3)
    assert [[plugin.name for plugin in offers] for offers in found] == [[], ["slow"], ["slow"]]


def test_names_that_several_plug_ins_have_are_logged_and_listed_only_if_one_wins(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, logged: Logged
) -> None:
    source = SLOW.replace("import the_gate\nthe_gate.opened.wait()", "")
    for name in ("snail", "slow", "tie", "knot"):
        text = source if name in ("snail", "slow") else source.replace('"slow"', '"late"')
        (tmp_path / f"{name}_offers.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    points = [EntryPoint(n, f"{n}_offers", "pacinian") for n in ("snail", "slow", "tie", "knot")]
    plugins = Plugins(points)
    monkeypatch.setattr(registry, "discover_plugins", lambda: plugins)
    assert [plugin.name for plugin in plugin_list.list_offers("solver")] == ["slow"]
    logged.wait("several plug-ins have one name", "'snail'")
    logged.wait("several plug-ins have one name", "two solvers are called 'late'")
    assert plugin_list.find_plugin("solver", "slow").plugin == "slow"
    with pytest.raises(PluginError, match="two solvers are called 'late'"):
        plugin_list.find_plugin("solver", "late")


def test_a_listing_that_fails_is_logged_and_tells_what_is_known(
    monkeypatch: pytest.MonkeyPatch, logged: Logged
) -> None:
    def fail(kind: str) -> None:
        raise KeyboardInterrupt("in a module")

    monkeypatch.setattr(plugin_list, "list_offers", fail)
    found: list[tuple[Plugin, ...]] = []
    plugin_list.publish_offers("solver", found.append)
    eventually(lambda: len(found) == 1)
    logged.wait("not all plug-ins could be listed", "in a module")
