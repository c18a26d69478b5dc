"""What is broken falls silent and sounds again, with real processes; tests/benchmarks/test_faults.py measures it."""

from __future__ import annotations

import itertools
import signal
from typing import TYPE_CHECKING

import pytest
import zmq

import pacinian as pc
from pacinian.client import link, server_session
from pacinian_lab.server.faults.logging_device import BLOCKED, UNPLUGGED
from pacinian_lab.server.faults.server import Server

from ..waiting import PATIENCE, eventually
from .game import LEASE, Game

if TYPE_CHECKING:
    from pathlib import Path

HASTY = "[safety]\nlease = 10.0\nsession_timeout = 3600.0\nhang_timeout = 8.0\n"
"""While the output may sound, a guard counts as hung after an eighth of `hang_timeout`, 1 s."""
RENEWALS = 1500
"""Of a game at 1 kHz, until its link ends because nothing answers."""


@pytest.mark.parametrize("part", ["render", "bus", "guard"])
def test_a_process_that_is_killed_is_replaced_and_the_game_is_told(game: Game, part: str) -> None:
    before = game.client.status().restarts[part]
    game.told.clear()
    mark = game.log.count
    game.server.signal(part, signal.SIGKILL)
    game.play(lambda: not game.log.read(mark)["sounds"].all())
    game.play(lambda: game.client.status().restarts[part] > before)
    game.sound()
    told = f"the process '{part}' was killed by signal 9"
    gone = pc.ConnectionLost if part == "bus" else ()  # the game may see that its link to it ends
    assert any(told in str(error) or isinstance(error, gone) for error in game.told)
    assert len(game.server.parts()) >= 3


@pytest.mark.deep
def test_a_guard_that_hangs_while_it_sounds_is_replaced_by_its_spare(tmp_path: Path) -> None:
    """It stands still, or its device does not return."""
    with Server(tmp_path, HASTY) as server, Game(server) as game:
        for hang in (lambda: server.signal("guard", signal.SIGSTOP), (tmp_path / BLOCKED).touch):
            game.play(lambda: "spare" in server.parts())
            parts, mark = server.parts(), game.log.count
            hang()
            game.play(lambda mark=mark: not game.log.read(mark)["sounds"].all())
            game.play(lambda parts=parts: not parts["guard"].is_running())
            game.sound()
            assert server.parts()["guard"] == parts["spare"]


@pytest.mark.deep
@pytest.mark.parametrize("how", ["stands still", "does not return", "was killed"])
def test_a_server_that_is_ended_while_its_guard_hangs_silences_the_device(
    tmp_path: Path, how: str
) -> None:
    with Server(tmp_path, HASTY) as server, Game(server) as game:
        game.play(lambda: "spare" in server.parts())
        parts = server.parts()
        if how == "does not return":
            (tmp_path / BLOCKED).touch()
        else:
            parts["guard"].send_signal(signal.SIGSTOP if how == "stands still" else signal.SIGKILL)
        server.process.send_signal(signal.SIGTERM)
        assert server.process.wait(PATIENCE) == 0
        assert not game.log.read(game.log.count - 1)["sounds"].any()
        assert not any(part.is_running() for part in parts.values())


def test_while_control_stands_still_the_lease_ends_the_sound(server: Server) -> None:
    with Game(server, LEASE) as game:
        server.signal("control", signal.SIGSTOP)
        try:
            game.fall_silent()
        finally:
            server.signal("control", signal.SIGCONT)
        game.sound()


def test_a_control_that_stood_still_goes_on_whatever_a_client_sent_before_it_left(
    server: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    """libzmq would end it, at a heartbeat behind a full queue of a closed connection."""
    monkeypatch.setitem(link.HEARTBEAT, zmq.HEARTBEAT_IVL, 1)
    monkeypatch.setattr(server_session, "BYE_TIMEOUT", 0.0)
    sent = itertools.count()
    with pc.Client(server.file) as client:
        server.signal("control", signal.SIGSTOP)
        eventually(lambda: next(sent) > RENEWALS, client.renew)
    server.signal("control", signal.SIGCONT)
    with Game(server):
        assert server.process.poll() is None


def test_a_device_that_is_unplugged_is_a_fault_until_it_is_back_and_reset(game: Game) -> None:
    file = game.server.folder / UNPLUGGED
    file.touch()
    try:
        game.play(lambda: game.client.status().output == "faulted")
        game.fall_silent()
    finally:
        file.unlink()
    mark = game.log.count
    game.told.clear()
    game.play(lambda: "stopped" in {getattr(error, "code", "") for error in game.told})
    assert not game.log.read(mark)["sounds"].any(), "it is back, and not reset"
    game.client.reset()
    game.sound()
