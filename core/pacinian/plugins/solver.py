"""The solver seam: points and pressures in, gains out."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar, NamedTuple

if TYPE_CHECKING:
    from pacinian.solving.problem import Budget, Limits, Targets
    from pacinian.solving.propagator import Propagator
    from pacinian.solving.solution import Solution
    from pacinian.types import Complexes, Gains


class Result(NamedTuple):
    """What a solver says of its answer; the session measures the rest itself.

    iterations: how many. limited: transducers are held at their limit. late: stopped by the budget.
    bound, objective, multipliers, mu: as in `Solution`. quiet_weight: in both, of the points beside regions
    (`Targets.beside`). note: free text. solver: the name of the solver that it was passed on to.
    unproven: with `scale="max"`, that it may be weaker than what it should be, the strongest for its phases.
    """

    iterations: int = 0
    limited: bool = False
    late: bool = False
    bound: float = float("nan")
    objective: float = float("nan")
    multipliers: Complexes | None = None
    mu: float = float("nan")
    quiet_weight: float = 1.0
    note: str = ""
    solver: str = ""
    unproven: bool = False


class Solver(ABC):
    """Finds gains that make given sound pressures at given points.

    A solver is a plain object made once: settings are arguments of its constructor, problems are
    arguments of `solve`. It holds nothing between calls. Give it to `pacinian.Session`, or register
    its class (`pacinian.hookimpl`).
    """

    name: ClassVar[str]
    """What users call it."""
    keeps: ClassVar[frozenset[str]] = frozenset()
    """Limits that it keeps by itself: "quiet", "exact". The session keeps `gain` and `power`."""
    linear: ClassVar[bool] = False
    """Whether targets c times as strong have gains c times as strong while no limit is reached: the
    session then need not ask again."""
    even: ClassVar[float] = 0.0
    """Up to how many points it drives all transducers alike, as the strongest focus needs; of more, each in proportion
    to how well it is heard there, as the least power needs. A point's force is spread over a focus of that width."""
    surrounds: ClassVar[bool] = False
    """Whether the points beside a region (`Targets.beside`) count so little that a loop may add some around each
    region, to keep sound from what lies there."""

    @abstractmethod
    def solve(
        self,
        propagator: Propagator,
        targets: Targets,
        limits: Limits,
        warm: Solution | None,
        budget: Budget,
        out: Gains,
    ) -> Result:
        """Write gains, shape (N,), to `out`; `out` holds zeros before.

        propagator: B, its Gram matrix, its factors; cached, shared, read-only; `propagator.quiet` is
        that of the quiet points, where `limits.quiet` is given.
        targets: at least one, at least one of them not 0. warm: the last solution, for as many points.
        Gains over the limit are scaled down as a whole by the session; gains that are not finite, and
        exceptions, end in silence. `budget.spent` is to be asked between iterations.
        """
