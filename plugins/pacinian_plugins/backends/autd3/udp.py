"""Units on a network, or what stands for them there: a client of the AUTD3 packages, in a thread of its own."""

from __future__ import annotations

import asyncio
import threading
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import pacinian as pc
from pacinian_plugins.backends.autd3.commands import make_exact, make_silent
from pacinian_plugins.backends.autd3.error_advice import explain
from pacinian_plugins.backends.autd3.packages import NAME, import_package

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Sequence

    from pacinian_plugins.backends.autd3.transport import Due

OPENING = 60.0  # [s]; the packages give up before
LOOK = 1.0  # [s] between two looks whether the units' failsafe has silenced them
TRIES = 3  # of ending that
MORE = 1.0  # [s] that a call may take beyond the time in which units must answer


class UdpTransport:
    """Units that a client of the packages reaches.

    geometry: of the units. option: how they are reached. watchdog: after which they are silent when nothing is sent
    [s]. timeout: for which they may not answer [s]. clock: [s]. failsafe: whether they are to be told of the watchdog.
    units: what stands for them, held while it is open. Raises BackendError.
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
        self._failing: float | None = None  # [s] since when nothing was answered
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
        """Whether what was posted last still waits to be sent."""
        return bool(self._next) and self._next is not self._nop

    def post(self, told: Sequence[Due]) -> None:
        """Send these, in place of what still waits, without waiting; nothing to tell says that the host is alive."""
        if not told:
            if self._next or self._clock() - self._sent < 0.25 * self._watchdog:
                return
            told = self._nop
        self._next = told
        self._loop.call_soon_threadsafe(self._wake.set)

    def check(self) -> None:
        """Raise BackendError if the units do not take what they are sent."""
        if self._problem:
            raise pc.BackendError(self._problem)

    def silence(self) -> None:
        """End all sound, and be sure of it. Units that have been lost for the watchdog's time are silent.

        Raises BackendError.
        """
        gone = self._problem and self._clock() - self._sent > self._watchdog
        if not (gone and self._failsafe):
            self._ask(self._silenced(), self._timeout + MORE)

    def close(self) -> None:
        """Silence the units and let them go. Never raises."""
        if self._loop.is_closed():
            return
        with suppress(Exception):
            self._ask(self._closed(), self._timeout + MORE)
        self._client = self.units = None
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(MORE)
        if not self._thread.is_alive():
            self._loop.close()

    def _ask(self, work: Coroutine[Any, Any, None], timeout: float) -> None:
        """Have something done in the client's thread. Raises BackendError."""
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
        await self._client.send([make_exact(), self._silent])
        self._sent = self._clock()
        self._begin(self._pump())

    def _begin(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _pump(self) -> None:
        """Send what is posted."""
        while True:
            await self._wake.wait()
            self._wake.clear()
            told, self._next = self._next, ()
            try:
                await self._send(told)
            except Exception as error:
                self._failed(error)

    async def _send(self, told: Sequence[Due]) -> None:
        silences, before = self._silences, self._sent
        for frames, due in told:
            at = self._api.ExecAt.Immediate if due is None else _at(self._api, due)
            for frame in frames:
                if silences != self._silences:
                    return
                response = await self._client.send_frame_at(frame, at)
                self._sent = self._clock()
                self._begin(self._settled(response))
        if self._sent - before > 0.5 * self._watchdog or self._sent - self._looked > LOOK:
            await self._released()

    async def _settled(self, response: Any) -> None:
        """Wait for the answer to a frame."""
        try:
            (await response).check()
            self._failing = None
        except self._error as error:
            self._failed(error)

    async def _released(self) -> None:
        """End the silence that the units' failsafe may have begun, now that they are told again what to play."""
        self._looked = self._clock()
        for _ in range(TRIES):
            states = await self._client.read_fpga_state()
            if not any(state.is_failsafe_active() for state in states):
                return
            with suppress(self._error):
                await self._client.send(self._commands.ReleaseFailsafe())

    def _failed(self, error: Exception) -> None:
        """One more was lost: a fault if a unit is, if it cannot be sent, or if nothing was answered for too long."""
        self.failures += 1
        now, gone = self._clock(), False
        self._failing = now if self._failing is None else self._failing
        with suppress(self._error):
            gone = self._client.state_checker().check().any_lost
        code = getattr(error, "code", self._error.INVALID_ARGUMENT)
        hopeless = code in (self._error.NETWORK, self._error.INVALID_ARGUMENT)
        if gone or hopeless or now - self._failing > self._timeout:
            self._problem = explain(error, gone)

    async def _silenced(self) -> None:
        self._silences += 1
        self._next, due = (), self._clock() + self._timeout
        while True:
            try:
                await self._client.send(self._silent)
                return
            except self._error:
                if self._clock() >= due:
                    raise

    async def _closed(self) -> None:
        try:
            if self._client is not None:
                self._silences += 1
                await self._client.close()
        finally:
            for task in self._tasks:
                task.cancel()
            await asyncio.gather(*self._tasks, return_exceptions=True)


def _at(api: Any, due: float) -> Any:
    """When to take effect, as the packages say it."""
    time = import_package("autd3.value").SysTime.from_nanos(round(1e9 * due))
    return api.ExecAt.At(time)
