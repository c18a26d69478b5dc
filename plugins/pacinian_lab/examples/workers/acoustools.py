"""The examples of AcousTools, with its own boards, constants and defaults; phases only, at full drive."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

torch: Any = import_module("torch")
solvers: Any = import_module("acoustools.Solvers")
utilities: Any = import_module("acoustools.Utilities")

LIBRARIES = "acoustools", "torch", "numpy"


def offers(threads: int) -> dict[tuple[str, str], Callable[[dict[str, Any]], Any]]:
    """Return the solvers of its examples, on the CPU and without gradients."""
    torch.set_num_threads(threads)
    torch.set_grad_enabled(False)
    found = {
        ("acoustools " + name, "eight"): make(getattr(solvers, name), {})
        for name in ("naive", "iterative_backpropagation", "gspat", "wgs")
    }
    return found | {
        ("acoustools gspat, 10 steps", "batch"): make(solvers.gspat, {"iterations": 10})
    }


def make(method: Any, options: dict[str, Any]) -> Callable[[dict[str, Any]], Any]:
    """Prepare a method for all patterns at once."""

    def prepare(given: dict[str, Any]) -> Any:
        board = utilities.TRANSDUCERS
        if np.abs(board.numpy().real - np.array(given["positions"])).max() > 1e-6:
            raise ValueError("the array is not that of AcousTools")
        q = np.array(given["points"])
        points = torch.from_numpy(np.ascontiguousarray(q.transpose(0, 2, 1), np.float32))

        def solve() -> Any:
            return method(points, board=board, **options)

        def read_gains(output: Any) -> Any:
            return output.numpy().reshape(len(q), -1).conj(), q  # its waves are exp(+jkr)

        return solve, read_gains

    return prepare
