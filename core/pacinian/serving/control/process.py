"""The control process. It answers at once, whatever the other processes do.

Each round of its polling loop handles a bounded number of requests, then the timed work: leases, link probes, checks of
the other processes, and the published state. Nothing here blocks or imports a plug-in. No client can take more
time than its share; only the owner's link is probed more often.
"""

from __future__ import annotations

import time
from collections import Counter
from typing import TYPE_CHECKING, NamedTuple

from msgspec.structs import replace

from pacinian.errors import WireError, describe_error
from pacinian.serving.control.pending_stops import PendingStops
from pacinian.serving.control.process_statuses import ProcessStatuses
from pacinian.serving.control.selection import SelectionManager
from pacinian.serving.control.sessions import ClientSessions
from pacinian.serving.control.state_builder import StateBuilder
from pacinian.serving.control.supervisor import SPARE
from pacinian.serving.ipc.logs import RateLimitedLog, log
from pacinian.serving.ipc.messages import pack
from pacinian.serving.ipc.rate_limit import PeerRateLimiter
from pacinian.wire.codec import decode_control, encode, id_of
from pacinian.wire.control import Arm, Capabilities, Select, Status, Stop
from pacinian.wire.replies import Error
from pacinian.wire.state import FRAME, STATE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from msgspec import Struct

    from pacinian.serving.control.client_session import ClientSession
    from pacinian.serving.control.sockets import ControlSockets
    from pacinian.serving.control.supervisor import Supervisor
    from pacinian.serving.ipc.shared_memory import SharedRegister
    from pacinian.serving.settings import Settings
    from pacinian.wire.control import AnyControl
    from pacinian.wire.state import State

# Maximum number of requests handled in one round.
MAX_ROUND_REQUESTS = 64
# Longest wait for requests in one round: while the output is armed; while it is not; and while nobody watches the state
# either [s]. Control notices the end of another process within this time.
MAX_WAIT, IDLE_WAIT, REST_WAIT = 0.01, 0.02, 0.05
REST_PUBLISH_INTERVAL = 0.25  # shortest interval between two states that nobody watches [s]
# Interval between two probes of the owner's link, and of the links of other clients [s].
OWNER_PROBE_INTERVAL, OTHER_PROBE_INTERVAL = 0.025, 0.5
# Shortest wait for requests, even if timed work is due sooner [s].
MIN_WAIT = 0.001
# Each frame is published later in its period than the frame before, by this share of the period. The golden ratio
# spreads these moments evenly, so that a viewer sees the whole of a cycle of frames, and of a modulation.
PUBLISH_PHASE_STEP = (5.0**0.5 - 1.0) / 2.0
CHECK_INTERVAL = 0.02  # interval between two checks of the other processes [s]
# Time limit for a process to answer a reset. Until it does, it may still report what was reset [s].
FAULT_CLEAR_TIMEOUT = 10.0
# Maps a process to the component whose faults it reports.
FAULT_COMPONENTS = {"render": "renderer", "guard": "device"}
# What a client must do after the end of the bus, which ends the sessions.
REJOIN_ADVICE = "say hello, put the objects again, and arm again"
# Longest request that is still decoded from a client over its rate limit, because it may be a stop
# [bytes].
MAX_STOP_BYTES = 64
MAX_PEERS = 4096  # maximum number of peers with a remembered rate


class PendingReset(NamedTuple):
    """A reset that a process has not answered yet.

    fault: the fault that the process reported when it was reset; "" if the reset ends whichever it reports. until: when
    to wait no longer [s]. ended: whether the process has ended. The next one does not know of the reset.
    """

    fault: str
    until: float
    ended: bool


