"""`pacinian.Client`: a game or a script that lets its scene be felt by a server's array."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from pacinian.checks import check_number
from pacinian.client import messages
from pacinian.client.base_client import BaseClient
from pacinian.client.emergency import emergency_stop
from pacinian.errors import ServerError, WireError
from pacinian.wire import commands, control, replies
from pacinian.wire.binary_arrays import unpack
from pacinian.wire.convert import envelope_to_wire, technique_to_wire
from pacinian.wire.protocol import MAX_TIME_TO_LIVE
from pacinian.wire.state import State

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from pacinian.acoustics.pose import Pose
    from pacinian.scene.hands.hand import Hand
    from pacinian.scene.modulation.envelope import Envelope
    from pacinian.scene.modulation.technique import Technique
    from pacinian.scene.motion import Motion
    from pacinian.scene.objects import Object
    from pacinian.solving.felt_regions import FeltRegion
    from pacinian.solving.quiet_zone import Zone
    from pacinian.types import ArrayLike, Complexes

CHANGE = 12.0  # [s] that another solver or backend may take to be ready


class Client(BaseClient):
    """A session with `pacinian serve`; a context manager. Belongs to the thread that makes it, but for `stop`.

    connection: its file, by default where the server writes it, or what is in there. name: for people. scene:
    clients of one name share a scene. lease: within which `renew` must be called while armed [s]; at most, and
    by default, the server's. timeout: of an answer [s]. keys: our CURVE keys, a file or a folder. reconnect: the
    next call after one that raised ConnectionLost connects anew, unless it is `renew`, `hold` or `watch`. clock:
    steady, [s].

    The server forgets a client that says nothing for long (`safety.forget`), with all its objects. While nothing is
    armed, any call renews the session by itself, however long it waits; what is armed, only `renew`, `hold`, `select`.

    Calls wait for their answer unless `wait=False`: then they never block, of commands that the server has no
    room for only the newest for each object is kept, and what it refuses is found in `errors`. ttl: a command that
    the server would apply later than so long after it was sent is dropped [s].

    After a loss nothing resumes: the output is not armed, and objects must be put again. Raises
    ConnectionLost, Refused; WireError for objects that cannot be sent.
    """

    def put(
        self, *objects: Object, duration: float | None = None, ttl: float = 1.0, wait: bool = True
    ) -> None:
        """Objects with names: each is new, or takes the place of the one of that name.

        duration: after which they are removed by themselves [s].
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
        """A new pose of an object that is there. motion: from now on; its `time` is not looked at."""
        self.moves({name: pose}, {name: motion} if motion else None, ttl=ttl, wait=wait)

    def moves(
        self,
        poses: Mapping[str, Pose],
        motions: Mapping[str, Motion] | None = None,
        *,
        ttl: float = 1.0,
        wait: bool = True,
    ) -> None:
        """New poses by name, in one message; those without a motion stand still."""
        for batch in messages.make_moves(poses, motions or {}):
            self._command(commands.Move, ttl, wait, **batch)

    def remove(self, *names: str, ttl: float = 1.0, wait: bool = True) -> None:
        """Take objects away; names that nothing has are no error."""
        for batch in messages.split_batches(names):
            self._command(commands.Remove, ttl, wait, names=batch)

    def clear(self, *, ttl: float = 1.0, wait: bool = True) -> None:
        """Take away all objects, hands and quiet zones of this client."""
        self._command(commands.Clear, ttl, wait)

    def envelope(
        self,
        names: str | tuple[str, ...],
        envelope: Envelope,
        *,
        ttl: float = 1.0,
        wait: bool = True,
    ) -> None:
        """How strong objects that are there are over time, from now on."""
        wire = envelope_to_wire(envelope)
        for batch in messages.split_batches((names,) if isinstance(names, str) else names):
            self._command(commands.Envelopes, ttl, wait, names=batch, envelope=wire)

    def hands(self, *hands: Hand, ttl: float = 1.0, wait: bool = True) -> None:
        """All hands that this client tracks, in place of those before; from then on only hands feel the scene.

        None: nothing is felt, as with lost ones only, which have no joints; the scene stays. Their `time` is of this
        client's clock; now unless given. Hands that are not lost must have joints.
        """
        frames, times = messages.make_hands(hands), [h.time for h in hands if h.time is not None]
        now = self._clock()
        seen = min(max(times, default=now), now)
        self._command(commands.Hands, ttl, wait, seen, hands=frames)

    def quiet(self, *zones: Zone, ttl: float = 1.0, wait: bool = True) -> None:
        """All quiet zones of this client, in place of those before. The array is silent until they are prepared."""
        self._command(commands.Quiet, ttl, wait, zones=messages.make_zones(zones))

    def field(self, points: ArrayLike) -> Complexes:
        """Complex sound pressure at points (K, 3) [m] of what is emitted now, (K,) [Pa]."""
        command = self._make_object(commands.Field, 1.0, points=messages.make_points(points))
        answer = self._live().send_command(command, replies.Pressures)
        pairs = unpack(answer.pressures, 2).astype(np.float64)
        return np.asarray(pairs[:, 0] + 1j * pairs[:, 1])

    def show(self, scene: str = "", since: int = 0) -> replies.Shown:
        """Objects of the scene that is felt, or was felt last, whoever put them, and where they are.

        scene, since: `scene` and `version` of the last answer: what was told then is not told again.
        """
        command = self._make_object(commands.Show, 1.0, scene=scene, since=since)
        return self._live().send_command(command, replies.Shown)

    def arm(self, take: bool = False) -> None:
        """This client's scene is to be felt, for as long as `renew` is called. take: from its owner, if need be."""
        self._live().arm(take)

    def disarm(self) -> None:
        """Silence, softly; the output is let go."""
        live = self._live()
        live.ask(control.Disarm, replies.Ok)
        live.armed = live.owner = False

    def stop(self) -> None:
        """Emergency stop: silence at once, whoever owns the output, until `reset`.

        From any thread, and after a loss or `close`, too: then as `emergency_stop`.
        """
        with suppress(ServerError):  # of another thread, closed, or lost
            self._check()
            self._dialogue.stop(control.Stop())
            return
        emergency_stop(self._where, timeout=self._timeout, keys=self._keys)

    def reset(self) -> None:
        """After an emergency stop or a fault: it may be armed again."""
        self._live().ask(control.Reset, replies.Ok)

    def renew(self) -> None:
        """From the game's own tick, oftener than the lease: it is alive. Does not wait, and never reconnects.

        Raises Refused, once, when the output is not armed any more without having been asked to: its code is
        "expired", "owner", "stopped" or "fault". Raises ConnectionLost after a loss.
        """
        self._live(again=False).renew()

    def hold(self, seconds: float, every: float | None = None) -> None:
        """For scripts: renew, again and again, for so long [s]. every: [s]; a quarter of the lease unless given.

        Ctrl-C, or a notebook's stop button, disarms. Raises as `renew`.
        """
        end = self._clock() + check_number("seconds", seconds, low=0.0)
        live = self._live(again=False)
        every = check_number("every", live.every if every is None else every, low=0.0, above=True)
        due = self._clock()
        try:
            while (now := self._clock()) < end:
                if now >= due:
                    self.renew()
                    due = now + every
                self._live(again=False).look(min(due, end) - self._clock())
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
        """Another solver, backend, technique of objects that have none of their own, or strength, while running.

        intensity: factor on all radiation pressures, 0..1. Waits until it is done, and renews the lease meanwhile
        if armed; with wait=False look at `look().solver`, and at `errors`, where `Refused.request` is the number that
        is returned (0 once it is done).
        """
        fields = {
            "solver": control.Choice(name=solver) if isinstance(solver, str) else solver,
            "backend": control.Choice(name=backend) if isinstance(backend, str) else backend,
            "technique": technique and technique_to_wire(technique),
            "intensity": intensity,
        }
        live = self._live()
        if wait:
            live.request_slow(control.Select, CHANGE, **fields)
            return 0
        return live.request_nowait(control.Select, **fields)

    def capabilities(self) -> replies.Abilities:
        """What there is: the array, solvers, backends, limits."""
        return self._live().ask(control.Capabilities, replies.Abilities)

    def status(self) -> State:
        """The state of now, asked for."""
        return self._live().ask(control.Status, State)

    def look(self) -> State | None:
        """The newest state published since the last look, if there is one; does not wait for it."""
        return self._live().newest(0.0)

    def watch(self, timeout: float | None = None) -> Iterator[State]:
        """States as they are published, always the newest. Raises ConnectionLost if none comes in time [s]."""
        patience = self._timeout if timeout is None else timeout
        while True:
            live = self._live(again=False)
            state = live.newest(patience)
            if state is None:
                live.lose(f"the server has published no state within {patience:g} s")
            yield state

    @staticmethod
    def felt(state: State) -> dict[str, FeltRegion]:
        """What is felt of each surface and volume in a state, by name: between its samples, against what was asked.

        Points and paths are left out, and all objects in silence.
        """
        from pacinian.solving.felt_regions import FeltRegion

        if state.output != "sounding":
            return {}
        figures = unpack(state.felt, 4).tolist()
        told = {name: FeltRegion(*four) for name, four in zip(state.objects, figures, strict=False)}
        return {name: felt for name, felt in told.items() if not math.isnan(felt.force)}

    def age(self, state: State) -> float:
        """How long ago a state was published [s]; right to half of the shortest round trip."""
        return self._live(again=False).timing.age(state.time, self._clock())

    def _make_object(
        self, kind: type[Any], ttl: float, time: float | None = None, **fields: Any
    ) -> Any:
        check_number("ttl", ttl, low=0.0, high=MAX_TIME_TO_LIVE)
        session = self._live().welcome.session
        now = self._clock() if time is None else time
        try:
            return kind(session=session, sequence=1, time=now, ttl=ttl, **fields)
        except ValueError as error:  # of bulk numbers, which it checks by itself
            raise WireError(str(error), "$") from error

    def _command(
        self, kind: type[Any], ttl: float, wait: bool, time: float | None = None, **fields: Any
    ) -> None:
        command = self._make_object(kind, ttl, time, **fields)
        if wait:
            self._dialogue.send_command(command, replies.Ok)
        else:
            self._dialogue.send_nowait(command)
