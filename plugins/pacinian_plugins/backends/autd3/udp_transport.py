"""Transport to units on a network, or to a stand-in: a client of the AUTD3 packages in a thread of its own."""

from __future__ import annotations

import asyncio
import threading
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import pacinian as pc
from pacinian_plugins.backends.autd3.commands import make_silent, make_unramped
from pacinian_plugins.backends.autd3.error_advice import describe_loss, explain
from pacinian_plugins.backends.autd3.packages import NAME, import_package

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Sequence

    from pacinian_plugins.backends.autd3.transport_interface import Due

OPENING = 60.0  # timeout of opening [s]; the packages give up earlier
CHECK_INTERVAL = 1.0  # interval at which the units' failsafe is checked [s]
TRIES = 3  # attempts to release the failsafe
EXTRA_TIME = 1.0  # time that a call may take beyond the timeout of the units [s]


class UdpTransport:
    """Transport through a client of the AUTD3 packages.

    geometry: of the units. option: link option of the packages. watchdog: time without frames after which the units
    fall silent [s]. timeout: time for which they may not answer [s]. clock: [s]. failsafe: whether to configure the
    watchdog on the units. units: stand-in for the units, kept alive while open. Raises BackendError.
    """

    def __init__(
        self,
        geometry: Any,
        option: Any,
        watchdog: float,
        timeout: float,
        clock: Callable[[], float],
        failsafe: bool = True,
        units: Any = None,
    ) -> None:
        self.failures, self.units = 0, units
        self._timeout, self._clock = timeout, clock
        self._watchdog, self._failsafe = watchdog, failsafe
        self._api, self._commands = import_package("autd3"), import_package("autd3.commands")
        self._error: Any = self._api.Autd3Error
        self._nop: list[Due] = [(self._api.Frames.encode(geometry, self._commands.Nop()), None)]
        self._silent = make_silent(len(geometry))
        self._next: Sequence[Due] = ()
        self._sent = self._looked = clock()
        self._failing: float | None = None  # time of the first failure without an answer since [s]
        self._problem = ""
        self._silences = 0
        self._tasks: set[asyncio.Task[None]] = set()
        self._client: Any = None
        self._wake = asyncio.Event()
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name=NAME, daemon=True)
        self._thread.start()
        try:
            self._ask(self._open(geometry, option), OPENING)
        except BaseException:
            self.close()
            raise

    # ------------------------------------------------------------------ in the caller's thread

    @property
    def time(self) -> float:
        """The units' clock [s]. Raises BackendError."""
        try:
            return float(self._client.device_time_now().sys_time) * 1e-9
        except self._error as error:
            raise pc.BackendError(explain(error)) from error

    @property
    def waits(self) -> bool:
        """Whether the last post is still waiting to be sent."""
        return bool(self._next) and self._next is not self._nop

    def post(self, updates: Sequence[Due]) -> None:
        """Queue these frames in place of waiting ones, without blocking. An empty post is a heartbeat."""
        if not updates:
            if self._next or self._clock() - self._sent < 0.25 * self._watchdog:
                return
            updates = self._nop
        self._next = updates
        self._loop.call_soon_threadsafe(self._wake.set)

    def check(self) -> None:
        """Raise BackendError if the units do not accept frames."""
        if self._problem:
            raise pc.BackendError(self._problem)

    def silence(self) -> None:
        """Stop all sound, and confirm it. Units lost for longer than the watchdog's time are already silent.

        Raises BackendError.
        """
        gone = self._problem and self._clock() - self._sent > self._watchdog
        if not (gone and self._failsafe):
            self._ask(self._send_silence(), self._timeout + EXTRA_TIME)

    def close(self) -> None:
        """Silence the units and disconnect. Never raises."""
        if self._loop.is_closed():
            return
        with suppress(Exception):
            self._ask(self._close_client(), self._timeout + EXTRA_TIME)
        self._client = self.units = None
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(EXTRA_TIME)
        if not self._thread.is_alive():
            self._loop.close()

    def _ask(self, work: Coroutine[Any, Any, None], timeout: float) -> None:
        """Run a coroutine in the client's thread and wait for it. Raises BackendError."""
        asked = asyncio.run_coroutine_threadsafe(work, self._loop)
        try:
            asked.result(timeout)
        except TimeoutError as error:
            asked.cancel()
            raise pc.BackendError(f"{NAME}: took more than {timeout:g} s: open it again") from error
        except self._error as error:
            raise pc.BackendError(explain(error)) from error

    # ------------------------------------------------------------------ in the client's thread

    async def _open(self, geometry: Any, option: Any) -> None:
        duration = self._api.Duration.from_secs_f64
        config = self._api.ClientConfig(
            ack_timeout=duration(0.25 * self._timeout), require_supported_firmware=True
        )
        self._client = await self._api.Client.open(geometry, option, config)
        if self._failsafe:
            cpu = self._commands.CpuConfig(failsafe_timeout=duration(self._watchdog))
            await self._client.send(self._commands.SetCpuConfig(cpu))
        await self._client.send([make_unramped(), self._silent])
        self._sent = self._clock()
        self._begin(self._pump())

    def _begin(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _pump(self) -> None:
        """Send posted frames, for ever."""
        while True:
            await self._wake.wait()
            self._wake.clear()
            updates, self._next = self._next, ()
            try:
                await self._send(updates)
            except Exception as error:
                self._count_failure(error)

    async def _send(self, updates: Sequence[Due]) -> None:
        silences, before = self._silences, self._sent
        for frames, due in updates:
            at = self._api.ExecAt.Immediate if due is None else _at(self._api, due)
            for frame in frames:
                if silences != self._silences:
                    return
                response = await self._client.send_frame_at(frame, at)
                self._sent = self._clock()
                self._begin(self._await_answer(response))
        if self._sent - before > 0.5 * self._watchdog or self._sent - self._looked > CHECK_INTERVAL:
            await self._release_failsafe()

    async def _await_answer(self, response: Any) -> None:
        """Await the answer to a frame."""
        try:
            (await response).check()
            self._failing = None
        except self._error as error:
            self._count_failure(error)

    async def _release_failsafe(self) -> None:
        """Release the units' failsafe if it has silenced them, now that frames are sent again."""
        self._looked = self._clock()
        for _ in range(TRIES):
            states = await self._client.read_fpga_state()
            if not any(state.is_failsafe_active() for state in states):
                return
            with suppress(self._error):
                await self._client.send(self._commands.ReleaseFailsafe())

    def _count_failure(self, error: Exception) -> None:
        """Count a lost frame. It is a fault if a unit is lost, sending is impossible, or the timeout has passed."""
        self.failures += 1
        now, gone = self._clock(), False
        self._failing = now if self._failing is None else self._failing
        with suppress(self._error):
            gone = self._client.state_checker().check().any_lost
        code = getattr(error, "code", self._error.INVALID_ARGUMENT)
        hopeless = code in (self._error.NETWORK, self._error.INVALID_ARGUMENT)
        if gone or hopeless or now - self._failing > self._timeout:
            self._problem = describe_loss() if gone else explain(error)

    async def _send_silence(self) -> None:
        self._silences += 1
        self._next, due = (), self._clock() + self._timeout
        while True:
            try:
                await self._client.send(self._silent)
                return
            except self._error:
                if self._clock() >= due:
                    raise

    async def _close_client(self) -> None:
        try:
            if self._client is not None:
                self._silences += 1
                await self._client.close()
        finally:
            for task in self._tasks:
                task.cancel()
            await asyncio.gather(*self._tasks, return_exceptions=True)


def _at(api: Any, due: float) -> Any:
    """Return the execution time `due` [s] as an object of the packages."""
    time = import_package("autd3.value").SysTime.from_nanos(round(1e9 * due))
    return api.ExecAt.At(time)
