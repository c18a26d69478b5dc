"""A hand that moves over a ball, for a page that has nothing to show. It has its own session with the server."""

from __future__ import annotations

import math
import threading
import time
from typing import TYPE_CHECKING

from pacinian.acoustics.pose import Pose
from pacinian.client.client import Client
from pacinian.errors import ConnectionLost, Refused, describe_error
from pacinian.scene.hands.hand import Hand
from pacinian.scene.objects import Volume
from pacinian.scene.shapes.sphere_capsule import Sphere

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

NAME = "demonstration"
HAND_INTERVAL = 1.0 / 60.0  # interval between two hands [s]
# Maximum time between two `alive` messages of an open page [s]. A page that is hidden ends the
# demonstration at once.
QUIET = 10.0
HEIGHT = 0.2  # height of the hand above the array [m]
TURN, SWAY = 5.0, 0.02  # period [s] and amplitude [m] of the movement
BALL = Volume(
    name="ball", shape=Sphere(0.03), pose=Pose((0.0, 0.0, HEIGHT - 0.04)), radiation_pressure=6.0
)


class Demonstration:
    """Plays in its own thread while the page that started it sends `alive`. It takes the output from nobody.

    where: the connection file. is_open: returns whether the page is still open. refuse: called with a message and
    advice if the demonstration cannot play. last: the demonstration before, which must have ended when this one begins.
    """

    def __init__(
        self,
        where: Path | str | None,
        is_open: Callable[[], bool],
        refuse: Callable[[str, str], object],
        last: Demonstration | None = None,
    ) -> None:
        self._where, self._is_open, self._refuse, self._last = where, is_open, refuse, last
        self._ended = threading.Event()
        self._alive = time.perf_counter()
        self._thread = threading.Thread(target=self._run, name=NAME, daemon=True)
        self._thread.start()

    @property
    def plays(self) -> bool:
        """Whether the demonstration is running, and has not been asked to end."""
        return self._thread.is_alive() and not self._ended.is_set()

    def keep_alive(self) -> None:
        """Note that the page is still visible."""
        self._alive = time.perf_counter()

    def end(self) -> None:
        """End the demonstration soon, without waiting."""
        self._ended.set()

    def close(self) -> None:
        """End the demonstration, and wait until it has ended."""
        self.end()
        self._thread.join()

    def _run(self) -> None:
        if self._last is not None:
            self._last.close()
            self._last = None
        try:
            with Client(self._where, name=NAME) as client:
                client.put(BALL)
                client.hands(make_hand(0.0))
                client.arm()
                begin = time.perf_counter()
                while self._goes_on():
                    client.hands(make_hand(time.perf_counter() - begin), wait=False)
                    client.hold(HAND_INTERVAL)
        except ConnectionLost:
            pass  # the viewer's own session reports it to the pages
        except Refused as error:
            if not self._ended.is_set():
                self._refuse(str(error).removesuffix(f"; {error.advice}"), error.advice)
        except Exception as error:
            self._refuse(describe_error(error), "")

    def _goes_on(self) -> bool:
        lives = self._is_open() and time.perf_counter() - self._alive < QUIET
        return lives and not self._ended.is_set()


def make_hand(t: float) -> Hand:
    """Return the hand at time t [s]."""
    turn = 2.0 * math.pi * t / TURN
    return Hand.open(
        "right", Pose((SWAY * math.sin(turn), 0.5 * SWAY * math.sin(2.0 * turn), HEIGHT))
    )
