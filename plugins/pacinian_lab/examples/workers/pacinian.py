"""The examples with Pacinian: one call each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import pacinian as pc

if TYPE_CHECKING:
    from collections.abc import Callable

LIBRARIES = "pacinian", "numpy", "scipy"
QUIET, RADIUS = 50.0, 0.001  # pressure [Pa] and radius [m] of a quiet place
CROSS = 0.001 * np.concatenate([np.zeros((1, 3)), np.eye(3), -np.eye(3)])  # points in it [m]


def offers(threads: int) -> dict[tuple[str, str], Callable[[dict[str, Any]], Any]]:
    """Return the solver `auto` for every example, and published methods where the peers use them."""
    every = ("focus", "foci", "circle", "eight", "batch")
    found = {("pacinian auto", name): make("auto", threads) for name in every}
    for name in ("eight", "batch"):
        found["pacinian weighted-gs", name] = make("weighted-gs", threads)
    for how in ("zone", "points"):
        found[f"pacinian auto, quiet {how}", "beside a trap"] = make("auto", threads, how)
    return found


def make(solver: str, threads: int, quiet: str = "") -> Callable[[dict[str, Any]], Any]:
    """Prepare `solve`, or `solve_many` for several patterns."""

    def prepare(given: dict[str, Any]) -> Any:
        air = pc.Air(speed_of_sound=given["speed"], density=1.2)
        k, a = air.wavenumber(40_000.0), given["radius"]
        directivity = pc.Piston(a, k) if a else pc.omni
        kind = pc.Transducer(pressure=given["pressure"], directivity=directivity)
        array = pc.Array(given["positions"], given["normals"], transducer=kind)
        points, limits = np.array(given["points"]), pc.Limits()
        if quiet == "zone":
            limits = pc.Limits(zones=(pc.Zone(given["quiet"], pressure=QUIET, radius=RADIUS),))
        elif quiet:
            limits = pc.Limits(quiet=(given["quiet"] + CROSS, QUIET))
        scale = "exact" if given["amplitude"] else "max"
        asked: dict[str, Any] = {"scale": scale, "limits": limits, "medium": air, "solver": solver}
        amplitude = given["amplitude"] or 1.0

        def solve() -> Any:
            if len(points) == 1:
                return pc.solve(array, points[0], amplitude, **asked).gains[None]
            return pc.solve_many(array, points, amplitude, workers=threads, **asked).gains

        def read_gains(gains: Any) -> Any:
            return gains, points

        return solve, read_gains

    return prepare
