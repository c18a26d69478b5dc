"""Time limits of clients, so long that only a hang exceeds them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import zmq

from pacinian.client import link, server_session
from pacinian.client.emergency_stop import emergency_stop
from pacinian.client.reconnecting_client import ReconnectingClient

from ...waiting import PATIENCE

if TYPE_CHECKING:
    import pytest

BEATS = dict(link.HEARTBEAT)
"""The real heartbeats."""


def wait_long(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the clients of this process wait long for connections, heartbeats, answers and farewells."""
    milliseconds = int(1e3 * PATIENCE)
    for option in (zmq.HANDSHAKE_IVL, zmq.CONNECT_TIMEOUT):
        monkeypatch.setitem(link.OPTIONS, option, milliseconds)
    for option in (zmq.HEARTBEAT_TTL, zmq.HEARTBEAT_TIMEOUT):
        monkeypatch.setitem(link.HEARTBEAT, option, milliseconds)
    for function in (ReconnectingClient.__init__, emergency_stop):
        monkeypatch.setitem(function.__kwdefaults__, "timeout", PATIENCE)
    monkeypatch.setattr(server_session, "BYE_TIMEOUT", PATIENCE)
