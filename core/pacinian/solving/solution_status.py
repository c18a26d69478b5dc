"""How a solve ended."""

from __future__ import annotations

from enum import Enum


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
