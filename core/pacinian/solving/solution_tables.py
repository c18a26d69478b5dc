"""Solutions as tables of other libraries: an xarray dataset and a pandas data frame."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.pressure import radiation_pressure
from pacinian.errors import MissingExtra

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from pacinian.solving.solution_metrics import SolutionMetrics

UNITS = {
    "x": "m",
    "y": "m",
    "z": "m",
    "target": "Pa",
    "sound_pressure": "Pa",
    "phase": "rad",
    "radiation_pressure": "Pa",
    "region": "1",
    "gain_amplitude": "1",
    "gain_phase": "rad",
}
"""Unit of each variable, by name."""
MEANINGS = {
    "target": "target amplitude of the sound pressure, peak",
    "sound_pressure": "achieved amplitude of the sound pressure, peak",
    "phase": "achieved phase of the sound pressure",
    "radiation_pressure": "achieved radiation pressure on skin",
    "region": "region of the point; -1: isolated, -2: beside the regions",
    "gain_amplitude": "amplitude of the transducer, 1 at full drive",
    "gain_phase": "phase of the transducer",
}


def to_dataframe(solution: SolutionMetrics) -> pd.DataFrame:
    """Return a data frame with one row for each point; see `Solution.to_dataframe`. Raises MissingExtra."""
    try:
        import pandas as pd
    except ImportError as error:
        raise MissingExtra("pandas", "tables") from error
    frame = pd.DataFrame(_columns(solution))
    frame.index.name = "point"
    frame.attrs.update(_facts(solution))
    return frame


def to_xarray(solution: SolutionMetrics) -> xr.Dataset:
    """Return a dataset of points and transducers; see `Solution.to_xarray`. Raises MissingExtra."""
    try:
        import xarray as xr
    except ImportError as error:
        raise MissingExtra("xarray", "tables") from error
    columns = _columns(solution)
    g, r = solution.gains, solution.array.positions
    variables: dict[str, Any] = {
        name: ("point", columns[name], _describe(name)) for name in columns if name not in "xyz"
    }
    variables["gain_amplitude"] = "transducer", np.abs(g), _describe("gain_amplitude")
    variables["gain_phase"] = "transducer", np.angle(g), _describe("gain_phase")
    places: dict[str, Any] = {name: ("point", columns[name], {"units": "m"}) for name in "xyz"}
    for name, along in zip("xyz", r.T, strict=True):
        places[f"transducer_{name}"] = "transducer", along, {"units": "m"}
    return xr.Dataset(variables, places, _facts(solution))


def _columns(solution: SolutionMetrics) -> dict[str, Any]:
    p, targets = solution.sound_pressure, solution.targets
    x, y, z = solution.points.T
    columns: dict[str, Any] = {
        "x": x,
        "y": y,
        "z": z,
        "target": targets.amplitudes,
        "sound_pressure": np.abs(p).astype(np.float64),
        "phase": solution.phases,
        "radiation_pressure": radiation_pressure(p, solution.medium),
    }
    if targets.regions is not None:
        columns["region"] = targets.regions
    return columns


def _describe(name: str) -> dict[str, str]:
    return {"units": UNITS[name], "long_name": MEANINGS[name]}


def _facts(solution: SolutionMetrics) -> dict[str, Any]:
    """Return what holds for the whole solution, as plain numbers and texts. NaN is left out."""
    medium = solution.medium
    facts: dict[str, Any] = {
        "solver": solution.solver,
        "status": solution.status.name,
        "error": solution.error,
        "iterations": solution.iterations,
        "seconds": solution.seconds,
        "objective": solution.objective,
        "bound": solution.bound,
        "frequency": solution.array.transducer.frequency,
        "speed_of_sound": medium.speed_of_sound,
        "density": medium.density,
    }
    return {
        name: value
        for name, value in facts.items()
        if not (isinstance(value, float) and math.isnan(value))
    }
