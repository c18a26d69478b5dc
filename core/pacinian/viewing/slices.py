"""Computes the field in planes and boxes, in a separate process of low priority."""

from __future__ import annotations

import asyncio
import functools
import math
import multiprocessing
import os
import pickle
import signal
import sys
import threading
from collections import deque
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.interpolated_field import InterpolatedField
from pacinian.errors import ArgumentError
from pacinian.serving.ipc.scheduling import AUTOGROUP
from pacinian.viewing.messages import Skin, Slice, Volume

if TYPE_CHECKING:
    from collections.abc import Callable
    from multiprocessing.process import BaseProcess

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import Complexes, Floats, Gains
    from pacinian.viewing.hub import Drive
    from pacinian.viewing.region_error import Regions

MAX_PAIRS = 5e7  # maximum number of point-transducer pairs per batch: 0.1 s of processor time
CALM = 10  # niceness of the process: a tenth of what others get, because a hundredth would stop the pictures
MAX_FIELDS = 16  # maximum number of fields that are computed for one slice
NEGLIGIBLE = 1e-5  # share of the power of all frames that may be left out


def make_grid(asked: Slice | Volume) -> InterpolatedField:
    """Return the grid of the requested points, in the order of the reply."""
    if isinstance(asked, Volume):
        steps = tuple(tuple(row) for row in (asked.spacing * np.eye(3)).tolist())
        return InterpolatedField(asked.origin, steps, asked.shape)
    down, right = (
        length / count * np.array(along)
        for length, count, along in zip(
            asked.size[::-1], asked.shape, (asked.v, asked.u), strict=True
        )
    )
    rows, columns = asked.shape
    first = np.array(asked.centre) - (rows - 1) / 2.0 * down - (columns - 1) / 2.0 * right
    return InterpolatedField(
        tuple(first.tolist()), (tuple(down.tolist()), tuple(right.tolist())), asked.shape
    )


class FieldWorker:
    """Computes fields for all pages, in batches, so that the pages take turns."""

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None
        self._closed = False
        self._rough: deque[InterpolatedField] = deque(maxlen=16)  # grids too inexact to interpolate

    async def pressure(
        self, asked: Slice | Volume, drive: Drive, wanted: Callable[[], bool]
    ) -> bytes | None:
        """Return the radiation pressure or its error, float32 [Pa], in the order of the reply.

        The request says whether the mean, the maximum or the last of the frames of `drive` counts. For a `Skin` the
        reply is the pressure on regions, then its target. Pressures are NaN on a transducer, errors away from regions.
        Returns None as soon as the result is no longer `wanted`. Raises ArgumentError.
        """
        where, drive, peak = make_grid(asked), drive.choose_frames(asked), asked.over == "peak"
        count = math.prod(where.shape)
        skin = isinstance(asked, Skin)
        if isinstance(asked, Slice) and (skin or asked.of == "error"):
            if drive.regions is None or not drive.gains:
                return np.full((1 + skin) * count, np.nan, np.float32).tobytes()
            across = tuple(np.cross(asked.u, asked.v).tolist())
            return await self._run(compute_on_regions, drive, where, across, drive.regions, skin)
        if not drive.gains:
            self._start()  # the first field after silence would otherwise wait for its imports
            return bytes(4 * count)
        if where not in self._rough:
            if found := await self._run(interpolate_pressure, drive, where, peak):
                return found
            self._rough.append(where)
        step = max(256, int(MAX_PAIRS / len(drive.model.array)))
        made: list[bytes] = []
        for begin in range(0, count, step):
            if not wanted():
                return None
            made.append(await self._run(compute_pressure, drive, where, begin, begin + step, peak))
        return b"".join(made)

    async def _run(self, work: Callable[..., bytes], drive: Drive, *about: Any) -> bytes:
        """Run `work` in the other process, which is restarted once if it was killed."""
        loop = asyncio.get_running_loop()
        for _ in range(2):
            pool = self._start()
            try:
                made = loop.run_in_executor(pool, work, drive.model.packed, drive.gains, *about)
                # if cancelled work waits when its process is killed, the pool does not end
                return await asyncio.shield(made)
            except BrokenProcessPool:
                if pool is self._pool:
                    self._kill()
        raise ArgumentError("slice", "cannot be computed: the process that does was killed twice")

    def _start(self) -> ProcessPoolExecutor:
        """Start the other process, if there is none."""
        if self._closed:
            raise ArgumentError("slice", "cannot be computed: the viewer ends")
        if self._pool is None:
            context = multiprocessing.get_context("spawn")
            self._pool = ProcessPoolExecutor(1, context, initializer=start_worker, initargs=(CALM,))
            self._pool.submit(os.getpid)  # the pool starts a process when it gets work
        return self._pool

    def close(self) -> None:
        """Kill the process, for otherwise the interpreter would wait for its work at exit. Start no other."""
        self._closed = True
        self._kill()

    def _kill(self) -> None:
        pool, self._pool = self._pool, None
        if pool is not None:
            workers: dict[int, BaseProcess] = getattr(pool, "_processes", None) or {}
            running = list(workers.values())  # as `kill_workers` does since Python 3.14
            pool.shutdown(wait=False, cancel_futures=True)
            for worker in running:
                worker.kill()


