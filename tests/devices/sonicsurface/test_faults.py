"""What goes wrong while it plays: what the user sees, and that it holds nobody up."""

from __future__ import annotations

import time

import numpy as np

import pacinian as pc
from pacinian_plugins.backends.sonicsurface import SonicSurface
from pacinian_plugins.backends.sonicsurface.ports import STUCK, UNPLUGGED

from ...waiting import eventually
from .adapters import ARRAY, NAME, Port, frame, refused


def open_patiently() -> SonicSurface:
    """Whose system may hold bytes for as long as a busy machine stands still."""
    made = SonicSurface(port=NAME, timeout=1.0)
    made.open(ARRAY)
    assert made._line is not None
    made._line._timeout = 60.0
    return made


def is_silent(backend: SonicSurface) -> bool:
    """As the loop asks for it, again and again."""
    try:
        backend.silence()
    except pc.BackendError:
        return False
    return True


def heard(port: Port) -> bool:
    return bool(port.out_waiting == 0 and port.board.pulses().any())


def test_it_is_silent_when_it_is_open_and_when_it_is_closed(port: Port) -> None:
    port.board.clocks = False  # as the boards' own controller fears
    backend = open_patiently()
    assert port.writes == [b"\x97", b"\xfe" + b"\x20" * 256 + b"\xfd"]
    assert port.board.clocks
    assert not heard(port)
    backend.send(frame(phase=3, rows=2))
    eventually(lambda: heard(port))
    assert port.writes[-1] == b"\xfe" + b"\x1d" * 256 + b"\xfd"
    backend.silence()
    assert not heard(port)
    backend.send(frame())
    eventually(lambda: heard(port))
    assert backend.capability == pc.Capability(32, 2, 1000.0)
    backend.close()
    backend.close()
    assert not heard(port)
    assert port.closed
    refused(lambda: backend.send(frame()), "sonicsurface is not open")
    backend.silence()


def test_a_line_that_takes_its_time_holds_nobody_up_and_only_the_newest_waits_for_it(
    port: Port,
) -> None:
    backend = open_patiently()
    backend.send(frame())
    eventually(lambda: heard(port))
    written = len(port.writes)
    port.hangs = True
    for k in range(300):
        backend.send(frame(phase=k % 32))
    assert len(port.writes) <= written + 1  # which is held
    port.hangs = False
    eventually(lambda: port.out_waiting == 0 and (port.board.heard == -299 % 32).all())
    assert len(port.writes) <= written + 2
    backend.close()


def test_silence_is_silence_whatever_is_under_way(port: Port) -> None:
    backend, random = open_patiently(), np.random.default_rng(0)
    for _ in range(60):
        for _ in range(random.integers(4)):
            backend.send(frame(phase=int(random.integers(32))))
        if random.integers(2):
            time.sleep(1e-3 * random.integers(20))
        backend.silence()
        assert not port.held
        assert not port.board.pulses().any()
    backend.close()


def test_an_adapter_that_hangs_is_an_error_and_nothing_waits_in_it(port: Port) -> None:
    backend = open_patiently()
    backend.send(frame())
    eventually(lambda: heard(port))
    line = backend._line
    assert line is not None
    line._timeout = 0.2
    port.hangs = True
    written, phase = len(port.writes), 0

    def problem() -> str:
        nonlocal phase
        phase = (phase + 1) % 32
        try:
            backend.send(frame(phase=phase))
        except pc.BackendError as error:
            return str(error)
        return ""

    assert eventually(problem) == f"sonicsurface {NAME}: {STUCK}"
    assert len(port.writes) == written + 1  # one frame, which is held
    refused(backend.silence, f"sonicsurface {NAME}: {STUCK}")
    refused(lambda: backend.send(frame()), f"sonicsurface {NAME}: {STUCK}")
    port.hangs = False
    line._timeout = 60.0
    eventually(lambda: is_silent(backend))
    assert not heard(port)
    backend.send(frame())
    eventually(lambda: heard(port))
    backend.close()


def test_a_system_that_takes_nothing_is_an_error(port: Port) -> None:
    backend = open_patiently()
    port.full = True
    refused(backend.silence, f"sonicsurface {NAME}: {STUCK}")
    port.full = False
    eventually(lambda: is_silent(backend))
    backend.close()


def test_unplugged_is_an_error_at_once_and_from_then_on(port: Port) -> None:
    backend = open_patiently()
    backend.send(frame())
    eventually(lambda: heard(port))
    port.gone = True
    gone = f"sonicsurface {NAME}: {UNPLUGGED}"
    for _ in range(2):
        refused(lambda: backend.send(frame()), gone)
        refused(backend.silence, gone)
    assert port.board.pulses().any()  # and no watchdog
    backend.close()
    assert port.closed


def test_unplugged_while_nothing_is_sent_is_told_by_the_next_frame(port: Port) -> None:
    backend = open_patiently()
    backend.send(frame())
    eventually(lambda: heard(port))
    port.gone = True
    line = backend._line
    assert line is not None
    eventually(lambda: line._problem)  # it is written again, now and then
    refused(lambda: backend.send(frame()), f"sonicsurface {NAME}: {UNPLUGGED}")
    backend.close()


def test_levels_that_it_does_not_have(port: Port) -> None:
    backend = open_patiently()
    for wrong in (frame(level=2), frame(phase=32)):
        refused(
            lambda wrong=wrong: backend.send(wrong),
            "sonicsurface: a frame contains levels that the array cannot emit",
        )
    backend.close()
