"""The renderer's part of the published state: the emitted pressures and the condition of the loop."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec.structs import asdict

from pacinian.acoustics.pressure import radiation_pressure
from pacinian.errors import shorten
from pacinian.region_numbers import BESIDE
from pacinian.rendering.zone_limit import TOO_COARSE
from pacinian.scene.sampling.hand_tracking import extrapolate_seen, is_gone
from pacinian.scene.sampling.sample_counts import label_object
from pacinian.serving.render.touch_report import find_touches

if TYPE_CHECKING:
    from pacinian.rendering.renderer import Renderer
    from pacinian.scene.hands.hand import Hand
    from pacinian.types import Floats

# Number of measurements averaged for `felt`. They take about a second together.
AVERAGED_MEASUREMENTS = 20
UNKNOWN = (math.nan,) * 4
FINER = "Select a device with more levels, or move the zones away from the array"
MAX_FAULTS = 5  # largest number of faults reported
TICK_BIN_EDGES = 10.0 ** (
    np.arange(1, 64) / 16.0 - 5.0
)  # edges between the bins of `State.tick_counts` [s]


def make_status(renderer: Renderer, t: float) -> dict[str, Any]:
    """Return fields of `pacinian.wire.state.State` at time t [s] of the scene."""
    report, ticks = renderer.report, np.sort(renderer.report.recent(round(1.0 / renderer.period)))
    hands, faults = find_hands(renderer, t), list(report.faults)[-MAX_FAULTS:]
    return {
        **_make_sample_fields(renderer, hands),
        **_describe_zones(renderer),
        "solver": shorten(renderer.session.solver.name),
        "hands": b"".join(hand.joints.astype("<f4").tobytes() for hand in hands if hand.joints is not None),
        "ticks": report.ticks,
        "late": report.late_ticks,
        "rate": 1.0 / renderer.period,
        "tick_ms": _compute_quantiles(ticks),
        "tick_counts": _count_ticks(ticks),
        "frames": report.frames_sent,
        "skipped": dict(report.skipped),
        "faults": tuple(shorten(f"{fault.stage}: {fault.message}")[:200] for fault in faults),
        "fault_count": report.fault_count,
    }  # fmt: skip


def find_hands(renderer: Renderer, t: float) -> list[Hand]:
    """Return the hands at time t [s] of the scene, without those that are lost or were last seen long ago."""
    return [
        extrapolate_seen(hand, t) for hand in renderer.newest_scene.hands if not is_gone(hand, t)
    ]


def _make_sample_fields(renderer: Renderer, hands: list[Hand]) -> dict[str, Any]:
    """Return the samples and the pressures on them, at full envelope."""
    play, solution, samples = renderer.played, renderer.solution, renderer.samples
    if renderer.halted is not None or solution is None or samples is None:
        return {}
    if not len(samples):
        return {"status": solution.status.name}
    targets, p = play.targets, renderer.sample_pressures
    assert targets is not None
    error, shown = targets.relative_error(p), samples.regions != BESIDE
    samples, p = samples.only(shown), p[shown]
    used, index = np.unique(samples.objects, return_inverse=True)
    return {
        "points": samples.positions.astype("<f4").tobytes(),
        "normals": samples.normals.astype("<f4").tobytes(),
        "asked": samples.radiation_pressure.astype("<f4").tobytes(),
        "achieved": radiation_pressure(p, renderer.session.medium).astype("<f4").tobytes(),
        "index": index.astype("<i4").tobytes(),
        "objects": tuple(samples.items[i].name for i in used.tolist()),
        "error": error,
        "felt": _encode_felt(renderer, [label_object(samples.items[i], i) for i in used.tolist()]),
        "status": solution.status.name,
        "touches": tuple(asdict(touch) for touch in find_touches(samples, hands)),
    }


def _describe_zones(renderer: Renderer) -> dict[str, Any]:
    """Return a status if quiet zones silence the output, or are louder than their limit, and why."""
    quiet_subspace, solution = renderer.session.propagator.quiet_subspace, renderer.solution
    if quiet_subspace is None or not renderer.played.rows:
        return {}
    gains = renderer.cycle_gains
    limited = any(one.limited_in_zones for one in renderer.played.rows)
    if limited and not gains.any():
        return {"status": f"silent: {TOO_COARSE}. {FINER}"}
    rows = renderer.last_frame.gains(renderer.backend.capability)  # with envelopes
    loudest = quiet_subspace.measure_excess(np.concatenate([gains, rows]))
    if loudest <= 1.0:
        return {}
    rounded = solution is not None and quiet_subspace.bound_excess(solution.gains) <= 1.0
    reason = ", because levels and numbers are rounded" if rounded else ""
    return {"status": f"quiet zones {20.0 * math.log10(loudest):.1f} dB above their limit{reason}"}


def _encode_felt(renderer: Renderer, labels: list[str]) -> bytes:
    """Return force, rms, holes and spill of each object, over the last measurements."""
    felt = renderer.report.compute_felt(AVERAGED_MEASUREMENTS)
    figures = [felt.get(label, UNKNOWN) for label in labels]
    return np.array(figures, dtype="<f4").tobytes()


def _count_ticks(ticks: Floats) -> bytes:
    """Return the number of sorted times (T,) [s] in each bin."""
    below = np.searchsorted(ticks, TICK_BIN_EDGES)
    return np.diff(below, prepend=0, append=len(ticks)).astype("<u4").tobytes()


def _compute_quantiles(ticks: Floats) -> tuple[float, float, float]:
    """Return median, 99th percentile and maximum [ms] of sorted times (T,) [s]."""
    if not len(ticks):
        return 0.0, 0.0, 0.0
    last = len(ticks) - 1
    at = ticks[[last // 2, round(0.99 * last), last]]
    x, y, z = (1e3 * at).tolist()
    return x, y, z
