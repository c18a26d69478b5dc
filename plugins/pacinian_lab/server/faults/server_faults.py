"""Faults inside the server, or of its device. Each function injects one fault into a stage, once."""

from __future__ import annotations

import random
import signal
import time
from functools import partial
from typing import TYPE_CHECKING

import psutil

from pacinian.serving.control.supervisor import SPARE, TRUSTED_AFTER
from pacinian.serving.settings import Safety
from pacinian_lab.server.faults.hanging_solver import SINCE, STUCK, Stuck
from pacinian_lab.server.faults.logged_backends import Models, Simulated
from pacinian_lab.server.faults.logging_device import BLOCKED, UNPLUGGED, Other, Probe
from pacinian_lab.server.faults.server import memory
from pacinian_lab.server.faults.stage import QUIET, Times, until

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian_lab.server.faults.stage import Stage

WINDOW = 0.5  # [s] observed for gaps, with and without a swap
STILL = 1.3 * Safety().hung  # [s]
READY, USED = 0.5, 0.03  # [s]: a waiting spare uses less than USED of CPU time in READY
SWAPPING = 0.03  # [s] after a selection during which the swap is in progress


def kill_render(stage: Stage) -> Times:
    """Kill the renderer with kill -9."""
    return _signal_part(stage, "render", signal.SIGKILL)


def stop_render(stage: Stage) -> Times:
    """Stop the renderer with SIGSTOP, until control kills it for hanging."""
    return _signal_part(stage, "render", signal.SIGSTOP)


def kill_bus(stage: Stage) -> Times:
    """Kill the bus with kill -9. Sessions end, and the game says hello again."""
    return _signal_part(stage, "bus", signal.SIGKILL)


def kill_guard(stage: Stage) -> Times:
    """Kill the guard with kill -9. A device without a watchdog sounds until the spare guard has opened it."""
    return _lose_guard(stage, lambda guard: guard.send_signal(signal.SIGKILL))


def stop_guard(stage: Stage) -> Times:
    """Stop the guard with SIGSTOP. Control kills it, and the spare guard takes over."""
    return _lose_guard(stage, lambda guard: guard.send_signal(signal.SIGSTOP))


def block_guard(stage: Stage) -> Times:
    """Block the device in a frame. Control kills the guard, and the spare guard takes over."""
    file = stage.server.folder / BLOCKED
    return _lose_guard(stage, lambda guard: file.touch())


def _lose_guard(stage: Stage, lose: Callable[[psutil.Process], object]) -> Times:
    """Take out the guard while a spare guard is ready."""
    until(lambda: any(_is_waiting(p) for name, p in stage.server.parts().items() if name == SPARE))
    return _inject_loss(stage, lambda: lose(stage.server.parts()["guard"]), quiet=0.0)


def _is_waiting(process: psutil.Process) -> bool:
    """Return whether a process has started up and now waits, using almost no CPU time."""
    before = process.cpu_times()
    time.sleep(READY)
    after = process.cpu_times()
    return bool(
        before.user > 0.0 and after.user + after.system < before.user + before.system + USED
    )


def _signal_part(stage: Stage, part: str, number: int) -> Times:
    process = stage.server.parts()[part]
    if stage.onlooker.ask("status")["restarts"][part]:
        # Control delays the restart of a process that ends repeatedly, and this delay is not to be
        # measured.
        until(lambda: time.time() - process.create_time() > TRUSTED_AFTER)
    return _inject_loss(stage, lambda: process.send_signal(number))


def _inject_loss(stage: Stage, lose: Callable[[], object], quiet: float = QUIET) -> Times:
    def act() -> None:
        stage.answers.clear()
        lose()

    silence = stage.inject_fault(act, quiet)
    recovery = stage.recover(after=0.0)
    told = [answer["code"] for answer in stage.answers if answer["type"] == "error"]
    return Times(silence, recovery, note=f"told: {told[0] if told else 'nothing'}")


def kill_control(stage: Stage) -> Times:
    """Kill the parent with kill -9, which ends its children too, and start a new server."""
    silence = stage.inject_fault(lambda: stage.server.signal("control", signal.SIGKILL))
    until(lambda: not stage.server.list_running())
    gone = time.perf_counter() - stage.at
    stage.server.start()
    return Times(silence, stage.recover(after=gone), note=f"children gone in {1e3 * gone:.0f} ms")


def stop_control(stage: Stage) -> Times:
    """Stop the parent with SIGSTOP, so that nobody renews the permit, then continue it with SIGCONT."""
    silence = stage.inject_fault(lambda: stage.server.signal("control", signal.SIGSTOP))
    return Times(silence, stage.recover(lambda: stage.server.signal("control", signal.SIGCONT)))


def stop_all(stage: Stage) -> Times:
    """Suspend all processes, as on a suspended machine, for longer than `hung`, then resume them. None is replaced."""
    before = stage.server.parts()
    processes = [psutil.Process(stage.server.process.pid), *before.values()]

    def act() -> None:
        for process in processes:
            process.suspend()
        time.sleep(STILL)
        stage.at = time.perf_counter()
        for process in processes:
            process.resume()

    silence = stage.inject_fault(act, quiet=0.0)  # the game may continue at once
    recovery = stage.recover(after=0.0)
    after = stage.server.parts()
    replaced = [name for name, process in before.items() if after.get(name) != process]
    return Times(silence, recovery, note=f"replaced: {replaced}" if replaced else "")


