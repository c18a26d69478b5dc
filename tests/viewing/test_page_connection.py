"""The connection to one page, without a socket, and with fields that are computed on demand."""

from __future__ import annotations

import asyncio
import contextlib
from typing import TYPE_CHECKING, Any

import msgpack
import numpy as np
import pytest
from websockets.asyncio.client import connect

import pacinian as pc
from pacinian.errors import ArgumentError
from pacinian.viewing import page_connection, run
from pacinian.viewing.app import make_app
from pacinian.viewing.array_model import ArrayModel
from pacinian.viewing.hub import Drive, Hub
from pacinian.viewing.page_connection import PageConnection

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from websockets.asyncio.client import ClientConnection

    from pacinian.viewing.messages import Slice, Volume

MODEL = ArrayModel(pc.autd(), pc.Air())
SLICE: dict[str, Any] = {
    "type": "slice", "centre": [0.0, 0.0, 0.1], "u": [1.0, 0.0, 0.0], "v": [0.0, 1.0, 0.0],
    "size": [0.1, 0.1], "shape": [2, 2],
}  # fmt: skip
VOLUME: dict[str, Any] = {
    "type": "volume", "origin": [0.0, 0.0, 0.1], "spacing": 0.01, "shape": [2, 2, 2],
}  # fmt: skip


