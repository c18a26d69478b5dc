"""Measure batches of solves, and one large field: by Pacinian's kernels, and by `array_api` with each library.

All contestants solve the same problems, of `problems.py`, and compute the field of the same gains. What they return is
compared with plain NumPy in double precision. Times count from arrays on the device to results on the host.
"""

from __future__ import annotations

import functools
import importlib.util
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

import pacinian as pc
from pacinian import array_api
from pacinian_lab.solvers import timing
from pacinian_lab.solvers.problems import AIR, DISTANCE, PRESSURE, SIDE, BenchmarkProblem, matrix
from pacinian_lab.solvers.run import cores

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from pacinian.types import Complexes, Floats

LEVEL = 0.5  # of the targets: every problem can be solved
MAX_COMPARED = 1000  # maximum number of points at which a field is compared
SOLVERS = "pseudo-inverse", "auto"


@dataclass(frozen=True)
class Batch:
    """K problems of one array. points: (K, M, 3) [m]. targets: (K, M) [Pa]."""

    array: pc.Array
    points: Floats
    targets: Floats

    @classmethod
    def make(cls, units: int, points: int, count: int) -> Batch:
        """Return `count` problems. Raises ArgumentError."""
        made = [BenchmarkProblem.make(units, points, LEVEL, seed) for seed in range(count)]
        kind = pc.Transducer(pressure=PRESSURE, directivity=pc.omni)
        array = pc.Array(made[0].positions, transducer=kind)
        return cls(array, np.array([p.points for p in made]), np.array([p.targets for p in made]))

    def error(self, gains: Complexes) -> float:
        """Return the rms of (|p| - t) / t over all points. gains: (K, N)."""
        found = [
            np.abs(matrix(self.array.positions, q) @ g)
            for q, g in zip(self.points, gains, strict=True)
        ]
        return float(np.sqrt(np.mean((np.array(found) / self.targets - 1.0) ** 2)))


@dataclass(frozen=True)
class Row:
    """What one contestant took. job: "solve" or "field". count: problems or points. seconds: of all of them, p50.

    error: of a solve, rms (|p| - t) / t at the points; of a field, the largest difference over the largest value.
    """

    job: str
    contestant: str
    count: int
    seconds: float
    error: float


class Library(NamedTuple):
    """An array library on one of its devices. put, get: from a NumPy array, and back."""

    name: str
    put: Callable[[Any], Any]
    get: Callable[[Any], Any]


def find_libraries() -> list[Library]:
    """Return the installed array libraries, each on every kind of device that it has here."""
    return [
        Library("NumPy", np.asarray, np.asarray),
        *(library for find in (_find_torch, _find_cupy, _find_jax) for library in find()),
    ]


def _find_torch() -> Iterator[Library]:
    if importlib.util.find_spec("torch") is None:
        return
    torch = importlib.import_module("torch")
    yield Library("PyTorch, CPU", torch.asarray, np.asarray)
    if torch.cuda.is_available():
        name = torch.cuda.get_device_name()
        put = functools.partial(torch.asarray, device="cuda")
        yield Library(f"PyTorch, {name}", put, _copy_from_gpu)


def _copy_from_gpu(tensor: Any) -> Any:
    return tensor.cpu().numpy()


def _find_cupy() -> Iterator[Library]:
    if importlib.util.find_spec("cupy") is None:
        return
    cupy = importlib.import_module("cupy")
    if cupy.cuda.is_available():
        name = cupy.cuda.runtime.getDeviceProperties(0)["name"].decode()
        yield Library(f"CuPy, {name}", cupy.asarray, cupy.asnumpy)


def _find_jax() -> Iterator[Library]:
    if importlib.util.find_spec("jax") is None:
        return
    numpy = importlib.import_module("jax.numpy")
    yield Library(f"JAX, {numpy.zeros(1).device.device_kind}", numpy.asarray, np.asarray)


def measure(units: int, points: int, count: int, field: int, seconds: float) -> Iterator[Row]:
    """Yield a row for each contestant: first the batch of `count` solves, then the field at `field` points.

    units: AUTD units. points: M of each problem. seconds: of calls of each contestant. Raises ArgumentError.
    """
    batch = Batch.make(units, points, count)
    libraries = find_libraries()

    def time_solve(name: str, solve: Callable[[], Any]) -> Row:
        gains, times = timing.measure(solve, seconds)
        return Row("solve", name, count, times.p50, batch.error(gains))

    for solver in SOLVERS:
        for workers in sorted({1, cores()}):
            name = f"solve_many, {solver}, {workers} {'core' if workers == 1 else 'cores'}"
            yield time_solve(name, functools.partial(_solve_many, batch, solver, workers))
    for library in libraries:
        points32, targets32 = batch.points.astype(np.float32), batch.targets.astype(np.float32)
        given = library.put(points32), library.put(targets32)
        solve = functools.partial(_solve_in, library, batch, *given)
        yield time_solve(f"array_api, {library.name}", solve)

    q = np.random.default_rng(0).uniform((-SIDE, -SIDE, DISTANCE / 2), SIDE, (field, 3))
    gains = _solve_many(batch, SOLVERS[0], 1)[0]
    some = slice(None, None, max(1, -(-field // MAX_COMPARED)))
    exact = matrix(batch.array.positions, q[some]) @ gains

    def time_field(name: str, compute: Callable[[], Any]) -> Row:
        p, times = timing.measure(compute, seconds)
        error = float(np.abs(p[some] - exact).max() / np.abs(exact).max())
        return Row("field", name, field, times.p50, error)

    yield time_field("field", functools.partial(pc.field, batch.array, gains, q, AIR))
    for library in libraries:
        given = library.put(gains.astype(np.complex64)), library.put(q.astype(np.float32))
        compute = functools.partial(_compute_field_in, library, batch.array, *given)
        yield time_field(f"array_api, {library.name}", compute)


def _solve_in(library: Library, batch: Batch, points: Any, targets: Any) -> Any:
    return library.get(array_api.solve(batch.array, points, targets, medium=AIR)[0])


def _compute_field_in(library: Library, array: pc.Array, gains: Any, points: Any) -> Any:
    return library.get(array_api.field(array, gains, points, AIR))


def _solve_many(batch: Batch, solver: str, workers: int) -> Complexes:
    return pc.solve_many(
        batch.array, batch.points, batch.targets, solver=solver, medium=AIR, workers=workers
    ).gains
