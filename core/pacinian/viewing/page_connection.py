"""The connection to one page: its messages and requests. A slow page delays no other page, and builds up no queue."""

from __future__ import annotations

import asyncio
import time
from functools import partial
from typing import TYPE_CHECKING

from pacinian.errors import ArgumentError, WireError
from pacinian.viewing.messages import (
    BatchAck,
    BatchEnd,
    FieldAck,
    Hide,
    Record,
    Skin,
    SkinMessage,
    Slice,
    SliceMessage,
    Volume,
    VolumeMessage,
    decode_message,
    encode_message,
)

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from pacinian.viewing.hub import Drive, Hub
    from pacinian.viewing.messages import FieldRequest, ServerMessage
    from pacinian.viewing.slices import FieldWorker

BATCH_END = encode_message(BatchEnd())
MIN_INTERVAL = 1.0 / 40.0  # minimum interval between slices [s]; frames come 30 times a second


class PageConnection:
    """An open page. send: sends a message, and returns when there is room for another."""

    def __init__(
        self, hub: Hub, fields: FieldWorker, send: Callable[[bytes], Awaitable[None]]
    ) -> None:
        self._hub, self._fields, self._send = hub, fields, send
        self._fresh, self._ready = asyncio.Event(), asyncio.Event()
        self._windows = {name: Window(name) for name in ("slice", "volume", "skin")}
        self._view = hub.join(self._wake)

    def _wake(self) -> None:
        self._fresh.set()
        for window in self._windows.values():
            window.turn.set()

    def close(self) -> None:
        """Remove the view of a page that has gone."""
        self._hub.leave(self._view)

    def hear(self, data: bytes) -> None:
        """Handle a message from the page; refuse a malformed one."""
        try:
            asked = decode_message(data)
        except WireError as error:
            self._refuse("message", str(error))
            return
        match asked:
            case Skin():
                self._windows["skin"].ask(asked)
            case Slice():
                self._windows["slice"].ask(asked)
            case Volume():
                self._windows["volume"].ask(asked)
            case Hide():
                self._windows[asked.what].ask(None)
            case FieldAck():
                for window in self._windows.values():
                    window.note_seen(asked.id)
            case BatchAck():
                self._ready.set()
            case Record():
                self._hub.record(self._view.number, asked.on)
            case _:
                self._hub.ask(self._view.number, asked)

    def _refuse(self, action: str, message: str) -> None:
        self._hub.refuse(self._view.number, action, message)

    async def run(self) -> None:
        """Send what is new, until cancelled or the page disconnects."""
        self._wake()
        async with asyncio.TaskGroup() as tasks:
            for window in self._windows.values():
                tasks.create_task(self._look(window))
            while True:
                await self._fresh.wait()
                self._fresh.clear()
                new = False
                for _, data in self._view.take():
                    await self._send(data)
                    new = True
                if new:  # a socket takes the values of many seconds before it is full
                    self._ready.clear()
                    await self._send(BATCH_END)
                    await self._ready.wait()

    async def _look(self, window: Window) -> None:
        """Send the field of a window whenever its request or the emission changes."""
        while True:
            await window.turn.wait()
            window.turn.clear()
            asked, drive = window.asked, self._hub.drive
            if asked is None or drive is None or window.unseen or window.shown == (asked, drive):
                continue
            begin = time.perf_counter()
            window.shown = asked, drive
            try:
                wanted = partial(window.wants, asked)
                pressure = await self._fields.pressure(asked, drive, wanted)
            except ArgumentError as error:
                self._refuse(window.name, str(error))
                continue
            window.turn.set()  # something may have changed meanwhile
            if pressure is None:
                continue
            window.unseen = asked.id
            await self._send(encode_message(_make_answer(asked, pressure, drive)))
            await asyncio.sleep(begin + MIN_INTERVAL - time.perf_counter())


class Window:
    """A page's request for the field. shown: request and drive that were computed last.

    unseen: id of the last reply until the page acknowledges it, else 0. turn: set when there may be something to do.
    """

    def __init__(self, name: str) -> None:
        self.name, self.unseen, self.turn = name, 0, asyncio.Event()
        self.asked: FieldRequest | None = None
        self.shown: object = None

    def ask(self, asked: FieldRequest | None) -> None:
        """Replace the request; None ends it."""
        self.asked, self.shown = asked, None
        self.turn.set()

    def wants(self, asked: FieldRequest) -> bool:
        """Whether the request is still the current one."""
        return self.asked is asked

    def note_seen(self, number: int) -> None:
        """Note that the page has received the reply with that id."""
        if number == self.unseen:
            self.unseen = 0
            self.turn.set()


def _make_answer(asked: FieldRequest, pressure: bytes, drive: Drive) -> ServerMessage:
    if isinstance(asked, Skin):
        felt, wanted = pressure[: len(pressure) // 2], pressure[len(pressure) // 2 :]
        return SkinMessage(
            id=asked.id, centre=asked.centre, u=asked.u, v=asked.v, size=asked.size,
            shape=asked.shape, felt=felt, asked=wanted, time=drive.time,
        )  # fmt: skip
    if isinstance(asked, Slice):
        return SliceMessage(
            id=asked.id, centre=asked.centre, u=asked.u, v=asked.v, size=asked.size,
            shape=asked.shape, of=asked.of, over=asked.over, frames=drive.frames(asked),
            pressure=pressure, time=drive.time,
        )  # fmt: skip
    return VolumeMessage(
        id=asked.id, origin=asked.origin, spacing=asked.spacing, shape=asked.shape,
        pressure=pressure, time=drive.time,
    )  # fmt: skip