class ControlLoop:
    """Connects sessions, selections, the other processes and the sockets.

    memory: shared files that control writes and reads, by name. counts: for the metrics. newest: the last published
    state. Times are those of `clock` [s].
    """

    def __init__(
        self,
        settings: Settings,
        sockets: ControlSockets,
        memory: Mapping[str, SharedRegister],
        supervisor: Supervisor,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.sessions = ClientSessions(settings, server=_name_server())
        self.selections = SelectionManager(settings)
        self.statuses = ProcessStatuses(memory)
        self.state_builder = StateBuilder(settings, self.statuses, self.sessions)
        self.counts: Counter[str] = Counter()
        self.newest: State | None = None
        self._settings, self._sockets, self._memory = settings, sockets, memory
        self._supervisor, self._clock = supervisor, clock
        self._log = RateLimitedLog(clock)
        self._written: dict[str, object] = {}
        self._stops = PendingStops()
        self._rates = PeerRateLimiter(settings.clients.max_rate, MAX_PEERS)
        self._due = {"owner": 0.0, "others": 0.0, "check": 0.0, "publish": 0.0, "frame": 0.0}
        self._offset = 0.0  # of the newest published frame in its period
        self._pending_resets: dict[str, PendingReset] = {}  # by process
        self._write_changes_and_reply()

    @property
    def ready(self) -> bool:
        """Whether all processes have sent a heartbeat and the renderer has reported."""
        known = self.state_builder.list_known()[
            "solver"
        ]  # the first client must be able to select one
        return bool(known) and all(map(self._is_alive, self._heartbeats))

    @property
    def _heartbeats(self) -> dict[str, float]:
        statuses = self.statuses
        return {
            "guard": statuses.device.heartbeat,
            "bus": statuses.bus_status.heartbeat,
            "render": statuses.renderer_status.heartbeat,
        }

    def run_round(self) -> None:
        """Answer the requests, then do the timed work. Raises ServerError if a process ends before all were ready."""
        watchers, permit = self._sockets.watchers, self.sessions.lease.permit
        if self._stops:
            self._sockets.wait(MIN_WAIT)
        elif self._supervisor.trusted and not (permit.armed or watchers):
            self._sockets.wait(REST_WAIT)
        else:
            due, longest = min(self._due.values()), IDLE_WAIT
            if permit.armed:
                due, longest = min(due, permit.until), MAX_WAIT
            self._sockets.wait(min(longest, max(due - self._clock(), MIN_WAIT)))
        self._carry_out_stops()
        for peer, user, data in self._sockets.receive_requests(MAX_ROUND_REQUESTS):
            self._handle_request(peer, user, data)
        for why, more in self._sockets.take_refusals():
            self._log.warning("connection refused", why=why, more=more)
        now = self._clock()
        self.sessions.pass_time(now)
        self._write_changes_and_reply()
        if self._stops:
            self._confirm_stops(now)
        if self._is_due("check", CHECK_INTERVAL, now) or self._supervisor.ended:
            self._check_processes(now)
        if self._is_due("owner", OWNER_PROBE_INTERVAL, now):
            self._probe_owner(now)
        if self._is_due("others", OTHER_PROBE_INTERVAL, now):
            self._probe_others(now)
        every = 1.0 / self._settings.state_rate
        if self._sockets.watchers > watchers:
            self._due["publish"] = self._due["frame"] = now
        elif not self._sockets.watchers:
            every = max(every, REST_PUBLISH_INTERVAL)
        if self._is_due("publish", every, now):
            self._publish(now)
        after = (self._offset + PUBLISH_PHASE_STEP) % 1.0
        if self._is_due("frame", every * (1.0 + after - self._offset), now):
            self._offset = after
            self._publish_frame(now)

    def silence_all(self) -> None:
        """Let the sound fade out, end the sessions, and stop the output."""
        lease = self.sessions.lease
        if lease.owner is not None:
            lease.disarm(lease.owner, self._clock())
        # Requests are not answered here, because a game that arms again would keep this loop
        # running.
        while lease.permit.armed:
            self._sockets.wait(MAX_WAIT)
            self.sessions.pass_time(self._clock())
            self._write_changes_and_reply()
        advice = "say hello when it runs again"
        self.sessions.end_all("the server ends", self._clock(), advice)
        lease.stop()
        self._write_changes_and_reply()
        due = self._clock() + REST_WAIT
        while self._stops and self._clock() < due:
            self._sockets.wait(MIN_WAIT)
            self._confirm_stops(self._clock())

    def _is_due(self, what: str, every: float, now: float) -> bool:
        if now < self._due[what]:
            return False
        self._due[what] = max(self._due[what] + every, now)
        return True

    def _carry_out_stops(self) -> None:
        """Carry out connectionless emergency stops, before all else."""
        received = self._sockets.stop.receive()
        confirmed = [each for each in received if self._stops.is_confirmed(each)]
        self._sockets.stop.confirm(confirmed)
        requests = [each for each in received if each not in confirmed]
        if not all(map(self._stops.waits, requests)):
            stopped = self.sessions.lease.permit.stopped
            self.sessions.lease.stop()
            self._write_changes_and_reply()
            self._note_stop("without a connection", before=bool(stopped))
        self._stops.add_datagrams(requests, self._clock())

    def _note_stop(self, user: str, *, before: bool) -> None:
        """Note a stop that is carried out. before: whether all was stopped before it."""
        if not before:  # a status from before the stop proves nothing
            self._stops.stopped_at = self._clock()
        self._log.warning("emergency stop", user=user)

    def _confirm_stops(self, now: float) -> None:
        """Confirm stops once a guard that lives has reported silence since."""
        self._look_for_faults(now)
        device = self.statuses.device
        guarded = self._is_alive("guard")
        silent = guarded and not device.sounding and device.heartbeat > self._stops.stopped_at
        for peer, reply in self._stops.confirm_and_take_replies(
            silent, now, self._sockets.stop.confirm
        ):
            try:
                self._send(peer, reply)
            except Exception:
                self._tell_failure(peer, reply.id)

    def _handle_request(self, peer: bytes, user: str, data: bytes) -> None:
        now = self._clock()
        self.counts["requests"] += 1
        busy = not self._rates.allows(peer, now)
        if busy:
            self.counts["busy"] += 1
            self._log.warning("too many requests", user=user)
            if len(data) > MAX_STOP_BYTES:
                if self._rates.should_report(peer, now):
                    self._tell_busy(peer, id_of(data))
                return
        try:
            message = decode_control(data)
        except WireError as error:
            self.counts["malformed"] += 1
            self._log.warning("malformed request", user=user, error=describe_error(error))
            if self._rates.should_report(peer, now):
                wrong = Error(
                    id=id_of(data), code="malformed", message=error.problem, path=error.path
                )
                self._send(peer, wrong)
            return
        if busy and not isinstance(message, Stop):
            if self._rates.should_report(peer, now):
                self._tell_busy(peer, message.id)
            return
        try:
            self._carry_out(peer, user, message, now)
            self._write_changes_and_reply()
        except Exception:  # a bug here must not end the server
            self._tell_failure(peer, message.id, user)

    def _tell_failure(self, peer: bytes, number: int, user: str = "") -> None:
        self.counts["failed"] += 1
        self._log.exception("request failed", user=user)
        problem = "the server failed to handle this"
        self._send(peer, Error(id=number, code="fault", message=problem))

    def _carry_out(self, peer: bytes, user: str, message: AnyControl, now: float) -> None:
        sessions, replayed, resets = self.sessions, self.sessions.replayed, self.sessions.resets
        match message:
            case Stop():
                stopped = sessions.lease.permit.stopped
                sessions.handle(peer, user, message, now)
                self._write_changes_and_reply()
                self._note_stop(user, before=bool(stopped))
                self._stops.add_message(peer, message.id, now)
            case Capabilities() | Status() | Select():
                sessions.pass_time(now)
                session = sessions.find(peer, message.session, message.id)
                if session is None:
                    pass
                elif isinstance(message, Capabilities):
                    self._send(peer, self.state_builder.describe_abilities(message.id))
                elif isinstance(message, Status):
                    state = self.state_builder.make_state(now, self._supervisor.restarts)
                    self._send(peer, replace(state, id=message.id))
                elif sessions.lease.owner not in (None, session):
                    problem = "another client owns the output"
                    self._send(peer, Error(id=message.id, code="owner", message=problem))
                elif reply := self.selections.select(
                    session, message, self.state_builder.list_known(), now
                ):
                    self._send(peer, reply)
            case Arm() if not self._is_alive("bus"):
                sessions.pass_time(now)
                if sessions.find(peer, message.session, message.id):
                    problem = "the bus process is restarting"
                    self._send(peer, Error(id=message.id, code="fault", message=problem))
            case _:
                sessions.handle(peer, user, message, now)
        if sessions.replayed > replayed:
            self.counts["replayed"] += 1
            self._log.warning("a session's key was used on another connection", user=user)
        if sessions.resets > resets:
            self._note_reset(now)

    def _note_reset(self, now: float) -> None:
        """Let the processes carry out a reset.

        A renderer keeps its first fault until it carries out the reset, which ends even a fault that it has not
        reported yet, such as the refusal to send to a device with a fault. The guard may replace a fault by a new one.
        """
        faults = {"render": "", "guard": self.statuses.device.fault}
        self._pending_resets = {
            process: PendingReset(
                fault, now + FAULT_CLEAR_TIMEOUT, ended=not self._is_alive(process)
            )
            for process, fault in faults.items()
            if fault or process == "render"
        }
        self.selections.set_reset_count(self.sessions.resets)
        self._log.info("reset")

    def _write_changes_and_reply(self) -> None:
        """Write what has changed for the other processes, then send the replies to the clients."""
        while True:
            lease = self.sessions.lease
            self._write("permit", lease.permit, lease.permit.pack)
            stamp = (self.sessions.changes, lease.owner)
            self._write("sessions", stamp, lambda: pack(self.sessions.list_sessions()))
            self._write(
                "selections",
                self.selections.newest,
                lambda: pack(self.selections.newest),
            )
            replies = self.sessions.take_replies()
            if not replies:
                return
            for peer, reply in replies:
                if isinstance(reply, Error):
                    self._log.warning("client told", code=reply.code, message=reply.message)
                self._send(peer, reply)

    def _write(self, name: str, value: object, data: Callable[[], bytes]) -> None:
        if self._written.get(name) != value:
            self._memory[name].write(data())
            self._written[name] = value

    def _send(self, peer: bytes, reply: Struct) -> None:
        if not self._sockets.reply(peer, encode(reply)):
            self.counts["lost"] += 1
            self.sessions.end_peer(peer, self._clock())

    def _tell_busy(self, peer: bytes, number: int) -> None:
        most = f"more than {self._settings.clients.max_rate:g} messages a second"
        self._send(peer, Error(id=number, code="busy", message=most))

    def _probe_owner(self, now: float) -> None:
        if (owner := self.sessions.lease.owner) is not None:
            self._probe([owner], now)

    def _probe_others(self, now: float) -> None:
        owner = self.sessions.lease.owner
        self._probe([session for session in self.sessions.all if session is not owner], now)

    def _probe(self, sessions: Iterable[ClientSession], now: float) -> None:
        for session in sessions:
            self._send(session.peer, self.sessions.make_probe(session, now))
        self._write_changes_and_reply()

    def _look_for_faults(self, now: float) -> None:
        """Read the statuses of the other processes. A fault that was not reset stops the output."""
        self.statuses.look()
        lease = self.sessions.lease
        renderer_status, device = self.statuses.renderer_status, self.statuses.device
        for process, fault, results in (
            ("render", renderer_status.halted, renderer_status.results),
            ("guard", device.fault, device.results),
        ):
            if self._is_reset_pending(process, fault, results, now):
                continue
            self._pending_resets.pop(process, None)
            if fault and not lease.fault:
                problem = f"{FAULT_COMPONENTS[process]}: {fault}"
                self._record_fault(problem)
                lease.fail(problem)

    def _is_reset_pending(
        self, process: str, fault: str, results: Mapping[str, str], now: float
    ) -> bool:
        """Whether what a process reports does not count, because it has not carried out the reset."""
        pending = self._pending_resets.get(process)
        if pending is None or now >= pending.until:
            return False
        answered = f"reset {self.selections.newest.reset}" in results
        replaced = pending.ended and self._is_alive(process)
        return not (answered or replaced) and pending.fault in ("", fault)

    def _is_alive(self, process: str) -> bool:
        """Whether the current process of that name has reported."""
        return self._supervisor.is_alive(process, self._heartbeats[process])

    def _check_processes(self, now: float) -> None:
        """Read the statuses of the other processes, and check that they live."""
        self._look_for_faults(now)
        permit, device = self.sessions.lease.permit, self.statuses.device
        sound = device.generation > 0 and (permit.armed > 0 or device.sounding)
        for name, why in self._supervisor.check(self._heartbeats, sound):
            self._handle_exit(name, why, now)
        self.statuses.guarded = self._is_alive("guard")
        for peer, reply in self.selections.take_replies(self.statuses.results, now):
            self._send(peer, reply)
        self._write_changes_and_reply()

    def _record_fault(self, fault: str) -> None:
        self.state_builder.record_fault(fault)
        log().error("fault", fault=fault)

    def _handle_exit(self, name: str, why: str, now: float) -> None:
        if name == SPARE:
            self._log.warning("spare guard lost", why=why)
            return
        problem = f"the process {name!r} {why}, and is restarted"
        self._record_fault(problem)
        if pending := self._pending_resets.get(name):
            self._pending_resets[name] = pending._replace(ended=True)
        if name == "bus":
            self.sessions.lease.interrupt("fault", problem, REJOIN_ADVICE)
            self.sessions.end_all(problem, now, REJOIN_ADVICE)
        else:
            self.sessions.lease.interrupt("fault", problem)
        if name == "render" and self.selections.note_renderer_end(now):
            self._record_fault("the configured solver replaces the selected one")

    def _publish(self, now: float) -> None:
        self._check_processes(now)  # what is published must have been acted on
        self._due["check"] = now + CHECK_INTERVAL
        # A plug-in reported something invalid, or the message is too long (WireError).
        try:
            self.newest = self.state_builder.make_next_state(now, self._supervisor.restarts)
            self._sockets.publish(STATE, encode(self.newest))
        except (TypeError, ValueError):
            self.counts["unpublished"] += 1

    def _publish_frame(self, now: float) -> None:
        self.statuses.look_at_frame()
        try:
            self._sockets.publish(FRAME, encode(self.state_builder.make_frame_state(now)))
        except (TypeError, ValueError):
            self.counts["unpublished"] += 1


def _name_server() -> str:
    import importlib.metadata

    return f"pacinian {importlib.metadata.version('pacinian')}"
