"""Devices change while a client moves an object a thousand times a second: the scene plays on."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

import numpy as np

import pacinian as pc
from pacinian.bench.faults.device import Probe
from pacinian.bench.faults.through import Models, Simulated
from pacinian.wire.bulk import unpack
from pacinian.wire.control import Choice

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.bench.faults.stage import Stage
    from pacinian.wire.state import State

RADIUS, HEIGHT, TURN = 0.02, 0.2, 6.0  # [m], [m], [rad/s]
POINT = pc.Point(name="thing", position=(RADIUS, 0.0, HEIGHT), radiation_pressure=20.0)
WAIT = 30.0  # [s]
MODELS = Choice(name="usb-autd", options={"pretend": True})


def play(client: pc.Client, done: Callable[[State], bool]) -> list[State]:
    """Move the object until a state is as wished; all states until then."""
    states: list[State] = []
    due = begin = time.perf_counter()
    for tick in range(round(1e3 * WAIT)):
        angle = TURN * time.perf_counter()
        place = RADIUS * math.cos(angle), RADIUS * math.sin(angle), HEIGHT
        client.move("thing", pc.Pose(place), wait=False)
        if tick % 8 == 0:
            client.renew()
            if (state := client.look()) is not None:
                states.append(state)
                if done(state):
                    return states
        due = max(due + 1e-3, time.perf_counter())
        time.sleep(max(0.0, due - time.perf_counter()))
    raise TimeoutError(f"not within {time.perf_counter() - begin:.0f} s: {states[-1:]}")


def swap(client: pc.Client, to: str | Choice, frames: int = 100) -> list[State]:
    """Another device, and so many frames by it; states from then on."""
    client.select(backend=to, wait=False)
    name = to if isinstance(to, str) else to.name
    states = play(client, lambda s: s.backend == name)
    begun = states[-1].frames
    return states + play(client, lambda s: s.backend == name and s.frames >= begun + frames)


def test_a_scene_plays_on_from_the_simulated_array_to_usb_devices_and_back(stage: Stage) -> None:
    server = stage.server
    with pc.Client(server.file) as client:
        client.put(POINT)
        client.arm()
        (*_, before) = play(client, lambda s: s.output == "sounding")
        states = swap(client, Simulated.name)
        marks = [log.count for log in server.logs]
        for to in (Models.name, Simulated.name, "simulated", MODELS, "simulated", Probe.name):
            states += swap(client, to)
        after = client.status()
        assert not client.errors
        client.disarm()
    # between two devices for a moment, and where this machine is slow
    assert {s.output for s in states} - {"silent", "stale"} == {"sounding"}
    assert all(s.armed and s.scene == before.scene for s in states)
    assert (after.fault_count, after.faults) == (before.fault_count, before.faults)
    assert after.restarts == before.restarts
    points = np.concatenate([unpack(s.points, 3) for s in states if s.points])
    np.testing.assert_allclose(np.hypot(points[:, 0], points[:, 1]), RADIUS, atol=1e-3)
    assert np.ptp(points, axis=0)[:2].min() > RADIUS
    # one at a time: each is silent before the next one sounds
    simulated, models = (server.logs[k].read(marks[k]) for k in (2, 3))
    first, last = (models["time"][models["sounds"] == 1][k] for k in (0, -1))
    assert models["sounds"][-1] == 0
    assert simulated["sounds"][-1] == 0
    assert (models["sounds"][1:-1] == 1).sum() > 50
    meanwhile = (simulated["time"] > first) & (simulated["time"] < last)
    assert not simulated["sounds"][meanwhile].any()
