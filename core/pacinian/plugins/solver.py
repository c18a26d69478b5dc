"""The solver interface: points and pressures go in, gains come out."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar, NamedTuple, TypeAlias, cast

import numpy as np

from pacinian.errors import PluginError, shorten

if TYPE_CHECKING:
    from pacinian.solving.budget import Budget
    from pacinian.solving.limits import Limits
    from pacinian.solving.propagator import Propagator
    from pacinian.solving.solution import Solution
    from pacinian.solving.targets import Targets
    from pacinian.types import Complexes, Gains


class Result(NamedTuple):
    """A solver's report on its own answer. The session measures everything else.

    iterations: number of iterations. limited: whether transducers are held at their limit. late: whether the budget
    stopped the solver. bound, objective, multipliers, mu: as in `Solution`; without mu, bound and objective do not
    count, because the session cannot check them. The multipliers are an array of any numeric type. mu: finite and at
    least 0; NaN for none. quiet_weight: weight of the points beside regions (`Targets.beside`) in the bound and the
    objective. note: free text. solver: name of the solver to which this one delegated the problem. unproven: with
    `scale="max"`, whether the answer may be weaker than the strongest one for its phases.
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

    def check(self, solver: str, samples: int) -> Result:
        """Check all fields. Return the result with its multipliers, (samples,), as the kernels need them.

        They are then contiguous, aligned and complex128. solver: its name, for errors. Raises PluginError.
        """
        wrong = f"solver {solver!r} returned a wrong result:"
        values = cast("tuple[object, ...]", self)  # a plug-in may have put anything there
        for field, kind, value in zip(self._fields, _FIELD_KINDS, values, strict=True):
            word, types = kind
            if not isinstance(value, types):
                raise PluginError(f"{wrong} `{field}` must be {word}, not {shorten(repr(value))}")
            if kind is _NUMBER and not _fits_float(value):
                raise PluginError(f"{wrong} `{field}` must be a number that a float can hold")
        if self.mu < 0.0 or math.isinf(self.mu):
            problem = f"must be finite and at least 0, or NaN for none, not {self.mu}"
            raise PluginError(f"{wrong} `mu` {problem}")
        y = self.multipliers
        if y is None:
            return self
        if y.shape != (samples,) or y.dtype.kind not in "iufc":
            problem = f"must be {samples} numbers, not {y.dtype} of shape {y.shape}"
            raise PluginError(f"{wrong} `multipliers` {problem}")
        multipliers = np.require(y, np.complex128, ["C", "A", "E"])
        return self if multipliers is y else self._replace(multipliers=multipliers)


_Kind: TypeAlias = tuple[str, tuple[type, ...]]
_COUNT: _Kind = "a whole number", (int, np.integer)
_FLAG: _Kind = "True or False", (bool, np.bool_)
_NUMBER: _Kind = "a number", (float, int, np.floating, np.integer)
_ARRAY: _Kind = "an array or None", (np.ndarray, type(None))
_TEXT: _Kind = "a text", (str,)
# in the order of the fields of `Result`
_FIELD_KINDS = (
    _COUNT, _FLAG, _FLAG, _NUMBER, _NUMBER, _ARRAY, _NUMBER, _NUMBER, _TEXT, _TEXT, _FLAG,
)  # fmt: skip


def _fits_float(value: object) -> bool:
    """Return whether a number can be converted to a float; a whole number can be too large for that."""
    try:
        float(cast("float", value))
    except OverflowError:
        return False
    return True


class Solver(ABC):
    """Base class of the solvers, which find gains that produce given sound pressures at given points.

    A solver is a plain object. Settings are arguments of its constructor, and problems are arguments of `solve`. It
    keeps no state between calls; what makes the next call faster may lie in `Propagator.workspace`. Pass the solver to
    `pacinian.Session`, or register its class (`pacinian.hookimpl`).
    """

    name: ClassVar[str]
    """The name by which users select it."""
    keeps: ClassVar[frozenset[str]] = frozenset()
    """Limits that the solver enforces itself: "quiet", "exact". The session enforces `gain` and `power`."""
    linear: ClassVar[bool] = False
    """Whether scaling the targets by c scales the gains by c, as long as no limit is reached. The session then reuses
    the last solution instead of solving again."""
    max_uniform_points: ClassVar[float] = 0.0
    """Largest number of points for which it drives all transducers alike, as the strongest focus needs. For more
    points it drives each transducer in proportion to the pressure that it makes there, as the least power needs. The
    force of a point is spread over a focus of the corresponding width."""
    surrounds: ClassVar[bool] = False
    """Whether the points beside a region (`Targets.beside`) cost so little that a loop may add some around each
    region, to keep sound away from its surroundings."""

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
        """Write the gains, shape (N,), to `out`, which holds zeros on entry.

        propagator: B, its Gram matrix and their factors, which are cached, shared and read-only. If `limits.quiet` is
        given, `propagator.quiet` is the propagator to the quiet points. targets: at least one, of which at least one
        is not 0. warm: the last solution, if it has as many points. budget: check `budget.spent` between iterations.
        The session scales gains above the limit down as a whole. Gains that are not finite, and exceptions, lead to
        silence.
        """
