"""The control process on real sockets."""

from __future__ import annotations

import contextlib
import json
import socket
import threading
import time
import urllib.request
from typing import TYPE_CHECKING, Any

import pytest
import zmq
from msgspec.structs import replace

from pacinian.errors import ServerError
from pacinian.serving.control import process as control_process
from pacinian.serving.control.metrics import MAX_CONNECTIONS
from pacinian.serving.settings import ClientLimits, Log, Metrics, Safety, Settings
from pacinian.wire.control import (
    Arm,
    Bye,
    Capabilities,
    Choice,
    Disarm,
    Renew,
    Reset,
    Select,
    Status,
    Stop,
)
from pacinian.wire.replies import Abilities, Error, Ok
from pacinian.wire.state import State

from ....waiting import PATIENCE, eventually
from ..processes import PATIENT

if TYPE_CHECKING:
    from collections.abc import Callable


def keep(game: Any, until: Callable[[], Any]) -> Any:
    """Renew until something is true."""

    def renewed() -> Any:
        game.ask(Renew, sequence=int(1e6 * time.monotonic()), time=time.monotonic())
        return until()

    return eventually(renewed)


def test_arm_renew_stop_reset_bye(server: Any) -> None:
    game = server.client().hello(scene="room")
    assert isinstance(game.ask(Arm), Ok)
    armed = server.permit()
    assert armed.armed == 1
    assert keep(game, lambda: server.permit().until > armed.until)
    other = server.client()
    assert isinstance(other.ask(Stop), Ok)
    assert server.permit()[0::3] == (0, 1)
    assert game.ask(Arm).code == "stopped"
    assert isinstance(game.ask(Reset), Ok)
    assert isinstance(game.ask(Arm), Ok)
    assert server.permit().epoch == 2
    assert isinstance(game.ask(Bye), Ok)
    eventually(lambda: server.permit()[:4] == (0, 0.0, 2, 0))


def test_the_lease_expires_while_the_connection_lives(start_server: Any) -> None:
    """The game is frozen, but its sockets live: ZeroMQ's heartbeats continue, and the lease expires."""
    server = start_server(Settings(safety=Safety(session_timeout=3600.0)))
    game = server.client().hello()
    game.ask(Arm)
    reply = eventually(lambda: isinstance(said := game.hear(), Error) and said)
    assert (reply.code, reply.id) == ("expired", 0)
    assert server.permit().armed == 0
    assert game.ask(Status).clients[0].name == "game"


def test_state_is_published_and_can_be_asked_for(server: Any) -> None:
    server.extra["render"] |= {"state": {"solver": "gs", "technique": "am", "intensity": 0.5}}
    server.extra["guard"] |= {"inputs": bytes(64), "input_count": 2, "frames": 9}
    next_state = server.states()
    game = server.client().hello("shooter", scene="range")
    assert isinstance(game.ask(Arm), Ok)
    seen = keep(game, lambda: (s := next_state()).output == "sounding" and s)
    assert (seen.owner, seen.scene, seen.armed) == ("shooter", "range", True)
    assert (seen.backend, seen.frames) == ("pretended", 9)
    assert seen.restarts == {"guard": 0, "bus": 0, "render": 0}
    after = next_state()
    assert after.sequence > seen.sequence
    assert after.inputs == b"", "each only once"
    asked = game.ask(Status)
    assert isinstance(asked, State)
    assert asked.clients[0].scene == "range"


def test_levels_are_published_while_they_sound_only_of_each_row_in_turn(server: Any) -> None:
    next_frame = server.states(b"frame")
    assert next_frame().phase == b""
    game = server.client().hello()
    game.ask(Arm)
    first, second = bytes(range(4)), bytes(range(4, 8))
    found = {keep(game, lambda: (f := next_frame()).phase and f).phase for _ in range(4)}
    assert found == {first, second}


