"""A custom solver compared with Pacinian's: all foci superposed, with amplitudes limited to full drive."""

import sys

import numpy as np

import pacinian as pc
from pacinian.plot import figure, save


class Superposition(pc.Solver):
    """Adds up one focus for each point, and ignores that foci disturb each other."""

    name = "superposition"

    def solve(
        self,
        propagator: pc.Propagator,
        targets: pc.Targets,
        limits: pc.Limits,
        warm: pc.Solution | None,
        budget: pc.Budget,
        out: pc.Gains,
    ) -> pc.Result:
        """Use conjugate phases, each scaled so that its own focus reaches its target."""
        own = targets.amplitudes / (np.abs(propagator.B) ** 2).sum(axis=1)  # (M,)
        phases = np.exp(2j * np.pi * np.sqrt(np.arange(len(own))))  # different for each point
        out[:] = propagator.adjoint(own * phases)  # B^H y
        return pc.Result()  # the session computes pressures, error and status


array, air = pc.autd(3, 3), pc.Air()
angle = 2.0 * np.pi * np.arange(12) / 12.0
points = np.stack([0.03 * np.cos(angle), 0.03 * np.sin(angle), 0 * angle + 0.2], axis=-1)  # [m]
amplitudes = pc.sound_pressure(np.full(12, 5.0), air)  # peak sound pressure [Pa]
page = figure(6.0, 3.0)
panel = page.subplots()
solvers: tuple[str | pc.Solver, ...] = (Superposition(), "gs-pat", "auto")
for k, solver in enumerate(solvers):
    solution = pc.solve(array, points, amplitudes, solver=solver, medium=air)
    P = pc.radiation_pressure(solution.sound_pressure, air)
    print(f"{solution.solver:14} error {solution.error:8.3%}   {P.min():.2f} to {P.max():.2f} Pa")
    panel.bar(
        np.arange(12) + 0.27 * (k - 1), P, 0.25, label=f"{solution.solver}, {solution.error:.1%}"
    )
panel.axhline(5.0, color="0.3", lw=0.8, ls="--", label="asked")
panel.set(xlabel="control point", ylabel="radiation pressure [Pa]", title="Twelve points of 5 Pa")
panel.set(xlim=(-0.6, 11.6), ylim=(0.0, 8.0), xticks=range(12))
panel.legend(fontsize=7, loc="upper right", ncols=2)
save(page, sys.argv[1] if len(sys.argv) > 1 else "custom_solver.png")
