"""One hard problem: what `Session.solve` is given, and B in double precision beside it."""

from __future__ import annotations

import functools
import math
import time
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.air import Air
from pacinian.acoustics.directivity import omni
from pacinian.acoustics.propagation import matrix
from pacinian.errors import PacinianError, PointOnTransducer
from pacinian.session import Session
from pacinian.solving.blas import one_thread
from pacinian.solving.problem import Limits, Targets
from pacinian_lab.stress.reference import Reference

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from pacinian.acoustics.array import Array
    from pacinian.acoustics.propagation import Precision
    from pacinian.plugins.solver import Solver
    from pacinian.solving.solution import Solution
    from pacinian.types import ArrayLike, Complexes, Floats

    Before = tuple[Floats, ArrayLike] | tuple[Floats, ArrayLike, ArrayLike]

PATIENCE = 3.0  # [s] for problems that ask for no deadline: a solver that would not end is seen
TABLE = 2e-5  # what the kernels' directivity table is off by, of 1
FAINT = math.exp(-32.0)  # where absorption leaves less, the kernels have none


@dataclass(frozen=True, eq=False, repr=False)
class Case:
    """One problem; its arguments as in `Session` and `Session.solve`.

    name: "family: what is hard". history: points (M, 3) [m] and amplitudes (M,) [Pa], and regions (M,) where there
    are any, that the same session solved before. refused: the error that is the right answer. slow: left out of a
    quick run. clock: of the session and of what is told of its time [s]; for tests.
    """

    name: str
    array: Array
    points: Floats
    amplitudes: Floats
    phases: ArrayLike | None = None
    limits: Limits = field(default_factory=Limits)
    scale: str = "exact"
    medium: Air = field(default_factory=Air)
    precision: Precision = "single"
    deadline: float = PATIENCE
    history: Sequence[Before] = ()
    refused: type[PacinianError] | None = None
    slow: bool = False
    regions: ArrayLike | None = None
    clock: Callable[[], float] = time.perf_counter

    def __repr__(self) -> str:
        return f"<Case {self.name}>"

    @property
    def family(self) -> str:
        """What kind of problem it is."""
        return self.name.partition(":")[0]

    def solve(self, solver: str | Solver) -> Solution:
        """The last solution of a session that went through `history`, and what is felt of its regions.

        Raises what the session does.
        """
        session = Session(
            self.array, self.medium, solver, precision=self.precision, clock=self.clock
        )
        for points, amplitudes, *rest in self.history:
            with suppress(PointOnTransducer):
                session.solve(
                    points, amplitudes, regions=rest[0] if rest else None,
                    limits=self.limits, deadline=self.deadline,
                )  # fmt: skip
        solution = session.solve(
            self.points, self.amplitudes, self.phases, regions=self.regions,
            limits=self.limits, scale=self.scale, deadline=self.deadline,
        )  # fmt: skip
        return session.felt(solution)

    @functools.cached_property
    def targets(self) -> Targets:
        """The targets as the session reads them."""
        return Targets.checked(
            len(self.points), self.amplitudes, self.phases, self.scale, self.regions
        )

    def ask(self, solution: Solution) -> Complexes:
        """The targets [Pa], complex, (M,): in the phases that the solver was given, or else in those it found."""
        phases = solution.asked_phases
        return self.targets.complex(np.angle(solution.sound_pressure) if phases is None else phases)

    @functools.cached_property
    def B(self) -> Complexes:
        """B [Pa], (M, N), in double precision."""
        return matrix(self.array, self.points, self.medium)

    @functools.cached_property
    def reference(self) -> Reference:
        """B decomposed."""
        return Reference.of(self.B)

    @functools.cached_property
    def work(self) -> float:
        """How long B and its smaller Gram matrix take in double precision [s], here and now."""
        begin = time.perf_counter()
        B = matrix(self.array, self.points, self.medium)
        with one_thread():
            B = B if len(B) <= B.shape[1] else B.T
            _ = B @ B.conj().T
        return time.perf_counter() - begin

    @property
    def eps(self) -> float:
        """The rounding unit of B."""
        return float(np.finfo(np.float32 if self.precision == "single" else np.float64).eps)

    @functools.cached_property
    def rounding(self) -> Floats:
        """A bound of what rounding can have done to each element of B in `precision` [Pa], (M, N).

        Coordinates within R of the array's centre are right to eps R, so a distance d is to 2 eps R,
        a phase to eps k (2 R + d), an amplitude d^-n exp(-beta d) to 2 eps R (n / d + beta), and the
        cosine of an angle to 2 eps R / d; directivities are taken to be no steeper than 4.
        """
        kind, centre = self.array.transducer, self.array.centre
        d = np.sqrt(((self.points[:, None] - self.array.positions) ** 2).sum(axis=2))  # (M, N) [m]
        d = np.maximum(d, 1e-15)
        R = max(np.abs(x - centre).max(initial=0.0) for x in (self.points, self.array.positions))
        if self.precision == "double":
            R += np.abs(centre).max()  # which is not subtracted there
        k, beta = self.medium.wavenumber(kind.frequency), self.medium.beta(kind.frequency)
        steep = self.medium.power + (0.0 if kind.directivity is omni else 4.0)
        few = 72.0 if beta else 8.0  # roundings; the kernel has exp(t) as exp(t / 64)^64
        relative = self.eps * (few + 2.0 * R * (steep / d + beta) + k * (2.0 * R + d))
        absorbed = np.exp(-beta * d)
        if self.precision == "single":
            relative += 0.0 if kind.directivity is omni else TABLE
            relative[absorbed < 2.0 * FAINT] = 1.0
        return np.asarray(relative * kind.pressure * d**-self.medium.power * absorbed)

    @functools.cached_property
    def blur(self) -> float:
        """||E|| + max(M, N) eps ||B|| [Pa]: by how much B g is uncertain in `precision`, per ||g||.

        E: `rounding`; Frobenius norms. The second term is what sums of products may lose.
        """
        lost = max(self.B.shape) * self.eps * np.linalg.norm(self.B)
        return float(np.linalg.norm(self.rounding) + lost)