def hang_solver(stage: Stage) -> Times:
    """Select a solver that never returns once the output sounds."""
    return _block_solver(stage, hold=False)


def hold_solver(stage: Stage) -> Times:
    """The same with a solver that holds the interpreter lock."""
    return _block_solver(stage, hold=True)


def _block_solver(stage: Stage, *, hold: bool) -> Times:
    stage.wait_for_sound()
    file, since = stage.server.folder / STUCK, stage.server.folder / SINCE
    since.unlink(missing_ok=True)
    answer = stage.select(solver={"name": Stuck.name, "options": {"hold": hold}})
    if answer["type"] != "ok":
        raise RuntimeError(f"{Stuck.name} cannot be selected: {answer}")
    try:
        stage.inject_fault(file.touch)
        stage.at = float(since.read_text(encoding="ascii"))
        silence, recovery = stage.measure_quiet() - stage.at, stage.recover(after=0.0)
    finally:
        file.unlink(missing_ok=True)
    used = stage.onlooker.ask("status")["solver"]
    stage.select(solver={"name": "auto"})
    return Times(silence, recovery, note=f"then with {used}")


def hang_solver_warming(stage: Stage) -> Times:
    """Select a solver that never returns while it warms up. The previous solver should continue."""
    file = stage.server.folder / STUCK
    undisturbed = stage.measure_gap(lambda: None, 3.0)
    file.touch()
    try:
        gap = stage.measure_gap(lambda: _select(stage, "solver", Stuck.name), 3.0)
    finally:
        file.unlink(missing_ok=True)
    until(lambda: bool(stage.answers))
    stage.select(solver={"name": "auto"})
    return Times(gap=gap, undisturbed=undisturbed)


def swap_solvers(stage: Stage) -> Times:
    """Swap the solver and back while the output sounds."""
    return _swap_each(stage, "solver", "lagrange", "auto")


def swap_devices(stage: Stage) -> Times:
    """Swap the device and back while the output sounds."""
    return _swap_each(stage, "backend", Other.name, Probe.name)


def swap_to_models(stage: Stage) -> Times:
    """Swap from the simulated array to models of USB devices while the output sounds."""
    return _swap_from(stage, Simulated.name, Models.name)


def swap_from_models(stage: Stage) -> Times:
    """Swap from models of USB devices to the simulated array while the output sounds."""
    return _swap_from(stage, Models.name, Simulated.name)


def _swap_from(stage: Stage, old: str, new: str) -> Times:
    stage.wait_for_sound()
    stage.select(backend={"name": old})
    times = _swap_each(stage, "backend", new)
    stage.select(backend={"name": Probe.name})
    return times


def _swap_each(stage: Stage, kind: str, *names: str) -> Times:
    """Select each in turn. Before each selection, observe for as long without a swap."""
    undisturbed, gaps = list[float](), list[float]()
    for name in names:
        undisturbed.append(stage.measure_gap(lambda: None, WINDOW))
        gaps.append(stage.measure_gap(partial(stage.select, **{kind: {"name": name}}), WINDOW))
        if (answer := stage.answers[-1])["type"] != "ok":
            raise RuntimeError(f"{name} cannot be selected: {answer}")
    return Times(gap=max(gaps), undisturbed=max(undisturbed))


def _select(stage: Stage, kind: str, name: str) -> None:
    stage.answers.clear()
    stage.tell("select", **{kind: {"name": name}})


def unplug_device(stage: Stage) -> Times:
    """Unplug the device and plug it in again, then reset."""
    return _unplug(stage, lambda: None)


def unplug_swapping(stage: Stage) -> Times:
    """Unplug the device while solvers are swapped."""
    return _unplug(stage, partial(_begin, stage, "solver", "lagrange"))


def unplug_both(stage: Stage) -> Times:
    """Unplug both devices while one takes over from the other."""
    return _unplug(stage, partial(_begin, stage, "backend", Other.name))


def _begin(stage: Stage, kind: str, name: str) -> None:
    """Start a selection, and return at a random time during the swap."""
    _select(stage, kind, name)
    time.sleep(random.uniform(0.0, SWAPPING))


def _unplug(stage: Stage, before: Callable[[], None]) -> Times:
    onlooker, file = stage.onlooker, stage.server.folder / UNPLUGGED

    def act() -> None:
        before()
        stage.at = time.perf_counter()
        file.touch()

    try:
        silence = stage.inject_fault(act)
        faulted = until(lambda: onlooker.ask("status")["output"] == "faulted")
        told = time.perf_counter() - stage.at
    finally:
        file.unlink(missing_ok=True)
    recovery = stage.recover(lambda: onlooker.ask("reset"))
    stage.select(backend={"name": Probe.name}, solver={"name": "auto"})
    return Times(silence, recovery, note=f"told in {1e3 * told:.0f} ms" if faulted else "")


def terminate_server(stage: Stage) -> Times:
    """Send SIGTERM to the server: silence, exit code 0 and no files left. Then start a new one."""
    stage.wait_for_sound()
    shared = memory(stage.server.process.pid)
    silence = stage.inject_fault(lambda: stage.server.signal("control", signal.SIGTERM))
    code = stage.server.process.wait(10.0)
    took = time.perf_counter() - stage.at
    left = [str(path) for path in (*shared, stage.server.file) if path.exists()]
    left += [str(process) for process in stage.server.list_running()]
    stage.server.start()
    note = f"exit code {code} after {1e3 * took:.0f} ms" + f"; left: {left}" * bool(left)
    return Times(silence, stage.recover(after=took), note=note)
