"""Evidence for given gains, for example rounded ones, computed in double precision, and also between the points."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.acoustics.propagation import matrix
from pacinian.solving.error_lower_bound import least_error
from pacinian.solving.felt_places import FeltPlaces
from pacinian.solving.loudest_places import find_peak
from pacinian.solving.propagator import Propagator
from pacinian.solving.solution_check import (
    compute_bound,
    compute_reached_multiple,
    measure_violations,
    relative_error,
)
from pacinian.solving.solution_status import (
    TOLERANCE,
    Status,
    determine_status,
    determine_status_between_points,
)

if TYPE_CHECKING:
    from pacinian.solving.limits import Limits
    from pacinian.solving.solution import Solution
    from pacinian.types import Complexes


def certify(
    propagator: Propagator, last: Solution, limits: Limits, g: Complexes, over_phases: bool
) -> Solution:
    """Return the solution `last` for other gains g, (N,), complex128; see `Session.certify`.

    propagator: holds the points of `last`. limits: those that it was solved with.
    """
    points, facing = propagator.points, propagator.facing
    B = matrix(propagator.array, points, propagator.medium)
    if facing is not None:
        B *= facing.weights(points, propagator.array.positions)
    p: Complexes = B @ g
    least = math.nan
    if over_phases and limits.gain is not None and last.targets.norm:
        counts = ~last.targets.beside
        least = least_error(limits.gain * B[counts], last.targets.amplitudes[counts])
    quiet_subspace = propagator.quiet_subspace
    if quiet_subspace is not None:
        quiet_subspace.leave_out(
            B, points
        )  # the multipliers belong to B without the excluded subspace
    y, proven = last.multipliers, math.nan
    # a pressure of 0 has no phase: use that of its multiplier
    phases = np.angle(p if y is None else np.where(p == 0.0, y, p))
    asked = last.targets.complex(phases if last.asked_phases is None else last.asked_phases)
    if y is not None and last.targets.scale == "exact":
        proven = compute_bound(B, asked, y, last.mu, limits.gain, last.weights)
    rest = asked - p
    missed_by = float(np.vdot(rest, last.weights * rest).real)
    objective = (missed_by + last.mu * float(np.vdot(g, g).real)) / 2.0
    if last.targets.scale == "max":
        objective = math.nan
    quiet = propagator.quiet
    at_quiet = None if quiet is None else matrix(quiet.array, quiet.points, quiet.medium) @ g
    violations = measure_violations(propagator, limits, last.targets, p, g, at_quiet)
    for zone in limits.zones:
        loudest = find_peak(propagator.array, propagator.medium, g, zone, points)
        if (over := loudest / zone.pressure - 1.0) > TOLERANCE:
            violations["zones"] = max(over, violations.get("zones", over))
    certified = dataclasses.replace(
        last,
        gains=g,
        sound_pressure=p,
        status=determine_status(
            propagator,
            last.targets,
            relative_error(last.targets, p),
            limit_violated=bool(violations),
            deadline_passed=last.status is Status.deadline,
            scaled=last.status is Status.scaled,
            limited=last.status is Status.limited,
            maybe_suboptimal=last.status is Status.approximate,
        ),
        bound=proven,
        objective=objective,
        violations=violations,
        least_error=least,
    )
    return add_felt(propagator, certified)


def add_felt(propagator: Propagator, solution: Solution) -> Solution:
    """Return `solution` with `felt` filled in and a status that also holds between the points.

    propagator: holds its points.
    """
    targets = solution.targets
    if targets.regions is None or not targets.norm:
        return solution
    between = Propagator(propagator.array, propagator.medium, propagator.precision)
    places = FeltPlaces.between_samples(
        propagator.points, targets, propagator.facing
    ).set_points_of(between)
    p = between.apply(solution.gains)
    multiple = (
        1.0
        if targets.scale == "exact"
        else compute_reached_multiple(targets, solution.sound_pressure)
    )
    felt = places.measure_felt(p, multiple)
    status = determine_status_between_points(
        solution.status, felt, limited=targets.scale == "max" or solution.saturation > 0.0
    )
    return dataclasses.replace(solution, felt=felt, status=status)