def test_capabilities_tell_what_there_is(server: Any) -> None:
    reply = server.client().hello().ask(Capabilities)
    assert isinstance(reply, Abilities)
    assert [p.name for p in reply.solvers] == ["auto", "gs"]
    assert [p.name for p in reply.backends] == ["pretended"]
    assert {"simultaneous", "am", "stm", "lm"} == set(reply.techniques)
    assert len(reply.positions) == len(reply.normals) == 12 * 2241
    assert reply.wavelength == pytest.approx(0.0086, abs=2e-4)
    assert reply.limits["pressure"] == 200.0


def test_a_selection_is_ordered_and_answered_when_it_is_done(server: Any) -> None:
    game = server.client().hello()
    assert game.ask(Select, solver=Choice(name="nope")).code == "unknown"
    assert isinstance(game.ask(Select), Ok)
    server.extra["render"] |= {"results": {"solver 1": "", "intensity 1": ""}}
    assert isinstance(game.ask(Select, solver=Choice(name="gs"), intensity=0.5), Ok)
    server.extra["guard"] |= {"results": {"backend 1": "is gone"}}
    reply = game.ask(Select, backend=Choice(name="pretended"))
    assert (reply.code, reply.message) == ("fault", "backend: is gone")
    game.ask(Arm)
    assert server.client().hello().ask(Select, intensity=1.0).code == "owner"


def test_malformed_requests_are_answered_with_where(server: Any) -> None:
    game = server.client()
    game.socket.send(b"\x82\xa4type\xa5hello\xa2id\x07")
    reply = game.hear()
    assert (reply.code, reply.id) == ("malformed", 7)
    game.socket.send_multipart([b"one", b"two"])
    assert game.hear().code == "malformed"
    game.socket.send(b"\xc1")
    assert game.hear().code == "malformed"


def test_one_who_asks_too_much_is_told_and_still_can_stop(start_server: Any) -> None:
    server = start_server(replace(PATIENT, clients=ClientLimits(max_rate=20.0)))
    game = server.client().hello()
    game.ask(Arm)
    for i in range(300):
        game.send(Renew(session=game.session, id=1000 + i, sequence=1 + i, time=0.0))
    eventually(lambda: getattr(game.hear(), "code", "") == "busy")
    assert isinstance(game.ask(Stop), Ok)
    assert server.permit().stopped == 1
    server.client().hello("calm")


@pytest.mark.parametrize(
    ("name", "told", "code"),
    [("render", "fault", 1), ("guard", "fault", -9), ("bus", "session", 1)],
)
def test_a_process_that_ends_silences_and_is_started_again(
    server: Any, name: str, told: str, code: int
) -> None:
    game = server.client().hello()
    game.ask(Arm)
    server.processes[name][0].code = code
    eventually(lambda: getattr(game.hear(), "code", "") == told)
    assert server.permit().armed == 0
    eventually(lambda: len(server.processes[name]) == 2)
    again = game if name != "bus" else game.hello()
    eventually(lambda: isinstance(again.ask(Arm), Ok))
    state = again.ask(Status)
    assert state.restarts[name] == 1
    assert any(name in fault for fault in state.faults)


def test_a_process_that_hangs_is_killed(start_server: Any) -> None:
    server = start_server(Settings(safety=Safety(hang_timeout=0.1)))
    server.processes["render"][0].silent = True
    eventually(lambda: server.processes["render"][0].killed)
    eventually(lambda: len(server.processes["render"]) == 2)


