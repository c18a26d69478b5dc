"""levitate 3.0: L-BFGS-B over phases and amplitudes. NumPy and SciPy, double precision.

The objective, sum (|p| - t)^2, is written as one `FieldImplementation`, as users of levitate do. A sum of M of its
own `Pressure` fields makes the same steps, 2 to 60 times slower.
"""

from __future__ import annotations

import itertools
import warnings
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # levitate uses names that NumPy 1.23 deprecates
    arrays: Any = import_module("levitate.arrays")
    optimization: Any = import_module("levitate.optimization")
    transducers: Any = import_module("levitate.transducers")
    fields: Any = import_module("levitate.fields._wrappers")

LIBRARIES = "levitate", "scipy", "numpy"
LOOSE = {"options": {"ftol": 1e-4, "gtol": 1e-9}}  # levitate's default: ftol 1e-15


class Misses(fields.FieldImplementation):  # type: ignore[misc]
    """The sum over the points of (|p| - t)^2 [Pa^2]."""

    shape = ()
    values_require = fields.FieldImplementation.requirement(pressure_derivs_summed=0)
    jacobians_require = fields.FieldImplementation.requirement(
        pressure_derivs_summed=0, pressure_derivs_individual=0
    )

    def __init__(self, array: Any, t: Any) -> None:
        super().__init__(array)
        self.t = t

    def values(self, pressure_derivs_summed: Any) -> Any:
        """Return the sum for pressures (1, M)."""
        return ((np.abs(pressure_derivs_summed[0]) - self.t) ** 2).sum()

    def jacobians(self, pressure_derivs_summed: Any, pressure_derivs_individual: Any) -> Any:
        """Return the gradient (N,) for pressures (1, M) and each transducer's part (1, N, M)."""
        p = pressure_derivs_summed[0]
        size = np.abs(p)
        return pressure_derivs_individual[0] @ (2.0 * (size - self.t) * p.conj() / size)


def offers(threads: int) -> dict[tuple[str, str], Callable[[dict[str, Any]], Any]]:
    """Return the solver with default tolerances, cold and warm, and with loose tolerances."""
    return {
        ("levitate", "cold"): make_optimised(None, False),
        ("levitate", "warm"): make_optimised(None, True),
        ("levitate-loose", "cold"): make_optimised(LOOSE, False),
    }


def make_optimised(settings: Any, warm: bool) -> Callable[[dict[str, Any]], Any]:
    """Prepare `minimize` with `variable_amplitudes`. warm: start from the last result, with points moved by 1 mm."""

    def prepare(problem: dict[str, Any]) -> Any:
        r, frames, t = (np.array(problem[k]) for k in ("positions", "frames", "targets"))
        transducer = transducers.PointSource(p0=problem["pressure"])
        transducer.k = problem["wavenumber"]
        array = arrays.TransducerArray(r.T, np.array([0.0, 0.0, 1.0]), transducer=transducer)
        path = itertools.cycle(frames if warm else frames[:1])
        last: Any = None

        def solve() -> Any:
            nonlocal last
            q = next(path)
            found = optimization.minimize(
                Misses(array, t) @ q.T,
                array,
                start_values=last,
                variable_amplitudes=True,
                minimize_kwargs=settings,
            )
            last = found if warm else None
            return found, q

        def read(output: Any) -> Any:
            return output[0].conj(), output[1]  # levitate's waves are exp(+jkr)

        return solve, read

    return prepare
