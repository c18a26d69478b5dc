"""Reads the newest state, and skips all older ones that wait.

A slow reader finds old states in the kernel's buffers, and more arrive only as it reads. Therefore it reads until a
state is fresh, or no more arrive.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import zmq

from pacinian.client.link import milliseconds
from pacinian.wire.codec import decode_state
from pacinian.wire.state import State

if TYPE_CHECKING:
    from collections.abc import Callable

MAX_FRESH_AGE = 0.05  # age below which a state is fresh [s]
SETTLING_TIME = 0.005  # time to wait for more states [s]
MAX_READS = 50  # largest number of states read in one call


def read_newest(socket: zmq.Socket[bytes], age: Callable[[State], float]) -> State | None:
    """Return the newest state that has arrived; None if there is none.

    age: returns the age of a state [s]. Raises WireError.
    """
    found: State | None = None
    wait = 0.0
    for _ in range(MAX_READS):
        if not socket.poll(milliseconds(wait)):
            break
        state = decode_state(_last(socket))
        found = state if isinstance(state, State) else found
        if found is not None and age(found) < MAX_FRESH_AGE:
            break
        wait = SETTLING_TIME
    return found


def _last(socket: zmq.Socket[bytes]) -> bytes:
    """Return the last of the waiting messages, of which there must be one."""
    data = socket.recv_multipart()[-1]
    while True:
        try:
            data = socket.recv_multipart(zmq.NOBLOCK)[-1]
        except zmq.Again:
            return data
