"""The guard's devices. Threads open and close them, so that the sounding device continues to play."""

from __future__ import annotations

import functools
import itertools
import queue
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, cast

from pacinian.argument_checks import check_kind
from pacinian.errors import BackendError, describe_error
from pacinian.plugins.backend import Capability
from pacinian.rendering.clock import SystemClock
from pacinian.rendering.row_times import check_server_rate
from pacinian.scene.config_sections import PluginConfig
from pacinian.serving.ipc import plugin_list
from pacinian.serving.ipc.messages import SUPERSEDED
from pacinian.serving.ipc.scheduling import raise_priority, start_background_thread

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.array import Array
    from pacinian.plugins.backend import Backend
    from pacinian.rendering.clock import Clock
    from pacinian.serving.guard.output_gate import OutputGate
    from pacinian.serving.ipc.messages import Selections
    from pacinian.wire.control import Choice

# Maximum number of results kept.
MAX_RESULTS = 16
# Time limit to open a device [s]. Clients wait longer, so they still learn why there is no device.
OPEN_TIMEOUT = 8.0
# Number of threads that may hang in abandoned devices; only the end of the process ends them.
MAX_HANGING = 4
# Time during which to retry a device that another process has just left, and pause between retries [s].
RETRY_TIME, RETRY_INTERVAL = 1.0, 0.02


class OpenResult(NamedTuple):
    """The result of opening a device. keys: of the results of the selections and resets that wait for it.

    problem: why there is no device. wrong_setting: the setting, "backend" or "rate", that no device could accept.
    """

    keys: tuple[str, ...]
    choice: Choice | PluginConfig
    device: tuple[Backend, Capability] | None = None
    problem: str = ""
    wrong_setting: str = ""


@dataclass(eq=False)
class OpenAttempt:
    """An attempt to open a device, in a thread. keys: as in `OpenResult`.

    devices_to_close: devices to close first. previous_guard_device: the device of the guard before this one, which may
    still sound. The thread opens and closes it first, which silences it. since: when the attempt began [s]. until: when
    to stop retrying [s].
    """

    keys: tuple[str, ...]
    choice: Choice | PluginConfig
    devices_to_close: list[Backend]
    previous_guard_device: PluginConfig | None
    since: float
    until: float


