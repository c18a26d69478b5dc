"""Devices and solvers change while a client moves an object: the scene plays on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from pacinian.wire.binary_arrays import unpack
from pacinian.wire.control import Choice
from pacinian_lab.server.faults.logged_backends import Models, Simulated
from pacinian_lab.server.faults.logging_device import Probe

from .game import RADIUS

if TYPE_CHECKING:
    from .game import Game

FRAMES = 100
MODELS = Choice(name="usb-autd", options={"pretend": True})


def swap(game: Game, to: str | Choice) -> None:
    """Another device, and some frames by it."""
    name = to if isinstance(to, str) else to.name
    game.client.select(backend=to, wait=False)
    game.play(lambda: game.states and game.states[-1].backend == name)
    begun = game.states[-1].frames
    game.play(lambda: game.states[-1].backend == name and game.states[-1].frames >= begun + FRAMES)


def test_a_scene_plays_on_from_the_simulated_array_to_usb_devices_and_back(game: Game) -> None:
    before = game.client.status()
    swap(game, Simulated.name)
    marks = [log.count for log in game.server.logs]
    for to in (Models.name, Simulated.name, "simulated", MODELS, "simulated", Probe.name):
        swap(game, to)
    for solver in ("lagrange", "auto"):
        game.client.select(solver=solver, wait=False)
        game.play(lambda solver=solver: game.states[-1].solver == solver)  # type: ignore[misc]
    game.sound()
    after, states = game.client.status(), game.states
    late = "did not finish within"  # a slow machine is no fault of the swap
    assert not [error for error in (*game.told, *game.client.errors) if late not in str(error)]
    # silent between two devices for a moment, stale where the machine is slow
    assert {s.output for s in states} - {"silent", "stale"} == {"sounding"}
    assert all(s.armed and s.scene == before.scene for s in states)
    assert (after.fault_count, after.faults) == (before.fault_count, before.faults)
    assert after.restarts == before.restarts
    points = np.concatenate([unpack(s.points, 3) for s in states if s.points])
    np.testing.assert_allclose(np.hypot(points[:, 0], points[:, 1]), RADIUS, atol=1e-3)
    assert np.ptp(points, axis=0)[:2].min() > RADIUS
    # one at a time: each is silent before the next one sounds
    simulated, models = (game.server.logs[k].read(marks[k]) for k in (2, 3))
    first, last = (models["time"][models["sounds"] == 1][k] for k in (0, -1))
    assert models["sounds"][-1] == 0
    assert simulated["sounds"][-1] == 0
    assert (models["sounds"][1:-1] == 1).sum() > FRAMES / 2
    meanwhile = (simulated["time"] > first) & (simulated["time"] < last)
    assert not simulated["sounds"][meanwhile].any()
