"""Fields of slices and volumes, computed by the real process."""

from __future__ import annotations

import asyncio
import contextlib
import gc
import math
import os
import signal
import struct
import subprocess
import sys
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
import psutil
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.viewing import slices
from pacinian.viewing.array_model import ArrayModel
from pacinian.viewing.hub import Drive
from pacinian.viewing.messages import Slice, Volume
from pacinian.viewing.region_error import Regions, compute_error
from pacinian.viewing.slices import (
    MAX_FIELDS,
    FieldWorker,
    compress_gains,
    compute_pressure,
    interpolate_pressure,
    make_grid,
)

from ..waiting import eventually
from .watching import LIMIT

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from pacinian.acoustics.interpolated_field import RegularGrid

UNIT = pc.autd()
RESPONSE = np.exp(1j * np.linspace(0.0, 6.0, len(UNIT))) * np.linspace(0.5, 1.5, len(UNIT))
ARRAY = pc.Array(UNIT.positions, UNIT.normals, UNIT.transducer, RESPONSE)
AIR = pc.Air(attenuation="absorbing", temperature=25.0)
GAINS = np.exp(1j * np.arange(len(ARRAY))).astype(np.complex64)
DRIVE = Drive(ArrayModel(ARRAY, AIR), GAINS.tobytes(), 1.0)
HERE = Slice(
    id=1, centre=(0.0, 0.01, 0.1), u=(0.0, 1.0, 0.0), v=(0.0, 0.0, 1.0), size=(0.1, 0.06), shape=(30, 40)
)  # fmt: skip


@given(st.floats(-math.pi, math.pi), st.integers(2, 9), st.integers(2, 9))
def test_points_of_a_slice_are_the_middles_of_its_cells(turn: float, rows: int, cols: int) -> None:
    u, v = (math.cos(turn), math.sin(turn), 0.0), (-math.sin(turn), math.cos(turn), 0.0)
    asked = Slice(id=1, centre=(0.1, 0.2, 0.3), u=u, v=v, size=(0.5, 0.2), shape=(rows, cols))
    found = make_grid(asked).points
    assert np.allclose(found.mean(axis=(0, 1)), asked.centre)
    assert np.allclose(found[0, 1] - found[0, 0], 0.5 / cols * np.array(u))
    assert np.allclose(found[1, 0] - found[0, 0], 0.2 / rows * np.array(v))
    corner = np.array(asked.centre) - 0.25 * np.array(u) - 0.1 * np.array(v)
    half = 0.25 / cols * np.array(u) + 0.1 / rows * np.array(v)
    assert np.allclose(found[0, 0], corner + half)


def test_points_of_a_volume_count_the_last_side_fastest() -> None:
    asked = Volume(id=1, origin=(1.0, 2.0, 3.0), spacing=0.5, shape=(2, 3, 4))
    found = make_grid(asked).points.reshape(-1, 3)
    assert found[1].tolist() == [1.0, 2.0, 3.5]
    assert found[4].tolist() == [1.0, 2.5, 3.0]
    assert found[-1].tolist() == [1.5, 3.0, 4.5]


def exactly(asked: Slice | Volume, begin: int = 0, end: int = 1 << 20) -> bytes:
    return compute_pressure(DRIVE.model.packed, DRIVE.gains, make_grid(asked), begin, end)


