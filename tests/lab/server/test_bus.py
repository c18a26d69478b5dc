"""The server's benchmarks without a server: what they make of what they find; nothing depends on how long it takes."""

from __future__ import annotations

import io
import json
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import zmq
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace
from rich.console import Console

import pacinian as pc
from pacinian.wire import binary_arrays
from pacinian.wire.convert import to_scene
from pacinian_lab.server import latency, latency_sender, load, report, soak_drift, tables
from pacinian_lab.server import positions as places
from pacinian_lab.server.bare_client import socket
from pacinian_lab.server.echo import Echo
from pacinian_lab.server.latency_sender import Times
from pacinian_lab.server.load import Final
from pacinian_lab.server.load_observer import Seen
from pacinian_lab.server.many_clients import Done
from pacinian_lab.server.quantiles import Quantiles
from pacinian_lab.server.soak import Row as Window
from pacinian_lab.server.soak_game import Heard
from pacinian_lab.server.worker_process import WorkerProcess
from pacinian_lab.solvers.worker_process import WorkerError

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

MS = Quantiles(0.001, 0.002, 0.003, 0.004, 100)
TIMES = Times(90.0, MS, MS, MS, MS, MS, 100, 100, (15, 16, 18), 1.0, (0.4, 0.6), 0.01, 0.0, 400)
SEEN = Seen(MS, MS, 0, 1000.0, 1000.0, 0.01, (0.4, 0.6), 0.002, 16, 1.0, 0, 0)
CPU = {"control": 0.01, "bus": 0.2, "render": 0.5, "guard": 0.1}
ROW = load.Row(8, 10_000.0, 10_000.0, 0.0, {}, SEEN, (100.0, 101.0, 102.0), CPU)
FINAL = Final(8, 16, 16, (), 1000, 1000, 0, 0)


def windows(change: Callable[[int, Window], Window] = lambda k, row: row) -> list[Window]:
    heard = Heard(1000, 0.01, (0.4, 0.6, 0.9), 0.002, MS, 1.0, 0, 0, {"swap": 1})
    first = Window(0.0, heard, {"bus": 50.0, "render": 150.0}, {"bus": 20, "render": 20}, CPU)
    return [change(k, replace(first, t=10.0 * (k + 1))) for k in range(40)]


def met(rows: list[Window]) -> list[bool]:
    return [verdict.met for verdict in soak_drift.verdicts(rows)]


@given(st.lists(st.floats(0.0, 10.0), min_size=1))
def test_quantiles_are_of_the_values(values: list[float]) -> None:
    found = Quantiles.of(iter(values))
    assert found.p50 <= found.p99 <= found.p999 <= found.most == max(values)
    assert {found.p50, found.p99, found.p999} <= set(values)
    assert found.count == len(values)
    assert Quantiles.of(()).count == 0


@given(st.floats(0.0, 1e6), st.floats(0.0, 9.9), st.integers(0, 15))
def test_a_place_tells_when_it_was_sent(t: float, age: float, index: int) -> None:
    point = binary_arrays.pack(places.place(index, t))
    found = places.decode_send_times(point, t + age + 1e-3)
    assert found.keys() == {index}
    assert found[index] == pytest.approx(t, abs=1e-3)


@given(st.floats(0.0, 1e6), st.sets(st.integers(0, 15)))
def test_what_is_not_where_it_was_put_is_missing(t: float, gone: set[int]) -> None:
    here = [places.place(i, t, 1) for i in range(16, 32) if i - 16 not in gone]
    found = places.find_missing(binary_arrays.pack(here or np.empty((0, 3))), range(16, 32), t)
    assert found == [16 + i for i in sorted(gone)]
    assert places.find_missing(
        binary_arrays.pack(here or np.empty((0, 3))), range(16), t + 1.0
    ) == [*range(16)]


def test_groups_that_are_not_felt_are_outside_of_the_workspace() -> None:
    workspace = pc.Workspace(*places.WORKSPACE)
    inside = workspace.holds(np.array([places.place(i, 3.0, 1) for i in range(48)]))
    assert np.flatnonzero(inside).tolist() == [*range(16, 32)]


def test_the_palm_always_touches_sixteen_points() -> None:
    array = pc.autd(3, 3)
    sampler = pc.Sampler()
    sampler.prepare(array, pc.Air())
    item = to_scene("points", latency_sender.points())
    counts = set[int]()
    for t, frame in enumerate(latency_sender.hands()[::20]):
        hand = pc.Hand(binary_arrays.unpack(frame.joints, 3))
        counts.add(len(sampler.sample(pc.Scene((item,), hands=(hand,)), 0.02 * t)))
    assert counts == {16}


