"""Selecting a solver while the loop runs."""

import importlib.metadata
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import msgspec
import numpy as np
import pytest
from msgspec import Meta

import pacinian as pc
from pacinian.plugins import registry
from pacinian.plugins.registry import Offer, Plugins
from pacinian.scene.config_sections import PluginConfig
from pacinian.serving.ipc.messages import SUPERSEDED
from pacinian.serving.ipc.plugin_list import list_offers
from pacinian.serving.render.solver_switcher import (
    MAX_HANGING,
    START_TIMEOUT,
    SolverSwitcher,
    make_solver,
)
from pacinian.testing import ManualClock
from pacinian.wire.control import Choice

ARRAY = pc.autd()


@dataclass
class Loud(pc.Solver):
    """A solver that drives all transducers, and keeps no limits."""

    name: ClassVar[str] = "loud"
    level: Annotated[float, Meta(ge=0.0, le=1.0)] = 0.5
    file: str = ""

    def solve(
        self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
    ) -> pc.Result:
        out[:] = self.level
        return pc.Result()


class Raises(Loud):
    """A solver whose `solve` raises."""

    name: ClassVar[str] = "raises"

    def solve(self, *_: Any) -> pc.Result:
        raise RuntimeError("no gains today")


class Infinite(Loud):
    """A solver whose gains are not finite."""

    name: ClassVar[str] = "infinite"

    def solve(
        self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
    ) -> pc.Result:
        out[:] = np.nan
        return pc.Result()


class Unmade(Loud):
    """A solver that cannot be made."""

    name: ClassVar[str] = "unmade"

    def __init__(self) -> None:
        raise SystemExit(3)


@pytest.fixture(autouse=True)
def plugins(monkeypatch: pytest.MonkeyPatch) -> None:
    found = Plugins(importlib.metadata.entry_points(group="pacinian"))
    for cls in (Loud, Raises, Infinite, Unmade):
        found.offers["solver", cls.name] = Offer("solver", cls, cls.name, "tests")
    monkeypatch.setattr(registry, "discover_plugins", lambda: found)


class Threads:
    """Threads that begin when the test says so."""

    def __init__(self) -> None:
        self.waiting: list[Any] = []

    def work(self) -> None:
        while self.waiting:
            self.waiting.pop()()


@pytest.fixture
def threads() -> Threads:
    return Threads()


@pytest.fixture
def solvers(threads: Threads) -> SolverSwitcher:
    return SolverSwitcher(make_solver("gs-pat"), ARRAY, thread=threads.waiting.append)


def test_a_solver_takes_over_once_it_is_made(solvers: SolverSwitcher, threads: Threads) -> None:
    before = solvers.chosen
    solvers.select(1, Choice(name="loud", options={"level": 0.25}))
    assert solvers.poll() == {}
    assert solvers.chosen is before
    threads.work()
    assert solvers.poll() == {"solver 1": ""}
    chosen = solvers.chosen
    assert isinstance(chosen, Loud)
    assert chosen.level == 0.25
    assert solvers.poll() == {}


def test_the_options_of_the_configuration_stay_where_a_client_chooses_the_same() -> None:
    owners = PluginConfig("loud", {"file": "secret", "level": 0.1})
    solver = make_solver(Choice(name="loud", options={"level": 0.25}), owners)
    assert (solver.file, solver.level) == ("secret", 0.25)  # type: ignore[attr-defined]
    assert make_solver(Choice(name="loud"), owners).level == 0.1  # type: ignore[attr-defined]
    assert make_solver(owners).level == 0.1  # type: ignore[attr-defined]
    assert make_solver(Choice(name="gs"), owners).name == "gs"


@pytest.mark.parametrize(
    ("choice", "problem"),
    [
        (Choice(name="raises"), "no gains today"),
        (Choice(name="infinite"), "infinite: gives gains that are not finite"),
        (Choice(name="unmade"), "SystemExit"),
        (Choice(name="nobody"), "no solver is called 'nobody'"),
        (Choice(name="loud", options={"volume": 11}), "volume"),
        (Choice(name="loud", options={"level": 11}), "<= 1.0"),
        (Choice(name="loud", options={"file": "/etc/passwd"}), "the server's configuration"),
    ],
)
def test_what_cannot_solve_is_refused_with_the_reason(
    solvers: SolverSwitcher, threads: Threads, choice: Choice, problem: str
) -> None:
    before = solvers.chosen
    solvers.select(1, choice)
    threads.work()
    assert problem in solvers.poll()["solver 1"]
    assert solvers.chosen is before


