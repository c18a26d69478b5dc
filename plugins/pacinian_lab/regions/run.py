"""Run the benchmark: each shape at each strength, made in each way."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pacinian.acoustics.pressure import sound_pressure
from pacinian.acoustics.propagation import matrix
from pacinian.session import Session
from pacinian.solving.solution_metrics import AT_LIMIT
from pacinian_lab.regions.methods import FREE, OURS, SPACINGS, SWEPT, MethodResult
from pacinian_lab.regions.score import evaluate_pressure, score
from pacinian_lab.regions.shapes import SHAPES
from pacinian_lab.solvers.problems import AIR

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from pacinian.acoustics.array import Array
    from pacinian.types import Complexes
    from pacinian_lab.regions.peers import Peers
    from pacinian_lab.regions.shapes import Shape

STRENGTHS = (0.25, 0.5, 1.0)  # fractions of the strongest even field


class Row(NamedTuple):
    """One shape, made in one way, at one strength: a fraction of the strongest even field.

    pressure: maximum of the request [Pa]. samples, status, cold_ms: as in `MethodResult`. force, rms, scaled_rms,
    holes, beside: as in `Score`. saturation: fraction of the transducers at their limit.
    """

    shape: str
    way: str
    strength: float
    pressure: float
    samples: int
    force: float
    rms: float
    scaled_rms: float
    holes: float
    beside: float
    saturation: float
    status: str
    cold_ms: float


def measure(
    array: Array,
    name: str,
    solvers: Sequence[str],
    strengths: Sequence[float],
    peers: Peers | None,
) -> Iterator[Row]:
    """Make a shape at each strength: by regions, by other `solvers` on the same samples, by foci, by peers.

    peers: use, and are evaluated with, their own model of the field. Raises WorkerError if they fail.
    """
    shape = SHAPES[name]()
    strongest = find_strongest(array, shape)
    for strength in strengths:
        pressure = strength * strongest
        for way in (OURS, *solvers, *FREE, SWEPT):
            made = make(array, shape, way, pressure)
            yield judge(array, shape, made, (name, way, strength, pressure))
        if peers is not None:
            theirs = make(peers.array, shape, OURS, pressure)
            yield judge(peers.array, shape, theirs, (name, peers.ours, strength, pressure))
            for way in peers.ways:
                made = peers.make(shape, way, pressure)
                yield judge(peers.array, shape, made, (name, way, strength, pressure))


def make(array: Array, shape: Shape, way: str, pressure: float) -> MethodResult:
    """Make a shape with at most `pressure` [Pa]: by regions, by free foci, by a swept focus, or by a solver's name.

    The name of a solver means this solver on the samples and regions of `OURS`.
    """
    if way == SWEPT:
        gains = sweep(array, shape, pressure)
        return MethodResult(gains, len(gains))
    spacing = FREE.get(way)
    samples = shape.samples(array, spacing)
    regions = None if spacing else samples.regions
    t, q = sound_pressure(pressure * samples.radiation_pressure, AIR), samples.positions
    session = Session(array, AIR, "auto" if spacing or way == OURS else way)
    session.solve(q, t, regions=regions)  # warms up
    session.forget()
    begin = time.perf_counter()
    solution = session.solve(q, t, regions=regions)
    cold = time.perf_counter() - begin
    status = session.certify(solution.gains).status.name
    return MethodResult(solution.gains, len(q), status, 1e3 * cold)


def judge(
    array: Array, shape: Shape, made: MethodResult, place: tuple[str, str, float, float]
) -> Row:
    """Evaluate a made shape. place: shape, way, strength, pressure [Pa], as in `Row`."""
    pressure = place[-1]
    inside, beside = (
        evaluate_pressure(array, made.gains, where) for where in (shape.places, shape.beside)
    )
    found = score(inside, pressure * shape.asked, beside)
    saturation = float((np.abs(made.gains) >= AT_LIMIT).mean())
    return Row(*place, made.samples, *found, saturation, made.status, made.cold_ms)


def find_strongest(array: Array, shape: Shape) -> float:
    """Return the highest pressure [Pa] that the array can make evenly over a shape."""
    samples = shape.samples(array)
    t = sound_pressure(samples.radiation_pressure, AIR)
    session = Session(array, AIR)
    solution = session.solve(samples.positions, t, regions=samples.regions, scale="max")
    made = float(np.vdot(solution.sound_pressure, solution.sound_pressure).real)
    return made / float(np.vdot(t, t).real)


def sweep(array: Array, shape: Shape, pressure: float) -> Complexes:
    """Put one focus on each sample in turn, (F, N), with the requested force, or at full drive if that is less."""
    samples = shape.samples(array, SPACINGS["4.25 mm"])
    B = matrix(array, samples.positions, AIR)
    share = samples.radiation_pressure / samples.radiation_pressure.max()
    gains = B.conj() / np.abs(B) * np.sqrt(share)[:, None]
    made = evaluate_pressure(array, gains, shape.places).sum()
    return np.asarray(gains * min(1.0, math.sqrt(pressure * shape.asked.sum() / made)))
