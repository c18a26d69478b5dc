"""Draws what a server publishes while Unity's components play: `python -m tests.adapters.pictures docs/pictures`."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from threading import Event, Thread
from typing import TYPE_CHECKING

import numpy as np

import pacinian as pc
from pacinian.plot import figure, save
from pacinian.scene.config_sections import Units
from pacinian.serving.settings import Settings
from pacinian.solving.felt_figures import FeltRegion
from pacinian.testing.server import run_server

from . import unity
from .game import Game

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pacinian.wire.state import State

ACTS = ("wave on", 2.0), ("hand off", 0.5), ("hand on", 1.0), ("freeze", 0.8), ("wave on", 0.6)
"""What the game does, and for how long [s]."""


def played() -> tuple[list[tuple[float, State]], list[float]]:
    """Return the states, with the arrival time of each, and the time at which each act began [s]."""
    states: list[tuple[float, State]] = []
    ended = Event()

    def watch(connection: Path) -> None:
        with pc.Client(connection, name="onlooker") as client:
            for state in client.watch():
                states.append((state.time, state))
                if ended.is_set():
                    return

    with (
        tempfile.TemporaryDirectory() as folder,
        run_server(Settings(array=Units(3, 3))) as server,
        Game(["mono", unity.build(Path(folder)).player, server.connection, "0"]) as game,
    ):
        game.do("play")
        game.event("connected")
        game.sounding(lambda status: status["force"] > 0.0)
        watching = Thread(target=watch, args=(server.connection,))
        watching.start()
        while not states:
            ended.wait(0.01)
        starts: list[float] = []
        for act, seconds in ACTS:
            starts.append(states[-1][0])
            game.say(act)
            ended.wait(seconds)
        ended.set()
        watching.join()
    return states, starts


def draw(states: list[tuple[float, State]], starts: list[float]) -> Figure:
    """Draw the hand's position, the largest pressure, and the force that is felt."""
    t = np.array([at for at, _ in states]) - starts[0]
    palm = [np.frombuffer(s.hands or b"\0\0\xc0\x7f", "<f4")[0] for _, s in states]
    most = [
        np.frombuffer(s.achieved, "<f4").max(initial=0.0) * (s.output == "sounding")
        for _, s in states
    ]
    felt = [next(iter(pc.Client.decode_felt(s).values()), FeltRegion(np.nan)) for _, s in states]
    page = figure(7.6, 4.6)
    rows = page.subplots(3, 1, sharex=True)
    curves = {
        "palm, as the server\nhas it: x [mm]": 1e3 * np.array(palm),
        "largest radiation\npressure [Pa]": np.array(most),
        "force felt\n[% of asked]": 100.0 * np.array([f.force for f in felt]),
    }
    for row, (label, values) in zip(rows, curves.items(), strict=True):
        row.plot(t, values, lw=1.2)
        row.set_ylabel(label)
        row.grid(alpha=0.3)
    for place, note in zip(
        starts[1::2], ("hand not tracked", "game frozen: silent until `Arm`"), strict=True
    ):
        rows[1].text(place - starts[0] + 0.1, 0.1 * max(most), note, fontsize=8)
    rows[-1].set_xlabel("time [s]")
    return page


if __name__ == "__main__":
    save(draw(*played()), Path(sys.argv[1]) / "unity-touch.png", 64)
