"""AcousTools 1.2: weighted Gerchberg-Saxton and GS-PAT, 200 steps. PyTorch; phases only, at full drive."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

torch: Any = import_module("torch")
solvers: Any = import_module("acoustools.Solvers")

LIBRARIES = "acoustools", "torch", "numpy"
STEPS = 200  # the peer's default


def offers(threads: int) -> dict[tuple[str, str], Callable[[dict[str, Any]], Any]]:
    """Return both methods, on the CPU and without gradients."""
    torch.set_num_threads(threads)
    torch.set_grad_enabled(False)
    return {
        ("acoustools-wgs", "cold"): iterative(solvers.wgs),
        ("acoustools-gspat", "cold"): iterative(solvers.gspat),
    }


def iterative(method: Any) -> Callable[[dict[str, Any]], Any]:
    """Prepare a method with the problem's medium, strength and omnidirectional transducers (radius 0)."""

    def prepare(problem: dict[str, Any]) -> Any:
        r, q, t = (np.array(problem[k]) for k in ("positions", "frames", "targets"))
        q = q[0]
        board = torch.from_numpy(r.astype(np.float32))
        air = {"k": problem["wavenumber"], "p_ref": problem["pressure"], "transducer_radius": 0.0}

        def solve() -> Any:
            points = torch.from_numpy(np.ascontiguousarray(q.T, dtype=np.float32))[None]
            targets = torch.from_numpy(t.astype(np.complex64))[:, None]
            return method(points, iterations=STEPS, board=board, b=targets, **air).numpy()

        def read(output: Any) -> Any:
            return output[0, :, 0].conj(), q  # AcousTools' waves are exp(+jkr)

        return solve, read

    return prepare