class NextDevice:
    """The next device to open. choice: the selected device; None reopens the current one.

    selection: key of its result, or "". resets: keys of the results of the resets that also wait for this device.
    devices_to_close: devices to close first.
    """

    def __init__(self) -> None:
        self.choice: Choice | PluginConfig | None = None
        self.selection = ""
        self.resets: list[str] = []
        self.devices_to_close: list[Backend] = []

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of all results that wait."""
        return (self.selection, *self.resets) if self.selection else tuple(self.resets)


class DeviceManager:
    """Gives an output gate its devices, as selected. It opens one at a time, and keeps only the newest that waits.

    choice: the first device. array: the array that the devices drive. rate: of the loop [Hz]. make, thread, clock: for
    tests.

    A device that has not opened within `OPEN_TIMEOUT` is abandoned. If its thread opens it later, it is closed and
    never sounds.
    """

    def __init__(
        self,
        gate: OutputGate,
        array: Array,
        choice: Choice | PluginConfig,
        rate: float,
        make: Callable[[Choice | PluginConfig], Backend] | None = None,
        thread: Callable[[Callable[[], None]], object] | None = None,
        clock: Clock | None = None,
    ) -> None:
        self.results: dict[str, str] = {}
        self.wrong_setting = ""
        """The setting, "backend" or "rate", that keeps the first device from opening, whatever is connected."""
        self._gate, self._array, self._choice = gate, array, choice
        self._rate = rate
        self._owners = choice
        self._make = make or functools.partial(_make_backend, configured=choice)
        self._thread = thread or functools.partial(start_background_thread, name="device")
        self._clock = clock or SystemClock()
        self._open_results: queue.SimpleQueue[tuple[OpenAttempt, OpenResult]] = queue.SimpleQueue()
        self._selected = self._reset = 0  # number of the last selection, and of the last reset
        self._attempt: OpenAttempt | None = None
        self._hanging = 0  # number of abandoned devices whose threads have not returned
        self._previous_guard_device: PluginConfig | None = None
        self._retry_time = 0.0  # time for which to retry the next device [s]
        self._choices: dict[int, PluginConfig] = {}  # choices by generation
        self._next = NextDevice()  # waits while another device is being opened
        # Maps a generation to the keys of the results that wait for its first frame.
        self._coming: dict[int, tuple[str, ...]] = {}

    def begin(
        self, selections: Selections, previous_guard_device: PluginConfig | None = None
    ) -> None:
        """Open the first device: the one selected before the guard was restarted, or the configured one.

        previous_guard_device: the device of the guard before this one. It may still sound, and the system may hold it
        for a moment.
        """
        self._reset = selections.reset
        self._selected, selected = selections.backend
        self._choice = selected or self._choice
        if previous_guard_device is not None:
            self._choices[0] = previous_guard_device
            self._retry_time = RETRY_TIME
        self._previous_guard_device = previous_guard_device
        self._select(f"backend {self._selected}", self._choice)

    @property
    def choice(self) -> PluginConfig | None:
        """The choice of the guard's device, or of the previous guard's device while this guard has none."""
        return self._choices.get(self._gate.generation)

    @property
    def busy(self) -> bool:
        """Whether a device is being opened, waits for its first frame, or is to be closed."""
        gate = self._gate
        return self._attempt is not None or gate.next_backend is not None or bool(gate.to_close)

    def follow(self, selections: Selections) -> None:
        """Carry out the selections and the reset that are new."""
        number, choice = selections.backend
        if number != self._selected and choice is not None:
            self._selected = number
            self._select(f"backend {number}", choice)
        if selections.reset != self._reset:
            self._reset = selections.reset
            self._reset_or_reopen(f"reset {self._reset}")

    def _select(self, key: str, choice: Choice | PluginConfig) -> None:
        if self._next.selection:
            self._note_result(self._next.selection, SUPERSEDED)
        self._next.selection, self._next.choice = key, choice
        self._open()

    def _reset_or_reopen(self, key: str) -> None:
        """Reset after a fault: switch to the waiting device, or reopen the current one."""
        gate = self._gate
        if gate.fault and gate.next_backend is None:
            self._next.resets.append(key)
            if (old := gate.release()) is not None:
                self._next.devices_to_close.append(old)
            self._open()
            return
        if gate.fault:
            gate.switch_device()
            gate.clear()
        self._note_result(key)

    def poll(self) -> None:
        """Take the devices that have opened, and close those that were replaced."""
        gate = self._gate
        while not self._open_results.empty():
            self._receive_result(*self._open_results.get())
        now, attempt = self._clock.now(), self._attempt
        if attempt is not None and now - attempt.since > OPEN_TIMEOUT:
            self._hanging += 1
            problem = (
                f"{attempt.choice.name}: did not open within {OPEN_TIMEOUT:g} s, and was abandoned"
            )
            self._take(OpenResult(attempt.keys, attempt.choice, problem=problem))
        for key in self._coming.pop(gate.generation, ()):  # the device has got its first frame
            self._note_result(key)
        while gate.to_close and self._start(functools.partial(self._close, gate.to_close[-1])):
            gate.to_close.pop()

    def _receive_result(self, attempt: OpenAttempt, result: OpenResult) -> None:
        if attempt is self._attempt:
            self._take(result)
            return
        self._hanging -= 1
        if result.device is not None:
            self._gate.to_close.append(result.device[0])

    def _take(self, result: OpenResult) -> None:
        gate, (keys, choice, device, problem, self.wrong_setting) = self._gate, result
        self._attempt = None
        if device is None:
            for key in keys:
                self._note_result(key, problem)
            if gate.backend is None:
                gate.clear()
                gate.fail(problem)
        else:
            if gate.backend is not None and self._next.selection:
                gate.to_close.append(device[0])
                for key in keys:
                    self._note_result(key, SUPERSEDED)
            else:
                for late in itertools.chain(*self._coming.values()):
                    self._note_result(late, SUPERSEDED)
                self._choice = choice
                generation = gate.adopt_device(*device)
                self._coming = {generation: keys}
                self._choices = {n: c for n, c in self._choices.items() if n == gate.generation}
                self._choices[generation] = self._convert_choice(choice)
            if any(key.startswith("reset") for key in keys):
                gate.clear()
        self._open()

    def _note_result(self, key: str, problem: str = "") -> None:
        self.results[key] = problem
        self._gate.changed = True
        for old in list(self.results)[:-MAX_RESULTS]:
            del self.results[old]

    def _open(self) -> None:
        """Open the next device, unless one is being opened."""
        ahead, gate = self._next, self._gate
        if self._attempt is not None or not ahead.keys:
            return
        self._next = NextDevice()
        # A device that was selected has taken over meanwhile.
        if ahead.choice is None and gate.backend is not None:
            gate.to_close += ahead.devices_to_close
            gate.clear()
            for key in ahead.resets:
                self._note_result(key)
            return
        choice, now = ahead.choice or self._choice, self._clock.now()
        attempt = OpenAttempt(
            ahead.keys,
            choice,
            ahead.devices_to_close,
            self._previous_guard_device,
            now,
            now + self._retry_time,
        )
        self._attempt, self._previous_guard_device, self._retry_time = attempt, None, 0.0
        work, problem = functools.partial(self._carry_out, attempt), ""
        if self._hanging >= MAX_HANGING:
            problem = (
                f"cannot open another device, because {self._hanging} devices hang while they open: "
                "restart the server"
            )
        elif not self._start(work):
            if gate.backend is None:  # nothing plays on meanwhile
                work()
            else:
                problem = f"{choice.name}: the system permits no more threads"
        if problem:
            gate.to_close += ahead.devices_to_close
            self._take(OpenResult(ahead.keys, choice, problem=problem))

    def _start(self, work: Callable[[], None]) -> bool:
        """Run `work` in a thread; return whether the system permits one."""
        try:
            self._thread(work)
        except RuntimeError:
            return False
        return True

    def _carry_out(self, attempt: OpenAttempt) -> None:
        """Open a device. Runs in a thread."""
        for old in attempt.devices_to_close:
            self._close(old)
        if attempt.previous_guard_device is not None:
            # Only opening and closing this device ends its sound.
            raise_priority()
        if attempt.previous_guard_device not in (None, self._convert_choice(attempt.choice)):
            device = self._try_open(attempt, attempt.previous_guard_device).device
            if device is not None:
                self._close(device[0])
        self._open_results.put((attempt, self._try_open(attempt, attempt.choice)))

    def _try_open(self, attempt: OpenAttempt, choice: Choice | PluginConfig) -> OpenResult:
        """Open a device, with retries until it opens, the time is over, or it was abandoned."""
        while True:
            result = self._try_open_once(attempt, choice)
            if (
                result.device is not None
                or attempt is not self._attempt
                or self._clock.now() >= attempt.until
            ):
                return result
            self._clock.wait_until(self._clock.now() + RETRY_INTERVAL)

    def _convert_choice(self, choice: Choice | PluginConfig) -> PluginConfig:
        """Return the choice as a configuration holds it, with the owner's options if it names the owner's backend."""
        given = choice if isinstance(choice, PluginConfig) else None
        owners = self._owners.options if given is None and choice.name == self._owners.name else {}
        return given or PluginConfig(choice.name, {**owners, **choice.options})

    def _close(self, backend: Backend) -> None:
        # The device was silenced before, or is faulty; a reset reports what is wrong.
        with suppress(BaseException):  # whatever a plug-in raises
            backend.close()
        self._gate.mark_closed(backend)

    def _try_open_once(self, attempt: OpenAttempt, choice: Choice | PluginConfig) -> OpenResult:
        """Try once to open a device. An abandoned device is not opened."""
        backend, keys, checked = None, attempt.keys, "backend"
        # Catch whatever a plug-in raises, because an exception must not end the thread.
        try:
            backend = self._make(choice)
            given = backend.capability
            check_kind("capability", given, Capability)
            checked = "rate"
            check_server_rate(given.rate, self._rate)
            checked = "backend"
            # Checked again: a plug-in may have set fields of it, or derived from it.
            can = Capability(given.phases, given.amplitudes, given.rate, given.watchdog)
            checked = ""
            if attempt is not self._attempt:
                raise BackendError(SUPERSEDED)
            backend.open(self._array)
        except BaseException as error:
            if backend is not None:
                self._close(backend)
            # ArgumentError is a ValueError. A device that is absent raises other errors.
            invalid = any(isinstance(e, TypeError | ValueError) for e in (error, error.__cause__))
            problem = _name_device(choice.name, describe_error(error))
            return OpenResult(
                keys, choice, problem=problem, wrong_setting=checked if invalid else ""
            )
        return OpenResult(keys, choice, (backend, can))


def _make_backend(choice: Choice | PluginConfig, configured: Choice | PluginConfig) -> Backend:
    return cast("Backend", plugin_list.make_plugin("backend", choice, configured))


def _name_device(name: str, problem: str) -> str:
    """Return a problem that begins with the name of its device, once."""
    return f"{name}: {problem.removeprefix(f'{name}: ')}"
