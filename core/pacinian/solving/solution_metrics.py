"""The values of a solution, and what follows from them alone."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native import solving as kernels

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.acoustics.skin_facing import SkinFacing
    from pacinian.solving.felt_figures import FeltRegion
    from pacinian.solving.limits import Limits
    from pacinian.solving.solution_status import Status
    from pacinian.solving.targets import Targets
    from pacinian.types import Complexes, Floats, Gains

AT_LIMIT = 1.0 - 1e-5  # share of the gain limit from which a transducer is at its limit


@dataclass(frozen=True, eq=False)
class SolutionMetrics:
    """The fields of a `pacinian.Solution`; its docstring describes them."""

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
        held = kernels.count_at_limit(np.ascontiguousarray(self.gains), AT_LIMIT * self.gain_limit)
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
        error = f"error {self.error:.2g}"
        if self.targets.scale == "max":
            most = np.abs(self.sound_pressure).max(initial=0.0)
            error = f"up to {most:.4g} Pa, error of the proportions {self.shape_error:.2g}"
        return (
            f"<Solution by {self.solver}: {self.status.name}, {error} "
            f"at {len(t)} point{'' if len(t) == 1 else 's'}{asked}, {len(self.gains)} transducers{held}, "
            f"{self.iterations} iterations, {1e3 * self.seconds:.2f} ms>"
        )


def _ratio(part: Complexes, whole: Complexes | Floats) -> float:
    size = float(np.linalg.norm(whole))
    return float(np.linalg.norm(part)) / size if size else 0.0
