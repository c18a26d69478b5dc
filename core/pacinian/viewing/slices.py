"""Computes the field in planes and boxes, in another process: see field_process.py."""

from __future__ import annotations

import asyncio
import functools
import math
import pickle
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.acoustics.interpolated_field import RegularGrid
from pacinian.errors import ArgumentError
from pacinian.viewing.field_process import FieldProcess, ProcessEnded
from pacinian.viewing.messages import Skin, Slice, Volume

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.types import Complexes, Floats, Gains
    from pacinian.viewing.hub import Drive
    from pacinian.viewing.messages import FieldRequest
    from pacinian.viewing.region_error import Regions

MAX_PAIRS = 5e7  # maximum number of point-transducer pairs per batch: 0.1 s of processor time
# Niceness of the process: it gets a tenth of the processor time of others. With a hundredth, the pictures would stop.
FIELD_NICENESS = 10
MAX_FIELDS = 16  # maximum number of fields that are computed for one slice
NEGLIGIBLE = 1e-5  # share of the power of all frames that may be left out


def make_grid(asked: FieldRequest) -> RegularGrid:
    """Return the grid of the requested points, in the order of the reply."""
    if isinstance(asked, Volume):
        steps = tuple(tuple(row) for row in (asked.spacing * np.eye(3)).tolist())
        return RegularGrid(asked.origin, steps, asked.shape)
    down, right = (
        length / count * np.array(along)
        for length, count, along in zip(
            asked.size[::-1], asked.shape, (asked.v, asked.u), strict=True
        )
    )
    rows, columns = asked.shape
    first = np.array(asked.centre) - (rows - 1) / 2.0 * down - (columns - 1) / 2.0 * right
    return RegularGrid(
        tuple(first.tolist()), (tuple(down.tolist()), tuple(right.tolist())), asked.shape
    )


class FieldWorker:
    """Computes fields for all pages, in batches, so that the pages take turns."""

    def __init__(self) -> None:
        self._process: FieldProcess | None = None
        self._thread = ThreadPoolExecutor(1, "slices")  # waits for the process
        self._closed = False
        self._rough: deque[RegularGrid] = deque(maxlen=16)  # grids too inexact to interpolate

    async def pressure(
        self, asked: FieldRequest, drive: Drive, wanted: Callable[[], bool]
    ) -> bytes | None:
        """Return the radiation pressure or its error, float32 [Pa], in the order of the reply.

        The request says whether the mean, the maximum or the last of the frames of `drive` counts. For a `Skin` the
        reply is the pressure on regions, then its target. Pressures are NaN on a transducer, errors away from regions.
        Returns None as soon as the result is no longer `wanted`. Raises ArgumentError.
        """
        where, drive = make_grid(asked), drive.choose_frames(asked)
        count = math.prod(where.shape)
        if isinstance(asked, Skin) or (isinstance(asked, Slice) and asked.of == "error"):
            skin = isinstance(asked, Skin)
            if drive.regions is None or not drive.gains:
                return np.full((1 + skin) * count, np.nan, np.float32).tobytes()
            across = tuple(np.cross(asked.u, asked.v).tolist())
            return await self._run(compute_on_regions, drive, where, across, drive.regions, skin)
        peak = asked.over == "peak"
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
            process = self._start()
            call = functools.partial(process.call, work, drive.model.packed, drive.gains, *about)
            try:
                return await loop.run_in_executor(self._thread, call)
            except ProcessEnded:
                if process is self._process:
                    self._process = None
        raise ArgumentError(
            "slice", "cannot be computed: the process that computes it was killed twice"
        )

    def _start(self) -> FieldProcess:
        """Start the other process, if there is none."""
        if self._closed:
            raise ArgumentError("slice", "cannot be computed: the viewer ends")
        if self._process is None:
            self._process = FieldProcess(FIELD_NICENESS)
        return self._process

    def close(self) -> None:
        """Kill the process, whatever it does. Start no other."""
        self._closed = True
        self._thread.shutdown(wait=False, cancel_futures=True)
        if self._process is not None:
            self._process.kill()


def interpolate_pressure(
    model: bytes, gains: bytes, where: RegularGrid, peak: bool = False
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
            p = where.interpolate_field(array, g, medium)
        if p is None:
            return b""
        fields.append(p)
    if peak:
        made = (radiation_pressure(np.tensordot(row, fields, 1), medium) for row in shares)
        return functools.reduce(np.maximum, made).astype(np.float32).tobytes()
    total = sum(radiation_pressure(p, medium) for p in fields)
    return np.asarray(total / len(shares), np.float32).tobytes()


def compute_pressure(
    model: bytes, gains: bytes, where: RegularGrid, begin: int, end: int, peak: bool = False
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
    where: RegularGrid,
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
def _points(where: RegularGrid) -> Floats:
    return where.points.reshape(-1, 3)
