"""Time lines show the counts of a report and the data of a recording at the right times."""

from contextlib import closing
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

import pacinian as pc
from pacinian import plot
from pacinian.plot.feeds import read_feed
from pacinian.plot.timelines import HISTOGRAM_BINS, MAX_VALUES
from pacinian.rendering.report import REMEMBERED
from pacinian.testing import ManualClock
from pacinian.viewing.feed_file import FeedWriter
from pacinian.viewing.messages import ArrayMessage, encode_message
from pacinian.wire.replies import Sound
from pacinian.wire.state import FrameState, State

ARRAY = pc.autd()
PERIOD = 1e-3  # [s]
PULSE = pc.Point(
    position=(0.0, 0.0, 0.15), radiation_pressure=5.0, envelope=pc.Square(frequency=50.0)
)
STILL = pc.Point(position=(0.0, 0.0, 0.15), radiation_pressure=5.0)


def report(ticks: int) -> pc.Report:
    made = pc.Report()
    for k in range(ticks):
        made.count_tick(1e-6 * (k % 1000), late=False)
    for k in range(5):
        made.count_solve(pc.Status.ok)
        made.add_measurement(0.01 * k, {})
    made.skipped.update({"solve, nothing moved": 7, "<i>missed</i>": 2, "nothing": 0})
    return made


def panels(page: Any) -> dict[str, Any]:
    return {panel.get_ylabel() or panel.get_xlabel(): panel for panel in page.axes}


@pytest.fixture
def recording(tmp_path: Path) -> pc.Recording:
    """Record 200 ticks of 1 ms; 30 are missed after the 100th; a reset and a still scene at the 150th."""
    path, clock = tmp_path / "run.rec", ManualClock()
    scene = pc.Scene((PULSE,))
    renderer = pc.Renderer(ARRAY, scene, clock=clock, recorder=pc.Recorder(path), adaptive=False)
    with renderer:
        for k in range(200):
            due = PERIOD * (k + 30 * (k >= 100))
            clock.time = due
            if k == 150:
                renderer.reset()
                renderer.scene = pc.Scene((STILL,))
            renderer.tick(due)
    return pc.Recording(path)


def test_a_reports_ticks_errors_and_skips_are_shown() -> None:
    found = panels(plot.timeline(report(100)))
    ticks, error, skipped = found.values()
    (line,) = ticks.lines
    np.testing.assert_allclose(line.get_xydata()[:, 0], np.arange(100))
    np.testing.assert_allclose(line.get_xydata()[:, 1], 1e-3 * np.arange(100))
    np.testing.assert_allclose(error.lines[0].get_ydata(), [0.0, 1.0, 2.0, 3.0, 4.0])
    assert [bar.get_width() for bar in skipped.patches] == [2, 7]
    assert [text.get_text() for text in skipped.texts] == ["<i>missed</i>", "solve, nothing moved"]
    assert list(found) == ["tick time [ms]", "error at samples [%]", "times skipped"]


def test_many_ticks_are_a_band_that_hides_no_extreme() -> None:
    made = report(MAX_VALUES + 1)
    made.count_tick(0.5, late=True)
    panel = plot.timeline(made, "ticks").axes[0]
    (band,), (median,) = panel.collections, panel.lines
    assert len(median.get_xdata()) == HISTOGRAM_BINS
    assert band.get_datalim(panel.transData).y1 == pytest.approx(500.0)


def test_of_a_long_run_the_last_ticks_and_errors_are_in_their_order() -> None:
    made = pc.Report()
    for k in range(REMEMBERED + 10):
        made.count_tick(1e-6 * k, late=False)
        made.count_solve(pc.Status.ok)
        made.add_measurement(1e-6 * k, {})
    for kept in (made.recent(REMEMBERED), made.errors_at_samples):
        np.testing.assert_allclose(kept, 1e-6 * np.arange(10, REMEMBERED + 10))
    np.testing.assert_allclose(made.recent(3), kept[-3:])
    x = plot.timeline(made, "ticks").axes[0].lines[0].get_xdata()
    assert x[0] >= 10
    assert x[-1] < REMEMBERED + 10


