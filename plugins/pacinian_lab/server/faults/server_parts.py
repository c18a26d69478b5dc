"""What goes wrong inside the server, or at its device. Each function does one to a stage, once."""

from __future__ import annotations

import random
import signal
import time
from functools import partial
from typing import TYPE_CHECKING

import psutil

from pacinian.serving.control.supervisor import SPARE, WELL
from pacinian.serving.settings import Safety
from pacinian_lab.server.faults.device import BLOCKED, UNPLUGGED, Other, Probe
from pacinian_lab.server.faults.logged_backends import Models, Simulated
from pacinian_lab.server.faults.server import memory
from pacinian_lab.server.faults.solvers import SINCE, STUCK, Stuck
from pacinian_lab.server.faults.stage import QUIET, Times, until

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian_lab.server.faults.stage import Stage

WINDOW = 0.5  # [s] that is looked at for gaps, with a swap and without
STILL = 1.3 * Safety().hung  # [s]
READY, USED = 0.5, 0.03  # [s] in which a spare that waits uses less than so much of a processor [s]
SWAPPING = 0.03  # [s] after a selection, in which something is being swapped


def render_killed(stage: Stage) -> Times:
    """kill -9 of the renderer."""
    return _signalled(stage, "render", signal.SIGKILL)


def render_stopped(stage: Stage) -> Times:
    """SIGSTOP of the renderer, until it is killed for it."""
    return _signalled(stage, "render", signal.SIGSTOP)


def bus_killed(stage: Stage) -> Times:
    """kill -9 of the bus: sessions end, the game says hello again."""
    return _signalled(stage, "bus", signal.SIGKILL)


def guard_killed(stage: Stage) -> Times:
    """kill -9 of the guard: a device without a watchdog sounds on until the spare has opened it."""
    return _guard_lost(stage, lambda guard: guard.send_signal(signal.SIGKILL))


def guard_stopped(stage: Stage) -> Times:
    """SIGSTOP of the guard: as before, once it is killed for it."""
    return _guard_lost(stage, lambda guard: guard.send_signal(signal.SIGSTOP))


def guard_blocked(stage: Stage) -> Times:
    """The device does not return from a frame: as before."""
    file = stage.server.folder / BLOCKED
    return _guard_lost(stage, lambda guard: file.touch())


def _guard_lost(stage: Stage, lose: Callable[[psutil.Process], object]) -> Times:
    """Lose the guard while there is a spare, which has had time to make itself ready."""
    until(lambda: any(_waits(p) for name, p in stage.server.parts().items() if name == SPARE))
    return _lost(stage, lambda: lose(stage.server.parts()["guard"]), quiet=0.0)


def _waits(process: psutil.Process) -> bool:
    """Whether it has used no processor to speak of for a while: it has made itself ready, and waits."""
    before = process.cpu_times()
    time.sleep(READY)
    after = process.cpu_times()
    return bool(
        before.user > 0.0 and after.user + after.system < before.user + before.system + USED
    )


def _signalled(stage: Stage, part: str, number: int) -> Times:
    process = stage.server.parts()[part]
    if stage.onlooker.ask("status")["restarts"][part]:
        # one that ends again and again is started later and later, which is not what is measured
        until(lambda: time.time() - process.create_time() > WELL)
    return _lost(stage, lambda: process.send_signal(number))


def _lost(stage: Stage, lose: Callable[[], object], quiet: float = QUIET) -> Times:
    def act() -> None:
        stage.answers.clear()
        lose()

    silence = stage.broken(act, quiet)
    recovery = stage.healed(after=0.0)
    told = [answer["code"] for answer in stage.answers if answer["type"] == "error"]
    return Times(silence, recovery, note=f"told: {told[0] if told else 'nothing'}")


def control_killed(stage: Stage) -> Times:
    """kill -9 of the parent: all its children go, too; a new server."""
    silence = stage.broken(lambda: stage.server.signal("control", signal.SIGKILL))
    until(lambda: not stage.server.left())
    gone = time.perf_counter() - stage.at
    stage.server.start()
    return Times(silence, stage.healed(after=gone), note=f"children gone in {1e3 * gone:.0f} ms")


def control_stopped(stage: Stage) -> Times:
    """SIGSTOP of the parent: nobody renews the permit; SIGCONT."""
    silence = stage.broken(lambda: stage.server.signal("control", signal.SIGSTOP))
    return Times(silence, stage.healed(lambda: stage.server.signal("control", signal.SIGCONT)))


def all_stopped(stage: Stage) -> Times:
    """SIGSTOP of all, as where the machine stands still, for longer than one may hang; SIGCONT: none is replaced."""
    before = stage.server.parts()
    processes = [psutil.Process(stage.server.process.pid), *before.values()]

    def act() -> None:
        for process in processes:
            process.suspend()
        time.sleep(STILL)
        stage.at = time.perf_counter()
        for process in processes:
            process.resume()

    silence = stage.broken(act, quiet=0.0)  # the game may be there again at once
    recovery = stage.healed(after=0.0)
    after = stage.server.parts()
    replaced = [name for name, process in before.items() if after.get(name) != process]
    return Times(silence, recovery, note=f"replaced: {replaced}" if replaced else "")


