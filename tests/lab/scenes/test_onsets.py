from __future__ import annotations

import math

import numpy as np
import pytest

import pacinian as pc
from pacinian.scene.sampling.ramps import RAMP_TIME
from pacinian_lab.scenes import onsets as comings

ARRAY = pc.autd()
EVENTS = [what for what in comings.CASES if not what.startswith(("square", "an envelope"))]
FOCUS = pc.matrix(ARRAY, [comings.HERE, comings.THERE], pc.Air())
SLACK = 0.02  # a solution of several points varies a little


@pytest.fixture(autouse=True)
def _soon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(comings, "EVENT", 0.012)


@pytest.mark.parametrize("rows", [1, 2, 16])
@pytest.mark.parametrize("what", EVENTS)
def test_no_step_is_larger_than_that_of_the_ramp(what: str, rows: int) -> None:
    made = comings.collect_gains(ARRAY, comings.CASES[what], rows, ticks=50)
    p = np.abs(made @ FOCUS.T)
    steepest = math.sin(math.pi / 10.0)  # of a raised cosine in 5 ticks: a quarter of a sine
    assert np.abs(np.diff(p, axis=0)).max() <= p.max() * (steepest / rows + SLACK)


@pytest.mark.parametrize("rows", [1, 4])
@pytest.mark.parametrize("strength", ["a point", "a weak point"])
def test_strong_or_weak_it_is_there_and_silent_again_after_the_ramp(
    strength: str, rows: int
) -> None:
    first, last = (
        round(1000 * comings.EVENT) * rows,
        round(1000 * (comings.EVENT + RAMP_TIME)) * rows - 1,
    )
    comes = comings.collect_gains(ARRAY, comings.CASES[f"{strength} appears"], rows, ticks=30)
    goes = comings.collect_gains(ARRAY, comings.CASES[f"{strength} vanishes"], rows, ticks=30)
    assert not comes[:first].any()
    assert comes[first].any()
    full = np.abs(comes[-1] @ FOCUS[0])
    shape = np.abs(comes @ FOCUS[0]) / full
    assert shape[last:] == pytest.approx(1.0, abs=1e-4)
    assert shape[first - 1 + rows : last + 1 : rows] == pytest.approx(
        np.sin(np.pi / 10.0 * np.arange(1, 6)), abs=1e-4
    )
    assert np.abs(goes[first - 1] @ FOCUS[0]) == pytest.approx(full, rel=1e-4)
    assert not goes[last:].any()


def test_what_stays_is_not_disturbed_by_what_comes_with_another_envelope() -> None:
    other = comings.point(envelope=pc.Sine(20.0))
    alone, both = pc.Scene((comings.STAYS,)), pc.Scene((comings.STAYS, other))
    for scene in (comings.after(alone, both), comings.after(both, alone)):
        made = comings.collect_gains(ARRAY, scene, 4, ticks=30)[32:]  # after its own ramp
        p = np.abs(made @ FOCUS[1])
        assert p == pytest.approx(p[-1], rel=0.01)


def test_two_envelopes_come_and_go_together() -> None:
    items = comings.STAYS, comings.point(envelope=pc.Sine(100.0))
    for scene in (
        comings.after(pc.Scene(), pc.Scene(items)),
        comings.after(pc.Scene(items), pc.Scene()),
    ):
        p = np.abs(comings.collect_gains(ARRAY, scene, 2, ticks=30) @ FOCUS.T)
        assert np.abs(np.diff(p, axis=0)).max() <= p.max() * (math.sin(math.pi / 10.0) / 2.0 + 0.16)


def test_squares_have_no_step_of_more_than_half() -> None:
    for what in ("square, 100 Hz", "square, 200 Hz"):
        one = comings.evaluate(
            what, comings.collect_gains(ARRAY, comings.CASES[what], 2, 60)[40:], 2, ARRAY
        )
        assert one.step <= 0.51
