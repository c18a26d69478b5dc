"""Units behind a real socket: what goes wrong, what the user sees, and that it ends silent."""

from __future__ import annotations

import asyncio
import math
import threading
import time
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian_plugins.backends.autd3 import udp_transport
from pacinian_plugins.backends.autd3.error_advice import LOST

from ...waiting import PATIENCE, eventually
from .loopback import Played, played, refusal

pytestmark = pytest.mark.usefixtures("loopback")
CALM = 60.0  # [s]; with such a watchdog only the tests say that the host is alive


@pytest.fixture(autouse=True)
def _unasked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Units are asked for their failsafe only after a pause, so that messages can be counted on a slow machine."""
    monkeypatch.setattr(udp_transport, "CHECK_INTERVAL", math.inf)


def test_frames_arrive_in_order_and_those_that_change_nothing_are_not_sent() -> None:
    with played(2, watchdog=CALM) as it:
        before = it.processed()
        for phase in (1, 2, 2, 2, 3):
            it.send(phase)
            it.settle()
        it.settle()
        assert it.processed() - before - 1 == 3  # less the first question
        assert it.line.failures == 0
        it.backend.silence()
        it.backend.silence()
        it.send(3)
        eventually(lambda: it.processed() >= before + 8)


def hold(it: Played) -> threading.Event:
    """Have the client's thread stand still until this is set."""
    entered, end = threading.Event(), threading.Event()

    def stand() -> None:
        entered.set()
        end.wait(PATIENCE)

    it.settle()
    it.line._loop.call_soon_threadsafe(stand)
    assert entered.wait(PATIENCE)
    return end


def test_sending_does_not_wait_and_only_the_newest_counts() -> None:
    with played(watchdog=CALM) as it:
        it.send(1)
        end, before = hold(it), it.line._sent
        for phase in (2, 3, 4):
            it.send(phase)
        assert it.line.waits
        assert it.line._sent == before
        end.set()
        it.settle()
        counted = it.processed()
        it.send(4)  # it sounds already
        it.settle()
        assert it.processed() == counted + 1


def test_what_only_says_that_the_host_is_alive_may_wait_while_units_play_by_themselves() -> None:
    with played() as it:
        it.send(1)
        end = hold(it)
        it.line._sent -= it.backend.watchdog
        it.line.post([])
        assert it.line._next
        assert not it.line.waits
        end.set()
        it.settle()
        assert not it.line._next


def test_nothing_that_was_on_its_way_sounds_after_a_silence() -> None:
    with played(rate=5000) as it:
        sent: list[str] = []
        client = it.line._client

        class Watched:
            def __getattr__(self, name: str) -> Any:
                return getattr(client, name)

            async def send_frame_at(self, *arguments: Any) -> Any:
                sent.append("row")
                response = await client.send_frame_at(*arguments)
                if len(sent) == 2:
                    it.line._loop.call_soon(silence.set)
                    while "silence" not in sent:
                        await asyncio.sleep(0)
                return response

            async def send(self, command: Any) -> None:
                sent.append("silence")
                await client.send(command)

        silence = threading.Event()
        it.line._client = Watched()
        first, zero = np.arange(5)[:, None] + np.zeros((1, 249)), np.zeros((5, 249), np.uint16)
        it.backend.send(pc.Frame(0, 0.0, first.astype(np.uint16), zero + 9))
        assert silence.wait(PATIENCE)
        it.backend.silence()
        it.settle()
        it.line._client = client
        assert sent == ["row", "row", "silence"]


def test_when_frames_stop_the_units_are_silent_and_sound_again_with_the_next() -> None:
    with played(watchdog=0.2) as it:
        assert it.backend.capability.watchdog == 0.2
        pause = 0.1

        def tripped() -> bool:
            nonlocal pause
            it.send()
            it.settle()
            pause *= 2.0
            time.sleep(pause)  # asking would tell it that the host is alive
            return bool(it.ask("fpga_state").is_failsafe_active())

        def sounds() -> bool:
            it.send()
            it.settle()
            return not it.ask("fpga_state").is_failsafe_active()

        eventually(tripped)
        eventually(sounds)


def test_frames_that_change_nothing_say_that_the_host_is_alive_when_nothing_else_did() -> None:
    with played(watchdog=CALM) as it:
        it.send(1)
        it.settle()
        before = it.processed()
        it.send(1)
        it.settle()
        assert it.processed() == before + 1  # the question before
        it.line._sent -= 0.25 * it.backend.watchdog
        it.send(1)
        it.settle()
        assert it.processed() == before + 3


def test_frames_that_change_nothing_keep_the_units_from_being_silent() -> None:
    """A trial in which they may have come too late says nothing: there is another."""
    with played(watchdog=1.0) as it:

        def stays_active() -> bool:
            begin = before = time.monotonic()
            longest, constant = 0.0, 1
            it.send(constant)
            it.settle()
            while before - begin < 1.5:
                it.send(constant)
                it.settle()
                time.sleep(0.02)
                now = time.monotonic()
                longest, before = max(longest, now - before), now
            active = it.ask("fpga_state").is_failsafe_active()
            longest = max(longest, time.monotonic() - before)
            assert not active or longest > 0.2
            return not active

        eventually(stays_active)


def test_units_that_are_gone_are_an_error_silent_and_found_again_when_it_is_opened() -> None:
    with played(watchdog=0.05) as it:
        it.send(1)
        it.settle()
        it.line.units = None
        assert it.lost() == f"autd3: {LOST}"
        assert refusal(it.backend, it.frame())
        eventually(lambda: it.line._clock() - it.line._sent > it.backend.watchdog)
        it.backend.silence()  # they are: their failsafe has seen to it
        it.backend.close()
        it.backend.open(it.array)
        it.send(1)
        it.settle()


def test_a_unit_that_was_reset_is_gone() -> None:
    with played(2) as it:
        it.send(1)
        it.settle()
        it.line.units.reboot(1)
        assert it.lost()


def failing(it: Played, codes: list[int]) -> None:
    """Have the next messages fail."""
    from autd3 import Autd3Error

    client = it.line._client

    class Failing:
        def __getattr__(self, name: str) -> Any:
            return getattr(client, name)

        async def send_frame_at(self, *arguments: Any) -> Any:
            if not codes:
                return await client.send_frame_at(*arguments)
            error = Autd3Error("lost on its way")
            error.code = codes.pop(0)
            raise error

    it.line._client = Failing()


def test_a_message_that_is_lost_is_made_up_for_by_the_next_frame() -> None:
    from autd3 import Autd3Error

    with played(watchdog=CALM) as it:
        it.send(1)
        it.settle()
        failing(it, [Autd3Error.TIMEOUT])
        it.send(2)
        eventually(lambda: it.line.failures == 1)
        before = it.processed()
        it.send(2)  # the same again: but it has not arrived
        it.settle()
        assert it.processed() == before + 2
        it.line.check()


def test_what_the_network_refuses_is_a_fault_at_once_and_what_is_late_only_after_a_while() -> None:
    from autd3 import Autd3Error

    with played() as it:
        failing(it, [Autd3Error.TIMEOUT] * 3 + [Autd3Error.NETWORK])
        for lost in range(1, 4):
            it.send(lost)
            eventually(lambda lost=lost: it.line.failures == lost)
            it.line.check()
        it.send(4)
        eventually(lambda: it.line.failures == 4)
        with pytest.raises(pc.BackendError, match="lost on its way: reset the server, or open"):
            it.send(5)