def test_pressures_are_those_of_the_reference_and_nan_on_a_transducer() -> None:
    on = msgspec.structs.replace(HERE, centre=tuple(ARRAY.positions[7].tolist()), shape=(31, 41))
    for asked in (HERE, on):
        found = np.frombuffer(exactly(asked), "<f4")
        at = make_grid(asked).points.reshape(-1, 3)
        free = np.isfinite(found)
        assert len(found) - free.sum() == (asked is on)
        wanted = pc.radiation_pressure(pc.field(ARRAY, GAINS, at[free], AIR, "double"), AIR)
        assert np.abs(found[free] - wanted).max() < 1e-3 * wanted.max()
    assert np.isnan(found[len(found) // 2])


def workers() -> list[psutil.Process]:
    found = list[psutil.Process]()
    for child in psutil.Process().children():
        with contextlib.suppress(psutil.Error):  # it has just ended
            if "spawn_main" in " ".join(child.cmdline()):
                found.append(child)
    return found


@pytest.fixture
def fields(monkeypatch: pytest.MonkeyPatch) -> Iterator[FieldWorker]:
    monkeypatch.setattr(slices, "FIELD_NICENESS", 1)  # so that no test waits for an idle machine
    made = FieldWorker()
    yield made
    made.close()
    assert not psutil.wait_procs(workers(), LIMIT)[1]


def computed(fields: FieldWorker, *asked: Any, wanted: Any = lambda: True) -> list[bytes | None]:
    async def run() -> list[bytes | None]:
        each = [fields.pressure(one, DRIVE, wanted) for one in asked]
        return list(await asyncio.gather(*each))

    return asyncio.run(run())


def test_the_mean_of_all_frames_is_shown() -> None:
    frames = np.stack([GAINS, np.exp(-0.3j * np.arange(len(ARRAY))).astype(np.complex64)])
    for asked in (HERE, msgspec.structs.replace(HERE, shape=(120, 160))):
        each = [
            np.frombuffer(
                compute_pressure(DRIVE.model.packed, g.tobytes(), make_grid(asked), 0, 1 << 20),
                "<f4",
            )
            for g in frames
        ]
        wanted = np.mean(each, axis=0)
        assert np.abs(each[0] - each[1]).max() > 0.5 * wanted.max()
        whole = compute_pressure(DRIVE.model.packed, frames.tobytes(), make_grid(asked), 0, 1 << 20)
        np.testing.assert_allclose(np.frombuffer(whole, "<f4"), wanted, rtol=1e-5)
    fast = interpolate_pressure(DRIVE.model.packed, frames.tobytes(), make_grid(asked))
    assert np.abs(np.frombuffer(fast, "<f4") - wanted).max() < 4e-3 * wanted.max()
    highest = np.max(each, axis=0)
    for compute, tolerance in ((interpolate_pressure, 4e-3), (at_once, 1e-4)):
        found = np.frombuffer(
            compute(DRIVE.model.packed, frames.tobytes(), make_grid(asked), peak=True), "<f4"
        )
        assert np.abs(found - highest).max() < tolerance * highest.max()


def at_once(model: bytes, gains: bytes, where: RegularGrid, *, peak: bool) -> bytes:
    return compute_pressure(model, gains, where, 0, 1 << 20, peak)


def test_many_frames_of_one_modulation_cost_one_field(fields: FieldWorker) -> None:
    strengths = np.sqrt(0.5 - 0.5 * np.cos(2 * np.pi * np.arange(16) / 16))
    frames = (strengths[:, None] * GAINS).astype(np.complex64)
    basis, shares = compress_gains(frames)
    assert len(basis) == 1
    np.testing.assert_allclose(shares @ basis, frames, atol=1e-5)
    rng = np.random.default_rng(0)
    others = np.exp(1j * rng.uniform(0.0, 6.0, (40, len(ARRAY)))).astype(np.complex64)
    basis, shares = compress_gains(others)
    assert len(basis) == len(shares) == MAX_FIELDS
    np.testing.assert_allclose(shares @ basis, others[-MAX_FIELDS:], atol=1e-4)
    (whole,) = computed(fields, HERE)
    full = np.frombuffer(whole or b"", "<f4")
    drive = DRIVE._replace(gains=frames.tobytes())
    for over, share in (("mean", 0.5), ("peak", 1.0), ("instant", float(strengths[-1]) ** 2)):
        asked = msgspec.structs.replace(HERE, over=over)
        found = asyncio.run(fields.pressure(asked, drive, lambda: True))
        np.testing.assert_allclose(
            np.frombuffer(found or b"", "<f4"), share * full, rtol=1e-3, atol=1e-5 * full.max()
        )
    uneven = drive._replace(
        gains=frames[:2].tobytes() + frames[8].tobytes(), shares=(0.5, 0.25, 0.25)
    )
    found = asyncio.run(fields.pressure(HERE, uneven, lambda: True))
    share = 0.25 * float(strengths[1]) ** 2 + 0.25
    np.testing.assert_allclose(np.frombuffer(found or b"", "<f4"), share * full, rtol=1e-3)


def test_an_error_is_computed_in_the_other_process_and_nowhere_without_a_region(
    fields: FieldWorker,
) -> None:
    asked = msgspec.structs.replace(HERE, of="error")
    (nowhere,) = computed(fields, asked)
    assert np.isnan(np.frombuffer(nowhere or b"", "<f4")).all()
    assert len(nowhere or b"") == 4 * 30 * 40
    points = np.float32(
        [[0.0, 0.0, 0.1], [0.0, 0.003, 0.1], [0.0, 0.0, 0.103], [0.0, 0.003, 0.103]]
    )
    told = Regions(
        points.tobytes(), np.tile(np.float32([1, 0, 0]), (4, 1)).tobytes(),
        np.full(4, 5.0, "<f4").tobytes(), bytes(16), b"",
    )  # fmt: skip
    found = asyncio.run(fields.pressure(asked, DRIVE._replace(regions=told), lambda: True))
    across = np.cross(asked.u, asked.v)
    at = make_grid(asked).points.reshape(-1, 3)
    wanted = compute_error(ARRAY, AIR, GAINS[None], at, across, told)
    np.testing.assert_array_equal(np.frombuffer(found or b"", "<f4"), wanted.astype("<f4"))
    assert 0 < np.isfinite(wanted).sum() < len(wanted)

    # a modulation, of which only some frames are computed
    frames = np.linspace(0.1, 1.0, 30)[:, None] * np.stack([GAINS, GAINS.conj()] * 15)
    many = DRIVE._replace(gains=frames.astype(np.complex64).tobytes(), regions=told)
    found = asyncio.run(fields.pressure(asked, many, lambda: True))
    wanted = compute_error(ARRAY, AIR, frames.astype(np.complex64), at, across, told)
    scale = np.nanmax(np.abs(wanted))
    np.testing.assert_allclose(np.frombuffer(found or b"", "<f4"), wanted, atol=1e-3 * scale)


def test_another_process_that_gives_way_to_all_others_computes_it_by_parts(
    fields: FieldWorker, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = exactly(HERE)
    monkeypatch.setattr(slices, "MAX_PAIRS", 300.0 * len(ARRAY))
    first, second = computed(fields, HERE, HERE)
    assert first == second == whole
    asked: list[bool] = []

    def twice() -> bool:
        asked.append(True)
        return len(asked) < 3

    assert computed(fields, HERE, wanted=twice) == [None]
    assert len(asked) == 3  # after each of the first three of four parts
    (worker,) = workers()
    if os.name == "posix":
        assert worker.nice() == psutil.Process().nice() + 1
        assert os.getsid(worker.pid) == worker.pid


def test_in_silence_the_process_starts_so_that_the_first_sound_is_seen_at_once(
    fields: FieldWorker,
) -> None:
    quiet = DRIVE._replace(gains=b"")
    error = msgspec.structs.replace(HERE, of="error")
    told = quiet._replace(regions=Regions(bytes(12), bytes(12), bytes(4), bytes(4), b""))
    found = asyncio.run(fields.pressure(error, told, lambda: True))
    assert np.isnan(np.frombuffer(found or b"", "<f4")).all()
    assert not workers()
    found = asyncio.run(fields.pressure(HERE, quiet, lambda: True))
    assert found == bytes(4 * 30 * 40)
    (worker,) = eventually(workers)  # when it has begun to run its program
    assert computed(fields, HERE) != [found]
    assert workers() == [worker]


def test_silent_frames_are_a_field_of_zeros() -> None:
    silent = np.zeros((3, len(ARRAY)), np.complex64).tobytes()
    assert not np.frombuffer(at_once(DRIVE.model.packed, silent, make_grid(HERE), peak=True)).any()


def test_a_fine_slice_is_interpolated_and_a_process_that_is_killed_is_replaced(
    fields: FieldWorker,
) -> None:
    fine = msgspec.structs.replace(HERE, shape=(120, 160))
    (found,) = computed(fields, fine)
    assert found == interpolate_pressure(DRIVE.model.packed, DRIVE.gains, make_grid(fine))
    wanted = np.frombuffer(exactly(fine), "<f4")
    assert np.abs(np.frombuffer(found or b"", "<f4") - wanted).max() < 2e-3 * wanted.max()
    (worker,) = workers()
    os.kill(worker.pid, signal.SIGKILL)
    assert computed(fields, fine) == [found]
    (other,) = workers()
    assert other.pid != worker.pid
    fields.close()
    other.wait(LIMIT)


def begin_to_answer(model: bytes, gains: bytes) -> bytes:
    """Write the first bytes of a long answer; then be killed."""
    for pipe in gc.get_objects():
        if isinstance(pipe, Connection) and pipe.writable:
            os.write(pipe.fileno(), struct.pack("!i", 1 << 20) + b"begin")
    os.kill(os.getpid(), signal.SIGKILL)
    return b""


def test_a_process_that_is_killed_in_the_middle_of_an_answer_is_not_waited_for(
    fields: FieldWorker,
) -> None:
    async def run() -> None:
        async with asyncio.timeout(LIMIT):
            with pytest.raises(pc.ArgumentError, match="killed twice"):
                await fields._run(begin_to_answer, DRIVE)

    asyncio.run(run())
    assert computed(fields, HERE) == [exactly(HERE)]


def fail(model: bytes, gains: bytes) -> bytes:
    raise ZeroDivisionError("no reason")


def test_an_error_of_a_computation_is_told_and_the_process_goes_on(fields: FieldWorker) -> None:
    with pytest.raises(pc.ArgumentError, match="ZeroDivisionError: no reason"):
        asyncio.run(fields._run(fail, DRIVE))
    (worker,) = workers()
    assert computed(fields, HERE) == [exactly(HERE)]
    assert workers() == [worker]


def test_what_is_being_computed_at_the_end_starts_no_other_process(fields: FieldWorker) -> None:
    async def end() -> None:
        task = asyncio.create_task(fields.pressure(HERE, DRIVE, lambda: True))
        while not workers():
            await asyncio.sleep(0.001)
        fields.close()
        with pytest.raises((pc.ArgumentError, asyncio.CancelledError)):
            await task

    asyncio.run(end())
    assert not psutil.wait_procs(workers(), LIMIT)[1]


ENDLESS = """
import asyncio, pathlib, sys, time
import pacinian as pc
from pacinian.viewing.hub import Drive
from pacinian.viewing.array_model import ArrayModel
from pacinian.viewing.slices import MAX_FIELDS, FieldWorker

def for_ever(model, gains, begun):
    pathlib.Path(begun).touch()
    while True:
        time.sleep(1.0)

async def main():
    fields = FieldWorker()
    try:
        await fields._run(for_ever, Drive(ArrayModel(pc.autd(), pc.Air()), bytes(8), 0.0), sys.argv[1])
    finally:
        fields.close()

if __name__ == "__main__":
    asyncio.run(main())
"""


UNREAD = """
import asyncio, psutil
import pacinian as pc
from pacinian.viewing.hub import Drive
from pacinian.viewing.array_model import ArrayModel
from pacinian.viewing.slices import FieldWorker

def measure(model, gains):
    return str(len(gains)).encode()

async def main():
    fields = FieldWorker()
    drive = Drive(ArrayModel(pc.autd(), pc.Air()), bytes(4_000_000), 0.0)
    tasks = [asyncio.create_task(fields._run(measure, drive)) for _ in range(3)]
    await asyncio.sleep(0.05)  # the first is being written, and the last waits
    tasks[2].cancel()
    for child in psutil.Process().children():
        if "resource_tracker" not in str(child.cmdline()):
            child.kill()
    assert await asyncio.gather(*tasks[:2]) == [b"4000000"] * 2
    fields.close()

if __name__ == "__main__":
    asyncio.run(main())
"""


def test_a_killed_process_is_replaced_and_the_viewer_ends_although_a_page_has_left(
    tmp_path: Path,
) -> None:
    program = tmp_path / "unread.py"
    program.write_text(UNREAD)
    command = [sys.executable, str(program)]
    subprocess.run(command, check=True, timeout=LIMIT, stderr=subprocess.DEVNULL)


@pytest.mark.skipif(os.name != "posix", reason="signals are of POSIX")
def test_a_slice_that_takes_for_ever_does_not_keep_the_viewer_from_its_end(tmp_path: Path) -> None:
    begun, program = tmp_path / "begun", tmp_path / "endless.py"
    program.write_text(ENDLESS)
    command = [sys.executable, str(program), str(begun)]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as process:
        try:
            eventually(begun.exists)
            children = psutil.Process(process.pid).children()
            process.send_signal(signal.SIGINT)  # the viewer handles SIGTERM in the same way
            process.wait(LIMIT)
            assert not psutil.wait_procs(children, LIMIT)[1]
        finally:
            process.kill()
