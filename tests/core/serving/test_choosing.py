"""Solvers that are selected while the loop runs."""

import importlib.metadata
from dataclasses import dataclass
from typing import Any, ClassVar

import pytest

import pacinian as pc
from pacinian.plugins import registry
from pacinian.plugins.registry import Offer, Plugins
from pacinian.serving.choosing import SUPERSEDED, Solvers, made
from pacinian.serving.offers import offers
from pacinian.wire.control import Choice

ARRAY = pc.autd()


@dataclass
class Loud(pc.Solver):
    """A solver that drives all. It keeps nothing."""

    name: ClassVar[str] = "loud"
    level: float = 0.5

    def solve(
        self, propagator: Any, targets: Any, limits: Any, warm: Any, budget: Any, out: Any
    ) -> pc.Result:
        out[:] = self.level
        return pc.Result()


class Raises(Loud):
    """Does not solve."""

    name: ClassVar[str] = "raises"

    def solve(self, *_: Any) -> pc.Result:
        raise RuntimeError("no gains today")


class Unmade(Loud):
    """Cannot be made."""

    name: ClassVar[str] = "unmade"

    def __init__(self) -> None:
        raise SystemExit(3)


@pytest.fixture(autouse=True)
def plugins(monkeypatch: pytest.MonkeyPatch) -> None:
    found = Plugins(importlib.metadata.entry_points(group="pacinian"))
    for cls in (Loud, Raises, Unmade):
        found.offers["solver", cls.name] = Offer("solver", cls, cls.name, "tests")
    monkeypatch.setattr(registry, "installed", lambda: found)


class Threads:
    """Threads that begin when they are told to."""

    def __init__(self) -> None:
        self.waiting: list[Any] = []

    def work(self) -> None:
        while self.waiting:
            self.waiting.pop()()


@pytest.fixture
def threads() -> Threads:
    return Threads()


@pytest.fixture
def solvers(threads: Threads) -> Solvers:
    return Solvers(made("gs-pat"), made("auto"), ARRAY, thread=threads.waiting.append)


def test_a_solver_takes_over_once_it_is_made(solvers: Solvers, threads: Threads) -> None:
    before = solvers.chosen
    solvers.order(1, Choice(name="loud", options={"level": 0.25}))
    assert solvers.poll(quiet=False) == {}
    assert solvers.solver(quiet=False) is before
    threads.work()
    assert solvers.poll(quiet=False) == {"solver 1": ""}
    chosen = solvers.solver(quiet=False)
    assert isinstance(chosen, Loud)
    assert chosen.level == 0.25
    assert solvers.poll(quiet=False) == {}


@pytest.mark.parametrize(
    ("choice", "problem"),
    [
        (Choice(name="raises"), "no gains today"),
        (Choice(name="unmade"), "SystemExit"),
        (Choice(name="nobody"), "no solver is called 'nobody'"),
        (Choice(name="loud", options={"volume": 11}), "volume"),
    ],
)
def test_what_cannot_solve_is_refused_with_the_reason(
    solvers: Solvers, threads: Threads, choice: Choice, problem: str
) -> None:
    before = solvers.chosen
    solvers.order(1, choice)
    threads.work()
    assert problem in solvers.poll(quiet=False)["solver 1"]
    assert solvers.chosen is before


def test_the_newest_order_wins_whichever_is_made_first(solvers: Solvers, threads: Threads) -> None:
    solvers.order(1, Choice(name="loud"))
    solvers.order(2, Choice(name="auto"))
    threads.work()  # the newest first
    assert solvers.poll(quiet=False) == {"solver 2": "", "solver 1": SUPERSEDED}
    assert solvers.chosen.name == "auto"


def test_quiet_zones_are_kept_by_the_stand_in_while_there_are_any(solvers: Solvers) -> None:
    assert solvers.chosen.name == solvers.solver(quiet=False).name == "gs-pat"
    assert not solvers.status(quiet=False)
    assert solvers.solver(quiet=True).name == "auto"
    assert "auto keeps the quiet zones" in solvers.status(quiet=True)
    assert solvers.solver(quiet=False).name == "gs-pat"


def test_while_there_are_quiet_zones_only_what_keeps_them_can_be_selected(
    solvers: Solvers, threads: Threads
) -> None:
    for number, name in enumerate(("loud", "lagrange"), 1):
        solvers.order(number, Choice(name=name))
        threads.work()
        problem = solvers.poll(quiet=True)[f"solver {number}"]
        assert ("quiet" in problem) == (name == "loud")
    assert solvers.solver(quiet=True).name == "lagrange"
    assert not solvers.status(quiet=True)


def test_a_stand_in_must_keep_them() -> None:
    with pytest.raises(pc.UnsupportedLimit):
        Solvers(made("auto"), made("gs-pat"), ARRAY)


def test_offers_are_described() -> None:
    found = {plugin.name: plugin for plugin in offers("solver")}
    assert found["loud"].summary == "A solver that drives all. It keeps nothing."
    assert found["loud"].options == {"level": 0.5}
    assert {"auto", "gs-pat", "lagrange"} <= set(found)
    assert [plugin.name for plugin in offers("backend")].count("simulated") == 1
