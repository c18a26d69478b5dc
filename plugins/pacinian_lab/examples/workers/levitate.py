"""The example of levitate: L-BFGS-B over phases and amplitudes, with the cost function of its notebook."""

from __future__ import annotations

import warnings
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # it uses names that NumPy 1.23 deprecates
    levitate: Any = import_module("levitate")

LIBRARIES = "levitate", "scipy", "numpy"
FAST = 1e3  # weight of the velocity, as in the notebook


def offers(threads: int) -> dict[tuple[str, str], Callable[[dict[str, Any]], Any]]:
    """Return the notebook's optimisation."""
    return {("levitate minimize", "beside a trap"): superpose}


def superpose(given: dict[str, Any]) -> Any:
    """Prepare the haptic half: pressure at the focus, no pressure and no velocity at the trap."""
    array = levitate.arrays.RectangularArray((21, 12))
    r = np.array(given["positions"])
    order = np.lexsort(r.T), np.lexsort(array.positions)
    if np.abs(r[order[0]] - array.positions.T[order[1]]).max() > 1e-9:
        raise ValueError("the array is not that of the notebook")
    ((focus,),), trap = np.array(given["points"]), np.array(given["quiet"])

    def solve() -> Any:
        p = abs(levitate.fields.Pressure(array)) ** 2
        v = (abs(levitate.fields.Velocity(array)) ** 2).sum()
        start = levitate.complex(array.focus_phases(focus))
        cost = p * (-1) @ focus + (p + v * FAST) @ trap
        return levitate.optimization.minimize(
            cost, array, start_values=start, variable_amplitudes=True
        )

    def read_gains(output: Any) -> Any:
        gains = np.empty_like(output)
        gains[order[0]] = output[order[1]]
        return gains[None].conj(), focus[None]  # its waves are exp(+jkr)

    return solve, read_gains
