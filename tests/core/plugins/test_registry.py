"""Finding plug-ins: lazily, by name, with errors that name the faulty plug-in."""

import importlib
import re
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from importlib.metadata import EntryPoint
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any, cast

import pytest

import pacinian as pc
from pacinian.plugins import hookspecs, registry

ROOT = Path(__file__).parents[3]
LIMIT = 60.0  # ends a test that hangs [s]
GOOD = '''
import pacinian as pc

class Plane(pc.Solver):
    """All in phase."""
    name = "{name}"
    def __init__(self, tilt: float = 0.0) -> None:
        self.tilt = tilt
    def solve(self, propagator, targets, limits, warm, budget, out):
        out[:] = 1.0
        return pc.Result()

@pc.hookimpl
def register_solvers():
    return [Plane]
'''


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """Write a plug-in module; return its entry point."""
    monkeypatch.syspath_prepend(tmp_path)
    made: list[str] = []

    def make(name: str, source: str, module: str = "") -> EntryPoint:
        module = module or f"plugin_{name.replace('-', '_')}"
        (tmp_path / f"{module}.py").write_text(source)
        made.append(module)
        return EntryPoint(name, module, "pacinian")

    yield make
    for module in made:
        sys.modules.pop(module, None)


def test_a_plugin_is_found_and_made_with_its_options(write: Any) -> None:
    plugins = pc.Plugins([write("plane", GOOD.format(name="plane"))])
    solver: Any = plugins.make("solver", "plane", {"tilt": 2.0})
    assert solver.tilt == 2.0
    (offer,) = plugins.list()
    assert (offer.kind, offer.name, offer.plugin) == ("solver", "plane", "plane")
    assert offer.options == {"tilt": 0.0}
    assert "plugin_plane" in offer.distribution


def test_only_the_plugin_that_is_asked_for_is_imported(write: Any) -> None:
    plugins = pc.Plugins(
        [write("plane", GOOD.format(name="plane")), write("heavy", "raise RuntimeError")]
    )
    plugins.find("solver", "plane")
    assert "plugin_heavy" not in sys.modules
    assert not plugins.failed


def test_what_does_not_speak_of_a_kind_s_hook_is_not_imported_for_it(write: Any) -> None:
    backend = GOOD.format(name="b").replace("register_solvers", "register_backends")
    sources = {
        "plane": GOOD.format(name="plane"),
        "backend": backend,
        "again": "from plugin_backend import register_backends",
        "star": "from plugin_backend import *",
        "gone": "",
    }
    points = [write(name, source) for name, source in sources.items()]
    points += [EntryPoint("none", "plugin_none", "pacinian")]
    plugins = pc.Plugins(points)
    plugins.load(kind="backend")
    assert "plugin_plane" not in sys.modules
    assert "plugin_gone" not in sys.modules
    assert set(plugins.failed) == {"backend", "again", "star", "none"}  # they offer a solver
    assert plugins.find("solver", "plane").name == "plane"


def test_an_offer_named_unlike_its_entry_point_is_found_too(write: Any) -> None:
    plugins = pc.Plugins([write("bundle", GOOD.format(name="plane"))])
    assert plugins.find("solver", "plane").plugin == "bundle"


@pytest.mark.parametrize(
    ("source", "why"),
    [
        ("import not_there", "not_there"),
        ("raise RuntimeError('boom')", "boom"),
        ("import sys; sys.exit(7)", "SystemExit"),
        ("def (", "SyntaxError"),
        ("", "offers nothing: is its hook decorated"),
        (GOOD.format(name="plane").replace("[Plane]", "None"), "`register_solvers` must return a"),
        (GOOD.format(name="plane").replace("register_solvers", "register_solver"), "unknown hook"),
        (GOOD.format(name="plane").replace("[Plane]", "[int]"), "derived from Solver"),
        (GOOD.format(name="plane").replace("[Plane]", "[Plane()]"), "derived from Solver"),
        (GOOD.format(name="plane").replace("def solve", "def solver"), "Plane lacks `solve` of"),
        (GOOD.format(name="plane").replace('name = "plane"', ""), "Plane lacks `name` of Solver"),
        (
            GOOD.replace("pc.Solver", "pc.Backend").replace("_solvers", "_backends"),
            "lacks `capability`, `close`, `open`, `send`, `silence` of Backend",
        ),
        (GOOD.format(name="p" * 65), "must be 1 to 64 characters"),
        (GOOD.format(name="\\n"), "must be 1 to 64 characters"),
        ("raise RuntimeError('boom' * 10**6)", "boom"),
        (GOOD.format(name="plane").replace("return [Plane]", "1 / 0"), "ZeroDivisionError"),
    ],
)
def test_a_broken_plugin_is_named_and_takes_nothing_down(write: Any, source: str, why: str) -> None:
    plugins = pc.Plugins([write("broken", source), write("plane", GOOD.format(name="plane"))])
    assert [offer.name for offer in plugins.list()] == ["plane"]
    assert re.search(f"'broken'.*{why}", str(plugins.failed["broken"]))
    with pytest.raises(pc.PluginError, match="broken"):
        plugins.find("solver", "broken")
    with pytest.raises(pc.UnknownPlugin, match=r"plane.*broken did not load"):
        plugins.find("solver", "other")