def interpolate_pressure(
    model: bytes, gains: bytes, where: InterpolatedField, peak: bool = False
) -> bytes:
    """Interpolate the radiation pressure at all points of a grid, float32 [Pa]; empty if that is too inexact.

    peak: return the maximum over the frames instead of their mean.
    """
    from pacinian.acoustics.pressure import radiation_pressure
    from pacinian.solving.blas import limit_blas_threads

    array, medium = _unpack_model(model)
    basis, shares = compress_gains(_frames(gains, array))
    fields: list[Complexes] = []
    for g in basis:
        with limit_blas_threads():
            p = where.field(array, g, medium)
        if p is None:
            return b""
        fields.append(p)
    if peak:
        made = (radiation_pressure(np.tensordot(row, fields, 1), medium) for row in shares)
        return functools.reduce(np.maximum, made).astype(np.float32).tobytes()
    total = sum(radiation_pressure(p, medium) for p in fields)
    return np.asarray(total / len(shares), np.float32).tobytes()


def compute_pressure(
    model: bytes, gains: bytes, where: InterpolatedField, begin: int, end: int, peak: bool = False
) -> bytes:
    """Return the radiation pressure at points `begin` to `end` of a grid, float32 [Pa]. Raises ArgumentError.

    NaN on a transducer. peak: return the maximum over the frames instead of their mean.
    """
    from pacinian.acoustics.pressure import radiation_pressure
    from pacinian.acoustics.propagation import field
    from pacinian.errors import PointOnTransducer

    array, medium = _unpack_model(model)
    (frames, shares), at = compress_gains(_frames(gains, array)), _points(where)[begin:end]
    found = np.full(len(at), np.nan, np.float32)
    here = np.ones(len(at), np.bool_)
    try:
        p = [field(array, frames[0], at, medium)]
    except PointOnTransducer as error:
        here[list(error.indices)] = False
        p = [field(array, frames[0], at[here], medium)]
    p += [field(array, g, at[here], medium) for g in frames[1:]]
    if peak:
        every = np.array([radiation_pressure(row @ np.array(p), medium) for row in shares])
        found[here] = every.max(axis=0)
    else:
        found[here] = sum(radiation_pressure(each, medium) for each in p) / len(shares)
    return found.tobytes()


def compute_on_regions(
    model: bytes,
    gains: bytes,
    where: InterpolatedField,
    across: tuple[float, ...],
    regions: Regions,
    skin: bool,
) -> bytes:
    """Return the error of the pressure on regions near the points of a grid, float32 [Pa]: `compute_error`.

    skin: return the pressure, then its target, instead of the error.
    """
    from pacinian.viewing.region_error import compute_error, compute_felt_and_asked

    array, medium = _unpack_model(model)
    compute = compute_felt_and_asked if skin else compute_error
    found = compute(
        array, medium, _average_gains(gains, array), _points(where), np.array(across), regions
    )
    return np.asarray(found, np.float32).tobytes()


def compress_gains(frames: Gains) -> tuple[Gains, Gains]:
    """Factor the frames, (K, N), into `basis`, (R, N), and `shares`, (K, R), so that frames = shares @ basis.

    The columns of `shares` are orthonormal. Therefore the mean of |p|^2 over the frames is its sum over the basis,
    divided by K. Components with less than `NEGLIGIBLE` of the total power are left out. If more than `MAX_FIELDS`
    components are needed, for example by a moving focus, only the last `MAX_FIELDS` frames count.
    """
    if len(frames) == 1:
        return frames, np.ones((1, 1), np.complex64)
    power, vectors = np.linalg.eigh(frames.astype(np.complex128) @ frames.conj().T)
    kept = power > NEGLIGIBLE * float(power.sum())
    kept[-1] = True  # the largest, also in silence
    if kept.sum() > MAX_FIELDS < len(frames):
        return compress_gains(frames[-MAX_FIELDS:])
    shares = vectors[:, kept].astype(np.complex64)
    return (shares.conj().T @ frames).astype(np.complex64), shares


def _average_gains(gains: bytes, array: Array) -> Gains:
    """Return fewer frames, (R, N), over which the mean of |p|^2 is the same."""
    basis, shares = compress_gains(_frames(gains, array))
    return np.asarray(math.sqrt(len(basis) / len(shares)) * basis, np.complex64)


def _frames(gains: bytes, array: Array) -> Gains:
    return np.frombuffer(gains, np.complex64).reshape(-1, len(array)).copy()


@functools.lru_cache(maxsize=2)
def _unpack_model(model: bytes) -> tuple[Array, Air]:
    made: tuple[Array, Air] = pickle.loads(model)  # from our own process
    return made


@functools.lru_cache(maxsize=2)
def _points(where: InterpolatedField) -> Floats:
    return where.points.reshape(-1, 3)


def start_worker(nice: int) -> None:
    """Import what fields need, then lower the priority: on a busy machine, imports would else take a minute."""
    from pacinian.acoustics import propagation
    from pacinian.solving import propagator
    from pacinian.viewing import region_error

    del propagation, propagator, region_error
    lower_own_priority(nice)


def lower_own_priority(nice: int) -> None:
    """Lower the priority of this process, and end it with its parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent handles Ctrl-C
    if sys.platform != "win32":
        with suppress(OSError):
            os.setsid()
        os.nice(nice)
    if sys.platform == "linux":
        with suppress(OSError):
            AUTOGROUP.write_text(str(nice))
    threading.Thread(target=_with_parent, daemon=True).start()


def _with_parent() -> None:
    if (parent := multiprocessing.parent_process()) is not None:
        parent.join()
        os._exit(0)
