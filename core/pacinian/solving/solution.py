"""The solution: gains, the problem that they solve, and evidence of how good they are."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any, Protocol, overload

import numpy as np

from pacinian.acoustics.intensity import normal_pressure
from pacinian.acoustics.pose import Pose
from pacinian.acoustics.pressure import radiation_pressure
from pacinian.acoustics.propagation import field
from pacinian.checks import check_length
from pacinian.errors import ArgumentError
from pacinian.native import solving as kernels
from pacinian.notebook import Card, card

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.acoustics.propagation import Precision
    from pacinian.acoustics.skin_facing import SkinFacing
    from pacinian.solving.felt_regions import FeltRegion
    from pacinian.solving.problem import Limits, Targets
    from pacinian.types import ArrayLike, Complexes, Floats, Gains


FORCE_SAMPLES = 10  # samples per wavelength along a surface whose force is computed
AT_LIMIT = 1.0 - 1e-5  # fraction of the gain limit from which a transducer is at its limit


class Status(Enum):
    """How a solve ended. The value explains the status and says what to do."""

    ok = "the targets are met"
    silent = "all targets are zero, so all gains are zero"
    approximate = (
        "not all targets are met, with no limit reached: "
        "the points are closer than the array can resolve, or the solver is approximate; "
        'or scale="max" was given and stronger gains may exist'
    )
    limited = (
        "transducers are at their limit: these are the nearest pressures within it; "
        "lower the amplitudes, or add units"
    )
    scaled = (
        "the gains exceeded the limits and were all scaled down: proportions are kept, strength is not; "
        "lower the amplitudes, or use solver 'lagrange'"
    )
    unreachable = (
        "some points cannot be reached by the sound of any transducer "
        "(are they behind the array, or does the skin face away from it?)"
    )
    infeasible = (
        "the limits cannot all be kept (see `violations`), so this is the best compromise; "
        "lower the amplitudes, move the quiet points, or ask for fewer exact samples"
    )
    deadline = "the deadline passed: this is the best result so far"
    failed = "no usable result, so the gains are zero; try solver 'pseudo-inverse'"

    @property
    def advice(self) -> str:
        """Meaning of the status, and what to do."""
        return self.value


class Placed(Protocol):
    """A `pacinian.Surface` or `pacinian.Volume`: a surface at a pose."""

    @property
    def pose(self) -> Pose:
        """The pose of the object's own frame."""
        ...

    def sample_surface(self, spacing: float) -> tuple[Floats, Floats, Floats]:
        """Return points, (K, 3) [m], normals, (K, 3), and areas, (K,) [m^2], in the object's own frame."""
        ...


