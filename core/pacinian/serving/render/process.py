"""The render process: the loop, the scene that is felt, solver plug-ins. Its frames go to the guard.

It ends with its parent, or on SIGTERM; the last thing it hands over is silence.
"""

from __future__ import annotations

import _thread
import functools
import signal
import sys
import time
from contextlib import ExitStack

from msgspec.msgpack import Decoder

from pacinian.plugins.backend import Capability
from pacinian.serving.ipc import child_process, scheduling
from pacinian.serving.ipc.messages import DeviceStatus
from pacinian.serving.ipc.plugin_list import list_offers
from pacinian.serving.ipc.shared_memory import SharedRegister
from pacinian.serving.render.background_loader import BackgroundLoader
from pacinian.serving.render.loop import FILES, ServerLoop
from pacinian.serving.render.solver_switcher import SolverSwitcher, make_solver
from pacinian.serving.render.warmup import warm_up

SWITCH = (
    1e-4  # [s] after which another thread gets the interpreter: helpers must not hold up a tick
)
LOOK = 0.002  # [s] between two looks for a device


def main() -> None:
    """Render until told to end."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    told = child_process.read_launch_config(lambda: _thread.interrupt_main(signal.SIGTERM))
    sys.setswitchinterval(SWITCH)
    try:
        _render(told)
    except KeyboardInterrupt:
        return


def _render(told: child_process.LaunchConfig) -> None:
    settings = told.settings
    with ExitStack() as stack:
        files = {
            name: stack.enter_context(SharedRegister.attach(told.path / name)) for name in FILES
        }
        array, medium = settings.array.make(), settings.medium.make()
        chosen = make_solver(settings.solver)
        warm_up(array, medium, chosen, Capability(rate=settings.rate), settings.rate)
        while (newest := files["device"].read()) is None:
            time.sleep(LOOK)
        device = Decoder(DeviceStatus).decode(newest[1])
        loop = ServerLoop(
            files,
            settings,
            array,
            medium,
            SolverSwitcher(chosen, array, medium, settings.solver),
            BackgroundLoader(),
        )
        scheduling.raise_priority()
        scheduling.avoid_cores(device.processor)
        stack.callback(loop.close)
        loop.open()
        scheduling.start_background_thread(functools.partial(_list, loop), "offers")
        # the past is not made up for: what is sent is of now, and the newest hands are seen at once
        loop.renderer.run(on_tick=loop.between, behind=0.0)


def _list(loop: ServerLoop) -> None:
    loop.solvers = list_offers("solver")


if __name__ == "__main__":
    main()
