"""The picture of a run: the field that is played, which may be of several frames."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import pacinian as pc
from pacinian import plot
from pacinian.cli.run_output import picture
from pacinian.testing import ManualClock

if TYPE_CHECKING:
    import pytest

ARRAY = pc.autd(3, 3)


def drawn(renderer: pc.Renderer, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return the horizontal slice of the picture, a Matplotlib image."""
    pages: list[Any] = []
    monkeypatch.setattr(plot, "save", lambda page, path: pages.append(page))
    assert picture(renderer, "run.png", "a run", quiet=True) == "run.png"
    return pages[0].axes[0].images[0]


def test_frames_in_turn_are_drawn_as_their_mean(monkeypatch: pytest.MonkeyPatch) -> None:
    x, y, _ = ARRAY.centre
    plate = pc.Surface(  # more samples than one frame may have
        shape=pc.Rectangle(0.11, 0.11), pose=pc.Pose((x, y, 0.2)), radiation_pressure=1.0
    )
    other = pc.Point(position=(x + 0.2, y, 0.2), radiation_pressure=0.001)  # then frames take turns
    clock = ManualClock()
    with pc.Renderer(ARRAY, pc.Scene((plate, other)), clock=clock, adaptive=False) as renderer:
        for k in range(100):
            clock.time = k * renderer.period
            renderer.tick(clock.time)
        frames, medium = renderer.cycle_gains, renderer.session.medium
        image = drawn(renderer, monkeypatch)
    assert len(frames) > 1
    shown, (left, right, bottom, top) = np.asarray(image.get_array()), image.get_extent()
    rows, columns = np.arange(10, shown.shape[0], 23), np.arange(10, shown.shape[1], 23)
    X, Y = np.meshgrid(
        left + (columns + 0.5) * (right - left) / shown.shape[1],
        bottom + (rows + 0.5) * (top - bottom) / shown.shape[0],
    )
    q = np.stack([X, Y, np.full(X.shape, 200.0)], axis=-1) * 1e-3
    power = np.mean([np.abs(pc.field(ARRAY, g, q, medium)) ** 2 for g in frames], axis=0)
    felt = pc.radiation_pressure(np.sqrt(power), medium)
    one = pc.radiation_pressure(np.abs(pc.field(ARRAY, frames[-1], q, medium)), medium)
    assert np.abs(one - felt).max() > 0.5  # one frame alone is another field
    np.testing.assert_allclose(shown[np.ix_(rows, columns)], felt, atol=0.01 * felt.max())


def test_before_the_first_frame_the_picture_is_of_silence(monkeypatch: pytest.MonkeyPatch) -> None:
    with pc.Renderer(ARRAY, pc.Scene(), clock=ManualClock()) as renderer:
        assert not np.asarray(drawn(renderer, monkeypatch).get_array()).any()