def test_two_offers_of_one_name_are_an_error(write: Any) -> None:
    plugins = pc.Plugins(
        [write("one", GOOD.format(name="plane")), write("two", GOOD.format(name="plane"))]
    )
    with pytest.raises(
        pc.PluginError, match=r"two solvers are called 'plane'.*plugin_one.*plugin_two"
    ):
        plugins.list()
    for _ in range(2):  # the result does not depend on earlier calls
        with pytest.raises(pc.PluginError, match="two solvers are called 'plane'"):
            plugins.find("solver", "plane")
        with pytest.raises(pc.UnknownPlugin):
            plugins.find("solver", "other")


@pytest.mark.parametrize("names", [("bundle", "plane", "other"), ("other", "bundle", "plane")])
def test_the_plugin_whose_entry_point_has_the_name_wins(write: Any, names: list[str]) -> None:
    points = [write(name, GOOD.format(name="plane")) for name in names]
    for first in (
        lambda p: p.find("solver", "plane"),
        lambda p: p.load(),
        lambda p: p.find("solver", "plane"),
    ):
        plugins = pc.Plugins(points)
        first(plugins)
        assert plugins.find("solver", "plane").plugin == "plane"
        plugins.load()
        assert plugins.find("solver", "plane").plugin == "plane"
        assert [offer.plugin for offer in plugins.list()] == ["plane"]
        assert not plugins.failed
        assert "the solver 'plane' of plug-in 'bundle' (plugin_bundle" in str(plugins.shadowed)
        assert "because plugin_plane" in str(plugins.problems["bundle"])


def test_a_clash_does_not_depend_on_what_was_loaded_before(write: Any) -> None:
    points = [write(name, GOOD.format(name="plane")) for name in ("one", "two")]
    plugins = pc.Plugins(points)
    plugins.load("two")
    with pytest.raises(pc.PluginError, match="two solvers are called 'plane'"):
        plugins.find("solver", "plane")
    assert plugins.find_loaded("solver", "plane") is None


@pytest.mark.parametrize("order", [1, -1])
def test_a_plugin_of_pacinian_itself_wins(write: Any, order: int) -> None:
    own = write("plane", GOOD.format(name="plane"))._for(
        SimpleNamespace(name="pacinian", version="1")
    )
    twin = write("plane", GOOD.format(name="plane"), module="elsewhere")
    plugins = pc.Plugins([own, twin][::order])
    assert plugins.find("solver", "plane").cls.__module__ == "plugin_plane"
    assert not plugins.clashes
    assert "'plane' (elsewhere, no distribution) is not used" in str(plugins.problems["plane"])
    assert "because plugin_plane, pacinian 1 has that name" in str(plugins.problems["plane"])


def test_our_plugins_are_called_what_they_offer() -> None:
    """`find` relies on that: another plug-in's offer cannot replace one of them."""
    plugins = pc.Plugins()
    assert {offer.plugin for offer in plugins.list()} == {offer.name for offer in plugins.list()}


def test_two_plugins_of_one_name_are_an_error(write: Any) -> None:
    points = [write("one", ""), write("one", "", module="elsewhere")]
    plugins = pc.Plugins([*points, write("plane", GOOD.format(name="plane"))])
    for ask in (plugins.list, lambda: plugins.find("solver", "one")):
        with pytest.raises(pc.PluginError, match="two plug-ins are called 'one'"):
            ask()
    assert plugins.find("solver", "plane")  # other plug-ins still work


