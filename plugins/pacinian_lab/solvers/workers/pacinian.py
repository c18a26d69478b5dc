"""Pacinian's solvers through the public API, and the references: the roofline and a fixed GEMM."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.array import Array
from pacinian.acoustics.transducer import Transducer
from pacinian.plugins.registry import discover_plugins
from pacinian.session import Session, solve
from pacinian.solving.propagator import Propagator
from pacinian_lab.solvers.problems import AIR

if TYPE_CHECKING:
    from collections.abc import Callable

LIBRARIES = "pacinian", "numpy", "scipy"
Task = tuple["Callable[[], Any]", "Callable[[Any], Any]"]


def offers(threads: int) -> dict[tuple[str, str], Callable[[dict[str, Any]], Task]]:
    """Return every installed solver, cold and as a session updates it, and the references."""
    found: dict[tuple[str, str], Callable[[dict[str, Any]], Task]] = {
        ("roofline", "reference"): roofline,
        ("gemm", "reference"): gemm,
    }
    for offer in discover_plugins().list():
        if offer.kind == "solver":
            found[offer.name, "cold"] = cold(offer.name)
            found[offer.name, "warm"] = warm(offer.name)
            if threads == 1:
                found[offer.name, "one moved"] = make_one_moved(offer.name)
                found[offer.name, "rescaled"] = make_rescaled(offer.name)
    return found


def cold(name: str) -> Callable[[dict[str, Any]], Task]:
    """Prepare `pacinian.solve`, which keeps no state."""

    def prepare(problem: dict[str, Any]) -> Task:
        array, frames, t = convert_problem(problem)
        q = frames[0]
        return lambda: solve(array, q, t, solver=name, medium=AIR).gains, lambda gains: (gains, q)

    return prepare


def warm(name: str) -> Callable[[dict[str, Any]], Task]:
    """Prepare one `Session`. Every point has moved by 1 mm since the last solve."""

    def prepare(problem: dict[str, Any]) -> Task:
        array, frames, t = convert_problem(problem)
        return make_task(Session(array, AIR, name), [(q, t) for q in frames])

    return prepare


def make_one_moved(name: str) -> Callable[[dict[str, Any]], Task]:
    """Prepare one `Session`. Only the first point has moved, by 1 mm, since the last solve."""

    def prepare(problem: dict[str, Any]) -> Task:
        array, frames, t = convert_problem(problem)
        path = [np.concatenate([q[:1], frames[0][1:]]) for q in frames]
        return make_task(Session(array, AIR, name), [(q, t) for q in path])

    return prepare


def make_rescaled(name: str) -> Callable[[dict[str, Any]], Task]:
    """Prepare one `Session`. Only the strength changes, between 0.5 and 0.4 of the targets."""

    def prepare(problem: dict[str, Any]) -> Task:
        array, frames, t = convert_problem(problem)
        return make_task(Session(array, AIR, name), [(frames[0], 0.5 * t), (frames[0], 0.4 * t)])

    return prepare


def make_task(session: Session, path: list[tuple[Any, Any]]) -> Task:
    """Solve for the (points, targets) of `path` in turn, repeatedly."""
    steps = itertools.cycle(path)

    def again() -> Any:
        q, t = next(steps)
        return session.solve(q, t).gains, q

    return again, lambda output: output


def roofline(problem: dict[str, Any]) -> Task:
    """Prepare the work that nearly every solver must do: B, its Gram matrix, B^H z and B g, with Pacinian's kernels."""
    array, frames, t = convert_problem(problem)
    propagator, path = Propagator(array, AIR), itertools.cycle(frames)
    z = t.astype(np.complex64)

    def once() -> None:
        propagator.set_points(next(path))
        _ = propagator.gram
        propagator.apply(propagator.adjoint(z))

    return once, lambda _: None


def gemm(problem: dict[str, Any]) -> Task:
    """Prepare a fixed product, 64 x 2241 by 2241 x 64, which shows how steady the machine is."""
    rng = np.random.default_rng(0)
    a = rng.normal(size=(64, 2241)).astype(np.complex64)
    b, out = np.ascontiguousarray(a.T), np.empty((64, 64), np.complex64)
    return lambda: np.matmul(a, b, out=out), lambda _: None


def convert_problem(problem: dict[str, Any]) -> tuple[Array, Any, Any]:
    """Return the array, the points of all frames (6, M, 3) [m] and the targets (M,) [Pa]."""
    array = Array(problem["positions"], transducer=Transducer(pressure=problem["pressure"]))
    return array, np.array(problem["frames"]), np.array(problem["targets"])
