"""A hand that moves over a ball, for a page that has nothing to show: a client of the server of its own."""

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
EVERY = 1.0 / 60.0  # [s] between two hands
QUIET = 10.0  # [s] without a word of a page that is open, after which it ends: one that is hidden says so at once
HEIGHT = 0.2  # [m] of the hand over the array
TURN, SWAY = 5.0, 0.02  # [s] of one way to and fro, and how far [m]
BALL = Volume(
    name="ball", shape=Sphere(0.03), pose=Pose((0.0, 0.0, HEIGHT - 0.04)), radiation_pressure=6.0
)


class Demonstration:
    """Plays in a thread of its own while the page that asked is alive. It arms, but takes the output from nobody.

    where: the connection file. is_open: whether the page is. refuse: is told, with a message and advice, why it does
    not play.
    """

    def __init__(
        self,
        where: Path | str | None,
        is_open: Callable[[], bool],
        refuse: Callable[[str, str], object],
    ) -> None:
        self._where, self._is_open, self._refuse = where, is_open, refuse
        self._ended = threading.Event()
        self._alive = time.perf_counter()
        self._thread = threading.Thread(target=self._run, name=NAME, daemon=True)
        self._thread.start()

    @property
    def plays(self) -> bool:
        """Whether it has not ended."""
        return self._thread.is_alive()

    def keep_alive(self) -> None:
        """The page is looked at."""
        self._alive = time.perf_counter()

    def end(self) -> None:
        """Silence, soon."""
        self._ended.set()

    def close(self) -> None:
        """End it, and wait for that."""
        self.end()
        self._thread.join()

    def _run(self) -> None:
        try:
            with Client(self._where, name=NAME) as client:
                client.put(BALL)
                client.hands(make_hand(0.0))
                client.arm()
                begin = time.perf_counter()
                while self._goes_on():
                    client.hands(make_hand(time.perf_counter() - begin), wait=False)
                    client.hold(EVERY)
        except ConnectionLost:
            pass  # the pages are told by the viewer's own session
        except Refused as error:
            self._refuse(str(error).removesuffix(f"; {error.advice}"), error.advice)
        except Exception as error:
            self._refuse(describe_error(error), "")

    def _goes_on(self) -> bool:
        lives = self._is_open() and time.perf_counter() - self._alive < QUIET
        return lives and not self._ended.is_set()


def make_hand(t: float) -> Hand:
    """The hand after t seconds [s]."""
    turn = 2.0 * math.pi * t / TURN
    return Hand.open(
        "right", Pose((SWAY * math.sin(turn), 0.5 * SWAY * math.sin(2.0 * turn), HEIGHT))
    )