def test_one_is_made_at_a_time_and_of_those_that_wait_the_newest(
    solvers: SolverSwitcher, threads: Threads
) -> None:
    before = solvers.chosen
    solvers.select(1, Choice(name="loud"))
    for number in range(2, 100):
        solvers.select(number, Choice(name="raises"))
    solvers.select(100, Choice(name="auto"))
    assert len(threads.waiting) == 1
    assert solvers.poll() == dict.fromkeys([f"solver {k}" for k in range(2, 100)], SUPERSEDED)
    threads.work()
    assert solvers.poll() == {"solver 1": SUPERSEDED}
    assert solvers.chosen is before
    threads.work()
    assert solvers.poll() == {"solver 100": ""}
    assert solvers.chosen.name == "auto"
    solvers.select(101, Choice(name="loud"))
    threads.work()
    assert solvers.poll() == {"solver 101": ""}


def test_one_that_hangs_while_it_is_made_gives_way_to_another(threads: Threads) -> None:
    clock = ManualClock()
    solvers = SolverSwitcher(
        make_solver("gs-pat"), ARRAY, thread=threads.waiting.append, clock=clock.now
    )
    before = solvers.chosen
    solvers.select(1, Choice(name="loud"))
    hangs = threads.waiting.pop()
    clock.advance(60.0 * START_TIMEOUT)
    assert solvers.poll() == {}, "it may compile for as long as nothing else is wanted"
    solvers.select(2, Choice(name="auto"))
    assert "did not start within" in solvers.poll()["solver 1"]
    threads.work()
    assert solvers.poll() == {"solver 2": ""}
    hangs()
    assert solvers.poll() == {}
    assert solvers.chosen is not before
    assert solvers.chosen.name == "auto", "what comes too late is not taken"


def test_solvers_that_hang_are_only_so_many(threads: Threads) -> None:
    clock = ManualClock()
    solvers = SolverSwitcher(
        make_solver("gs-pat"), ARRAY, thread=threads.waiting.append, clock=clock.now
    )
    results: dict[str, str] = {}
    for number in range(1, MAX_HANGING + 2):
        solvers.select(number, Choice(name="loud"))
        clock.advance(1.1 * START_TIMEOUT)
        results |= solvers.poll()
    assert len(threads.waiting) == MAX_HANGING
    assert "restart the server" in results[f"solver {MAX_HANGING + 1}"]
    threads.work()
    solvers.poll()
    solvers.select(100, Choice(name="auto"))
    threads.work()
    assert solvers.poll() == {"solver 100": ""}


def test_an_odd_plug_in_does_not_keep_the_others_from_being_offered(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Odd(Loud):
        name: ClassVar[str] = "odd"

    class Unreadable(Loud):
        name: ClassVar[str] = "unreadable"
        __signature__ = "none of yours"

    class Huge(Loud):
        name: ClassVar[str] = "huge"

        def __init__(self, size: int = 1 << 80) -> None:
            pass

    Odd.__doc__ = "One \ud800."
    for cls in (Odd, Unreadable, Huge):
        offer = Offer("solver", cls, cls.name, "tests")
        monkeypatch.setitem(registry.discover_plugins().offers, ("solver", cls.name), offer)
    found = {plugin.name: plugin for plugin in list_offers("solver")}
    assert found["unreadable"].options == found["huge"].options == {}
    assert found["loud"].options == {"level": 0.5}
    assert msgspec.msgpack.encode(tuple(found.values()))


def test_offers_are_described() -> None:
    found = {plugin.name: plugin for plugin in list_offers("solver")}
    assert found["loud"].summary == "A solver that drives all transducers, and keeps no limits."
    assert found["loud"].options == {"level": 0.5}
    assert {"auto", "gs-pat", "lagrange"} <= set(found)
    assert [plugin.name for plugin in list_offers("backend")].count("simulated") == 1