def test_an_option_that_does_not_exist_is_refused_with_those_that_do() -> None:
    with pytest.raises(pc.ArgumentError, match=r"`stepz`.*mu, mu_regions, rounds, starts"):
        pc.solver("lagrange", stepz=3)


def test_a_bad_value_of_an_option_is_named() -> None:
    with pytest.raises(pc.ArgumentError, match="`mu`"):
        pc.solver("lagrange", mu=-1.0)


@pytest.mark.parametrize("code", ["0", "3"])
def test_a_constructor_that_ends_the_program_is_an_error(write: Any, code: str) -> None:
    source = GOOD.format(name="plane").replace("self.tilt = tilt", f"raise SystemExit({code})")
    plugins = pc.Plugins([write("plane", source)])
    with pytest.raises(pc.PluginError, match=rf"'plane'.*SystemExit: {code}.*uninstall it"):
        plugins.make("solver", "plane", {})


BACKEND = """
import pacinian as pc

class Device(pc.Backend):
    name = "device"
    @property
    def capability(self):
        {capability}
    def open(self, array): ...
    def send(self, frame): ...
    def silence(self): ...
    def close(self): ...

@pc.hookimpl
def register_backends():
    return [Device]
"""


@pytest.mark.parametrize(
    ("capability", "why"),
    [
        ("return None", "`capability` must be a pacinian.Capability, not None"),
        ("raise RuntimeError('boom')", "RuntimeError: boom"),
        ("raise SystemExit(0)", "SystemExit: 0.*uninstall it"),
    ],
)
def test_a_backend_without_a_capability_is_named(write: Any, capability: str, why: str) -> None:
    plugins = pc.Plugins([write("device", BACKEND.format(capability=capability))])
    device: Any = plugins.make("backend", "device", {})
    with pytest.raises(pc.PluginError, match=f"backend 'device'.*{why}"):
        pc.Renderer(pc.autd(), pc.Scene(), backend=device)
    with pytest.raises(pc.PluginError, match="backend 'device'"):
        registry.read_capability(device)


@dataclass
class Point:
    """An entry point of which several threads read the module at the same time."""

    name: str
    module: str
    together: threading.Barrier
    dist: Any = None

    @property
    def value(self) -> str:
        return self.module

    def load(self) -> Any:
        self.together.wait(LIMIT)
        return sys.modules[self.module]


def test_threads_may_load_one_plugin_at_the_same_time(write: Any) -> None:
    write("plane", GOOD.format(name="plane")).load()
    point: Any = Point("plane", "plugin_plane", threading.Barrier(2))
    plugins = pc.Plugins([point])
    with ThreadPoolExecutor(2) as threads:
        made = [threads.submit(plugins.find, "solver", "plane") for _ in range(2)]
        one, two = (future.result(LIMIT) for future in made)
    assert one is two
    assert not plugins.problems
    assert not plugins.importing


