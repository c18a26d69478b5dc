"""The examples of autd3: focus, GS-PAT and a circle of foci; 8-bit phases and intensities."""

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
FULL = 255  # intensity


def offers(threads: int) -> dict[tuple[str, str], Callable[[dict[str, Any]], Any]]:
    """Return the calls of autd3's examples."""
    option = holo.GspatOption(parallel=threads > 1)
    return {
        ("autd3 focus", "focus"): focus,
        ("autd3 focus", "circle"): focus,
        ("autd3 gspat", "foci"): lambda given: gspat(given, option),
    }


def convert_problem(given: dict[str, Any]) -> tuple[Any, Any, Any]:
    """Return the geometry of one unit [mm], the wavelength, and the foci (K, M, 3) [mm]."""
    r = 1e3 * np.array(given["positions"])
    geometry = core.Geometry([core.Autd3(r[0], np.array([1.0, 0.0, 0.0, 0.0]))])
    if np.abs(geometry[0].positions() - r).max() > 1e-3:
        raise ValueError("the array is not an AUTD3 unit")
    return (
        geometry,
        core.Length.from_mm(1e3 * given["speed"] / 40e3),
        1e3 * np.array(given["points"]),
    )


def focus(given: dict[str, Any]) -> Any:
    """Prepare one pattern for each focus, at full intensity."""
    geometry, length, foci = convert_problem(given)
    phases = [pattern.PhaseBuffer(1) for _ in foci]

    def solve() -> None:
        for (place,), buffer in zip(foci, phases, strict=True):
            pattern.focus(geometry, place, length, buffer)

    def read_gains(output: None) -> Any:
        return np.concatenate([to_gains(buffer) for buffer in phases]), foci

    return solve, read_gains


def gspat(given: dict[str, Any], option: Any) -> Any:
    """Prepare GS-PAT with its default options."""
    geometry, length, foci = convert_problem(given)
    phases, intensities = pattern.PhaseBuffer(1), pattern.IntensityBuffer(1)

    def solve() -> None:
        asked = [holo.AmplitudeTarget(p, given["amplitude"] * holo.Pa) for p in foci[0].tolist()]
        holo.gspat(geometry, asked, length, option, phases, intensities)

    def read_gains(output: None) -> Any:
        return intensities.to_numpy().reshape(1, -1) / FULL * to_gains(phases), foci

    return solve, read_gains


def to_gains(phases: Any) -> Any:
    """Return the gains (1, N) of phases. They are negated, because autd3's waves are exp(+jkr)."""
    return np.exp(-2j * np.pi / 256 * phases.to_numpy().reshape(1, -1))
