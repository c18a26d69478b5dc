"""Faults inside the server, or of its device. Each function injects one fault into a rig, once."""

from __future__ import annotations

import random
import signal
import time
from functools import partial
from typing import TYPE_CHECKING

import psutil

from pacinian.serving.control.supervisor import BACKOFF_RESET_TIME, SPARE
from pacinian.serving.settings import Safety
from pacinian_lab.server.faults.hanging_solver import SINCE, STUCK, Stuck
from pacinian_lab.server.faults.logged_backends import Models, Simulated
from pacinian_lab.server.faults.logging_device import BLOCKED, UNPLUGGED, Other, Probe
from pacinian_lab.server.faults.rig import QUIET, Times, until
from pacinian_lab.server.faults.server import memory

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian_lab.server.faults.rig import Rig

WINDOW = 0.5  # [s] observed for gaps, with and without a swap
STILL = 1.3 * Safety().hang_timeout  # [s]
READY, USED = 0.5, 0.03  # [s]: a waiting spare uses less than USED of CPU time in READY
SWAPPING = 0.03  # [s] after a selection during which the swap is in progress


def kill_render(rig: Rig) -> Times:
    """Kill the renderer with kill -9."""
    return _signal_part(rig, "render", signal.SIGKILL)


def stop_render(rig: Rig) -> Times:
    """Stop the renderer with SIGSTOP, until control kills it for hanging."""
    return _signal_part(rig, "render", signal.SIGSTOP)


def kill_bus(rig: Rig) -> Times:
    """Kill the bus with kill -9. Sessions end, and the game says hello again."""
    return _signal_part(rig, "bus", signal.SIGKILL)


def kill_guard(rig: Rig) -> Times:
    """Kill the guard with kill -9. A device without a watchdog sounds until the spare guard has opened it."""
    return _lose_guard(rig, lambda guard: guard.send_signal(signal.SIGKILL))


def stop_guard(rig: Rig) -> Times:
    """Stop the guard with SIGSTOP. Control kills it, and the spare guard takes over."""
    return _lose_guard(rig, lambda guard: guard.send_signal(signal.SIGSTOP))


def block_guard(rig: Rig) -> Times:
    """Block the device in a frame. Control kills the guard, and the spare guard takes over."""
    file = rig.server.folder / BLOCKED
    return _lose_guard(rig, lambda guard: file.touch())


def _lose_guard(rig: Rig, lose: Callable[[psutil.Process], object]) -> Times:
    """Take out the guard while a spare guard is ready."""
    until(lambda: any(_is_waiting(p) for name, p in rig.server.parts().items() if name == SPARE))
    return _inject_loss(rig, lambda: lose(rig.server.parts()["guard"]), quiet=0.0)


def _is_waiting(process: psutil.Process) -> bool:
    """Return whether a process has started up and now waits, using almost no CPU time."""
    before = process.cpu_times()
    time.sleep(READY)
    after = process.cpu_times()
    return bool(
        before.user > 0.0 and after.user + after.system < before.user + before.system + USED
    )


def _signal_part(rig: Rig, part: str, number: int) -> Times:
    process = rig.server.parts()[part]
    if rig.onlooker.ask("status")["restarts"][part]:
        # Control delays the restart of a process that ends repeatedly, and this delay is not to be
        # measured.
        until(lambda: time.time() - process.create_time() > BACKOFF_RESET_TIME)
    return _inject_loss(rig, lambda: process.send_signal(number))


def _inject_loss(rig: Rig, lose: Callable[[], object], quiet: float = QUIET) -> Times:
    def act() -> None:
        rig.answers.clear()
        lose()

    silence = rig.inject_fault(act, quiet)
    recovery = rig.recover(after=0.0)
    codes = [answer["code"] for answer in rig.answers if answer["type"] == "error"]
    return Times(silence, recovery, note=f"reported: {codes[0] if codes else 'nothing'}")


def kill_control(rig: Rig) -> Times:
    """Kill the parent with kill -9, which ends its children too, and start a new server."""
    silence = rig.inject_fault(lambda: rig.server.signal("control", signal.SIGKILL))
    until(lambda: not rig.server.list_running())
    gone = time.perf_counter() - rig.at
    rig.server.start()
    return Times(silence, rig.recover(after=gone), note=f"children gone in {1e3 * gone:.0f} ms")


def stop_control(rig: Rig) -> Times:
    """Stop the parent with SIGSTOP, so that nobody renews the permit, then continue it with SIGCONT."""
    silence = rig.inject_fault(lambda: rig.server.signal("control", signal.SIGSTOP))
    return Times(silence, rig.recover(lambda: rig.server.signal("control", signal.SIGCONT)))


def stop_all(rig: Rig) -> Times:
    """Suspend all processes for longer than `hang_timeout`, as on a suspended machine, then resume them.

    None is replaced.
    """
    before = rig.server.parts()
    processes = [psutil.Process(rig.server.process.pid), *before.values()]

    def act() -> None:
        for process in processes:
            process.suspend()
        time.sleep(STILL)
        rig.at = time.perf_counter()
        for process in processes:
            process.resume()

    silence = rig.inject_fault(act, quiet=0.0)  # the game may continue at once
    recovery = rig.recover(after=0.0)
    after = rig.server.parts()
    replaced = [name for name, process in before.items() if after.get(name) != process]
    return Times(silence, recovery, note=f"replaced: {replaced}" if replaced else "")


def hang_solver(rig: Rig) -> Times:
    """Select a solver that never returns once the output sounds."""
    return _block_solver(rig, hold=False)


