"""`pacinian.Client` and a server that is killed under it: nothing resumes, nothing is replayed, reconnecting works."""

from __future__ import annotations

import signal
from typing import TYPE_CHECKING

import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.bench.faults.peer import Peer
from pacinian.bench.faults.stage import until
from pacinian.wire.connection import Connection

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.bench.faults.server import Server
    from pacinian.bench.faults.stage import Stage

POINT = pc.Point(name="thing", position=(0.0, 0.0, 0.2), radiation_pressure=20.0)


def test_a_server_that_is_killed_and_restarted(stage: Stage) -> None:
    server, before = stage.server, Connection.read(stage.server.file)
    with Peer(server.file) as peer:
        session = peer.hello()["session"]
    with pc.Client(server.file, reconnect=True) as client:
        client.put(POINT)
        client.arm()
        until(lambda: sounds(client, server))
        server.signal("control", signal.SIGKILL)
        until(lambda: not server.left())
        with pytest.raises(pc.ConnectionLost):
            until(client.renew)
        stale(client)
        server.start()
        state = client.status()  # connects anew
        assert (state.output, state.armed, state.objects) == ("silent", False, ())
        mark = server.log.count
        client.hold(0.3)
        assert not server.log.read(mark)["sounds"].any()
        client.put(POINT)
        client.arm()
        until(lambda: sounds(client, server))
        assert client.status().owner
    with Peer(server.file) as peer:
        peer.session = session
        assert peer.ask("status")["code"] == "session"
    with pytest.raises(pc.ConnectionLost, match="token"):
        pc.Client(replace(Connection.read(server.file), token=before.token))
    assert before.token not in server.said()


def stale(client: pc.Client) -> None:
    """Sent while nobody is there."""
    for _ in range(20):
        with pytest.raises(pc.ServerError):
            client.put(POINT)


def sounds(client: pc.Client, server: Server) -> bool:
    mark = server.log.count
    client.hold(0.05)
    return bool(server.log.read(mark)["sounds"].any())


def test_stop_and_hand_over(stage: Stage, servers: Callable[[], Server]) -> None:
    server = stage.server
    with pc.Client(server.file) as first, pc.Client(server.file) as second:
        for client in (first, second):
            client.put(POINT)
        first.arm()
        until(lambda: sounds(first, server))
        second.arm(take=True)
        until(lambda: sounds(second, server))
        with pytest.raises(pc.Refused) as told:
            until(first.renew)
        assert told.value.code == "owner"
        first.stop()
        with pytest.raises(pc.Refused) as told:
            until(second.renew)
        assert told.value.code == "stopped"
        assert second.status().output == "stopped"
        second.reset()
        second.arm()
        until(lambda: sounds(second, server))