def solver_hangs(stage: Stage) -> Times:
    """A solver that was selected while it sounded never returns."""
    return _stuck(stage, hold=False)


def solver_holds(stage: Stage) -> Times:
    """The same, and it holds the interpreter lock."""
    return _stuck(stage, hold=True)


def _stuck(stage: Stage, *, hold: bool) -> Times:
    stage.sounding()
    file, since = stage.server.folder / STUCK, stage.server.folder / SINCE
    since.unlink(missing_ok=True)
    answer = stage.select(solver={"name": Stuck.name, "options": {"hold": hold}})
    if answer["type"] != "ok":
        raise RuntimeError(f"{Stuck.name} cannot be selected: {answer}")
    try:
        stage.broken(file.touch)
        stage.at = float(since.read_text(encoding="ascii"))
        silence, recovery = stage.quiet() - stage.at, stage.healed(after=0.0)
    finally:
        file.unlink(missing_ok=True)
    used = stage.onlooker.ask("status")["solver"]
    stage.select(solver={"name": "auto"})
    return Times(silence, recovery, note=f"then with {used}")


def solver_hangs_warming(stage: Stage) -> Times:
    """A solver that never returns is selected: the one before should sound on."""
    file = stage.server.folder / STUCK
    undisturbed = stage.gap(lambda: None, 3.0)
    file.touch()
    try:
        gap = stage.gap(lambda: _select(stage, "solver", Stuck.name), 3.0)
    finally:
        file.unlink(missing_ok=True)
    until(lambda: bool(stage.answers))
    stage.select(solver={"name": "auto"})
    return Times(gap=gap, undisturbed=undisturbed)


def solvers_swapped(stage: Stage) -> Times:
    """Another solver, and back, while it sounds."""
    return _swapped(stage, "solver", "lagrange", "auto")


def devices_swapped(stage: Stage) -> Times:
    """Another device, and back, while it sounds."""
    return _swapped(stage, "backend", Other.name, Probe.name)


def to_models(stage: Stage) -> Times:
    """Models of USB devices take over from the simulated array while it sounds."""
    return _from(stage, Simulated.name, Models.name)


def from_models(stage: Stage) -> Times:
    """The simulated array takes over from models of USB devices while they sound."""
    return _from(stage, Models.name, Simulated.name)


def _from(stage: Stage, old: str, new: str) -> Times:
    stage.sounding()
    stage.select(backend={"name": old})
    times = _swapped(stage, "backend", new)
    stage.select(backend={"name": Probe.name})
    return times


def _swapped(stage: Stage, kind: str, *names: str) -> Times:
    """Select each; before each, look on for as long while nothing is done."""
    undisturbed, gaps = list[float](), list[float]()
    for name in names:
        undisturbed.append(stage.gap(lambda: None, WINDOW))
        gaps.append(stage.gap(partial(stage.select, **{kind: {"name": name}}), WINDOW))
        if (answer := stage.answers[-1])["type"] != "ok":
            raise RuntimeError(f"{name} cannot be selected: {answer}")
    return Times(gap=max(gaps), undisturbed=max(undisturbed))


def _select(stage: Stage, kind: str, name: str) -> None:
    stage.answers.clear()
    stage.tell("select", **{kind: {"name": name}})


def unplugged(stage: Stage) -> Times:
    """The device is gone, and back; reset."""
    return _unplugged(stage, lambda: None)


def unplugged_swapping(stage: Stage) -> Times:
    """The device is gone while solvers are swapped."""
    return _unplugged(stage, partial(_begin, stage, "solver", "lagrange"))


def unplugged_both(stage: Stage) -> Times:
    """Both devices are gone while one takes over from the other."""
    return _unplugged(stage, partial(_begin, stage, "backend", Other.name))


def _begin(stage: Stage, kind: str, name: str) -> None:
    """Select it, and go on somewhere in the middle."""
    _select(stage, kind, name)
    time.sleep(random.uniform(0.0, SWAPPING))


def _unplugged(stage: Stage, before: Callable[[], None]) -> Times:
    onlooker, file = stage.onlooker, stage.server.folder / UNPLUGGED

    def act() -> None:
        before()
        stage.at = time.perf_counter()
        file.touch()

    try:
        silence = stage.broken(act)
        faulted = until(lambda: onlooker.ask("status")["output"] == "faulted")
        told = time.perf_counter() - stage.at
    finally:
        file.unlink(missing_ok=True)
    recovery = stage.healed(lambda: onlooker.ask("reset"))
    stage.select(backend={"name": Probe.name}, solver={"name": "auto"})
    return Times(silence, recovery, note=f"told in {1e3 * told:.0f} ms" if faulted else "")


def terminated(stage: Stage) -> Times:
    """SIGTERM of the server: silent, exit code 0, no file left; a new one."""
    stage.sounding()
    shared = memory(stage.server.process.pid)
    silence = stage.broken(lambda: stage.server.signal("control", signal.SIGTERM))
    code = stage.server.process.wait(10.0)
    took = time.perf_counter() - stage.at
    left = [str(path) for path in (*shared, stage.server.file) if path.exists()]
    left += [str(process) for process in stage.server.left()]
    stage.server.start()
    note = f"exit code {code} after {1e3 * took:.0f} ms" + f"; left: {left}" * bool(left)
    return Times(silence, stage.healed(after=took), note=note)