def hold_solver(rig: Rig) -> Times:
    """The same with a solver that holds the interpreter lock."""
    return _block_solver(rig, hold=True)


def _block_solver(rig: Rig, *, hold: bool) -> Times:
    rig.wait_for_sound()
    file, since = rig.server.folder / STUCK, rig.server.folder / SINCE
    since.unlink(missing_ok=True)
    answer = rig.select(solver={"name": Stuck.name, "options": {"hold": hold}})
    if answer["type"] != "ok":
        raise RuntimeError(f"{Stuck.name} cannot be selected: {answer}")
    try:
        rig.inject_fault(file.touch)
        rig.at = float(since.read_text(encoding="ascii"))
        silence, recovery = rig.measure_quiet() - rig.at, rig.recover(after=0.0)
    finally:
        file.unlink(missing_ok=True)
    used = rig.onlooker.ask("status")["solver"]
    rig.select(solver={"name": "auto"})
    return Times(silence, recovery, note=f"then with {used}")


def hang_solver_warming(rig: Rig) -> Times:
    """Select a solver that never returns while it warms up. The previous solver should continue."""
    file = rig.server.folder / STUCK
    undisturbed = rig.measure_gap(lambda: None, 3.0)
    file.touch()
    try:
        gap = rig.measure_gap(lambda: _select(rig, "solver", Stuck.name), 3.0)
    finally:
        file.unlink(missing_ok=True)
    until(lambda: bool(rig.answers))
    rig.select(solver={"name": "auto"})
    return Times(gap=gap, undisturbed=undisturbed)


def swap_solvers(rig: Rig) -> Times:
    """Swap the solver and back while the output sounds."""
    return _swap_each(rig, "solver", "lagrange", "auto")


def swap_devices(rig: Rig) -> Times:
    """Swap the device and back while the output sounds."""
    return _swap_each(rig, "backend", Other.name, Probe.name)


def swap_to_models(rig: Rig) -> Times:
    """Swap from the simulated array to models of USB devices while the output sounds."""
    return _swap_from(rig, Simulated.name, Models.name)


def swap_from_models(rig: Rig) -> Times:
    """Swap from models of USB devices to the simulated array while the output sounds."""
    return _swap_from(rig, Models.name, Simulated.name)


def _swap_from(rig: Rig, old: str, new: str) -> Times:
    rig.wait_for_sound()
    rig.select(backend={"name": old})
    times = _swap_each(rig, "backend", new)
    rig.select(backend={"name": Probe.name})
    return times


def _swap_each(rig: Rig, kind: str, *names: str) -> Times:
    """Select each in turn. Before each selection, observe for as long without a swap."""
    undisturbed, gaps = list[float](), list[float]()
    for name in names:
        undisturbed.append(rig.measure_gap(lambda: None, WINDOW))
        gaps.append(rig.measure_gap(partial(rig.select, **{kind: {"name": name}}), WINDOW))
        if (answer := rig.answers[-1])["type"] != "ok":
            raise RuntimeError(f"{name} cannot be selected: {answer}")
    return Times(gap=max(gaps), undisturbed=max(undisturbed))


def _select(rig: Rig, kind: str, name: str) -> None:
    rig.answers.clear()
    rig.tell("select", **{kind: {"name": name}})


def unplug_device(rig: Rig) -> Times:
    """Unplug the device and plug it in again, then reset."""
    return _unplug(rig, lambda: None)


def unplug_swapping(rig: Rig) -> Times:
    """Unplug the device while solvers are swapped."""
    return _unplug(rig, partial(_begin, rig, "solver", "lagrange"))


def unplug_both(rig: Rig) -> Times:
    """Unplug both devices while one takes over from the other."""
    return _unplug(rig, partial(_begin, rig, "backend", Other.name))


def _begin(rig: Rig, kind: str, name: str) -> None:
    """Start a selection, and return at a random time during the swap."""
    _select(rig, kind, name)
    time.sleep(random.uniform(0.0, SWAPPING))


def _unplug(rig: Rig, before: Callable[[], None]) -> Times:
    onlooker, file = rig.onlooker, rig.server.folder / UNPLUGGED

    def act() -> None:
        before()
        rig.at = time.perf_counter()
        file.touch()

    try:
        silence = rig.inject_fault(act)
        faulted = until(lambda: onlooker.ask("status")["output"] == "faulted")
        delay = time.perf_counter() - rig.at
    finally:
        file.unlink(missing_ok=True)
    recovery = rig.recover(lambda: onlooker.ask("reset"))
    rig.select(backend={"name": Probe.name}, solver={"name": "auto"})
    return Times(silence, recovery, note=f"reported in {1e3 * delay:.0f} ms" if faulted else "")


def terminate_server(rig: Rig) -> Times:
    """Send SIGTERM to the server: silence, exit code 0 and no files left. Then start a new one."""
    rig.wait_for_sound()
    shared = memory(rig.server.process.pid)
    silence = rig.inject_fault(lambda: rig.server.signal("control", signal.SIGTERM))
    code = rig.server.process.wait(10.0)
    took = time.perf_counter() - rig.at
    left = [str(path) for path in (*shared, rig.server.file) if path.exists()]
    left += [str(process) for process in rig.server.list_running()]
    rig.server.start()
    note = f"exit code {code} after {1e3 * took:.0f} ms" + f"; left: {left}" * bool(left)
    return Times(silence, rig.recover(after=took), note=note)
