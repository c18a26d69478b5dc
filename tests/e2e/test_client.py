"""`pacinian.Client` and a server that is killed under it: nothing resumes, nothing is replayed, reconnecting works."""

from __future__ import annotations

import signal

import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.wire.connection_file import Connection
from pacinian_lab.server.faults.misbehaving_client import MisbehavingClient

from ..waiting import PATIENCE, eventually
from .game import POINT, Game


def test_a_server_that_is_killed_and_restarted(game: Game) -> None:
    server, client, before = game.server, game.client, Connection.read(game.server.file)
    with MisbehavingClient(server.file) as bare:
        session = bare.hello(PATIENCE)["session"]
    server.signal("control", signal.SIGKILL)
    eventually(lambda: not server.list_running())
    with pytest.raises(pc.ConnectionLost):
        eventually(client.renew)
    for _ in range(20):
        with pytest.raises(pc.ServerError):
            client.put(POINT)
    server.start()
    mark = server.log.count
    state = client.status()  # connects anew
    assert (state.output, state.armed, state.objects) == ("silent", False, ())
    client.put(POINT)
    assert client.status().output == "silent"
    assert not server.log.read(mark)["sounds"].any()
    game.sound()
    assert client.status().owner
    with MisbehavingClient(server.file) as bare:
        bare.session = session
        assert bare.ask("status", PATIENCE)["code"] == "session"
    with pytest.raises(pc.ConnectionLost, match="token"):
        pc.Client(replace(Connection.read(server.file), token=before.token))
    assert before.token not in server.read_output()


def test_stop_and_hand_over(game: Game) -> None:
    first, second = game.client, Game(game.server)
    with second.client as taker:
        taker.put(POINT)
        taker.arm(take=True)
        second.sound()
        with pytest.raises(pc.Refused) as told:
            eventually(first.renew)
        assert told.value.code == "owner"
        first.stop()
        with pytest.raises(pc.Refused) as told:
            eventually(taker.renew)
        assert told.value.code == "stopped"
        assert taker.status().output == "stopped"
        taker.reset()
        second.sound()
