"""Builds the published state from the statuses of the server's processes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, get_args

import msgspec
import numpy as np
from msgspec.structs import replace

from pacinian.acoustics.directivity import DIRECTIVITIES
from pacinian.scene.modulation.presets import PRESETS
from pacinian.serving.control.explain_silence import find_cause
from pacinian.serving.ipc.messages import HAND_UPDATE
from pacinian.wire.binary_arrays import pack
from pacinian.wire.modulation import Technique
from pacinian.wire.replies import Abilities, Sound
from pacinian.wire.state import ClientState, FrameState, State

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pacinian.acoustics.air import Air
    from pacinian.acoustics.array import Array
    from pacinian.serving.control.process_statuses import ProcessStatuses
    from pacinian.serving.control.sessions import ClientSessions
    from pacinian.serving.settings import Settings
    from pacinian.wire.state import Output

# Number of faults shown.
MAX_FAULTS = 8
MAX_TEXT, MAX_NAME = 500, 200  # maximum characters of a fault, and of a backend's name
CONTROL_FIELDS = frozenset(
    {"id", "sequence", "time", "output", "armed", "owner", "scene", "backend"}
)


class StateBuilder:
    """Builds the published messages. faults: the server's own, newest last. fault_count: number of its own faults."""

    def __init__(
        self, settings: Settings, statuses: ProcessStatuses, sessions: ClientSessions
    ) -> None:
        self._settings, self._statuses, self._sessions = settings, statuses, sessions
        self.faults: list[str] = []
        self.fault_count = 0
        self._sequence = 0
        self._input_count = 0
        self._row = -1  # of a frame; the one published last
        array, medium = settings.array.make(), settings.medium.make()
        self._positions, self._normals = pack(array.positions), pack(array.normals)
        self._frequency = float(array.transducer.frequency)
        self._wavelength = medium.wavelength(self._frequency)
        self._sound = describe_sound(array, medium)

    def record_fault(self, fault: str) -> None:
        """Record a fault of the server."""
        self.faults = [*self.faults[1 - MAX_FAULTS :], fault[:MAX_TEXT]]
        self.fault_count += 1

    def find_output(self) -> Output:
        """Return the output state: the first true one, from worst to best: the reverse of the order of `OUTPUTS`.

        It is faulted without a guard or a device, and while a process still reports a fault that was reset.
        """
        statuses, lease, device = self._statuses, self._sessions.lease, self._statuses.device
        there = statuses.guarded and device.generation
        if lease.fault or statuses.any_fault or not there:
            return "faulted"
        if lease.permit.stopped:
            return "stopped"
        if device.sounding:
            return "sounding"
        return "stale" if lease.armed and device.stale else "silent"

    def make_state(self, now: float, restarts: dict[str, int]) -> State:
        """Return the state at `now` [s], without hand updates."""
        renderer_status, device, lease = (
            self._statuses.renderer_status,
            self._statuses.device,
            self._sessions.lease,
        )
        reported = {k: v for k, v in renderer_status.state.items() if k not in CONTROL_FIELDS}
        common: dict[str, Any] = {
            "type": "state",
            "sequence": self._sequence,
            "time": now,
            "output": self.find_output(),
            "armed": lease.armed,
            "owner": lease.owner.name if lease.owner is not None else "",
            "scene": lease.owner.scene if lease.owner is not None else "",
            "backend": device.name[:MAX_NAME],
            "frames": device.frames,
            "longest_gap": device.longest_gap,
            "restarts": restarts,
            "clients": self._describe_clients(now),
        }
        nothing = {
            "solver": "",
            "technique": "",
            "intensity": 1.0,
            "faults": tuple(self.faults),
            "fault_count": self.fault_count,
        }
        try:
            theirs = [fault[:MAX_TEXT] for fault in reported.pop("faults", ())]
            reported["faults"] = tuple([*theirs, *self.faults][-MAX_FAULTS:])
            reported["fault_count"] = reported.get("fault_count", 0) + self.fault_count
            made = msgspec.convert({**nothing, **reported, **common}, State)
        except (TypeError, ValueError):  # a plug-in's part is not valid
            self._statuses.unreadable += 1
            made = msgspec.convert({**nothing, **common}, State)
        found = find_cause(
            made,
            resumes=lease.may_resume,
            fault=lease.fault[:MAX_TEXT],
            stopped=bool(lease.permit.stopped),
            resetting=self._statuses.guarded and self._statuses.any_fault,
        )
        cause, why = found or ("", "")
        refused = [
            f"{name or 'changes'}: {text}"[:MAX_TEXT]
            for name, text in renderer_status.refused.items()
        ]
        told = [*refused, *made.faults]
        return replace(made, cause=cause, why=why, faults=tuple(told[-MAX_FAULTS:]))

    def make_next_state(self, now: float, restarts: dict[str, int]) -> State:
        """Return the state to publish. Each hand update that reached the device is in exactly one of them."""
        self._sequence += 1
        return replace(self.make_state(now, restarts), inputs=self._take_new_inputs())

    def _take_new_inputs(self) -> bytes:
        device = self._statuses.device
        if device.input_count < self._input_count:  # a new guard counts from 0
            self._input_count = 0
        new = min(device.input_count - self._input_count, len(device.inputs) // HAND_UPDATE.size)
        self._input_count = device.input_count
        return device.inputs[len(device.inputs) - HAND_UPDATE.size * new :]

    def _describe_clients(self, now: float) -> tuple[ClientState, ...]:
        known, made = self._statuses.bus_status.clients, list[ClientState]()
        for session in self._sessions.all:
            objects, commands, errors, dropped, age = known.get(
                session.key.hex(), (0, 0, 0, 0, 0.0)
            )
            made.append(
                ClientState(
                    name=session.name,
                    scene=session.scene,
                    owner=session is self._sessions.lease.owner,
                    objects=objects,
                    commands=commands,
                    errors=errors,
                    dropped=dropped,
                    age=age,
                    renewed=now - session.renewed,
                )
            )
        return tuple(made)

    def make_frame_state(self, now: float) -> FrameState:
        """Return the levels that are emitted, of one row after the other; empty in silence."""
        statuses, rows, columns = (
            self._statuses,
            self._statuses.frame.rows,
            self._statuses.frame.columns,
        )
        self._row += 1
        row = self._row % rows if rows else 0
        size = 2 * columns  # size of a row [bytes]
        loud = statuses.device.sounding and rows > 0 and len(statuses.levels) == 2 * rows * size
        end = (row + 1) * size if loud else 0
        amplitudes = rows * size  # where they begin
        return FrameState(
            sequence=statuses.frame.sequence,
            time=now,
            phases=statuses.device.phases,
            amplitudes=statuses.device.amplitudes,
            phase=statuses.levels[end - size : end] if loud else b"",
            amplitude=statuses.levels[amplitudes + end - size : amplitudes + end] if loud else b"",
            scene_time=statuses.frame.time
            - statuses.frame.start
            + row / max(rows, 1) / self._settings.rate,
            part=(statuses.frame.part + row) % max(statuses.frame.parts, 1),
            parts=statuses.frame.parts,
        )

    def describe_abilities(self, request: int) -> Abilities:
        """Return the capabilities reply."""
        settings, device = self._settings, self._statuses.device
        limits = {
            "gain": settings.gain,
            "pressure": settings.safety.pressure,
            "lease": settings.safety.lease,
            "clients": settings.clients.max_sessions,
            "objects": settings.clients.max_objects,
            "objects_per_client": settings.clients.max_client_objects,
            "messages_per_second": settings.clients.max_rate,
            "command_bytes": settings.clients.max_command_bytes,
        }
        if settings.power is not None:
            limits["power"] = settings.power
        return Abilities(
            id=request,
            solvers=self._statuses.renderer_status.solvers,
            backends=device.backends,
            techniques=tuple(str(kind.__struct_config__.tag) for kind in get_args(Technique)),
            presets=tuple(PRESETS),
            positions=self._positions,
            normals=self._normals,
            frequency=self._frequency,
            wavelength=self._wavelength,
            phases=device.phases,
            amplitudes=device.amplitudes,
            device_rate=device.rate,
            rate=settings.rate,
            limits={name: float(value) for name, value in limits.items()},
            sound=replace(self._sound, sizes=device.sizes),
        )

    def list_known(self) -> dict[str, tuple[str, ...]]:
        """Return the names of the solvers and the backends that can be selected."""
        return {
            "solver": _list_names(self._statuses.renderer_status.solvers),
            "backend": _list_names(self._statuses.device.backends),
        }


def describe_sound(array: Array, medium: Air) -> Sound:
    """Describe how an array emits in a medium."""
    kind, response = array.transducer, array.response
    names = [name for name, D in DIRECTIVITIES.items() if D is kind.directivity]
    return Sound(
        pressure=kind.pressure,
        directivity=names[0] if names else "",
        response=b"" if response is None else pack(response.view(np.float64)),
        speed_of_sound=medium.speed_of_sound,
        density=medium.density,
        power=medium.exponent,
        absorption=medium.beta(kind.frequency),
        temperature=medium.temperature,
    )


def _list_names(plugins: Sequence[Any]) -> tuple[str, ...]:
    return tuple(plugin.name for plugin in plugins)
