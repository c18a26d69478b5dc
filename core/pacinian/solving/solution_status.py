"""How a solve ended: the statuses, and the rules and tolerances that decide which one a solution has."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pacinian.solving.felt_figures import FeltRegion
    from pacinian.solving.propagator import Propagator
    from pacinian.solving.targets import Targets

TOLERANCE = 1e-3  # largest relative error at which targets and limits count as met
# Largest relative error of the sound pressure at which targets of regions count as met; that of their radiation
# pressure is then 10 %.
REGION_TOLERANCE = 0.05


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
        "the limits cannot all be kept (see `violations`), or a target is in a quiet zone, so this is the best "
        "compromise; lower the amplitudes, move the quiet points or zones, or ask for fewer exact samples"
    )
    deadline = "the deadline passed: this is the best result so far"
    failed = "no usable result, so the gains are zero; try solver 'pseudo-inverse'"

    @property
    def advice(self) -> str:
        """Meaning of the status, and what to do."""
        return self.value


def determine_status(
    propagator: Propagator,
    targets: Targets,
    relative_error: float,
    *,
    limit_violated: bool,
    deadline_passed: bool,
    scaled: bool,
    limited: bool,
    maybe_suboptimal: bool = False,
) -> Status:
    """Return the status, given the relative error at the points and reports of the solver and of the limits.

    scaled: the gains were scaled down to the limits. limited: a limit held the solver back. maybe_suboptimal: with
    `scale="max"`, stronger gains may exist. A target in a quiet zone counts as a violated limit, because gains make no
    sound there.
    """
    if not targets.norm:
        return Status.silent
    if limit_violated or _has_target_in_zone(propagator, targets):
        return Status.deadline if deadline_passed else Status.infeasible
    if targets.scale == "max":
        if deadline_passed:
            return Status.deadline
        if maybe_suboptimal:
            return Status.approximate
        scaled = False
    if relative_error <= (TOLERANCE if targets.regions is None else REGION_TOLERANCE):
        return Status.ok
    unheard = (targets.amplitudes > 0.0) & (propagator.powers == 0.0)  # or they underflow
    if unheard.any() and not propagator.B[unheard].any(axis=1).all():
        return Status.unreachable
    if deadline_passed:
        return Status.deadline
    if scaled:
        return Status.scaled
    return _explain_miss(limited=limited)


def determine_status_between_points(
    at_points: Status, felt: Iterable[FeltRegion], *, limited: bool
) -> Status:
    """Return the status of a solution for regions: `ok` only if each region is within tolerance between its points.

    at_points: status from `determine_status`. felt: what is felt of each region. limited: a limit holds the gains back.
    """
    if at_points is not Status.ok or all(region.even for region in felt):
        return at_points
    return _explain_miss(limited=limited)


def _explain_miss(*, limited: bool) -> Status:
    """Return the status of a solution that misses its targets for no other reason than a limit or the solver."""
    return Status.limited if limited else Status.approximate


def _has_target_in_zone(propagator: Propagator, targets: Targets) -> bool:
    """Return whether any target that is not 0 is in a quiet zone, where gains make no sound."""
    quiet_subspace = propagator.quiet_subspace
    return quiet_subspace is not None and bool(
        targets.amplitudes[quiet_subspace.holds(propagator.points)].any()
    )
