"""The render loop of the server: takes changes at each tick, and settings between ticks; reports its status."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, Any

from msgspec.msgpack import Decoder
from msgspec.structs import replace

from pacinian.errors import describe_error, shorten
from pacinian.rendering.clock import Clock, SystemClock
from pacinian.rendering.realtime_section import realtime_section
from pacinian.rendering.renderer import Renderer
from pacinian.rendering.tick_pacing import pace
from pacinian.scene.modulation.technique import SIMULTANEOUS
from pacinian.scene.sampling.ramps import RAMP_TIME
from pacinian.scene.sampling.sampler import Sampler
from pacinian.scene.scene import Scene
from pacinian.serving.ipc import messages
from pacinian.serving.ipc.scheduling import start_background_thread
from pacinian.serving.ipc.shared_memory import RegisterReader
from pacinian.serving.render import renderer_status
from pacinian.serving.render.change_decoding import decode_changes
from pacinian.serving.render.frame_output import Input, OutputSwitcher
from pacinian.serving.render.scene_replica import SceneReplica
from pacinian.serving.render.touch_report import explain_contact, explain_loading, explain_outside
from pacinian.serving.render.zone_placement import ZonePlacement
from pacinian.solving.limits import Limits
from pacinian.wire.convert_modulation import technique_to_scene

if TYPE_CHECKING:
    from collections.abc import Callable

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.serving.ipc.messages import Selections
    from pacinian.serving.ipc.shared_memory import SharedRegister
    from pacinian.serving.ipc.wake_pipe import WakePipe
    from pacinian.serving.render.background_loader import BackgroundLoader
    from pacinian.serving.render.solver_switcher import SolverSwitcher
    from pacinian.serving.settings import Settings
    from pacinian.wire.modulation import Technique
    from pacinian.wire.replies import Plugin
    from pacinian.wire.silence_cause import Silence

FILES = (
    "permit",
    "selections",
    "changes",
    "changes_ack",
    "frame",
    "renderer_status",
    "device",
)
FADE_LEAD = 0.02  # time before a permit expires at which the output begins to fade out [s]
EXPLAIN_PERIOD = 0.2  # shortest time between two computations of the nearest object [s]
MIN_REST_INTERVAL = 0.05  # shortest time between two reports while the loop rests [s]
# Longest time between two ticks while each repeats the frame before [s]. It is short because something that moves by
# itself may come into reach.
STILL_INTERVAL = 4e-3
# The same limit, as a share of `frame_timeout` or of the device's watchdog, whichever is shorter.
STILL_SHARE = 0.25
MAX_RESULTS = 64  # largest number of results that are kept


class RenderLoop:
    """Does the server's work between ticks of the renderer: takes changes and settings, reports, dims, silences.

    files: those of `FILES`, by name. array, medium: from the settings. solvers, loader: do the slow work. Call `open`,
    then `run_ticks` or single ticks of the renderer, then `close`. Raises ArgumentError.
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
        """The solvers that can be selected."""
        self._files, self._settings, self._switcher = files, settings, solvers
        self.clock = clock or SystemClock()
        self._permit = RegisterReader(files["permit"], messages.Permit.unpack, messages.Permit())
        self._selections = RegisterReader(
            files["selections"],
            Decoder(messages.Selections).decode,
            messages.Selections(),
        )
        self._device = RegisterReader(
            files["device"], Decoder(messages.DeviceStatus).decode, messages.NO_DEVICE
        )
        self._changes = RegisterReader(
            files["changes"], decode_changes, (messages.Changes(0, 0, ()), 0)
        )
        zones = tuple(zone.make() for zone in settings.safety.zones)
        self.replica = SceneReplica(settings.workspace, loader, zones)
        self._device.look()
        self._outputs = OutputSwitcher(
            files["frame"], self._device, self._permit, settings.rate, self._make_tag
        )
        sampling = settings.sampling
        self.renderer = Renderer(
            array,
            Scene(workspace=settings.workspace),
            medium=medium,
            solver=solvers.chosen,
            backend=self._outputs.make_first(),
            rate=settings.rate,
            sampler=Sampler(sampling.budget, sampling.spacing, ramp=RAMP_TIME),
            max_cycle_frames=settings.max_cycle_frames,
            peak=settings.safety.pressure,
            clock=self.clock,
            start_thread=start_background_thread,
        )
        limits = Limits(gain=settings.gain, power=settings.power)
        self._zones_kept = True
        self._zone_placement = ZonePlacement(
            array, self.renderer.session.medium, limits, len(zones)
        )
        self._done = messages.Selections()
        self._technique: Technique | None = None  # the default one, as selected
        self._reset = 0
        # When the cause of silence was found [s], and whether a hand was seen.
        self._explained = -math.inf, False
        self._cause: Silence | None = None
        self._reported, self._report_interval = -math.inf, 1.0 / settings.state_rate  # [s]
        self._switched = False  # another device has not got a frame yet

    def prepare_zones(self) -> None:
        """Prepare the quiet zones of the settings. May take seconds. Raises ArgumentError if they cannot be kept."""
        if self.replica.zones:
            self._zone_placement.prepare(self.replica.zones)

    def open(self) -> None:
        """Open the renderer, and render the bus's changes from now on. Earlier changes are skipped."""
        self.renderer.open()
        self.replica.start = self.renderer.start
        self._changes.skip()
        self._files["changes_ack"].write(messages.pack(messages.ChangesAck(0, self.run, 0)))
        self._try(self._selections.look)
        self._reset = self._selections.value.reset
        self._apply_selections(self._selections.value)
        self.renderer.scene = self._make_scene
        self._report(self.clock.now())

    def run_ticks(self, wake: WakePipe) -> None:
        """Tick for ever; less often while nothing changes, and not while there is nothing to do. wake: ends a wait.

        Late ticks are skipped, so that frames are current and the newest hands are used at once.
        """
        renderer = self.renderer
        with realtime_section():
            due = -math.inf
            while True:
                for due, lost in pace(self.clock, renderer.period, max_lag=0.0):
                    renderer.tick(due, lost)
                    self.run_between()
                    if self.rests or (renderer.repeats and wake.works):
                        break
                if not self.rests:
                    wake.wait(self._find_still_wait(), lambda: True)
                    self.clock.wait_until(due + renderer.period)  # however often it is woken
                while self.rests:
                    due = self._reported + max(MIN_REST_INTERVAL, self._report_interval)
                    wake.wait(due - self.clock.now(), lambda: self._has_news)
                    self.run_between()

    def _find_still_wait(self) -> float:
        """Return how long the next tick may wait, after one that repeated the frame before [s]."""
        watchdog = self._device.value.watchdog or math.inf
        limit = min(self._settings.safety.frame_timeout, watchdog)
        longest = min(STILL_INTERVAL, STILL_SHARE * limit)
        fade = self._permit.value.until - FADE_LEAD - self.clock.now()
        return min(longest, fade) if fade >= 0.0 else longest

    @property
    def rests(self) -> bool:
        """Whether another tick would change nothing: there is silence, no permit, and nothing new or pending."""
        if not self.renderer.silent or self._switcher.starting:
            return False
        if self.renderer.halted is not None:
            return True  # until a reset
        return not (
            self._permit.waiting
            or self._permit.value.armed
            or self._changes.waiting
            or self._switched
            or self.renderer.rendered_scene is not self.replica.silenced
            or self.replica.loading
            or self._zone_placement.preparing
        )

    @property
    def _has_news(self) -> bool:
        """Whether another process has written a value that ends the rest, or that `run_between` reads."""
        return self._selections.waiting or self._device.waiting or not self.rests

    def close(self) -> None:
        """Silence the output."""
        self.renderer.close()

    def run_between(self) -> None:
        """Do the work between two ticks: settings, a new device, a new solver, a report. Never raises an Exception."""
        for step in (
            self._poll_selections,
            self._follow_device,  # after the selections: a reset must not be answered with an older status
            self._poll_solver,
            self._restart_after_reset,
        ):
            self._try(step)
        now = self.clock.now()
        if now >= self._reported + self._report_interval:
            self._reported = now
            self._try(lambda: self._report(now))

    def _try(self, step: Callable[[], object]) -> str:
        """Call `step`; report and return its error, if any, so that the loop goes on."""
        try:
            step()
        except Exception as error:
            problem = describe_error(error)
            self.replica.refuse("", problem)
            return problem
        return ""

    def _follow_device(self) -> None:
        if self._device.look():
            before = self.renderer.backend
            self._record_results(self._outputs.follow(self.renderer))
            self._switched = self._switched or self.renderer.backend is not before

    def _poll_selections(self) -> None:
        if self._selections.look():
            self._apply_selections(self._selections.value)

    def _make_scene(self, t: float) -> Scene:
        """Return the scene of a tick."""
        self._switched = False
        epoch = self._permit.value.epoch
        if self._permit.look() and self._permit.value.epoch != epoch:
            self.renderer.restart()  # nothing that an earlier permit has begun may sound under this one
        self._try(self._take_changes)
        self._zones_kept = self._are_zones_kept()
        permit = self._permit.value
        over = self.clock.now() > permit.until - FADE_LEAD
        other = permit.scene != self.replica.number
        silenced = (
            permit.armed != messages.PermitState.ARMED
            or permit.stopped
            or over
            or other
            or not self._zones_kept
        )
        return self.replica.silenced if silenced else self.replica.scene

    def _take_changes(self) -> None:
        """Apply the new changes."""
        last = self._changes.value[0]
        if not self._changes.look():
            self.replica.apply()
            return
        new, damaged = self._changes.value
        again = () if new.run == last.run else (messages.ResetScene(),)
        self.replica.apply((*again, *new.changes))
        if damaged:
            self.replica.refuse("", f"{damaged} changes were damaged")
        self._files["changes_ack"].write(
            messages.pack(messages.ChangesAck(new.number, self.run, new.run))
        )

    def _are_zones_kept(self) -> bool:
        """Whether the current quiet zones can be enforced. There is silence until they are prepared."""
        if not self._zone_placement.keeps(self.replica.zones):
            return False
        self.renderer.limits = self._zone_placement.limits
        return True

    def _poll_solver(self) -> None:
        self._record_results(self._switcher.poll())
        solver, session = self._switcher.chosen, self.renderer.session
        if session.solver is not solver:
            session.solver = solver

    def _apply_selections(self, selections: Selections) -> None:
        """Carry out the new selections. One that fails does not stop the others."""
        done, self._done = self._done, selections
        (solver, choice), (technique, asked), (intensity, level) = (
            selections.solver, selections.technique, selections.intensity
        )  # fmt: skip
        if solver != done.solver[0] and choice is not None:
            problem = self._try(lambda: self._switcher.select(solver, choice))
            if problem:
                self._record_results({f"solver {solver}": problem})
        if technique != done.technique[0]:
            self._record_results(
                {f"technique {technique}": self._try(lambda: self._set_technique(asked))}
            )
        if intensity != done.intensity[0]:
            self._record_results(
                {f"intensity {intensity}": self._try(lambda: self._set_intensity(level))}
            )

    def _set_technique(self, technique: Technique | None) -> None:
        """Set the default technique. Raises ArgumentError, WireError."""
        made = SIMULTANEOUS if technique is None else technique_to_scene(technique)
        self.replica.present(made, self.replica.intensity)
        self._technique = technique

    def _set_intensity(self, intensity: float) -> None:
        """Set the factor on all pressures."""
        self.replica.present(self.replica.technique, intensity)

    def _restart_after_reset(self) -> None:
        """After a reset, restart the renderer once the device has no fault."""
        reset = self._selections.value.reset
        if reset == self._reset or self._device.value.fault:
            return
        self._reset = reset
        self.renderer.reset()
        self._record_results({f"reset {self._reset}": ""})

    def _record_results(self, results: dict[str, str]) -> None:
        self.results.update(results)
        for old in list(self.results)[:-MAX_RESULTS]:
            del self.results[old]

    def _make_tag(self) -> Input:
        """Return what belongs to the frame that is being sent. A newer hand update may have arrived since."""
        part, parts = self.renderer.modulator.place_in_cycle
        newest = self.replica.find_input(self.renderer.rendered_scene)
        return newest._replace(start=self.renderer.start, part=part, parts=parts)

    def _report(self, now: float) -> None:
        """Report the status; if its state cannot be encoded, report without it, as a heartbeat."""
        halted = self.renderer.halted
        report = messages.RendererStatus(
            now,
            {},
            self.results,
            "" if halted is None else shorten(f"{halted.stage}: {halted.message}"),
            self.replica.refused,
            self.solvers,
        )
        try:
            self._publish(replace(report, state=self._make_state(now)))
        except Exception as error:
            self.replica.refuse("", describe_error(error))
            self._publish(report)

    def _publish(self, report: messages.RendererStatus) -> None:
        self._files["renderer_status"].write(messages.pack(report))

    def _make_state(self, now: float) -> dict[str, Any]:
        renderer = self.renderer
        state = renderer_status.make_status(renderer, now - renderer.start)
        technique = self._technique
        state["technique"] = "" if technique is None else technique.__struct_config__.tag
        state["presentation"], state["intensity"] = technique, self.replica.intensity
        if not self._zones_kept:
            state["status"] = self._zone_placement.note
        found = None if "asked" in state else self._explain(now, seen=bool(state["hands"]))
        if found is not None:
            state["cause"], state["why"] = found
        return state

    def _explain(self, now: float, *, seen: bool) -> Silence | None:
        """Return why there are no samples, as far as the renderer knows. It is computed now and then.

        seen: whether a hand is.
        """
        if now >= self._explained[0] + EXPLAIN_PERIOD or seen is not self._explained[1]:
            self._explained, shown = (now, seen), self.renderer.rendered_scene
            if awaited := self.replica.find_awaited():
                self._cause = explain_loading(awaited)
            elif seen:
                hands = renderer_status.find_hands(self.renderer, now - self.renderer.start)
                self._cause = explain_contact(hands, shown.objects)
            else:
                self._cause = explain_outside(self.renderer.sample_counts)
        return self._cause
