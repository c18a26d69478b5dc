"""Minimises over all phases and amplitudes at once by L-BFGS."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib import import_module
from typing import TYPE_CHECKING, Annotated, ClassVar, NamedTuple

import numpy as np
from msgspec import Meta

import pacinian as pc
from pacinian.argument_checks import check_integer, check_number
from pacinian.solving.phases import choose_phases
from pacinian.solving.solution_metrics import AT_LIMIT
from pacinian.solving.target_scaling import scale_targets

if TYPE_CHECKING:
    from collections.abc import Iterable

    from scipy import optimize

    from pacinian.types import Complexes, Floats

MIN_DECREASE = 1e-5  # relative decrease of f in one step below which it ends
MAX_TARGET = 100.0  # largest targets, as a multiple of a focus
MAX_START = 0.99  # largest |h| at the start, because the sine is flat at 1
MAX_GRAM_POINTS = 256  # points above which the Gram matrix costs more than the steps that it saves
MAX_PROPORTION_ERROR = 1e-3  # error up to which `scale="max"` counts proportions as kept
MAX_ROUNDS = 12  # maximum number of times that targets are lowered for `scale="max"`


@dataclass(frozen=True)
class Lbfgs(pc.Solver):
    """Quasi-Newton descent on phases and amplitudes of all transducers, as in levitate's `minimize`.

    steps: maximum number of steps. tolerance: error || |p| - t || / ||t|| at which it ends. memory: number of
    past steps and gradients that are kept.

    Minimises 1/2 sum_m (|p_m| - t_m)^2, with |p_m - t_m exp(j phi_m)|^2 where a phase is fixed, by SciPy's
    L-BFGS (Byrd, Lu, Nocedal & Zhu, SIAM J. Sci. Comput. 16(5), 1995). Gains are limit sin(v_n) exp(j theta_n),
    which keeps the limit without bounds (levitate bounds the amplitudes; this is slower and no better). It starts
    from back-propagation with Gerchberg-Saxton phases, or from the last gains, and ends in a local minimum.
    `scale="max"`: starts with targets as strong as one focus and lowers them until they are met within 0.1 %.
    """

    name: ClassVar[str] = "lbfgs"
    linear: ClassVar[bool] = True

    steps: Annotated[int, Meta(ge=1, le=10_000)] = 1000
    tolerance: Annotated[float, Meta(gt=0.0, le=1.0)] = 1e-5
    memory: Annotated[int, Meta(ge=1, le=100)] = 10

    def __post_init__(self) -> None:
        # Only here, because all solvers are imported before the first client; and no solve should wait for it.
        import_module("scipy.optimize")
        object.__setattr__(self, "steps", check_integer("steps", self.steps, low=1))
        tolerance = check_number("tolerance", self.tolerance, low=0.0, high=1.0, above=True)
        object.__setattr__(self, "tolerance", tolerance)
        object.__setattr__(self, "memory", check_integer("memory", self.memory, low=1))

    def solve(
        self,
        propagator: pc.Propagator,
        targets: pc.Targets,
        limits: pc.Limits,
        warm: pc.Solution | None,
        budget: pc.Budget,
        out: pc.Gains,
    ) -> pc.Result:
        """Write the gains; see `pacinian.Solver.solve`."""
        B = propagator.B
        parts = B.view(B.real.dtype)
        d = np.einsum("mn,mn->m", parts, parts).astype(np.float64)  # (M,) of B B^H [Pa^2]
        t = np.where(d > 0.0, targets.amplitudes, 0.0)
        if not t.any():
            return pc.Result(note="no transducer reaches the points")
        reach = float(np.sqrt(B.shape[1] * d[t > 0.0]).mean())  # [Pa] of a focus at full drive
        t, unit = scale_targets(t, reach, targets.scale, limits.gain, MAX_TARGET)
        objective = Objective(
            propagator, t, targets.phases, self.tolerance * float(np.linalg.norm(t))
        )
        near = warm is not None and 1e-6 < float(np.abs(warm.gains).max()) / unit < 1e6
        h = warm.gains / unit if warm is not None and near else None
        if h is None:
            M = len(B)
            p = targets.complex(np.pi * np.arange(M) ** 2 / M)
            p = choose_phases(propagator, targets, None) if M <= MAX_GRAM_POINTS else p
            z = np.exp(1j * np.angle(p)) * (t / np.where(d > 0.0, d, 1.0))
            h = objective.back(np.asarray(z, np.complex128))
        end = self._descend(objective, h, budget)
        steps = end.steps
        if targets.scale == "max":
            for _ in range(MAX_ROUNDS):
                if end.late or end.error <= MAX_PROPORTION_ERROR:
                    break
                objective = replace(objective, t=objective.t * (1.0 - end.error))
                end = self._descend(objective, end.h, budget)
                steps += end.steps
        out[:] = unit * end.h
        at_limit = unit == limits.gain and float(np.abs(end.h).max()) >= AT_LIMIT
        return pc.Result(iterations=steps, limited=at_limit, late=end.late)

    def _descend(self, objective: Objective, h: Complexes, budget: pc.Budget) -> End:
        """Descend from h, (N,), to a local minimum, or until the budget is spent."""
        from scipy import optimize

        late = False

        def stop_if_done(intermediate_result: optimize.OptimizeResult) -> None:
            nonlocal late
            late = budget.spent
            if late or intermediate_result.fun <= 0.5:
                raise StopIteration

        start = np.concatenate([np.arcsin(np.minimum(np.abs(h), MAX_START)), np.angle(h)])
        result = optimize.minimize(
            objective.value, start, method="L-BFGS-B", jac=True, callback=stop_if_done,
            options={
                "maxiter": self.steps, "maxfun": 2 * self.steps, "maxcor": self.memory,
                "ftol": MIN_DECREASE, "gtol": 0.0,
            },
        )  # fmt: skip
        error = self.tolerance * float(np.sqrt(2.0 * result.fun))
        return End(Objective.gains(result.x), error, int(result.nit), late)


class End(NamedTuple):
    """Outcome of a descent."""

    h: Complexes  # (N,), |h| <= 1
    error: float  # || |p| - t || / ||t||
    steps: int
    late: bool


@dataclass(frozen=True, eq=False)
class Objective:
    """The objective f of v and theta, and its gradient.

    t: targets, (M,) [Pa] at |h| = 1. phases: (M,), NaN where free. unit: residual at which f = 1/2 [Pa].
    """

    propagator: pc.Propagator
    t: Floats
    phases: Floats
    unit: float

    @staticmethod
    def gains(x: Floats) -> Complexes:
        """Return h = sin(v) exp(j theta), (N,), for x = v, theta, (2 N,)."""
        v, theta = np.split(x, 2)
        return np.asarray(np.sin(v) * np.exp(1j * theta))

    def value(self, x: Floats) -> tuple[float, Floats]:
        """Return f = 1/2 ||r||^2 and df/dx. With B^H r = y, df = Re(y^H dh)."""
        v, theta = np.split(x, 2)
        sine, turn = np.sin(v), np.exp(1j * theta)
        p = self.propagator.apply(sine * turn).astype(np.complex128)
        angle = np.where(np.isnan(self.phases), np.angle(p), self.phases)
        r = (p - self.t * np.exp(1j * angle)) / self.unit
        s = self.propagator.adjoint(r).conj() * turn
        slope = np.concatenate([s.real * np.cos(v), -s.imag * sine], dtype=np.float64) / self.unit
        return float(np.vdot(r, r).real) / 2.0, slope

    def back(self, z: Complexes) -> Complexes:
        """Return the multiple of B^H z whose pressures are as strong as t."""
        h = self.propagator.adjoint(z)
        made = np.abs(self.propagator.apply(h)).astype(np.float64)
        square = float(made @ made)
        return h * (float(made @ self.t) / square if square else 0.0)


@pc.hookimpl
def register_solvers() -> Iterable[type[pc.Solver]]:
    """Return this plug-in's solver."""
    return [Lbfgs]
