"""Ramps: pressures rise and fall without a jump, whatever happens to their samples."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from pacinian.neighbours import find_nearest
from pacinian.scene.sampling.samples import Samples, join_samples, no_samples

if TYPE_CHECKING:
    from pacinian.scene.objects import Object
    from pacinian.types import Flags, Floats, Indices

JUMP = 0.02  # a sample that moves farther than this in one tick fades out there and rises anew here [m]
MAX_TICK = 0.02  # longest time that one tick counts for, because time may jump [s]
QUARTER = math.pi / 2.0  # a quarter turn [rad]
MIN_PRESSURE = 1e-300  # prevents division by zero [Pa]
RAMP_TOLERANCE = 1e-6  # margin for rounding, as a fraction of a ramp, so that a ramp ends on time


class PressureRamps:
    """Follows the target samples, while each pressure takes at least `ramp` [s] from 0 to its maximum.

    The ramp is a raised cosine over time, so that its slope begins and ends at 0. The maximum is the full pressure of
    the object, or the current pressure if that is higher. A sample that is no longer a target fades out at its last
    position. With `ramp` 0, the pressures follow at once. The samples of a region change when the region moves over
    the skin or is sampled more finely. The new samples then start from the pressure that was there, and the old ones
    end.
    """

    def __init__(self, ramp: float) -> None:
        self.ramp = ramp
        self._asked: Samples | None = None
        self._last = no_samples()
        self._time = -math.inf
        self._ghosts = 0

    @property
    def settled(self) -> bool:
        """Whether all pressures have reached their targets."""
        return self._last is self._asked

    def follow(self, asked: Samples, t: float) -> Samples:
        """Return the samples at time t [s]: the object `asked` itself once all ramps have ended."""
        seconds = min(max(t - self._time, 0.0), MAX_TICK) if self._time > -math.inf else 0.0
        self._time = t
        if self.ramp == 0.0 or (asked is self._asked and self.settled):
            self._asked = self._last = asked
            return asked
        self._asked = asked
        share = (
            seconds / self.ramp * (1.0 + RAMP_TOLERANCE)
        )  # part of a full ramp that this tick covers
        last = self._last
        was, top, gone, jumped = _match_samples(asked, last)
        most = np.maximum(asked.most, np.where(was > asked.radiation_pressure, top, was))
        low, high = _on(was, most, -share), _on(was, most, share)
        P = np.minimum(np.maximum(asked.radiation_pressure, low), high)
        going = self._fade_out(last, gone, jumped, share) if gone.any() else None
        if going is None and (asked.radiation_pressure == P).all():
            self._last = asked
        else:
            self._last = replace(asked, radiation_pressure=P, most=most)
        if going is not None:
            self._last = _with(self._last, going)
        return self._last

    def _fade_out(self, last: Samples, gone: Flags, jumped: Flags, share: float) -> Samples | None:
        """Return the fading samples, one step fainter; None if none are left.

        A fading sample keeps its key, so that it rises from its current pressure if it becomes a target again. If its
        target has jumped to another position, it gets a new key.
        """
        P = last.radiation_pressure
        P = _on(P, np.maximum(last.most, P), -share)
        left = gone & (P > 0.0)
        if not left.any():
            return None
        going = last.only(left)
        keys, new = going.keys.copy(), jumped[left]
        count = int(new.sum())
        keys[new] = -1 - self._ghosts - np.arange(count)
        self._ghosts += count
        return replace(going, radiation_pressure=P[left], keys=keys)


def _on(P: Floats, most: Floats, share: float) -> Floats:
    """Advance pressures, (M,), by `share` of a full ramp from 0 to `most`. The ramp is the square of a sine."""
    if not share:
        return P
    way = np.arcsin(np.sqrt(P / np.maximum(most, MIN_PRESSURE))) / QUARTER
    return np.asarray(most * np.sin(QUARTER * np.clip(way + share, 0.0, 1.0)) ** 2)


def _match_samples(asked: Samples, last: Samples) -> tuple[Floats, Floats, Flags, Flags]:
    """Match the target samples `asked` with the last ones.

    Returns the last pressure and maximum of each target, 0 for new ones, and which of the last samples are gone and
    which have jumped.
    """
    jumped = np.zeros(len(last), dtype=np.bool_)
    if len(asked) == len(last) and (asked.keys == last.keys).all():
        near = _find_near(asked.positions, last.positions)
        was, top = (np.where(near, x, 0.0) for x in (last.radiation_pressure, last.most))
        return was, top, ~near, ~near
    gone = np.ones(len(last), dtype=np.bool_)
    if not (len(last) and len(asked)):
        return np.zeros(len(asked)), np.zeros(len(asked)), gone, jumped
    order = np.argsort(last.keys, kind="stable")
    place = np.minimum(np.searchsorted(last.keys, asked.keys, sorter=order), len(last) - 1)
    index = order[place]
    found = last.keys[index] == asked.keys
    near = found & _find_near(asked.positions, last.positions[index])
    jumped[index[found & ~near]] = True
    gone[index[near]] = False
    was, top = (np.where(near, x[index], 0.0) for x in (last.radiation_pressure, last.most))
    new = np.flatnonzero(~found & (asked.regions >= 0))
    if len(new):
        under = _under(asked.only(new), last)
        there = under >= 0
        new, under = new[there], under[there]
        was[new] = np.minimum(asked.radiation_pressure[new], last.radiation_pressure[under])
        top[new] = was[new]
    left = np.flatnonzero(gone & ~jumped & (last.regions >= 0))
    if len(left):
        gone[left[_under(last.only(left), asked) >= 0]] = False
    return was, top, gone, jumped


def _under(samples: Samples, others: Samples) -> Indices:
    """Find for each sample the nearest of `others` in its region, if the sample lies on its area; else -1."""
    found = np.full(len(samples), -1, dtype=np.intp)
    for region in np.unique(samples.regions).tolist():
        own, there = (np.flatnonzero(s.regions == region) for s in (samples, others))
        if len(there):
            away, which = find_nearest(others.positions[there], samples.positions[own])
            nearest = there[which]
            on = away**2 <= others.area[nearest]
            found[own] = np.where(on, nearest, -1)
    return found


def _find_near(a: Floats, b: Floats) -> Flags:
    """Return which of the points, (M, 3) [m], have not jumped, (M,)."""
    d = a - b
    return np.asarray(np.einsum("mk,mk->m", d, d) <= JUMP * JUMP)


def _with(asked: Samples, going: Samples) -> Samples:
    """Join the targets and the fading samples. Objects that have left the scene follow the scene's."""
    items = asked.items
    extra: list[Object] = []
    used, objects = np.unique(going.objects, return_inverse=True)
    for n, i in enumerate(used.tolist()):
        item = going.items[i]
        if i >= len(items) or not _same(item, items[i]) or not _alike(item, items[i]):
            used[n] = len(items) + len(extra)
            extra.append(item)
    if extra:
        items = (*items, *extra)
    going = replace(going, objects=used[objects], items=items)
    return join_samples([replace(asked, items=items), going])


def _alike(item: Object, other: Object) -> bool:
    """Return whether two objects have equal envelopes and techniques."""
    return item.envelope == other.envelope and item.technique == other.technique


def _same(item: Object, other: Object) -> bool:
    return item is other or (bool(item.name) and item.name == other.name)