@pytest.fixture
def known(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """What modules of plug-ins find in the module `known`."""
    module = ModuleType("known")
    monkeypatch.setitem(sys.modules, "known", module)
    return cast("SimpleNamespace", module)


@pytest.mark.parametrize("where", ["body", "hook"])
def test_a_plugin_may_ask_for_others(write: Any, known: SimpleNamespace, where: str) -> None:
    ask = """
import known
assert known.plugins.find("solver", "plane").name == "plane"
try:
    known.plugins.find("solver", "none")
except ValueError:
    pass
"""
    source = GOOD.format(name="asking")
    if where == "hook":
        ask = ask.replace("\n", "\n    ")
        source = source.replace("    return [Plane]", f"{ask}\n    return [Plane]")
    else:
        source = source + ask
    points = [write("asking", source), write("plane", GOOD.format(name="plane"))]
    known.plugins = plugins = pc.Plugins(points)
    assert plugins.find("solver", "asking").name == "asking"
    assert not plugins.problems


def test_a_plugin_whose_module_runs_is_left_for_later(write: Any, known: SimpleNamespace) -> None:
    source = f"{GOOD.format(name='plane')}\nimport known\nknown.plugins.load()\n"
    known.plugins = plugins = pc.Plugins([write("bundle", source)])
    importlib.import_module("plugin_bundle")
    assert not plugins.problems
    assert plugins.find("solver", "plane").plugin == "bundle"


def test_threads_that_import_each_other_s_modules_come_to_an_end(
    write: Any, known: SimpleNamespace
) -> None:
    """One imports a module that asks for a plug-in, the other the plug-in, which imports that module."""
    asks = """
import known
known.together.wait(known.limit)
try:
    known.plugins.find("solver", "plane")
except ValueError:
    pass
"""
    imports = "import known\nknown.together.wait(known.limit)\nimport plugin_asks\n"
    write("asks", asks)
    plugins = pc.Plugins([write("plane", imports + GOOD.format(name="plane"))])
    known.plugins, known.together, known.limit = plugins, threading.Barrier(2), LIMIT
    ways = lambda: importlib.import_module("plugin_asks"), lambda: plugins.find("solver", "plane")
    threads = [threading.Thread(target=way, daemon=True) for way in ways]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(LIMIT)
        assert not thread.is_alive()
    assert not plugins.problems
    assert plugins.find("solver", "plane").name == "plane"


def test_every_file_of_ours_is_an_entry_point() -> None:
    ours = {p.value for p in pc.Plugins()._waiting.values() if "pacinian_plugins" in p.value}
    root = ROOT / "plugins"
    kinds = [root / "pacinian_plugins" / kind for kind in ("solvers", "backends")]
    files = [f for kind in kinds for f in kind.iterdir() if not f.name.startswith("__")]
    assert {".".join(f.relative_to(root).with_suffix("").parts) for f in files} == ours


def test_every_hook_is_documented() -> None:
    hooks = [name for name in vars(hookspecs) if name.startswith("register_")]
    assert hooks
    for name in hooks:
        assert vars(hookspecs)[name].__doc__
        assert name in (ROOT / "docs" / "plugins.md").read_text()


COMMAND = '''
import click
import pacinian as pc

@click.command("{name}")
def tune() -> None:
    """Tune."""

@pc.hookimpl
def register_commands():
    return [{offer}]
'''


def test_a_plugin_offers_commands(write: Any) -> None:
    plugins = pc.Plugins([write("tuner", COMMAND.format(name="tune", offer="tune"))])
    plugins.load(kind="solver")
    assert not plugins.commands
    plugins.load(kind="command")
    (offer,) = plugins.commands.values()
    assert (offer.name, offer.plugin, offer.command.help) == ("tune", "tuner", "Tune.")
    assert offer.group == "develop"
    assert not plugins.list()


def test_a_plugin_chooses_the_group_of_its_commands(write: Any) -> None:
    source = COMMAND.format(name="tune", offer="tune").replace("[tune]", '{"run": [tune]}')
    plugins = pc.Plugins([write("tuner", source)])
    plugins.load(kind="command")
    assert plugins.commands["tune"].group == "run"
    plugins = pc.Plugins([write("other", source.replace('"run"', '"play"'))])
    plugins.load(kind="command")
    assert not plugins.commands
    assert "no group is called 'play'; the groups are start, run, inspect, develop" in str(
        plugins.failed["other"]
    )


@pytest.mark.parametrize(
    ("name", "offer", "problem"),
    [
        ("tune", "print", "click commands"),
        ("", "tune", "name of a command"),
        ("a b", "tune", "'a b'"),
    ],
)
def test_what_no_user_can_call_is_no_command(
    write: Any, name: str, offer: str, problem: str
) -> None:
    plugins = pc.Plugins([write("tuner", COMMAND.format(name=name, offer=offer))])
    plugins.load(kind="command")
    assert problem in str(plugins.failed["tuner"])
    assert not plugins.commands


def test_two_plugins_with_one_command_are_named(write: Any) -> None:
    points = [write(n, COMMAND.format(name="tune", offer="tune")) for n in ("one", "two")]
    plugins = pc.Plugins(points)
    plugins.load(kind="command")
    assert plugins.commands["tune"].plugin == "one"
    assert "tune" in str(plugins.shadowed["two"])
    assert "plugin_one" in str(plugins.shadowed["two"])
    assert not plugins.failed


@pytest.mark.parametrize("order", [1, -1])
def test_no_plugin_replaces_a_command_of_ours(write: Any, order: int) -> None:
    twin, own = (write(n, COMMAND.format(name="tune", offer="tune")) for n in ("twin", "own"))
    own = own._for(SimpleNamespace(name="pacinian", version="1"))
    plugins = pc.Plugins([twin, own][::order])
    plugins.load(kind="command")
    assert plugins.commands["tune"].plugin == "own"
    assert "the command 'tune' of plug-in 'twin'" in str(plugins.problems["twin"])
