"""autd3-pattern-holo 0.12: GS-PAT, Gerchberg-Saxton, naive, greedy. Rust; 8-bit phases and intensities."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

core: Any = import_module("autd3_core")
holo: Any = import_module("autd3_pattern_holo")
pattern: Any = import_module("autd3_pattern")

LIBRARIES = "autd3", "autd3-pattern-holo", "numpy"
UNIT = 249  # transducers
FULL = 255  # intensity


def offers(threads: int) -> dict[tuple[str, str], Callable[[dict[str, Any]], Any]]:
    """Return GS-PAT with its default of 100 steps and with 10; the others with their defaults.

    They use several threads only if `threads` allows it.
    """
    parallel = threads > 1
    gspat, few = (holo.GspatOption(repeat=n, parallel=parallel) for n in (100, 10))
    gs, naive = holo.GsOption(parallel=parallel), holo.NaiveOption(parallel=parallel)
    return {
        ("autd3-gspat", "cold"): linear(holo.gspat, gspat),
        ("autd3-gspat-10", "cold"): linear(holo.gspat, few),
        ("autd3-gs", "cold"): linear(holo.gs, gs),
        ("autd3-naive", "cold"): linear(holo.naive, naive),
        ("autd3-greedy", "cold"): greedy,
    }


def linear(method: Any, option: Any) -> Callable[[dict[str, Any]], Any]:
    """Prepare a method that writes phases and intensities. The default, `Clamp`, takes the targets [Pa] unscaled."""

    def prepare(problem: dict[str, Any]) -> Any:
        geometry, length, q, t, phases, intensities = convert_problem(problem)

        def solve() -> None:
            method(geometry, foci(q, t), length, option, phases, intensities)

        def read(output: None) -> Any:
            return gains(phases, intensities), q

        return solve, read

    return prepare


def greedy(problem: dict[str, Any]) -> Any:
    """Prepare the greedy method: phases one by one, 16 levels, in random order, at full drive."""
    geometry, length, q, t, phases, intensities = convert_problem(problem)
    option = holo.GreedyOption()
    full = core.Intensity(FULL)
    intensities.copy_from(np.full((geometry_size(problem), UNIT), FULL, np.uint8))

    def solve() -> None:
        holo.greedy(geometry, foci(q, t), length, full, option, phases)

    def read(output: None) -> Any:
        return gains(phases, intensities), q

    return solve, read


def convert_problem(problem: dict[str, Any]) -> tuple[Any, Any, Any, Any, Any, Any]:
    """Return geometry [mm], wavelength, points [m], targets [Pa], and buffers for the output."""
    r = np.array(problem["positions"])
    units = geometry_size(problem)
    geometry = core.Geometry(
        [core.Autd3(1e3 * r[UNIT * unit], np.array([1.0, 0.0, 0.0, 0.0])) for unit in range(units)]
    )
    theirs = np.concatenate([device.positions() for device in geometry]) / 1e3
    if theirs.shape != r.shape or np.abs(theirs - r).max() > 1e-6:
        raise ValueError("the array is not made of AUTD3 units")
    length = core.Length.from_mm(1e3 * 2.0 * np.pi / problem["wavenumber"])
    buffers = pattern.PhaseBuffer(units), pattern.IntensityBuffer(units)
    return geometry, length, np.array(problem["frames"][0]), np.array(problem["targets"]), *buffers


def geometry_size(problem: dict[str, Any]) -> int:
    """Return the number of units."""
    return len(problem["positions"]) // UNIT


def foci(q: Any, t: Any) -> list[Any]:
    """Return the targets in the peer's own type. The conversion is part of the timed work."""
    points, amplitudes = (1e3 * q).tolist(), t.tolist()
    return [
        holo.AmplitudeTarget(point, amplitude * holo.Pa)
        for point, amplitude in zip(points, amplitudes, strict=True)
    ]


def gains(phases: Any, intensities: Any) -> Any:
    """Return the gains (N,) of the levels. The phase is negated because autd3's waves are exp(+jkr)."""
    phase, intensity = phases.to_numpy().ravel(), intensities.to_numpy().ravel()
    return intensity / FULL * np.exp(-2j * np.pi / 256 * phase)