def test_nothing_can_be_drawn_too() -> None:
    page = plot.timeline(pc.Report())
    assert "nothing skipped" in panels(page)


def test_a_recordings_drive_is_that_of_its_frames(recording: pc.Recording) -> None:
    panel = plot.timeline(recording, "drive").axes[0]
    most, mean = panel.lines
    frames = np.array([frame.amplitude[0] / 255.0 for frame in recording])
    for line, exact in ((mean, frames.mean(axis=1)), (most, frames.max(axis=1))):
        y = line.get_ydata()
        np.testing.assert_allclose(y[np.isfinite(y)], exact, atol=1e-6)
    x = mean.get_xdata()
    np.testing.assert_allclose(np.nanmax(x), 0.229, atol=1e-9)
    assert np.isnan(x).sum() == 1  # where ticks were missed, the curve is broken


def test_missed_ticks_and_kept_frames_are_shares_of_all(recording: pc.Recording) -> None:
    panel = plot.timeline(recording, "skipped").axes[0]
    kept, missed = (patch.get_data() for patch in panel.patches)
    each = np.diff(missed.edges) / PERIOD  # ticks per bin
    assert (missed.values / 100.0 * each).sum() == pytest.approx(30.0, abs=1.0)
    assert missed.values[(missed.edges[:-1] > 0.105) & (missed.edges[1:] < 0.125)] == (
        pytest.approx(100.0)
    )
    assert not kept.values[kept.edges[1:] < 0.18].any()
    assert kept.values[-1] > 90.0  # nothing moves
    (anew,) = panel.lines
    assert anew.get_xdata()[0] == pytest.approx(0.180)


def test_a_recordings_panels_share_their_time(recording: pc.Recording) -> None:
    page = plot.timeline(recording)
    assert [panel.get_ylabel() for panel in page.axes] == [
        "amplitude (1: full)",
        "time [ms]",
        "skipped [%]",
    ]
    assert len({panel.get_xlim() for panel in page.axes}) == 1
    assert page.axes[-1].get_xlabel() == "time [s]"


def state(k: int, **fields: Any) -> State:
    given: dict[str, Any] = {
        "output": "sounding", "armed": True, "owner": "game", "scene": "room", "solver": "auto",
        "backend": "simulated", "technique": "", "intensity": 1.0, "rate": 1000.0, "points": bytes(12),
        "error": 0.01 * k, "tick_ms": (0.1, 0.2, 0.01 * k),
    }  # fmt: skip
    return State(sequence=k, time=1e6 + k, **{**given, **fields})


def frame(*amplitude: int) -> FrameState:
    levels = np.array(amplitude, "<u2").tobytes()
    return FrameState(sequence=1, time=0.0, phases=16, amplitudes=5, phase=levels, amplitude=levels)


@pytest.fixture
def feed(tmp_path: Path) -> Path:
    """Write a feed: 100 states in 10 s, silent from the 40th to the 59th, lost for 2 s after the 80th."""
    writer = FeedWriter(tmp_path / "a.feed")
    encode = msgspec.msgpack.encode
    for k in range(100):
        at = 0.1 * k + 2.0 * (k >= 80)
        silent = 40 <= k < 60
        writer.write(at, "frame", encode(frame() if silent else frame(4, 2, 0)))
        writer.write(at, "state", encode(state(k, output="silent" if silent else "sounding")))
        writer.write(at, "state", b"spoiled")
    writer.close()
    return tmp_path / "a.feed"


