"""What comes back: gains, and the evidence of how good they are."""

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


AT_LIMIT = 1.0 - 1e-5  # of the gain limit: from here a transducer is at it


class Status(Enum):
    """How a solve ended; the value is advice."""

    ok = "the targets are met"
    silent = "nothing is asked: all gains are zero"
    approximate = (
        "not all targets are met, with no limit reached: "
        "the points are closer than the array can resolve, or the solver is approximate; "
        "or as strong as possible was asked, and it may be weaker"
    )
    limited = (
        "transducers are at their limit: these are the nearest pressures that it allows; "
        "lower the amplitudes, or add units"
    )
    scaled = (
        "over the limits, so scaled down as a whole: proportions are kept, strength is not; "
        "lower the amplitudes, or use solver 'lagrange'"
    )
    unreachable = (
        "some points cannot be reached: no sound of any transducer gets there "
        "(are they behind the array, or does the skin face away from it?)"
    )
    infeasible = (
        "the limits cannot be kept all at once, see `violations`: the best compromise; "
        "lower the amplitudes, move the quiet points, or ask for fewer exact samples"
    )
    deadline = "the time was up: the best answer so far"
    failed = "no usable answer: the gains are zero; try solver 'pseudo-inverse'"

    @property
    def advice(self) -> str:
        """What it means and what to do."""
        return self.value


@dataclass(frozen=True, eq=False)
class Solution:
    """Gains, and what they achieve.

    gains: (N,), complex64, or complex128 in double precision. targets: what was asked.
    sound_pressure: achieved [Pa], complex, (M,).
    status: how it ended. solver: which. iterations: how many.
    bound: a lower bound of the objective 1/2 ||p - B g||^2 + mu/2 ||g||^2 for the phases found [Pa^2]
    and objective: its value at these gains; NaN where the solver proves none.
    multipliers: y, (M,) [Pa], and mu [Pa^2], from which the bound follows: `Session.certify`.
    violations: of limits that are not kept: "quiet", the loudest point over its limit, less 1 (a limit below
    1 % of full drive counts as that); "exact", the relative error of the samples to be met exactly;
    "gain" and "power", which only `Session.certify` can find broken, over their limits, less 1.
    felt: of each region, what is felt between its samples; where there are regions, from `pacinian.solve` and
    `Session.certify`. gain_limit: of |g_n|; infinity for none. seconds: how long it took [s].
    late: whether the time was up before the solver was done. asked_phases: what the solver was given [rad], (M,),
    where there are regions: to go on from. quiet_weight: of the points beside regions (`Targets.beside`), where others
    have 1, in bound and objective. least_error: no gains within the gain limit have a lower `error`, whatever the
    phases; from `Session.certify`, where that is asked for, else NaN.
    note: what the solver has to say, such as why `auto` chose it.
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
        """The targets [Pa], complex, (M,), with the achieved phase where the phase was free."""
        return self.targets.complex(np.angle(self.sound_pressure))

    @property
    def weights(self) -> Floats:
        """What the squared error at each point counts in objective and bound, (M,)."""
        return np.where(self.targets.beside, self.quiet_weight, 1.0)

    @property
    def saturation(self) -> float:
        """The share of transducers at the gain limit, 0..1."""
        return float((np.abs(self.gains) >= AT_LIMIT * self.gain_limit).mean())

    @property
    def phases(self) -> Floats:
        """The phases achieved [rad], (M,)."""
        return np.asarray(np.angle(self.sound_pressure), np.float64)

    @property
    def residual(self) -> Complexes:
        """Asked less achieved [Pa], complex, (M,); where the phase was free, with the achieved phase."""
        return self.asked - self.sound_pressure

    @property
    def error(self) -> float:
        """||residual|| / ||amplitudes|| at the points; 0 where nothing was asked. Between them: `felt`."""
        return self.targets.relative_error(self.sound_pressure)

    @property
    def shape_error(self) -> float:
        """As `error`, against the best multiple of the targets: whether the proportions are right."""
        p, t = np.where(self.targets.beside, 0.0, self.sound_pressure), self.asked
        if not p.any() or not t.any():
            return self.error
        scale = (t.conj() @ p).real / (t.conj() @ t).real
        return _ratio(scale * t - p, scale * t) if scale > 0.0 else 1.0

    @property
    def gap(self) -> float:
        """Objective - bound [Pa^2]: at most this far from the optimum; NaN where nothing is proven."""
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
        """What was asked, and what is achieved."""
        panel.plot(self.targets.amplitudes, "o", mfc="none", ms=5, label="asked")
        panel.plot(np.abs(self.sound_pressure), ".", ms=4, label="achieved")
        panel.set(xlabel="point", ylabel="sound pressure [Pa]")
        panel.set_ylim(bottom=0.0)
        panel.legend(fontsize=6)


def _ratio(part: Complexes, whole: Complexes | Floats) -> float:
    size = float(np.linalg.norm(whole))
    return float(np.linalg.norm(part)) / size if size else 0.0
