"""The output lease: whose scene is rendered and until when, as a permit for the guard. Pure: callers pass the time.

How long a lease lasts is `Safety.lease` in settings.py.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pacinian.serving.ipc.messages import Permit, PermitState
from pacinian.wire.replies import Error, Ok

if TYPE_CHECKING:
    from pacinian.serving.control.client_session import ClientSession
    from pacinian.wire.replies import Code, Reply

# Time in which the output fades out when its session releases it [s].
FADE_OUT_TIME = 0.02


class OutputLease:
    """Lends the output to one session until the session disarms or ends. The output is armed while the lease lasts.

    takeover: whether a session may take the output from another. permit: for the guard and the renderer. fault: keeps
    the output silent until `reset`. replies: to peers; the caller sends and clears them.
    """

    def __init__(self, takeover: bool = True) -> None:
        self.permit = Permit()
        self.owner: ClientSession | None = None
        self.fault = ""
        self.replies: list[tuple[bytes, Reply]] = []
        self._takeover = takeover
        self.may_resume = False
        """Whether the lease ran out and the owner's next renewal arms the output again."""
        self._resume_requested = False  # the owner's last `arm` had `resume`
        # Ids of the owner's pending `arm` requests, while another session's sound fades.
        self._pending_arms: list[int] = []

    @property
    def armed(self) -> bool:
        """Whether there may be sound now."""
        return self.permit.armed == PermitState.ARMED

    def pass_time(self, now: float) -> None:
        """End a permit that expires at `now` [s], then carry out the waiting `arm`. Call this first at each time."""
        if self.permit.armed and now >= self.permit.until:
            expired = self.armed
            self._silence()
            self.may_resume = expired and self._resume_requested
            if expired and not self._resume_requested:
                self._tell_owner(
                    "expired",
                    "the lease was not renewed in time: silence",
                    "renew from the game's own tick, and arm again",
                )
        if not self.permit.armed and self._pending_arms and self.owner is not None:
            if now >= self.owner.until:
                self._refuse(
                    "expired", "the lease was not renewed while the previous owner's sound faded"
                )
                return
            self._begin(self.owner)
            for request in self._pending_arms:
                self.replies.append((self.owner.peer, Ok(id=request)))
            self._pending_arms = []

    def arm(
        self, session: ClientSession, request: int, take: bool, now: float, *, resume: bool = False
    ) -> None:
        """Arm the session's scene: at once, or when another session's sound has faded.

        resume: whether a renewal after the lease ran out arms it again.
        """
        if self.permit.stopped or self.fault:
            problem = (
                f"a fault has stopped the output: {self.fault}"
                if self.fault
                else "an emergency stop has stopped the output"
            )
            self._tell_error(session, request, "stopped", problem, "reset first")
            return
        if self.owner not in (None, session):
            if not (take and self._takeover):
                allowed = (
                    "arm with `take`" if self._takeover else "its settings forbid taking it over"
                )
                self._tell_error(
                    session, request, "owner", f"{self._name} owns the output", allowed
                )
                return
            self._refuse("owner", f"{session.name} has taken the output")
            self._tell_owner("owner", f"{session.name} has taken the output")
            self._fade_out(now)
        self.owner, self._resume_requested, self.may_resume = session, resume, False
        session.until = max(session.until, now + session.lease)
        if self.armed:
            self.renew(session, now)
            self.replies.append((session.peer, Ok(id=request)))
        else:
            self._pending_arms.append(request)
            self.pass_time(now)

    def renew(self, session: ClientSession, now: float) -> None:
        """Extend the lease of the session to `session.until`, or begin it again if it ran out and `may_resume`."""
        if session is self.owner and self.armed:
            self.permit = self.permit._replace(until=session.until)
        elif session is self.owner and self.may_resume and now < session.until:
            self._begin(session)

    def disarm(self, session: ClientSession, now: float) -> bool:
        """Release the output; its sound fades out. Return False if another session owns it."""
        if self.owner not in (None, session):
            return False
        self._release(now)
        return True

    def end_session(self, session: ClientSession, now: float, *, fade: bool = False) -> None:
        """Note that the session has ended. fade: fade out instead of silencing at once."""
        if session is self.owner:
            self._release(now)
            if not fade:
                self._silence()

    def stop(self) -> None:
        """Silence at once, until `reset`."""
        self.interrupt("stopped", "emergency stop", "reset, and arm again")
        self.permit = self.permit._replace(stopped=1)

    def fail(self, fault: str) -> None:
        """Silence at once, until `reset`, because of a fault."""
        if not self.fault:
            self.interrupt("fault", fault, "reset, and arm again")
            self.fault = fault

    def interrupt(self, code: Code, problem: str, advice: str = "arm again") -> None:
        """Silence at once, until the next `arm`."""
        if self.armed or self.may_resume:
            self._tell_owner(code, problem, advice)
        self._refuse(code, problem)
        self._silence()

    def reset(self) -> bool:
        """End an emergency stop or a fault; return whether there was one."""
        held = bool(self.permit.stopped or self.fault)
        self.permit, self.fault = self.permit._replace(stopped=0), ""
        return held

    @property
    def _name(self) -> str:
        return self.owner.name if self.owner is not None else ""

    def _release(self, now: float) -> None:
        self._refuse("armed", "the session disarmed the output before this request was carried out")
        self._fade_out(now)
        self.owner, self.may_resume = None, False

    def _fade_out(self, now: float) -> None:
        if self.armed:
            self.permit = self.permit._replace(
                armed=PermitState.FADING, until=min(self.permit.until, now + FADE_OUT_TIME)
            )

    def _begin(self, session: ClientSession) -> None:
        epoch = self.permit.epoch + 1
        self.permit = Permit(PermitState.ARMED, session.until, epoch, scene=session.number)
        self.may_resume = False

    def _silence(self) -> None:
        """Silence at once. No renewal arms the output again, unless `pass_time` sets `may_resume` afterwards."""
        self.permit = self.permit._replace(armed=PermitState.SILENT, until=0.0)
        self.may_resume = False

    def _refuse(self, code: Code, problem: str) -> None:
        """Refuse every pending `arm` of the owner."""
        for request in self._pending_arms:
            if self.owner is not None:
                self._tell_error(self.owner, request, code, problem)
        self._pending_arms = []

    def _tell_owner(self, code: Code, problem: str, advice: str = "") -> None:
        if self.owner is not None:
            self._tell_error(self.owner, 0, code, problem, advice)

    def _tell_error(
        self, session: ClientSession, request: int, code: Code, problem: str, advice: str = ""
    ) -> None:
        error = Error(id=request, code=code, message=problem[:1000], advice=advice)
        self.replies.append((session.peer, error))
