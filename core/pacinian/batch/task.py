"""The problems of a batch, and how one of them is solved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from pacinian.session import Session

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.acoustics.propagation import Precision
    from pacinian.plugins.solver import Solver
    from pacinian.solving.limits import Limits
    from pacinian.solving.solution import Solution
    from pacinian.types import Floats, Longs


@dataclass(frozen=True, eq=False)
class Task:
    """K problems that are solved alike.

    arrays: one, or K of them. points: (K, M, 3) [m]. amplitudes: (K, M) [Pa]. phases: (K, M) [rad], NaN where free.
    regions: (K, M); None if there are none. The rest as for `pacinian.solve`.
    """

    arrays: tuple[Array, ...]
    points: Floats
    amplitudes: Floats
    phases: Floats | None
    regions: Longs | None
    solver: Solver
    limits: Limits
    scale: str
    medium: Air
    precision: Precision

    def array(self, k: int) -> Array:
        """Return the array of problem k."""
        return self.arrays[k if len(self.arrays) > 1 else 0]

    def solve(self, numbers: Iterator[int]) -> Iterator[tuple[int, Solution]]:
        """Solve the problems with these numbers by one session, each from a cold start; yield them with the numbers.

        An error carries a note with the number of its problem.
        """
        session = None
        for k in numbers:
            array = self.array(k)
            if session is None or session.array is not array:
                session = Session(array, self.medium, self.solver, precision=self.precision)
            try:
                solution = session.solve(
                    self.points[k],
                    self.amplitudes[k],
                    None if self.phases is None else self.phases[k],
                    regions=None if self.regions is None else self.regions[k],
                    limits=self.limits,
                    scale=self.scale,
                )
                solution = session.measure_felt(solution)
            except Exception as error:
                error.add_note(f"This was problem {k} of {len(self.points)}.")
                raise
            session.forget()
            yield k, solution