@pytest.fixture(autouse=True)
def unpaced(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let slices follow each other without a pause."""
    monkeypatch.setattr(page_connection, "MIN_INTERVAL", 0.0)


def drive(gain: float) -> Drive:
    return Drive(MODEL, np.full(249, gain, np.complex64).tobytes(), gain)


class Slow:
    """Fields whose computation the test ends. begun: ids. abandoned: ids of fields that were no longer wanted."""

    def __init__(self) -> None:
        self.begun: list[int] = []
        self.abandoned: list[int] = []
        self.go = asyncio.Semaphore(0)
        self.wrong = False

    async def pressure(
        self, asked: Slice | Volume, drive: Drive, wanted: Callable[[], bool]
    ) -> bytes | None:
        self.begun.append(asked.id)
        await self.go.acquire()
        if self.wrong:
            raise ArgumentError("points", "cannot be meant")
        if not wanted():
            self.abandoned.append(asked.id)
            return None
        return bytes(np.full(4, drive.time, np.float32))


class Stage:
    """A page and its hub. sent: messages to it. room: whether its socket has room. answers: whether it answers."""

    answers = True

    def __init__(self) -> None:
        self.hub, self.fields, self.sent = Hub(), Slow(), list[dict[str, Any]]()
        self.room = asyncio.Event()
        self.room.set()
        self.page = PageConnection(self.hub, self.fields, self._send)  # type: ignore[arg-type]

    async def _send(self, data: bytes) -> None:
        await self.room.wait()
        self.sent.append(msgpack.unpackb(data))
        if self.answers and self.sent[-1]["type"] == "batch":
            self.say(type="ready")

    def say(self, **message: Any) -> None:
        self.page.hear(msgpack.packb(message) or b"")

    def of(self, kind: str) -> list[dict[str, Any]]:
        return [message for message in self.sent if message["type"] == kind]


async def settle() -> None:
    for _ in range(20):
        await asyncio.sleep(0)


@contextlib.asynccontextmanager
async def staged() -> AsyncIterator[Stage]:
    stage = Stage()
    running = asyncio.create_task(stage.page.run())
    await settle()
    try:
        yield stage
    finally:
        stage.page.close()
        running.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await running


def test_the_next_slice_comes_only_after_the_last_was_seen() -> None:
    async def run() -> None:
        async with staged() as stage:
            stage.hub.set_drive(drive(1.0))
            stage.say(id=1, **SLICE)
            stage.fields.go.release()
            await settle()
            assert [s["id"] for s in stage.of("slice")] == [1]
            for i in range(2, 50):
                stage.hub.set_drive(drive(i))
                stage.say(id=i, **SLICE)
                stage.say(type="seen", id=i)  # for slices that never came
            stage.fields.go.release()
            await settle()
            assert stage.fields.begun == [1]
            stage.say(type="seen", id=1)
            await settle()
            assert stage.fields.begun == [1, 49]  # the newest request wins
            assert stage.of("slice")[-1]["time"] == 49.0

    asyncio.run(run())


def test_a_newer_request_abandons_the_old_one() -> None:
    async def run() -> None:
        async with staged() as stage:
            stage.hub.set_drive(drive(1.0))
            stage.say(id=1, **SLICE)
            await settle()
            stage.say(id=2, **SLICE)
            stage.fields.go.release()
            stage.fields.go.release()
            await settle()
            assert stage.fields.abandoned == [1]
            assert [s["id"] for s in stage.of("slice")] == [2]

    asyncio.run(run())


def test_nothing_is_computed_again_while_nothing_changes_or_it_is_hidden() -> None:
    async def run() -> None:
        async with staged() as stage:
            stage.say(id=1, **SLICE)
            await settle()
            assert not stage.fields.begun  # the array is not known yet
            stage.hub.set_drive(drive(1.0))
            stage.fields.go.release()
            await settle()
            stage.say(type="seen", id=1)
            await settle()
            stage.hub.put("state", msgpack.packb({"type": "state"}) or b"")
            await settle()
            assert stage.fields.begun == [1]
            stage.hub.set_drive(drive(2.0))
            stage.fields.go.release()
            await settle()
            assert stage.fields.begun == [1, 1]
            stage.say(type="seen", id=1)
            stage.say(type="hide", what="slice")
            stage.hub.set_drive(drive(3.0))
            await settle()
            assert stage.fields.begun == [1, 1]

    asyncio.run(run())


def test_a_slice_goes_on_when_a_server_that_was_lost_is_back() -> None:
    async def run() -> None:
        async with staged() as stage:
            stage.hub.set_drive(drive(1.0))
            stage.say(id=1, **SLICE)
            stage.fields.go.release()
            await settle()
            stage.say(type="seen", id=1)
            stage.hub.disconnect("it has gone")
            await settle()
            stage.hub.set_drive(drive(2.0))
            stage.fields.go.release()
            await settle()
            assert [s["time"] for s in stage.of("slice")] == [1.0, 2.0]

    asyncio.run(run())


def test_what_was_hidden_is_shown_when_it_is_asked_for_again() -> None:
    async def run() -> None:
        async with staged() as stage:
            stage.hub.set_drive(drive(1.0))
            for times in (1, 2):
                stage.say(id=1, **SLICE)
                stage.fields.go.release()
                await settle()
                stage.say(type="seen", id=1)
                stage.say(type="hide", what="slice")
                await settle()
                assert len(stage.of("slice")) == times

    asyncio.run(run())


def test_slices_and_volumes_do_not_wait_for_each_other() -> None:
    async def run() -> None:
        async with staged() as stage:
            stage.hub.set_drive(drive(1.0))
            stage.say(id=1, **VOLUME)
            stage.say(id=2, **SLICE)
            await settle()
            assert sorted(stage.fields.begun) == [1, 2]

    asyncio.run(run())


def test_what_cannot_be_computed_is_refused_and_the_next_is_done() -> None:
    async def run() -> None:
        async with staged() as stage:
            stage.hub.set_drive(drive(1.0))
            stage.fields.wrong = True
            stage.say(id=1, **SLICE)
            stage.fields.go.release()
            await settle()
            assert stage.of("refused")[0]["action"] == "slice"
            stage.fields.wrong = False
            stage.say(id=2, **SLICE)
            stage.fields.go.release()
            await settle()
            assert [s["id"] for s in stage.of("slice")] == [2]

    asyncio.run(run())


def test_a_page_that_goes_in_the_middle_of_a_slice_leaves_nothing() -> None:
    async def run() -> None:
        stage = Stage()
        running = asyncio.create_task(stage.page.run())
        stage.hub.set_drive(drive(1.0))
        stage.say(id=1, **SLICE)
        await settle()
        assert stage.fields.begun == [1]
        stage.page.close()
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)
        assert not stage.hub.views
        assert len(asyncio.all_tasks()) == 1

    asyncio.run(run())


def test_the_next_values_come_only_after_the_last_were_answered_and_are_the_newest() -> None:
    async def run() -> None:
        async with staged() as stage:
            stage.answers, before = False, len(stage.of("batch"))
            for i in range(100):
                stage.hub.put("state", msgpack.packb({"type": "state", "sequence": i}) or b"")
                await settle()
            assert [m["sequence"] for m in stage.of("state")] == [0]
            stage.say(type="ready")
            await settle()
            assert [m["sequence"] for m in stage.of("state")] == [0, 99]
            stage.say(type="ready")
            await settle()
            assert len(stage.of("batch")) == before + 2  # nothing was new

    asyncio.run(run())


def test_nothing_piles_up_for_a_page_that_is_slow() -> None:
    async def main() -> None:
        async with staged() as slow:
            other = slow.hub.join(lambda: None)
            slow.room.clear()
            for i in range(5000):
                slow.hub.put("state", msgpack.packb({"type": "state", "sequence": i}) or b"")
                await asyncio.sleep(0)
            assert dict(other.take())["state"]
            slow.room.set()
            await settle()
            told = [message["sequence"] for message in slow.of("state")]
            assert told[-1] == 4999
            assert len(told) <= 2

    asyncio.run(main())


def test_a_socket_that_is_not_read_holds_up_no_other_and_keeps_little() -> None:
    count, size = 1000, 1 << 16

    async def heard(page: ClientConnection) -> int:
        """Receive states until the last one."""
        for number in range(1, count + 1):
            message = msgpack.unpackb(await page.recv())
            while message["type"] != "state":
                if message["type"] == "batch":
                    await page.send(msgpack.packb({"type": "ready"}) or b"")
                message = msgpack.unpackb(await page.recv())
            if message["sequence"] == count - 1:
                return number
        raise AssertionError("the last one did not come")

    async def main() -> None:
        hub, ended = Hub(), asyncio.Event()
        with run.bind("127.0.0.1", 0) as listening:
            host = f"127.0.0.1:{listening.getsockname()[1]}"
            fields: Any = Slow()
            serving = asyncio.create_task(
                run._serve(make_app(hub, fields, "key"), listening, ended)
            )
            opening = {"origin": f"http://{host}", "max_queue": 1, "compression": None}
            url = f"ws://{host}/feed?token=key"
            async with connect(url, **opening) as slow, connect(url, **opening) as page:
                while len(hub.views) < 2:
                    await asyncio.sleep(0)
                hearing = asyncio.create_task(heard(page))
                for i in range(count):
                    state = {"type": "state", "sequence": i, "bulk": bytes(size)}
                    hub.put("state", msgpack.packb(state) or b"")
                    await settle()
                await hearing
                assert await heard(slow) < count / 2
            ended.set()
            await serving

    asyncio.run(main())
