"""`pacinian.Client`: lets a game or a script render its scene on a server's array."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.argument_checks import check_number
from pacinian.client import messages
from pacinian.client.emergency_stop import emergency_stop
from pacinian.client.reconnecting_client import ReconnectingClient
from pacinian.client.timeouts import CHANGE_TIMEOUT
from pacinian.errors import ConnectionLost, ServerError, WireError
from pacinian.wire import commands, control, replies
from pacinian.wire.binary_arrays import unpack
from pacinian.wire.convert import envelope_to_wire, technique_to_wire
from pacinian.wire.protocol import MAX_TIME_TO_LIVE
from pacinian.wire.silence_cause import DISCONNECTED
from pacinian.wire.state import State

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from pacinian.acoustics.pose import Pose
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.modulation.envelope import Envelope
    from pacinian.scene.modulation.technique import Technique
    from pacinian.scene.motion import Motion
    from pacinian.scene.objects import Object
    from pacinian.solving.felt_figures import FeltRegion
    from pacinian.solving.quiet_zone import Zone
    from pacinian.types import ArrayLike, Complexes
    from pacinian.wire.silence_cause import Silence


class Client(ReconnectingClient):
    """A session with `pacinian serve`. A context manager. Belongs to the thread that makes it, except for `stop`.

    connection: a connection, or the path of its file; by default, the file that the server writes. name: shown to
    people. scene: clients that give the same name share a scene. lease: maximum time between two calls of `renew` while
    armed [s]; default and maximum: the server's. timeout: for a reply [s]. keys: this client's CURVE keys, a file
    or a folder. reconnect: whether the call after one that raised ConnectionLost connects again, unless it is `renew`,
    `hold` or `watch`. clock: a steady clock [s].

    The server forgets a client that sends nothing for `safety.session_timeout`, with all its objects. While the client
    is not armed, any call also renews the session, however long it waits. While it is armed, only `renew`, `hold` and
    `select` do.

    Calls wait for their reply unless `wait=False`. Then they never block. If the socket has no room, commands wait; a
    newer command replaces the waiting ones that it makes useless. `errors` lists the commands that the server refused.
    ttl: time to live [s]; a command that is older than this is dropped.

    After a connection loss nothing resumes: arm again, and put the objects again. Raises ConnectionLost, Refused;
    WireError for objects that cannot be sent.
    """

    def put(
        self, *objects: Object, duration: float | None = None, ttl: float = 1.0, wait: bool = True
    ) -> None:
        """Put named objects into the scene. An object replaces the one of the same name.

        duration: time after which the server removes them [s].
        """
        for batch in messages.make_put(objects, duration):
            self._command(commands.Put, ttl, wait, objects=batch)

    def move(
        self,
        name: str,
        pose: Pose,
        motion: Motion | None = None,
        *,
        ttl: float = 1.0,
        wait: bool = True,
    ) -> None:
        """Set the pose of an object. motion: its motion from now on; `motion.time` is ignored."""
        self.moves({name: pose}, {name: motion} if motion else None, ttl=ttl, wait=wait)

    def moves(
        self,
        poses: Mapping[str, Pose],
        motions: Mapping[str, Motion] | None = None,
        *,
        ttl: float = 1.0,
        wait: bool = True,
    ) -> None:
        """Set poses by name, in one message. Objects without a motion stand still."""
        for batch in messages.make_moves(poses, motions or {}):
            self._command(commands.Move, ttl, wait, **batch)

    def remove(self, *names: str, ttl: float = 1.0, wait: bool = True) -> None:
        """Remove objects. Unknown names are ignored."""
        for batch in messages.split_batches(names):
            self._command(commands.Remove, ttl, wait, names=batch)

    def clear(self, *, ttl: float = 1.0, wait: bool = True) -> None:
        """Remove all objects, hands and quiet zones of this client."""
        self._command(commands.Clear, ttl, wait)

    def envelope(
        self,
        names: str | tuple[str, ...],
        envelope: Envelope,
        *,
        ttl: float = 1.0,
        wait: bool = True,
    ) -> None:
        """Set the envelope of objects from now on."""
        wire = envelope_to_wire(envelope)
        for batch in messages.split_batches((names,) if isinstance(names, str) else names):
            self._command(commands.Envelopes, ttl, wait, names=batch, envelope=wire)

    def hands(self, *hands: Hand, ttl: float = 1.0, wait: bool = True) -> None:
        """Set all hands that this client tracks. From then on, objects are rendered only where hands touch them.

        Without arguments, nothing is rendered, but the objects stay in the scene. A lost hand, which has no joints,
        stays for 50 ms and then fades; all other hands must have joints. The hands' `time` is by this client's clock;
        the default is now.
        """
        frames, times = messages.make_hands(hands), [h.time for h in hands if h.time is not None]
        now = self._clock()
        seen = min(max(times, default=now), now)
        self._command(commands.Hands, ttl, wait, seen, hands=frames)

    def quiet(self, *zones: Zone, ttl: float = 1.0, wait: bool = True) -> None:
        """Set all quiet zones of this client. The array is silent until the server has prepared them."""
        self._command(commands.Quiet, ttl, wait, zones=messages.make_zones(zones))

    def field(self, points: ArrayLike) -> Complexes:
        """Return the complex sound pressure that is emitted now at points (K, 3) [m], (K,) [Pa]."""
        command = self._make_object(commands.Field, 1.0, points=messages.make_points(points))
        answer = self._get_session().send_command(command, replies.Pressures)
        pairs = unpack(answer.pressures, 2).astype(np.float64)
        return np.asarray(pairs[:, 0] + 1j * pairs[:, 1])

    def show(self, scene: str = "", since: int = 0) -> replies.Shown:
        """Return the objects and poses of the scene that is rendered now, or was last, whoever put them.

        scene, since: `scene` and `version` of the last reply; objects in earlier replies are then left out.
        """
        command = self._make_object(commands.Show, 1.0, scene=scene, since=since)
        return self._get_session().send_command(command, replies.Shown)

    def arm(self, take: bool = False, resume: bool = True) -> None:
        """Arm the output with this client's scene, for as long as `renew` is called.

        take: whether to take the output from another owner. resume: whether, after the lease ran out, the next `renew`
        lets the output sound again, unless it was taken, stopped or faulted meanwhile; if False, arm again.
        """
        self._get_session().arm(take, resume)

    def disarm(self) -> None:
        """End the sound softly, and let go of the output."""
        session = self._get_session()
        session.request(control.Disarm, replies.Ok)
        session.armed = session.owner = False

    def stop(self) -> None:
        """Emergency stop: silence the array at once, whoever owns the output, until `reset`.

        May be called from any thread, and after a connection loss or `close`; then it works like `emergency_stop`.
        """
        with suppress(ServerError):  # called from another thread, or the session is closed or lost
            self._check()
            self._server_session.stop()
            return
        emergency_stop(self._where, timeout=self._timeout, keys=self._keys)

    def reset(self) -> None:
        """Clear an emergency stop or a fault, so that the output can be armed again."""
        self._get_session().request(control.Reset, replies.Ok)

    def renew(self) -> None:
        """Renew the lease. Call this from the game's own tick, more often than the lease.

        Never waits, never reconnects. Raises Refused, once, if the output was disarmed without a request; its code is
        "owner", "stopped" or "fault", or, if it was armed with resume=False, "expired". Raises ConnectionLost after a
        connection loss.
        """
        self._get_session(reconnect=False).renew()

    def hold(self, seconds: float, every: float | None = None) -> None:
        """Renew the lease repeatedly for `seconds` [s], in a script.

        every: interval [s]; an eighth of the lease by default. Ctrl-C, or a notebook's stop button, disarms. Raises as
        `renew`.
        """
        end = self._clock() + check_number("seconds", seconds, low=0.0)
        session = self._get_session(reconnect=False)
        every = check_number(
            "every", session.renewal_interval if every is None else every, low=0.0, above=True
        )
        due = self._clock()
        try:
            while (now := self._clock()) < end:
                if now >= due:
                    self.renew()
                    due = now + every
                self._get_session(reconnect=False).handle_messages(min(due, end) - self._clock())
        except KeyboardInterrupt:
            with suppress(ServerError):
                self.disarm()
            raise

    def select(
        self,
        *,
        solver: str | control.Choice | None = None,
        backend: str | control.Choice | None = None,
        technique: Technique | None = None,
        intensity: float | None = None,
        wait: bool = True,
    ) -> int:
        """Select another solver, backend, default technique or intensity at run time.

        technique: for objects without their own. intensity: factor on all radiation pressures, 0..1. Waits until the
        selection takes effect, and renews the lease meanwhile if armed. With wait=False, watch `poll_state().solver`
        and `errors`: the returned number is `Refused.request` of its error. Returns 0 if it waited.
        """
        fields = {
            "solver": control.Choice(name=solver) if isinstance(solver, str) else solver,
            "backend": control.Choice(name=backend) if isinstance(backend, str) else backend,
            "technique": technique and technique_to_wire(technique),
            "intensity": intensity,
        }
        session = self._get_session()
        if wait:
            session.request_slow(control.Select, CHANGE_TIMEOUT, **fields)
            return 0
        return session.request_nowait(control.Select, **fields)

    def capabilities(self) -> replies.Abilities:
        """Return the capabilities: array, solvers, backends, limits."""
        return self._get_session().request(control.Capabilities, replies.Abilities)

    def status(self) -> State:
        """Request the current state and return it."""
        return self._get_session().request(control.Status, State)

    def explain_silence(self, state: State | None = None) -> Silence | None:
        """Return why the output is silent now, and what to do about it; None if it sounds.

        state: the newest one, if it is known already; by default, it is requested. A lost connection is an answer, not
        an error.
        """
        try:
            return (self.status() if state is None else state).silence
        except ConnectionLost:
            return DISCONNECTED

    def poll_state(self) -> State | None:
        """Return the newest state published since the last call, or None. Does not wait."""
        return self._get_session().newest(0.0)

    def watch(self, timeout: float | None = None) -> Iterator[State]:
        """Yield the newest published states. Raises ConnectionLost if none arrives within `timeout` [s]."""
        patience = self._timeout if timeout is None else timeout
        while True:
            session = self._get_session(reconnect=False)
            state = session.newest(patience)
            if state is None:
                session.lose(f"the server has published no state within {patience:g} s")
            yield state

    @staticmethod
    def decode_felt(state: State) -> dict[str, FeltRegion]:
        """Return what is felt of each surface and volume in a state, by name.

        It is measured over all touched skin or, in free air, between the samples, against the targets. Points and paths
        are left out; in silence, all objects are.
        """
        from pacinian.wire.felt_regions import read_felt

        return read_felt(state.objects, state.felt) if state.output == "sounding" else {}

    def age(self, state: State) -> float:
        """Return the age of a state [s], accurate to half of the shortest round trip of a connection or a renewal."""
        return self._get_session(reconnect=False).server_clock.age(state.time, self._clock())

    def _make_object(
        self, kind: type[Any], ttl: float, time: float | None = None, **fields: Any
    ) -> Any:
        check_number("ttl", ttl, low=0.0, high=MAX_TIME_TO_LIVE)
        session = self._get_session().welcome.session
        now = self._clock() if time is None else time
        try:
            return kind(session=session, sequence=1, time=now, ttl=ttl, **fields)
        except ValueError as error:  # the type itself checks bulk numbers
            raise WireError(str(error), "$") from error

    def _command(
        self, kind: type[Any], ttl: float, wait: bool, time: float | None = None, **fields: Any
    ) -> None:
        command = self._make_object(kind, ttl, time, **fields)
        if wait:
            self._server_session.send_command(command, replies.Ok)
        else:
            self._server_session.send_nowait(command)
