"""A stop is confirmed once the guard has reported silence, and never before."""

from __future__ import annotations

import threading
from typing import Any

import msgspec

from pacinian.client.emergency_stop import emergency_stop
from pacinian.serving.control.pending_stops import MAX_CONFIRM_TIME, PendingStops
from pacinian.serving.settings import Safety, Settings
from pacinian.wire.control import Arm, Stop
from pacinian.wire.replies import Error, Ok

from ....waiting import eventually


class Told:
    """What was confirmed, and what was sent to whom."""

    def __init__(self) -> None:
        self.stops = PendingStops()
        self.confirmed: list[Any] = []
        self.sent: list[Any] = []

    def answer(self, silent: bool, now: float) -> None:
        self.sent += self.stops.confirm_and_take_replies(silent, now, self.confirmed.extend)


def test_all_are_confirmed_once_it_is_silent_and_only_once() -> None:
    told = Told()
    told.stops.add_datagrams([(b"n", 1), (b"m", 2), (b"n", 1)], 0.0)  # one was sent again
    told.stops.add_message(b"game", 7, 0.0)
    told.answer(False, 0.1)
    assert (told.confirmed, told.sent) == ([], [])
    told.answer(True, 0.2)
    told.answer(True, 0.3)
    assert told.confirmed == [(b"n", 1), (b"m", 2)]
    assert told.sent == [(b"game", Ok(id=7))]
    assert not told.stops


def test_a_stop_that_is_sent_again_is_known_while_it_waits_and_after() -> None:
    told = Told()
    assert not told.stops.waits((b"n", 1))
    told.stops.add_datagrams([(b"n", 1)], 0.0)
    assert told.stops.waits((b"n", 2))
    assert not told.stops.is_confirmed((b"n", 1))
    told.answer(True, 0.1)
    assert told.stops.is_confirmed((b"n", 2))
    assert not told.stops.waits((b"n", 2))
    assert not told.stops.is_confirmed((b"m", 1))
    assert not told.stops.waits((b"m", 1))


def test_who_waits_too_long_is_told_to_switch_the_array_off() -> None:
    told = Told()
    told.stops.add_datagrams([(b"n", 1)], 0.0)
    told.stops.add_message(b"game", 7, 0.0)
    told.answer(False, MAX_CONFIRM_TIME + 0.01)
    ((peer, reply),) = told.sent
    assert (peer, reply.id, reply.code) == (b"game", 7, "fault")
    assert "switch it off" in reply.advice
    assert not told.stops, "a sender that still waits sends its datagram again"
    told.stops.add_datagrams([(b"n", 1)], 0.6)
    told.answer(True, 0.7)
    assert told.confirmed == [(b"n", 1)]
    assert len(told.sent) == 1


def test_a_flood_is_bounded() -> None:
    told = Told()
    told.stops.add_datagrams([(k.to_bytes(4, "big"), k) for k in range(10_000)], 0.0)
    for k in range(10_000):
        told.stops.add_message(b"game", k, 0.0)
    told.answer(False, 0.1)
    assert len(told.sent) == 10_000 - 256, "the others are told at once"
    told.answer(True, 0.2)
    assert len(told.confirmed) == 256
    assert len(told.sent) == 10_000


def test_without_a_guard_that_reports_no_stop_is_confirmed(start_server: Any) -> None:
    server = start_server(Settings(safety=Safety(hang_timeout=60.0)))
    game = server.client().hello()
    assert isinstance(game.ask(Arm), Ok)
    guard = server.processes["guard"][-1]
    guard.silent = True  # it hangs; the last that it has said is that it sounds or not
    reply = server.client().ask(Stop)
    assert isinstance(reply, Error)
    assert reply.code == "fault"
    assert server.permit().stopped == 1, "the sound was ended all the same"
    done = threading.Event()

    def ask() -> None:
        emergency_stop(server.path, timeout=60.0)
        done.set()

    asking = threading.Thread(target=ask)
    asking.start()
    assert not done.wait(0.2)
    guard.silent = False
    eventually(done.is_set)
    asking.join()
    assert isinstance(server.client().ask(Stop), Ok)


def test_the_reply_has_advice_that_fits_the_wire() -> None:
    told = Told()
    told.stops.add_message(b"game", 7, 0.0)
    told.answer(False, 9.0)
    reply = told.sent[0][1]
    assert msgspec.msgpack.decode(msgspec.msgpack.encode(reply), type=Error) == reply
