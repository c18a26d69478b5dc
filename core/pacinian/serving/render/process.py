"""The render process: the loop, its copy of the owner's scene, and solver plug-ins. Its frames go to the guard.

It ends with its parent, or on SIGTERM. The last frame that it writes is silence.
"""

from __future__ import annotations

import _thread
import functools
import signal
import time
from contextlib import ExitStack

from msgspec.msgpack import Decoder

from pacinian.plugins.backend import Capability
from pacinian.serving.ipc import launch_config, parent_link, scheduling
from pacinian.serving.ipc.logs import configure
from pacinian.serving.ipc.messages import DeviceStatus, open_wake_pipe, open_wakes
from pacinian.serving.ipc.plugin_list import publish_offers
from pacinian.serving.ipc.refused_setting import blame_setting
from pacinian.serving.ipc.shared_memory import SharedRegister
from pacinian.serving.ipc.system_setup import trim_memory
from pacinian.serving.render.background_loader import BackgroundLoader
from pacinian.serving.render.render_loop import FILES, RenderLoop
from pacinian.serving.render.solver_switcher import SolverSwitcher, make_solver
from pacinian.serving.render.warmup import warm_up

CHECK_INTERVAL = 0.002  # interval between two checks for a device [s]


def main() -> None:
    """Render until the parent ends or asks this process to end."""
    try:
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        config = parent_link.read_launch_config(lambda: _thread.interrupt_main(signal.SIGTERM))
        configure(config.settings.log, "render")
        _render(config)
    except KeyboardInterrupt:
        return


def _render(config: launch_config.LaunchConfig) -> None:
    settings = config.settings
    with ExitStack() as stack:
        files = {
            name: stack.enter_context(
                SharedRegister.attach(
                    path, open_wakes(path) if name in ("changes_ack", "frame") else ()
                )
            )
            for name in FILES
            for path in (config.path / name,)
        }
        wake = open_wake_pipe(config.path, "render")
        stack.callback(wake.close)
        array, medium = settings.array.make(), settings.medium.make()
        with blame_setting(config.path, "solver"):
            chosen = make_solver(settings.solver)
        warm_up(array, medium, chosen, Capability(rate=settings.rate), settings.rate)
        while (newest := files["device"].read()) is None:
            time.sleep(CHECK_INTERVAL)
        device = Decoder(DeviceStatus).decode(newest[1])
        loop = RenderLoop(
            files,
            settings,
            array,
            medium,
            SolverSwitcher(chosen, array, medium, settings.solver),
            BackgroundLoader(),
        )
        with blame_setting(config.path, "safety.zones"):
            loop.prepare_zones()
        scheduling.raise_priority()
        scheduling.avoid_cores(device.processor)
        stack.callback(loop.close)
        loop.open()
        trim_memory()
        publish = functools.partial(setattr, loop, "solvers")
        scheduling.start_background_thread(lambda: publish_offers("solver", publish), "offers")
        loop.run_ticks(wake)


if __name__ == "__main__":
    main()
