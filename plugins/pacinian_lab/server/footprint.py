"""Measure what a server takes from a game: the wait until it is ready, its memory, and its share of the processor."""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct

from pacinian.acoustics.pose import Pose
from pacinian.client.client import Client
from pacinian.errors import Refused
from pacinian.scene.config_sections import Units
from pacinian.scene.hands.hand import Hand
from pacinian.scene.objects import Volume
from pacinian.scene.shapes import Sphere
from pacinian.serving.settings import Log, Settings
from pacinian.testing import run_server
from pacinian.testing.server import list_processes
from pacinian_lab.solvers.timing import calibrate

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    import psutil

    from pacinian.types import Floats

UPDATE_INTERVAL = 1.0 / 90.0  # of the game [s]
SETTLE = 3.0  # before each window, until the spare guard is ready and ramps have ended [s]
BALL = Volume(name="ball", shape=Sphere(0.03), pose=Pose((0.0, 0.0, 0.175)), radiation_pressure=8.0)
STATES = "idle", "armed", "moved", "hand"


class Row(Struct, frozen=True):
    """A server in one state.

    state: nothing armed (idle); a still ball without hands (armed); the ball moved at 90 Hz (moved); a hand moved over
    the ball at 90 Hz (hand). ready: from the start until clients can connect [s]. memory: PSS of each process [MB].
    cores: share of a processor of each process. wakeups: how often its main thread begins again after a wait [1/s].
    calibration: processor time of a fixed Python loop just before [s]: compare machines by `ready / calibration`. The
    game's own work is not included, but its messages are.
    """

    state: str
    ready: float
    memory: dict[str, float]
    cores: dict[str, float]
    wakeups: dict[str, float]
    calibration: float


def measure(side: int, seconds: float, rounds: int) -> Iterator[Row]:
    """Yield a row for each state of `rounds` servers of `side` x `side` units, from windows of `seconds` [s].

    Raises ServerError.
    """
    settings = Settings(array=Units(side, side), log=Log(level="warning"))
    for _ in range(rounds):
        begin = time.perf_counter()
        with run_server(settings) as server:
            ready = time.perf_counter() - begin
            window = partial(_window, server.process.pid, ready, seconds)
            yield window("idle", time.sleep)
            with Client(server.connection, name="game") as game:
                game.put(BALL)
                game.arm()
                for state in STATES[1:]:
                    yield window(state, partial(_play, game, state))


def _window(
    pid: int, ready: float, seconds: float, state: str, play: Callable[[float], object]
) -> Row:
    calibration = calibrate()
    play(SETTLE)
    processes = list_processes(pid)
    before, begin = _count_use(processes), time.perf_counter()
    play(seconds)
    passed = time.perf_counter() - begin
    grown = {name: use - before[name] for name, use in _count_use(processes).items()}
    cores = {name: round(float(use[0] / passed), 4) for name, use in grown.items()}
    wakeups = {name: round(float(use[1] / passed), 1) for name, use in grown.items()}
    memory = {name: round(_read_memory(each), 1) for name, each in processes.items()}
    return Row(state, round(ready, 3), memory, cores, wakeups, round(calibration, 4))


def _count_use(processes: dict[str, psutil.Process]) -> dict[str, Floats]:
    """Return the processor time [s] of each process so far, and the number of waits of its main thread, (2,)."""
    return {
        name: np.array([sum(each.cpu_times()[:2]), each.num_ctx_switches().voluntary])
        for name, each in processes.items()
    }


def _read_memory(process: psutil.Process) -> float:
    memory = process.memory_full_info()
    return float(getattr(memory, "pss", memory.uss)) / 1e6


def _play(game: Client, state: str, seconds: float) -> None:
    """Renew the lease for `seconds` [s], and move what moves in this state."""
    begin = now = time.perf_counter()
    while now < begin + seconds:
        x = 0.02 * ((now % 2.0) - 1.0)
        try:
            if state == "moved":
                game.move("ball", Pose((x, 0.0, 0.175)), wait=False)
            elif state == "hand":
                game.hands(Hand.open("right", Pose((x, 0.0, 0.215))), wait=False)
            game.renew()
        except Refused:  # the game was late on a busy machine
            game.arm()
        time.sleep(UPDATE_INTERVAL)
        now = time.perf_counter()
