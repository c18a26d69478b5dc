"""From a scene to what the array emits."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np
import pytest

import pacinian as pc
from pacinian.testing import ManualClock
from pacinian_plugins.backends.simulated import Simulated
from pacinian_plugins.backends.sonicsurface import SonicSurface
from pacinian_plugins.backends.sonicsurface.protocol import SELECT, Packer
from pacinian_plugins.backends.sonicsurface.write_scheduler import WriteScheduler

from ...waiting import eventually
from .adapters import ARRAY, Terminal
from .fpga import Board

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.skipif(os.name == "nt", reason="Windows has no pseudo-terminals")
POINT = pc.Point(position=(0.0, 0.0, 0.12), radiation_pressure=5.0)


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    made = Terminal()
    yield made
    made.close()


def test_a_loop_feeds_a_slow_line_and_the_last_frame_is_what_sounds(terminal: Terminal) -> None:
    ticks = 0

    def scene(t: float) -> pc.Scene:
        nonlocal ticks
        ticks += 1
        x = 1e-3 * min(ticks, 100)
        return pc.Scene((pc.Point(position=(x, 0.0, 0.12), radiation_pressure=5.0),))

    backend = SonicSurface(port=terminal.name, timeout=1.0)
    with pc.Renderer(ARRAY, scene, backend=backend, adaptive=False) as renderer:
        for _ in range(120):
            renderer.tick()
            terminal.pump()
        want = renderer.last_frame.gains(backend.capability)[-1]

        def arrived() -> bool:
            terminal.pump()
            return bool(np.abs(terminal.board.gains() - want).max() < 1e-6)

        eventually(arrived)
        assert not renderer.report.faults
    terminal.pump()
    assert not terminal.board.pulses().any()


def test_all_pulses_arrive_at_a_focus_together(terminal: Terminal) -> None:
    """In time, as it is on air: whichever way round phases are counted."""
    backend = SonicSurface(port=terminal.name, timeout=1.0)
    with pc.Renderer(ARRAY, pc.Scene((POINT,)), backend=backend) as renderer:
        for _ in range(20):
            renderer.tick()
        sent = renderer.last_frame.amplitude[-1]

        def arrived() -> bool:
            terminal.pump()
            return bool((terminal.board.pulses().any(axis=1) == sent.astype(bool)).all())

        eventually(arrived)
        pulses = terminal.board.pulses()
    on = pulses.any(axis=1)
    assert 20 < on.sum() < 256
    late = np.angle(pulses[on] @ np.exp(2j * np.pi * np.arange(32) / 32))  # the middle of each
    r = np.linalg.norm(ARRAY.positions[on] - POINT.position, axis=1)
    k = renderer.session.medium.wavenumber(ARRAY.transducer.frequency)
    arrival = late + k * r
    assert abs(np.exp(1j * arrival).mean()) > 0.99


def test_a_square_envelope_is_played_by_swaps() -> None:
    blink = pc.Point(
        position=(0.0, 0.0, 0.12), radiation_pressure=5.0, envelope=pc.Square(frequency=50.0)
    )
    clock = ManualClock()
    shown = pc.Renderer(
        ARRAY, pc.Scene((blink,)), backend=Simulated(phases=32, amplitudes=2), clock=clock
    )
    ALL = np.arange(256)
    packer, feed, board = Packer([pc.Wiring("", 256, ALL, ALL)]), WriteScheduler(1, SELECT), Board()
    sizes: list[int] = []
    late = 0
    with shown:
        for k in range(500):
            clock.time = k * 1e-3
            shown.tick()
            feed.newest = packer.pack(shown.last_frame.phase[-1], shown.last_frame.amplitude[-1])
            board.take(data := feed.next(clock.time))
            sizes.append(len(data))
            late += board.heard.tobytes() != np.array(list(feed.newest)).tobytes()
    assert sizes.count(258) < 6  # the beginning
    assert 40 <= sizes.count(1) <= 50
    assert late < 60  # of the beginning, too
