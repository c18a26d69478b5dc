"""The solution: gains, and evidence of how good they are."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.notebook import Card, card

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pacinian.solving.felt_regions import FeltRegion
    from pacinian.solving.problem import Targets
    from pacinian.types import Complexes, Floats, Gains


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


@dataclass(frozen=True, eq=False)
class Solution:
    """Gains, and the pressures that they achieve.

    gains: (N,), complex64, or complex128 in double precision. targets: the targets of the solve.
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
    """

    gains: Gains
    targets: Targets
    sound_pressure: Complexes
    status: Status
    solver: str
    iterations: int = 0
    bound: float = float("nan")
    objective: float = float("nan")
    multipliers: Complexes | None = None
    mu: float = float("nan")
    violations: Mapping[str, float] = field(default_factory=dict[str, float])
    seconds: float = 0.0
    note: str = ""
    gain_limit: float = math.inf
    felt: tuple[FeltRegion, ...] = ()
    late: bool = False
    asked_phases: Floats | None = None
    quiet_weight: float = 1.0
    least_error: float = math.nan

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
        return float((np.abs(self.gains) >= AT_LIMIT * self.gain_limit).mean())

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
        return (
            f"<Solution by {self.solver}: {self.status.name}, error {self.error:.2g}, "
            f"{len(self.sound_pressure)} points, {len(self.gains)} gains, "
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