def test_a_fault_of_the_device_holds_until_it_is_reset(
    server: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(control_process, "FAULT_CLEAR_TIMEOUT", 3600.0)
    game = server.client().hello()
    game.ask(Arm)
    server.extra["guard"]["fault"] = "unplugged"
    eventually(lambda: game.ask(Status).output == "faulted")
    assert game.ask(Arm).code == "stopped"
    assert isinstance(game.ask(Reset), Ok)
    assert isinstance(game.ask(Arm), Ok), "what was reset is no new fault"
    assert game.ask(Status).output == "faulted", "but it is not mended"
    server.extra["guard"]["fault"] = "unplugged once more"
    eventually(lambda: game.ask(Status).fault_count == 2)
    assert game.ask(Arm).code == "stopped"
    monkeypatch.setattr(control_process, "FAULT_CLEAR_TIMEOUT", 0.0)
    assert isinstance(game.ask(Reset), Ok)
    eventually(lambda: game.ask(Status).fault_count == 3)
    monkeypatch.setattr(control_process, "FAULT_CLEAR_TIMEOUT", 3600.0)
    server.extra["guard"].clear()
    game.ask(Reset)
    assert isinstance(game.ask(Arm), Ok)
    assert game.ask(Status).fault_count == 3


def test_it_ends_in_order_and_leaves_nothing(server: Any) -> None:
    game = server.client().hello()
    game.ask(Arm)
    folder = server.processes["guard"][0].told.path
    assert folder.exists()
    server.end()
    assert server.error is None
    assert not server.path.exists()
    assert not folder.exists()
    assert {p.code for ps in server.processes.values() for p in ps} == {0}


def test_a_port_that_is_taken_is_an_error(server: Any, start_server: Any) -> None:
    port = int(server.connection.control.rpartition(":")[2])
    settings = Settings()
    with pytest.raises(ServerError, match="another server"):
        start_server(replace(settings, network=replace(settings.network, control=port)))


def test_metrics_are_served_on_loopback(start_server: Any) -> None:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    server = start_server(replace(PATIENT, metrics=Metrics(port)))
    server.extra["bus"] |= {"received": 9, "superseded": 4, "refused": 2, "waiting": 1}
    server.client().hello()

    def text() -> str:
        with ask_metrics(port) as answer:
            return str(answer.read().decode())

    wanted = (
        "pacinian_clients 1.0",
        "pacinian_ticks_total",
        'pacinian_output{state="silent"} 1.0',
        'pacinian_tick_seconds{quantile="0.99"}',
        'pacinian_restarts_total{process="bus"} 0.0',
        "pacinian_control_requests_total",
        "pacinian_bus_received_total 9.0",
        "pacinian_bus_superseded_total 4.0",
        "pacinian_bus_refused_total 2.0",
        "pacinian_bus_waiting 1.0",
    )
    eventually(lambda: all(name in seen for name in wanted) if (seen := text()) else False)


def test_strangers_at_the_metrics_get_few_threads(
    start_server: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pacinian.serving.control.metrics._Handler.timeout", PATIENCE)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        at = probe.getsockname()
    start_server(replace(PATIENT, metrics=Metrics(at[1])))
    with contextlib.ExitStack() as stack:
        before = threading.active_count()
        for _ in range(MAX_CONNECTIONS):
            stack.enter_context(socket.create_connection(at, PATIENCE)).send(b"GET /")
        for _ in range(5):
            with (
                socket.create_connection(at, PATIENCE) as stranger,
                contextlib.suppress(ConnectionError),
            ):
                assert stranger.recv(1) == b"", "it is closed at once"
        assert threading.active_count() <= before + MAX_CONNECTIONS
    with eventually(lambda: ask_metrics(at[1])) as answer:
        assert answer.status == 200


def ask_metrics(port: int) -> Any:
    """Return the answer; None while the server has no room."""
    with contextlib.suppress(OSError):
        return urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics")
    return None


def test_logs_hold_no_secrets(start_server: Any, logged: Any, capfd: Any) -> None:
    server = start_server(replace(PATIENT, log=Log("json", "debug")))
    token, game = server.connection.token, server.client().hello()
    with contextlib.suppress(zmq.Again):
        server.client(token="wrong", sndtimeo=0).socket.send(b"x")
    logged.wait("connection refused")
    assert isinstance(game.ask(Disarm), Ok)
    server.end()
    text = logged.wait('"event": "end"')
    assert all(isinstance(json.loads(line), dict) for line in text.splitlines())
    for said in (text, *capfd.readouterr()):
        assert token not in said
        assert game.session.hex() not in said
