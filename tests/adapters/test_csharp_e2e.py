"""A game in C# from its start to its sudden end: a hand that moves at 90 Hz feels a ball."""

from __future__ import annotations

import json
import os
import subprocess
import time
from typing import TYPE_CHECKING

import pacinian as pc
from pacinian.bench.faults.server import Server

from . import tools
from .game import HELD, LEASE
from .silence import silent

if TYPE_CHECKING:
    from pathlib import Path

SECONDS = 10.0
FRAME = 1.0 / 90.0  # [s]
LATE = 0.15  # [s] after the lease, where two processors are shared by many
REACH = 0.06  # [m] from the ball's centre: its radius is half of it
SPARE = 4.0  # [bytes] a frame, of a text in the state that changes now and then


def until(client: pc.Client, output: str) -> None:
    """Until a state says so."""
    for state in client.watch():
        if state.output == output:
            return


def test_from_nothing_to_a_hand_that_feels(csharp_core: Path, tmp_path: Path) -> None:
    sources = (tools.CSHARP / "example").glob("*.cs")
    program = tools.csharp(csharp_core.with_name("EndToEnd.exe"), sources, csharp_core)
    with Server(tmp_path, HELD) as server:
        environment = {**os.environ, "PACINIAN_CONNECTION": str(server.file)}
        with subprocess.Popen(
            ["mono", "--debug", str(program), "-", str(SECONDS)],
            env=environment,
            stdout=subprocess.PIPE,
        ) as game:
            assert game.stdout is not None
            told = json.loads(game.stdout.readline() or "{}")
            with pc.Client(server.file) as onlooker:
                until(onlooker, "sounding")  # as its hand may be lost where frames are late
                since = time.perf_counter()
                game.kill()
                until(onlooker, "silent")
                published = time.perf_counter() - since
        device = silent(server, since, server.logs[1]) - since
    print({**told, "published": published, "device": device})  # noqa: T201
    assert device < LEASE + LATE
    assert published < LEASE + LATE + 1.0
    assert (told["solver"], told["backend"]) == ("gs", "probe-other")
    assert told["foci"] > 0
    assert told["far"] < REACH
    assert told["frames"] > 0.5 * SECONDS / FRAME
    assert told["inputs"] > 0.5 * told["frames"]
    assert 0.0 < told["trip_p50"] <= told["trip_p99"]
    assert 0.0 < told["hand_p50"] < LEASE
    assert told["steady"] > 0
    assert told["bytes_per_frame"] == 0.0
    assert told["worker_bytes_per_frame"] < SPARE