@dataclass(frozen=True, eq=False)
class Solution:
    """Gains, the problem that they solve, and the pressures that they achieve.

    gains: (N,), complex64, or complex128 in double precision. array, medium: of N transducers, and the air. points:
    (M, 3) [m], read-only. targets: what was asked at these points. limits: what the gains had to keep.
    sound_pressure: achieved, complex, (M,) [Pa].
    status: how the solve ended. solver: its name. iterations: their number.
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
    facing: the skin at the points, if it was given; `sound_pressure` is then that along its normals.
    versions: of Pacinian, NumPy and Python when the solution was saved; empty unless it was loaded.
    """

    gains: Gains
    array: Array
    medium: Air
    points: Floats
    targets: Targets
    limits: Limits
    sound_pressure: Complexes
    status: Status
    solver: str
    iterations: int = 0
    bound: float = float("nan")
    objective: float = float("nan")
    multipliers: Complexes | None = None
    mu: float = float("nan")
    violations: Mapping[str, float] = dataclasses.field(default_factory=dict[str, float])
    seconds: float = 0.0
    note: str = ""
    gain_limit: float = math.inf
    felt: tuple[FeltRegion, ...] = ()
    late: bool = False
    asked_phases: Floats | None = None
    quiet_weight: float = 1.0
    least_error: float = math.nan
    facing: SkinFacing | None = None
    versions: Mapping[str, str] = dataclasses.field(default_factory=dict[str, str])

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

    def force(self, surface: Placed, *, spacing: float | None = None) -> float:
        """Return the force on a surface [N]: the integral of the radiation pressure over it.

        surface: a `pacinian.Surface`, or the shell of a `pacinian.Volume`; nothing is shaded. spacing: between the
        places at which the pressure is evaluated [m], by default a tenth of the wavelength. Raises ArgumentError,
        PointOnTransducer.
        """
        pose, sample = getattr(surface, "pose", None), getattr(surface, "sample_surface", None)
        if not isinstance(pose, Pose) or sample is None:
            raise ArgumentError("surface", f"must be a Surface or a Volume, not {surface!r}")
        wavelength = self.medium.wavelength(self.array.transducer.frequency)
        spacing = (
            wavelength / FORCE_SAMPLES if spacing is None else check_length("spacing", spacing)
        )
        points, _, areas = sample(spacing)
        return float(self.radiation_pressure(pose.points(points)) @ areas)

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
        and region if there are regions. Its `attrs` hold the solver, the status and more. Raises MissingExtra:
        `pip install "pacinian[tables]"`.
        """
        from pacinian.solving.solution_tables import to_dataframe

        return to_dataframe(self)

    def to_xarray(self) -> xr.Dataset:
        """Return an xarray dataset with the dimensions `point` and `transducer`.

        Its variables are the columns of `to_dataframe`, and gain and gain_phase [rad] of each transducer, each with its
        unit. All are real, so that it can be written as netCDF. Raises MissingExtra: `pip install "pacinian[tables]"`.
        """
        from pacinian.solving.solution_tables import to_xarray

        return to_xarray(self)

    def save(self, path: str | Path) -> None:
        """Write the solution and its whole problem to one file, for `Solution.load`.

        It holds array, air, points, targets, limits, gains, evidence and versions, as MessagePack (docs/solvers.md).
        Raises ArgumentError if a directivity is a Python function, SolutionFileError if the file cannot be written.
        """
        from pacinian.solving.solution_file import save_solution

        save_solution(self, path)

    @classmethod
    def load(cls, path: str | Path) -> Solution:
        """Read a solution from a file by `save`. All values are checked. Raises SolutionFileError."""
        from pacinian.solving.solution_file import load_solution

        return load_solution(path)

    @property
    def asked(self) -> Complexes:
        """Complex targets, (M,) [Pa], with the achieved phase where the phase was free."""
        return self.targets.complex(np.angle(self.sound_pressure))

    @property
    def weights(self) -> Floats:
        """Weight of each point's squared error in objective and bound, (M,)."""
        return np.where(self.targets.beside, self.quiet_weight, 1.0)

    @property
    def saturation(self) -> float:
        """Fraction of transducers at the gain limit, 0..1."""
        held = kernels.held(np.ascontiguousarray(self.gains), AT_LIMIT * self.gain_limit)
        return held / len(self.gains)

    @property
    def phases(self) -> Floats:
        """Achieved phases, (M,) [rad]."""
        return np.asarray(np.angle(self.sound_pressure), np.float64)

    @property
    def residual(self) -> Complexes:
        """Targets minus achieved pressures, complex, (M,) [Pa]; free phases are the achieved ones."""
        return self.asked - self.sound_pressure

    @property
    def error(self) -> float:
        """||residual|| / ||amplitudes|| at the points; 0 if all targets are 0. For the space between, see `felt`."""
        return self.targets.relative_error(self.sound_pressure)

    @property
    def shape_error(self) -> float:
        """Like `error`, but relative to the best multiple of the targets: the error of the proportions."""
        p, t = np.where(self.targets.beside, 0.0, self.sound_pressure), self.asked
        if not p.any() or not t.any():
            return self.error
        scale = (t.conj() @ p).real / (t.conj() @ t).real
        return _ratio(scale * t - p, scale * t) if scale > 0.0 else 1.0

    @property
    def gap(self) -> float:
        """Objective minus bound [Pa^2], the largest possible distance from the optimum; NaN if there is no bound."""
        return self.objective - self.bound

    def __repr__(self) -> str:
        t = self.targets.amplitudes
        ends = (
            dict.fromkeys(f"{end:.4g}" for end in (t.min(), t.max()))
            if len(t)
            else dict[str, None]()
        )
        asked = f" ({' to '.join(ends)} Pa)" if ends else ""
        held = f", {self.saturation:.0%} at their limit" if self.saturation else ""
        return (
            f"<Solution by {self.solver}: {self.status.name}, error {self.error:.2g} "
            f"at {len(t)} points{asked}, {len(self.gains)} transducers{held}, "
            f"{self.iterations} iterations, {1e3 * self.seconds:.2f} ms>"
        )

    @card
    def _repr_html_(self) -> Card:
        rows = {
            "status": f"{self.status.name}: {self.status.advice}",
            "error at the points": f"{100.0 * self.error:.2g} %; "
            f"of the proportions {100.0 * self.shape_error:.2g} %",
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


def _ratio(part: Complexes, whole: Complexes | Floats) -> float:
    size = float(np.linalg.norm(whole))
    return float(np.linalg.norm(part)) / size if size else 0.0