def test_a_process_of_its_own_answers_until_it_is_closed() -> None:
    context = zmq.Context[Any]()
    with WorkerProcess("echo") as other:
        echo = other.receive(Echo)
        with socket(context, zmq.DEALER, echo.endpoint, echo.token) as one:
            one.rcvtimeo = 60_000
            one.send(b"hello")
            assert one.recv() == b"hello"
        with socket(context, zmq.DEALER, echo.endpoint, "guessed") as stranger:
            stranger.sndtimeo = 100
            with pytest.raises(zmq.Again):
                stranger.send(b"hello")
    assert other.process.returncode is not None
    context.term()


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_process_that_ends_is_told(capfd: pytest.CaptureFixture[str]) -> None:
    with (
        WorkerProcess("nothing_of_that_name") as other,
        pytest.raises(WorkerError, match="has ended"),
    ):
        other.receive(Done)
    assert "No module named" in capfd.readouterr().err
    with WorkerProcess("echo") as other:
        other.receive(Echo)
        with pytest.raises(WorkerError, match="said nothing"):
            other.receive(Done, limit=0.01)


def test_what_is_as_it_was_meets_every_aim() -> None:
    assert all(met(windows()))
    assert all(verdict.met for verdict in report.latency([TIMES]))
    assert all(verdict.met for verdict in report.load([ROW], [FINAL]))


@pytest.mark.parametrize(
    "change",
    [
        lambda k, row: replace(row, memory={"bus": 50.0 + 0.5 * k, "render": 150.0}),
        lambda k, row: replace(row, files={"bus": 20 + k, "render": 20}),
        lambda k, row: replace(row, heard=replace(row.heard, tick_ms=(0.4 + 0.01 * k, 0.6, 0.9))),
        lambda k, row: replace(row, heard=replace(row.heard, late=0.002 * k)),
        lambda k, row: replace(row, heard=replace(row.heard, age=replace(MS, p50=1e-4 * k))),
        lambda k, row: replace(row, heard=replace(row.heard, faults=k // 20)),
        lambda k, row: replace(row, heard=replace(row.heard, events={"lost: gone": 1})),
    ],
)
def test_each_drift_misses_one_aim(change: Callable[[int, Window], Window]) -> None:
    assert met(windows(change)).count(False) == 1


def test_what_is_slow_or_large_only_at_first_is_no_drift() -> None:
    assert all(
        met(
            windows(
                lambda k, row: replace(
                    row,
                    memory={"bus": 10.0 + min(4.0 * k, 40.0)},
                    heard=replace(row.heard, late=0.2 * (k == 0)),
                )
            )
        )
    )


@pytest.mark.parametrize(
    ("seen", "final", "missed"),
    [
        ({}, {"missing": (3,)}, "no object lost"),
        ({}, {"known": 15}, "no object lost"),
        ({"ping": replace(MS, most=0.06)}, {}, "control answers"),
        ({"lost": 1}, {}, "control answers"),
        ({"ticks": 900.0}, {}, "ticks held"),
        ({"late": 0.05}, {}, "ticks held"),
        ({"backwards": 1}, {}, "newest wins"),
        ({"age": replace(MS, p99=0.2)}, {}, "newest wins"),
    ],
)
def test_each_loss_misses_one_aim(seen: Any, final: Any, missed: str) -> None:
    quiet = replace(ROW, rate=1000.0)
    rows = [quiet, replace(ROW, seen=replace(SEEN, **seen))]
    gone = [v for v in report.load(rows, [replace(FINAL, **final)]) if not v.met]
    assert len(gone) == 1
    assert missed in gone[0].target


def test_memory_that_grows_and_late_hands_are_missed_too() -> None:
    grown = report.load([replace(ROW, memory=(100.0, 110.0, 200.0))], [FINAL])
    assert [v.target for v in grown if not v.met] == ["8 clients: memory bounded"]
    assert not report.latency([replace(TIMES, whole=replace(MS, p50=0.0021))])[0].met


def test_everything_is_told_in_json_and_in_tables(tmp_path: Path) -> None:
    told = report.plain([TIMES], [ROW], [FINAL], seconds=1.0)
    assert json.loads(json.dumps(told))["latency"][0]["rate"] == 90.0
    console = Console(file=io.StringIO(), width=120)
    shown = [*tables.latency([TIMES]), *tables.load_([ROW]), tables.windows(windows())]
    for table in (*shown, tables.events(windows())):
        console.print(table)
    assert isinstance(console.file, io.StringIO)
    for word in ("echo", "15-16-18", "8 at 10000", "swap"):
        assert word in console.file.getvalue()
    from pacinian_lab.server.soak_picture import draw

    draw(windows(), tmp_path / "soak.png")
    assert (tmp_path / "soak.png").stat().st_size > 10_000


def test_pacing_calls_in_turn() -> None:
    calls = list[str]()
    latency_sender.pace_calls(10_000.0, 0.002, lambda: calls.append("a"), lambda: calls.append("b"))
    assert calls == ["a", "b"] * 20
    assert latency.settings(3).array.make().positions.shape == (2241, 3)
