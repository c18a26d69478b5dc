"""A hand that is new in the field gets no more than the pressure limit: the output is silent until it is known."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from msgspec.structs import replace

import pacinian as pc
from pacinian.gallery import HAND
from pacinian.rendering.deviation_log import SKIN_LIMITED
from pacinian.rendering.rerender import rerender
from pacinian.rendering.smoothing import Smoothing
from pacinian.testing import ManualClock
from pacinian_plugins.backends.simulated import Simulated

from .manual_background import ManualBackground, solve_beside
from .test_background_solve import Slow
from .test_skin_limit import AIR, CENTRE, HIGH, ONE, TOLERANCE, highest

if TYPE_CHECKING:
    from pathlib import Path

TICK = 1e-3  # [s]
LIMIT = 3.0  # [Pa]
SILENT_AFTER = 2  # ticks in which the output fades out
ROUNDING = 0.02  # of the device
BALL = pc.Volume(
    shape=pc.Sphere(0.02), pose=pc.Pose((*CENTRE[:2], 0.19)), radiation_pressure=4.0, name="ball"
)
RIGHT = HAND.transform(HIGH)
LEFT = pc.Hand.open("left", pc.Pose((CENTRE[0], CENTRE[1] + 0.12, 0.22)))


class Loop:
    """A renderer whose scene and background the test controls.

    item: the object. background: whether solves run in the background.
    """

    def __init__(
        self, *hands: pc.Hand, background: bool, item: Any = BALL, **settings: Any
    ) -> None:
        settings.setdefault("peak", LIMIT)
        self.item = item
        self.device = Simulated(rate=2000.0, keep=1000)
        self.show(*hands)
        self.renderer = pc.Renderer(
            ONE, lambda t: self.scene, backend=self.device, clock=ManualClock(), medium=AIR, **settings
        )  # fmt: skip
        self.renderer.open()
        self.ticks = 0
        self.run(30)
        self.background: ManualBackground | None = (
            solve_beside(self.renderer) if background else None
        )

    def show(self, *hands: pc.Hand) -> None:
        """Let the scene have these hands from now on."""
        self.scene = pc.Scene((self.item,), hands=hands)

    def run(self, count: int) -> list[Any]:
        """Run ticks, and return the gains of the last row of each."""
        made = []
        for _ in range(count):
            self.renderer.tick(self.ticks * TICK)
            self.ticks += 1
            made.append(self.device.frames[-1].gains(self.device.capability)[-1])
        assert not self.renderer.report.faults
        return made

    def end_solve(self, *, ready: bool) -> None:
        """Let solves in the background end from now on, or not."""
        if self.background is not None:
            self.background.ready = ready


@pytest.mark.parametrize("background", [False, True])
def test_no_place_of_a_new_hand_gets_more_than_the_limit(background: bool) -> None:
    loop = Loop(background=background)
    free = loop.run(1)[0]
    assert highest(free, RIGHT, 0) > 1.3 * LIMIT, "otherwise this tests nothing"
    loop.end_solve(ready=False)
    loop.show(RIGHT)
    began = loop.ticks * TICK
    made = loop.run(10)
    if background:
        assert not np.any(made[SILENT_AFTER:])
    loop.end_solve(ready=True)
    made = made[SILENT_AFTER:] + loop.run(30)
    for gains in made[::3]:
        assert highest(gains, RIGHT, 0) <= LIMIT * (1.0 + TOLERANCE)
    assert highest(made[-1], RIGHT, 0) > 0.5 * LIMIT, "it is felt again"
    assert loop.renderer.report.deviations.totals["ball"][SKIN_LIMITED].first == pytest.approx(
        began
    )


def test_a_second_hand_is_new_while_the_first_is_known() -> None:
    loop = Loop(RIGHT, background=True)
    assert np.any(loop.run(1))
    loop.end_solve(ready=False)
    loop.show(RIGHT, LEFT)
    assert not np.any(loop.run(10)[SILENT_AFTER:])
    loop.end_solve(ready=True)
    assert np.any(loop.run(10)[-1])


def move(hand: pc.Hand, x: float) -> pc.Hand:
    return hand.transform(pc.Pose((x, 0.0, 0.0)))


def rename(hand: pc.Hand, name: str) -> pc.Hand:
    return pc.Hand(hand.joints, side=hand.side, name=name)


@pytest.mark.parametrize("background", [False, True])
def test_hands_that_are_known_do_not_interrupt_the_output(background: bool) -> None:
    gone = pc.Hand(np.full((26, 3), np.nan), side="right")
    loop = Loop(RIGHT, background=background)
    assert np.any(loop.run(1))
    loop.end_solve(ready=False)
    for hands in [(gone,), (RIGHT,), (move(RIGHT, 0.001),), (move(RIGHT, 0.05),), ()]:
        loop.show(*hands)
        assert all(np.any(gains) for gains in loop.run(3))


def test_a_hand_that_is_no_longer_measured_does_not_interrupt_the_output() -> None:
    loop = Loop(RIGHT, background=True)
    for k in range(5):  # with other values each time
        loop.show(RIGHT, pc.Hand(move(LEFT, 0.001 * k).joints, side="left", time=-0.2))
        assert all(np.any(gains) for gains in loop.run(5))


@pytest.mark.parametrize(
    "after",
    [
        (move(RIGHT, 0.1), LEFT),
        (rename(RIGHT, "left"), rename(LEFT, "right")),
        (move(RIGHT, -0.1), pc.Hand(np.full((26, 3), np.nan), side="left")),
    ],
    ids=["jump", "names", "jump and loss"],
)
def test_a_hand_that_jumps_is_new(after: tuple[pc.Hand, ...]) -> None:
    loop = Loop(RIGHT, LEFT, background=True)
    assert np.any(loop.run(1))
    loop.end_solve(ready=False)
    loop.show(*after)
    assert not np.any(loop.run(10)[SILENT_AFTER:])


def find_rows(loop: Loop) -> Any:
    """Run a tick, and return its gains, (K, N)."""
    loop.run(1)
    return loop.device.frames[-1].gains(loop.device.capability)


def test_a_technique_that_moves_a_focus_fades_out_too() -> None:
    focus = replace(BALL, technique=pc.STM(frequency=50.0, along="outline"))
    loop = Loop(background=False, item=focus, peak=1.0)
    before = find_rows(loop)
    loop.show(RIGHT)
    levels = np.abs(np.concatenate([before, *(find_rows(loop) for _ in range(2))])).max(axis=1)
    step = Smoothing().rate / loop.device.rate + ROUNDING  # type: ignore[operator]
    falls = levels[1:] - levels[:-1]
    first = int((levels < 0.01).argmax())
    assert 0 < first < len(levels)
    assert (falls[:first] > -step * levels[0]).all()


def test_with_new_limits_the_output_begins_from_silence_as_without() -> None:
    begins = []
    for limits in (pc.Limits(gain=1.0), pc.Limits(gain=0.99)):
        loop = Loop(background=False, max_cycle_frames=1, limits=pc.Limits(gain=1.0))
        loop.show(RIGHT)
        loop.renderer.limits = limits
        levels = np.abs(np.concatenate([find_rows(loop) for _ in range(6)])).max(axis=1)
        silent = int((levels < 0.01).argmax())
        begins.append(levels[silent:][levels[silent:] > 0.01][0])
    assert begins[1] == pytest.approx(begins[0], abs=ROUNDING)
    assert begins[1] < 0.8 * levels[-1]


@pytest.mark.parametrize("peak", [float("inf"), 500.0])
def test_a_limit_that_the_array_cannot_exceed_does_not_interrupt_the_output(peak: float) -> None:
    loop = Loop(background=True, peak=peak)
    loop.end_solve(ready=False)
    loop.show(RIGHT)
    assert all(np.any(gains) for gains in loop.run(10))


@pytest.mark.parametrize("seed", [0, 1])
def test_a_recording_with_new_hands_is_rendered_again_exactly(tmp_path: Path, seed: int) -> None:
    chance, path = np.random.default_rng(seed), tmp_path / "run.pac"
    scenes = [pc.Scene((BALL,), hands=hands) for hands in [(), (RIGHT,), (LEFT,), (RIGHT, LEFT)]]
    renderer = pc.Renderer(
        ONE,
        lambda t: scenes[int(t / 0.03) % 4],
        backend=Simulated(rate=2000.0),
        clock=Slow(),
        peak=LIMIT,
        recorder=pc.Recorder(path),
    )
    with renderer:
        background = renderer._pipeline.background = ManualBackground()
        for k in range(120):
            background.ready = bool(chance.random() < 0.4)
            renderer.tick(k * TICK)
        assert not renderer.report.faults
        assert renderer.schedule.in_background
    assert renderer.report.deviations.totals["ball"][SKIN_LIMITED].ticks > 5
    found = rerender(pc.Recording(path))
    assert (found.ticks, found.different) == (120, 0)
