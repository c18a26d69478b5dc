"""One hard problem: the arguments of `Session.solve`, and B in double precision for comparison."""

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
from pacinian.solving.blas import limit_blas_threads
from pacinian.solving.limits import Limits
from pacinian.solving.targets import Targets
from pacinian_lab.stress.reference import Reference

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from pacinian.acoustics.array import Array
    from pacinian.acoustics.propagation import Precision
    from pacinian.plugins.solver import Solver
    from pacinian.solving.solution import Solution
    from pacinian.types import ArrayLike, Complexes, Floats

    Before = tuple[Floats, ArrayLike] | tuple[Floats, ArrayLike, ArrayLike]

# [s] deadline of problems without their own, to detect a solver that does not end
DEFAULT_DEADLINE = 3.0
TABLE = 2e-5  # error of the kernels' directivity table, relative to 1
FAINT = math.exp(-32.0)  # the kernels treat what absorption leaves as zero below this


@dataclass(frozen=True, eq=False, repr=False)
class Case:
    """One problem. Its arguments are those of `Session` and `Session.solve`.

    name: "family: difficulty". history: points (M, 3) [m], amplitudes (M,) [Pa] and, optionally, regions (M,) that
    the same session solved before. refused: the error that is the right answer. slow: omitted from a quick run.
    clock: of the session and of the measured time [s]; for tests.
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
    deadline: float = DEFAULT_DEADLINE
    history: Sequence[Before] = ()
    refused: type[PacinianError] | None = None
    slow: bool = False
    regions: ArrayLike | None = None
    clock: Callable[[], float] = time.perf_counter

    def __repr__(self) -> str:
        return f"<Case {self.name}>"

    def solve(self, solver: str | Solver) -> Solution:
        """Solve `history` and then the problem in one session. Returns the solution, with what its regions feel like.

        Raises the errors of the session.
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
        return session.measure_felt(solution)

    @functools.cached_property
    def targets(self) -> Targets:
        """The targets as the session reads them."""
        return Targets.make_checked(
            len(self.points), self.amplitudes, self.phases, self.scale, self.regions
        )

    def ask(self, solution: Solution) -> Complexes:
        """Return complex targets [Pa], (M,), with the phases given to the solver, or else with those that it found."""
        phases = solution.asked_phases
        return self.targets.complex(np.angle(solution.sound_pressure) if phases is None else phases)

    @functools.cached_property
    def B(self) -> Complexes:
        """B [Pa], (M, N), in double precision."""
        return matrix(self.array, self.points, self.medium)

    @functools.cached_property
    def reference(self) -> Reference:
        """The singular value decomposition of B."""
        return Reference.of(self.B)

    @functools.cached_property
    def work(self) -> float:
        """Time that B and its smaller Gram matrix take in double precision [s], measured now."""
        begin = time.perf_counter()
        B = matrix(self.array, self.points, self.medium)
        with limit_blas_threads():
            B = B if len(B) <= B.shape[1] else B.T
            _ = B @ B.conj().T
        return time.perf_counter() - begin

    @property
    def eps(self) -> float:
        """The rounding unit of B."""
        return float(np.finfo(np.float32 if self.precision == "single" else np.float64).eps)

    @functools.cached_property
    def rounding(self) -> Floats:
        """An upper bound of the rounding error of each element of B in `precision` [Pa], (M, N).

        Coordinates within R of the array's centre are accurate to eps R. Therefore a distance d is accurate to 2 eps
        R, a phase to eps k (2 R + d), an amplitude d^-n exp(-beta d) to 2 eps R (n / d + beta), and the cosine of an
        angle to 2 eps R / d. The bound assumes that the slope of a directivity is at most 4.
        """
        kind, centre = self.array.transducer, self.array.centre
        d = np.sqrt(((self.points[:, None] - self.array.positions) ** 2).sum(axis=2))  # (M, N) [m]
        d = np.maximum(d, 1e-15)
        R = max(np.abs(x - centre).max(initial=0.0) for x in (self.points, self.array.positions))
        if self.precision == "double":
            R += np.abs(centre).max()  # double precision does not subtract the centre
        k, beta = self.medium.wavenumber(kind.frequency), self.medium.beta(kind.frequency)
        steep = self.medium.exponent + (0.0 if kind.directivity is omni else 4.0)
        few = 72.0 if beta else 8.0  # roundings; the kernel computes exp(t) as exp(t / 64)^64
        relative = self.eps * (few + 2.0 * R * (steep / d + beta) + k * (2.0 * R + d))
        absorbed = np.exp(-beta * d)
        if self.precision == "single":
            relative += 0.0 if kind.directivity is omni else TABLE
            relative[absorbed < 2.0 * FAINT] = 1.0
        return np.asarray(relative * kind.pressure * d**-self.medium.exponent * absorbed)

    @functools.cached_property
    def blur(self) -> float:
        """||E|| + max(M, N) eps ||B|| [Pa]: the uncertainty of B g in `precision`, per ||g||.

        E: `rounding`; Frobenius norms. The second term is the rounding of sums of products.
        """
        lost = max(self.B.shape) * self.eps * np.linalg.norm(self.B)
        return float(np.linalg.norm(self.rounding) + lost)
