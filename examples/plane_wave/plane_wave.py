"""A solver plug-in: every transducer in phase, at full drive."""

import pacinian as pc


class PlaneWave(pc.Solver):
    """All transducers in phase: a beam, whatever is asked."""

    name = "plane-wave"

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
        out[:] = limits.gain or 1.0
        return pc.Result()


@pc.hookimpl
def register_solvers() -> list[type[pc.Solver]]:
    """This plug-in's solver."""
    return [PlaneWave]
