"""The newest state: of many that wait, all but the last are skipped.

A reader that was slow finds old ones in the kernel's buffers, more of which come only as it reads: so it reads on
until one is fresh, or no more come.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import zmq

from pacinian.client.link import milliseconds
from pacinian.wire.codec import decode_state
from pacinian.wire.state import State

if TYPE_CHECKING:
    from collections.abc import Callable

FRESH = 0.05  # [s]
SETTLE = 0.005  # [s] in which more would come
PASSES = 50


def read_newest(socket: zmq.Socket[bytes], age: Callable[[State], float]) -> State | None:
    """The newest state that has come; None if none has.

    age: how long ago a state was published [s]. Raises WireError.
    """
    found: State | None = None
    wait = 0.0
    for _ in range(PASSES):
        if not socket.poll(milliseconds(wait)):
            break
        state = decode_state(_last(socket))
        found = state if isinstance(state, State) else found
        if found is not None and age(found) < FRESH:
            break
        wait = SETTLE
    return found


def _last(socket: zmq.Socket[bytes]) -> bytes:
    """The last of the messages that wait, of which there is one at least."""
    data = socket.recv_multipart()[-1]
    while True:
        try:
            data = socket.recv_multipart(zmq.NOBLOCK)[-1]
        except zmq.Again:
            return data
