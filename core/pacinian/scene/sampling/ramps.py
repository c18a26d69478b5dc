"""Ramps: pressures rise and fall without a jump, whatever happens to their samples."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from pacinian.native.scene import ramp
from pacinian.scene.sampling.samples import Samples, join_samples, no_samples

if TYPE_CHECKING:
    from pacinian.scene.objects import Object
    from pacinian.types import Flags, Floats, Indices

RAMP_TIME = 0.005  # fade-in and fade-out time of a sample in a renderer or a server [s]
MAX_RAMPED_MOVE = 0.02  # a sample that moves farther than this in one tick fades out there and rises anew here [m]
MAX_TICK = 0.02  # longest time that one tick counts for, because time may jump [s]
RAMP_TOLERANCE = 1e-6  # margin for rounding, as a fraction of a ramp, so that a ramp ends on time


class PressureRamps:
    """Follows the target samples, while each pressure takes at least `ramp` [s] from 0 to its maximum.

    The ramp is a raised cosine over time, so that its slope begins and ends at 0. The maximum is the full pressure of
    the object, or the current pressure if that is higher. A sample that is no longer a target fades out at its last
    position. With `ramp` 0, the pressures follow at once. The samples of a region change when the region moves over
    the skin or is sampled more finely. The new samples then start from the pressure that was there, and the old ones
    end. When the first hand comes or the last one leaves, all old samples end at once.
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

    def rest_until(self, t: float) -> None:
        """Let the next change begin at time t [s], if all ramps have ended."""
        if self.settled:
            self._time = max(self._time, t)

    def follow(self, asked: Samples, t: float) -> Samples:
        """Return the samples at time t [s]: the object `asked` itself once all ramps have ended."""
        seconds = min(max(t - self._time, 0.0), MAX_TICK) if self._time > -math.inf else 0.0
        self._time = t
        if self.ramp == 0.0 or (asked is self._asked and self.settled):
            self._asked = self._last = asked
            return asked
        self._asked = asked
        if (asked.capsules is None) is not (self._last.capsules is None):
            # A solve for skin cannot produce samples that fade in free air: it would drive the array fully to press on
            # normals that face away. Only the slew-rate limit then softens the end.
            self._last = no_samples()
        # part of a full ramp that this tick covers
        share = seconds / self.ramp * (1.0 + RAMP_TOLERANCE)
        last, M, L = self._last, len(asked), len(self._last)
        P, most = np.empty(M), np.empty(M)
        index, fading, jumped = np.empty(L, np.int64), np.empty(L), np.empty(L, np.bool_)
        count = ramp(
            asked.keys, asked.positions, asked.regions, asked.area, asked.radiation_pressure, asked.most,
            last.keys, last.positions, last.regions, last.area, last.radiation_pressure, last.most,
            share, MAX_RAMPED_MOVE, P, most, index, fading, jumped,
        )  # fmt: skip
        if not count and np.array_equal(asked.radiation_pressure, P):
            self._last = asked
        else:
            self._last = asked.changed(radiation_pressure=P, most=most)
        if count:
            going = self._fade(last, index[:count], fading[:count], jumped[:count])
            self._last = _with(self._last, going)
        return self._last

    def _fade(self, last: Samples, index: Indices, P: Floats, jumped: Flags) -> Samples:
        """Return the samples `index`, (K,), of the last ones that fade out, at their new pressures P, (K,) [Pa].

        A fading sample keeps its key, so that it rises from its current pressure if it becomes a target again. If its
        target has jumped to another position, it gets a new key.
        """
        going = last.only(index)
        keys, count = going.keys, int(jumped.sum())
        keys[jumped] = -1 - self._ghosts - np.arange(count)
        self._ghosts += count
        return going.changed(radiation_pressure=P)


def _with(asked: Samples, going: Samples) -> Samples:
    """Join the targets and the fading samples. Objects that have left the scene are appended to the scene's objects."""
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
    going = going.changed(objects=used[objects], items=items)
    return join_samples([asked.changed(items=items), going])


def _alike(item: Object, other: Object) -> bool:
    """Return whether two objects have equal envelopes and techniques."""
    return item.envelope == other.envelope and item.technique == other.technique


def _same(item: Object, other: Object) -> bool:
    return item is other or (bool(item.name) and item.name == other.name)
