"""The solution: gains, the problem that they solve, and evidence of how good they are."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Protocol, overload

import numpy as np

from pacinian.acoustics.intensity import normal_pressure
from pacinian.acoustics.pose import Pose
from pacinian.acoustics.pressure import radiation_pressure
from pacinian.acoustics.propagation import field
from pacinian.argument_checks import check_length
from pacinian.errors import ArgumentError
from pacinian.notebook import Card, card
from pacinian.solving.solution_metrics import SolutionMetrics

if TYPE_CHECKING:
    from pathlib import Path

    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pacinian.acoustics.propagation import Precision
    from pacinian.acoustics.skin_facing import SkinFacing
    from pacinian.types import ArrayLike, Complexes, Floats


FORCE_SAMPLES = 10  # number of samples per wavelength along a surface whose force is computed


class PosedSurface(Protocol):
    """A `pacinian.Surface` or `pacinian.Volume`: a surface at a pose."""

    @property
    def pose(self) -> Pose:
        """The pose of the object's own frame."""
        ...

    def sample_surface(self, spacing: float) -> tuple[Floats, Floats, Floats]:
        """Return points, (K, 3) [m], normals, (K, 3), and areas, (K,) [m^2], in the object's own frame."""
        ...


class Solution(SolutionMetrics):
    """Gains, the problem that they solve, and the pressures that they achieve.

    gains: (N,), complex64, or complex128 in double precision. array, medium: of N transducers, and the air. points:
    (M, 3) [m], read-only. targets: what was asked at these points. limits: what the gains had to keep.
    sound_pressure: achieved, complex, (M,) [Pa].
    status: how the solve ended. solver: name of the solver. iterations: number of its iterations.
    objective: 1/2 ||p - B g||^2 + mu/2 ||g||^2 [Pa^2] for these gains g and the chosen phases of the targets p.
    bound: a lower bound of the objective [Pa^2]. Both are NaN if the solver proves no bound.
    multipliers, mu: y, (M,) [Pa], and mu [Pa^2], which prove the bound; see `Session.certify`.
    violations: broken limits by name. "quiet": the highest ratio of pressure to limit at a quiet point, minus 1; limits
    below 1 % of full drive count as 1 %. "exact": relative error of the samples to be met exactly. "zones": as "quiet",
    for zones. "gain" and "power": the ratio of value to limit, minus 1; only `Session.certify` can find these broken.
    felt: what is felt between the samples of each region; `pacinian.solve` and `Session.certify` compute it.
    gain_limit: limit of |g_n|, infinity for none. seconds: duration of the solve [s].
    late: whether the deadline passed before the solver was done.
    asked_phases: the phases given to the solver [rad], (M,), if there are regions; the next solve starts from them.
    quiet_weight: weight of the points beside regions (`Targets.beside`) in bound and objective; other points have 1.
    least_error: lower bound of `error` over all phases and all gains within the gain limit; NaN unless requested from
    `Session.certify`.
    note: a remark by the solver, for example why `auto` chose it.
    facing: the skin at the points, if it was given; `sound_pressure` is then the pressure along its normals.
    versions: of Pacinian, NumPy and Python when the solution was saved; empty unless it was loaded.
    """

    def field(self, points: ArrayLike, *, precision: Precision = "single") -> Complexes:
        """Return the complex sound pressure [Pa] of these gains at any points, in the solution's own air.

        points: [m], shape (..., 3). precision: "single" or "double", as for `pacinian.field`. What hides or reflects
        the sound is not taken into account. Returns shape (...). Raises ArgumentError, PointOnTransducer.
        """
        return field(self.array, self.gains, points, self.medium, precision)

    def radiation_pressure(
        self, points: ArrayLike | None = None, facing: SkinFacing | None = None
    ) -> Floats:
        """Return the radiation pressure on skin [Pa] of these gains.

        points: [m], shape (..., 3); by default, those of the solution, with their skin. facing: the skin at the points,
        whose shape is then (K, 3): the pressure is that along its normals. Returns shape (...). Raises ArgumentError,
        PointOnTransducer.
        """
        if points is None:
            return radiation_pressure(self.sound_pressure, self.medium)
        if facing is not None:
            return normal_pressure(self.array, self.gains, points, facing, self.medium)
        return radiation_pressure(self.field(points), self.medium)

    def force(self, surface: PosedSurface, *, spacing: float | None = None) -> float:
        """Return the force that presses a surface along its normals [N], the integral of the radiation pressure.

        surface: a `pacinian.Surface`, or the shell of a `pacinian.Volume`. Sound presses a place only if it arrives on
        the place's outer side, in proportion to the squared cosine of its incidence (`SkinFacing`). A body therefore
        shades its own far side; other bodies cast no shadow. A flat surface is pressed on the side of the array.
        spacing: between the places at which the pressure is evaluated [m], by default a tenth of the wavelength. Raises
        ArgumentError, PointOnTransducer.
        """
        from pacinian.solving.surface_force import surface_force

        pose, sample = getattr(surface, "pose", None), getattr(surface, "sample_surface", None)
        if not isinstance(pose, Pose) or sample is None:
            raise ArgumentError("surface", f"must be a Surface or a Volume, not {surface!r}")
        wavelength = self.medium.wavelength(self.array.transducer.frequency)
        spacing = (
            wavelength / FORCE_SAMPLES if spacing is None else check_length("spacing", spacing)
        )
        points, normals, areas = sample(spacing)
        return surface_force(self, pose.points(points), pose.directions(normals), areas)

    @overload
    def plot(
        self,
        plane: str | Pose = "xz",
        at: ArrayLike | None = None,
        *,
        show: Any = "radiation",
        ax: None = None,
    ) -> Figure: ...
    @overload
    def plot(
        self,
        plane: str | Pose = "xz",
        at: ArrayLike | None = None,
        *,
        show: Any = "radiation",
        ax: Axes,
    ) -> Axes: ...
    def plot(
        self,
        plane: str | Pose = "xz",
        at: ArrayLike | None = None,
        *,
        show: Any = "radiation",
        ax: Axes | None = None,
    ) -> Figure | Axes:
        """Plot a slice of the field of these gains, with the points marked; see `pacinian.plot.field`.

        plane: "xy", "xz" or "yz" through `at`, (3,) [m], by default the middle of the points; or a pose, whose xy-plane
        is used. show: "radiation" pressure [Pa], sound "pressure" [Pa], its "level" [dB] or "phase" [rad]. Returns a
        figure; the axes if `ax` is given. Raises ArgumentError, MissingExtra.
        """
        from pacinian.plot.fields import field as plot_field

        given: Any = {"at": at, "show": show, "points": self.points, "ax": ax}
        made: Figure | Axes = plot_field(self.array, self.gains, plane, medium=self.medium, **given)
        return made

    def to_dataframe(self) -> pd.DataFrame:
        """Return a pandas data frame with one row for each point.

        Its columns are x, y, z [m], target, sound_pressure (amplitudes) [Pa], phase [rad], radiation_pressure [Pa],
        and region if there are regions. Its `attrs` hold the solver, the status and more. Raises MissingExtra
        without the extra `tables`.
        """
        from pacinian.solving.solution_tables import to_dataframe

        return to_dataframe(self)

    def to_xarray(self) -> xr.Dataset:
        """Return an xarray dataset with the dimensions `point` and `transducer`.

        Its variables are the columns of `to_dataframe`, and gain_amplitude and gain_phase [rad] of each transducer,
        each with its unit. All are real, so that it can be written as netCDF. Raises MissingExtra
        without the extra `tables`.
        """
        from pacinian.solving.solution_tables import to_xarray

        return to_xarray(self)

    def save(self, path: str | Path) -> None:
        """Write the solution and its whole problem to one file, for `Solution.load`.

        It holds array, air, points, targets, limits, gains, evidence and versions, as MessagePack (docs/solvers.md).
        Raises ArgumentError if a directivity is a Python function, SolutionFileError if the file cannot be written.
        """
        from pacinian.solving.solution_file import save_values

        save_values(self, path)

    @classmethod
    def load(cls, path: str | Path) -> Solution:
        """Read a solution from a file by `save`. All values are checked. Raises SolutionFileError."""
        from pacinian.solving.solution_file import load_values

        return cls(**load_values(path))

    @card
    def _repr_html_(self) -> Card:
        rows = {
            "status": f"{self.status.name}: {self.status.advice}",
            "error at the points": f"of the proportions {100.0 * self.shape_error:.2g} %"
            if self.targets.scale == "max"
            else f"{100.0 * self.error:.2g} %; of the proportions {100.0 * self.shape_error:.2g} %",
            "points": len(self.sound_pressure),
            "transducers": f"{len(self.gains)}, {self.saturation:.0%} at their limit",
            "iterations": self.iterations,
            "time": f"{1e3 * self.seconds:.2f} ms",
        }
        if not math.isnan(self.gap):
            rows["proof"] = f"objective {self.objective:.4g} Pa², optimum at least {self.bound:.4g}"
        if not math.isnan(self.least_error):
            rows["error of any gains and phases"] = f"at least {100.0 * self.least_error:.2g} %"
        for number, felt in enumerate(self.felt):
            rows[f"felt of region {number}"] = str(felt)
        rows |= {f"broken: {name}": f"by {by:.2%}" for name, by in self.violations.items()}
        rows |= {"note": self.note} if self.note else {}
        draw = self._draw if len(self.sound_pressure) else None
        return Card(f"Solution by {self.solver}", rows, draw=draw)

    def _draw(self, panel: Any) -> None:
        """Plot target and achieved amplitudes."""
        panel.plot(self.targets.amplitudes, "o", mfc="none", ms=5, label="asked")
        panel.plot(np.abs(self.sound_pressure), ".", ms=4, label="achieved")
        panel.set(xlabel="point", ylabel="sound pressure [Pa]")
        panel.set_ylim(bottom=0.0)
        panel.legend(fontsize=6)