def test_a_viewers_file_has_drive_error_and_ticks_over_time(feed: Path) -> None:
    page = plot.timeline(feed)
    drive, error, ticks = page.axes
    assert [panel.get_ylabel() for panel in page.axes] == [
        "amplitude (1: full)", "error at samples [%]", "tick time [ms]",
    ]  # fmt: skip
    k = np.arange(100)
    sounds, at = (k < 40) | (k >= 60), 0.1 * k + 2.0 * (k >= 80)
    for line, loud in zip(drive.lines, (1.0, 0.5), strict=True):
        x, y = line.get_xydata()[np.isfinite(line.get_xdata())].T
        np.testing.assert_allclose(x, at)
        np.testing.assert_allclose(y, loud * sounds)
    (line,) = error.lines
    x, y = line.get_xydata().T
    np.testing.assert_allclose(x[np.isfinite(x)], at[sounds])
    np.testing.assert_allclose(y[np.isfinite(y)], k[sounds])
    assert np.isnan(x).sum() == 2  # without samples, and without a server
    most, percentile, median, deadline = ticks.lines
    assert np.nanmax(most.get_ydata()) == pytest.approx(0.99)
    assert np.nanmax(percentile.get_ydata()) == pytest.approx(0.2)
    assert np.nanmax(median.get_ydata()) == pytest.approx(0.1)
    assert deadline.get_ydata()[0] == pytest.approx(1.0)
    assert len(plot.timeline(str(feed), "error").axes) == 1


def test_levels_of_an_uneven_device_are_what_it_makes_of_them(tmp_path: Path) -> None:
    sound = Sound(
        pressure=1.0, directivity="omni", sizes=np.array([0.0, 0.1, 0.3, 1.0, 0.9], "<f4").tobytes(),
        speed_of_sound=343.0, density=1.2, power=1.0, absorption=0.0,
    )  # fmt: skip
    array = ArrayMessage(
        server="", positions=b"", normals=b"", frequency=40e3, wavelength=0.0085, phases=16, amplitudes=5,
        device_rate=1e3, rate=1e3, limits={}, solvers=(), backends=(), techniques=(), presets=(), fields=True,
        sound=sound,
    )  # fmt: skip
    with closing(FeedWriter(tmp_path / "a.feed")) as writer:
        writer.write(0.0, "array", encode_message(array))
        writer.write(0.0, "frame", msgspec.msgpack.encode(frame(1, 2)))
        writer.write(
            0.1, "frame", msgspec.msgpack.encode(frame(7, 7))
        )  # a level that the device does not have
        writer.write(0.1, "state", msgspec.msgpack.encode(state(1)))
    found = read_feed(tmp_path / "a.feed")
    np.testing.assert_allclose(found.drive, [[0.0, 0.2, 0.3]], rtol=1e-6)


def test_the_file_of_a_renderers_recording_is_that_recording(recording: pc.Recording) -> None:
    wanted, found = plot.timeline(recording, "drive"), plot.timeline(recording.path, "drive")
    for one, other in zip(wanted.axes[0].lines, found.axes[0].lines, strict=True):
        np.testing.assert_array_equal(one.get_xydata(), other.get_xydata())


def test_a_file_that_is_no_recording_or_has_no_state_is_told(tmp_path: Path) -> None:
    (tmp_path / "x").write_bytes(b"hello")
    for name in ("x", "none"):
        with pytest.raises(pc.RecordingError, match=name):
            plot.timeline(tmp_path / name)
    with closing(FeedWriter(tmp_path / "a.feed")) as writer:
        writer.write(0.0, "frame", msgspec.msgpack.encode(frame(1)))
    with pytest.raises(pc.RecordingError, match="no state"):
        plot.timeline(tmp_path / "a.feed")


def test_what_a_recording_does_not_tell_is_refused(recording: pc.Recording) -> None:
    with pytest.raises(pc.ArgumentError, match="drive"):
        plot.timeline(recording, "error")


def test_a_recording_without_ticks_or_cut_off_is_told_or_shown(
    recording: pc.Recording, tmp_path: Path
) -> None:
    data = recording.path.read_bytes()
    (tmp_path / "cut.rec").write_bytes(data[: len(data) - 1000])
    plot.timeline(pc.Recording(tmp_path / "cut.rec"))
    recorder = pc.Recorder(tmp_path / "none.rec")
    recorder.begin(ARRAY, pc.Capability(), {"rate": 1000.0, "medium": {}})
    recorder.close()
    with pytest.raises(pc.RecordingError, match="no tick"):
        plot.timeline(pc.Recording(tmp_path / "none.rec"))
