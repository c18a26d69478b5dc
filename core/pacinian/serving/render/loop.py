"""The renderer in the server: it takes changes at each tick, orders between ticks, and reports."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from msgspec.msgpack import Decoder
from msgspec.structs import replace

from pacinian.errors import describe_error, shorten
from pacinian.rendering.clock import Clock, SystemClock
from pacinian.rendering.renderer import RAMP, Renderer
from pacinian.scene.modulation.technique import SIMULTANEOUS
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.scene import Scene
from pacinian.serving.ipc import messages
from pacinian.serving.ipc.shared_memory import RegisterReader
from pacinian.serving.render import status
from pacinian.serving.render.change_decoding import decode_changes
from pacinian.serving.render.frame_output import Input, OutputSwitcher
from pacinian.serving.render.quiet_zones import ZonePlacement
from pacinian.serving.render.scene_replica import SceneReplica
from pacinian.solving.problem import Limits
from pacinian.solving.quiet_zone import Zone
from pacinian.wire.convert_time import technique_to_scene

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.scene.modulation.technique import Technique
    from pacinian.serving.ipc.messages import RequestedSettings
    from pacinian.serving.ipc.shared_memory import SharedRegister
    from pacinian.serving.render.background_loader import BackgroundLoader
    from pacinian.serving.render.solver_switcher import SolverSwitcher
    from pacinian.serving.settings import Settings
    from pacinian.wire.replies import Plugin
    from pacinian.wire.time import Technique as WireTechnique

FILES = "permit", "orders", "changes", "taken", "frame", "report", "device"
EARLY = 0.01  # [s] before a permit ends, the scene fades
MAX_RESULTS = 64  # results of orders
NO_DEVICE = messages.DeviceStatus(0, 0, "", 256, 256, 0.0, None, 0.0, False)


class ServerLoop:
    """Renders what the bus tells, while control permits it, for the guard.

    files: those of `FILES`, by name. array, medium: as the settings have them. solvers, loader: make what
    takes long. The loop's life: `open`, then `renderer.run(on_tick=loop.between)`, or ticks; then `close`.
    Raises ArgumentError.
    """

    def __init__(
        self,
        files: dict[str, SharedRegister],
        settings: Settings,
        array: Array,
        medium: Air,
        solvers: SolverSwitcher,
        loader: BackgroundLoader,
        clock: Clock | None = None,
    ) -> None:
        self.run = int.from_bytes(os.urandom(6), "little")
        self.results: dict[str, str] = {}
        self.solvers: tuple[Plugin, ...] = ()
        """That can be selected."""
        self._files, self._settings, self._choosing = files, settings, solvers
        self.clock = clock or SystemClock()
        self._permit = RegisterReader(files["permit"], messages.Permit.unpack, messages.Permit())
        self._orders = RegisterReader(
            files["orders"],
            Decoder(messages.RequestedSettings).decode,
            messages.RequestedSettings(),
        )
        self._device = RegisterReader(
            files["device"], Decoder(messages.DeviceStatus).decode, NO_DEVICE
        )
        self._changes = RegisterReader(
            files["changes"], decode_changes, (messages.Changes(0, 0, ()), 0)
        )
        zones = settings.safety.zones
        self.felt = SceneReplica(
            settings.workspace, loader, tuple(Zone(z.position, z.pressure, z.radius) for z in zones)
        )
        self._device.look()
        self._outputs = OutputSwitcher(
            files["frame"], self._device, self._permit, settings.rate, self._tag
        )
        sampling = settings.sampling
        self.renderer = Renderer(
            array,
            Scene(workspace=settings.workspace),
            medium=medium,
            solver=solvers.chosen,
            backend=self._outputs.first(),
            rate=settings.rate,
            sampler=Sampler(sampling.budget, sampling.spacing, ramp=RAMP),
            cycle=settings.cycle,
            peak=settings.safety.pressure,
            clock=self.clock,
        )
        limits = Limits(gain=settings.gain, power=settings.power)
        self._quiet = True
        self._quieting = ZonePlacement(array, self.renderer.session.medium, limits, len(zones))
        self._done = messages.RequestedSettings()
        self._kind: tuple[str, Technique] = "", SIMULTANEOUS  # what is presented
        self._intensity = 1.0
        self._reset = 0
        self._told = 0.0  # [s] when the next report is due

    def open(self) -> None:
        """From now on, ticks render what the bus tells. What was told before is not for us."""
        self.renderer.open()
        self.felt.start = self.renderer.start
        self._changes.skip()
        self._files["taken"].write(messages.pack(messages.ChangesAck(0, self.run, 0)))
        self._try(self._orders.look)
        self._reset = self._orders.value.reset
        self._obey(self._orders.value)
        self.renderer.scene = self._scene
        self._report(self.clock.now())

    def close(self) -> None:
        """Silence."""
        self.renderer.close()

    def between(self, report: object = None) -> None:
        """Between two ticks: orders, a new device, a new solver, a report. It never raises an Exception."""
        for step in self._follow, self._listen, self._choose, self._mend:
            self._try(step)
        now = self.clock.now()
        if now >= self._told:
            self._told = now + 1.0 / self._settings.state_rate
            self._try(lambda: self._report(now))

    def _try(self, step: Callable[[], object]) -> str:
        """Do it; what is wrong with it, which is told. Whatever it is, the loop goes on."""
        try:
            step()
        except Exception as error:
            problem = describe_error(error)
            self.felt.refuse("", problem)
            return problem
        return ""

    def _follow(self) -> None:
        if self._device.look():
            self._note(self._outputs.follow(self.renderer))

    def _listen(self) -> None:
        if self._orders.look():
            self._obey(self._orders.value)

    def _scene(self, t: float) -> Scene:
        """The scene of a tick."""
        self._permit.look()
        self._try(self._take)
        self._quiet = self._is_quiet()
        permit = self._permit.value
        over = self.clock.now() > permit.until - EARLY
        other = permit.scene != self.felt.number
        hushed = permit.armed != 1 or permit.stopped or over or other or not self._quiet
        return self.felt.hushed if hushed else self.felt.scene

    def _take(self) -> None:
        """Take the changes there are."""
        last = self._changes.value[0]
        if not self._changes.look():
            self.felt.apply()
            return
        new, damaged = self._changes.value
        again = () if new.run == last.run else (messages.ResetScene(),)
        self.felt.apply((*again, *new.changes))
        if damaged:
            self.felt.refuse("", f"{damaged} changes were damaged")
        self._files["taken"].write(
            messages.pack(messages.ChangesAck(new.number, self.run, new.run))
        )

    def _is_quiet(self) -> bool:
        """Whether the quiet zones of now can be kept: until they are prepared, there is silence."""
        if not self._quieting.keeps(self.felt.zones):
            return False
        self.renderer.limits = self._quieting.limits
        return True

    def _choose(self) -> None:
        self._note(self._choosing.poll())
        solver, session = self._choosing.chosen, self.renderer.session
        if session.solver is not solver:
            session.solver = solver

    def _obey(self, orders: RequestedSettings) -> None:
        """Do what is new in the orders; what cannot be done does not keep the rest from it."""
        done, self._done = self._done, orders
        (solver, choice), (technique, asked), (intensity, level) = (
            orders.solver, orders.technique, orders.intensity
        )  # fmt: skip
        if solver != done.solver[0] and choice is not None:
            problem = self._try(lambda: self._choosing.order(solver, choice))
            if problem:
                self._note({f"solver {solver}": problem})
        if technique != done.technique[0]:
            self._note({f"technique {technique}": self._try(lambda: self._present(asked))})
        if intensity != done.intensity[0]:
            self._note({f"intensity {intensity}": self._try(lambda: self._dim(level))})

    def _present(self, technique: WireTechnique | None) -> None:
        """Another technique. Raises ArgumentError, WireError."""
        name = "" if technique is None else str(technique.__struct_config__.tag)
        kind = SIMULTANEOUS if technique is None else technique_to_scene(technique)
        self.felt.present(kind, self._intensity)
        self._kind = name, kind

    def _dim(self, intensity: float) -> None:
        """Another factor on all pressures."""
        self.felt.present(self._kind[1], intensity)
        self._intensity = intensity

    def _mend(self) -> None:
        """After a reset, once the device is well: begin again."""
        reset = self._orders.value.reset
        if reset == self._reset or self._device.value.fault:
            return
        self._reset = reset
        self.renderer.reset()
        self._note({f"reset {self._reset}": ""})

    def _note(self, results: dict[str, str]) -> None:
        self.results.update(results)
        for old in list(self.results)[:-MAX_RESULTS]:
            del self.results[old]

    def _tag(self) -> Input:
        """The newest hands in the frame that is being sent: with turns, not the newest there are."""
        return self.felt.input(self.renderer.shown)

    def _report(self, now: float) -> None:
        """Tell how it is; or where that cannot be told, that it lives."""
        halted = self.renderer.halted
        report = messages.RendererStatus(
            self.run,
            now,
            {},
            self.results,
            "" if halted is None else shorten(f"{halted.stage}: {halted.message}"),
            self.felt.refused,
            self.solvers,
        )
        try:
            self._tell(replace(report, state=self._state(now)))
        except Exception as error:
            self.felt.refuse("", describe_error(error))
            self._tell(report)

    def _tell(self, report: messages.RendererStatus) -> None:
        self._files["report"].write(messages.pack(report))

    def _state(self, now: float) -> dict[str, Any]:
        renderer = self.renderer
        state = status.make_status(renderer, now - renderer.start)
        state["technique"], state["intensity"] = self._kind[0], self._intensity
        if not self._quiet:
            state["status"] = self._quieting.note
        return state
