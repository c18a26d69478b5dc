"""Plots of the emission of a run, from a renderer and from its recording."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.plot.emissions import MAX_GAINS, collect_emission
from pacinian.testing import ManualClock

ARRAY = pc.lattice(0.05, 0.05)
SPARK = pc.Point(
    position=(0.0, 0.0, 0.1), radiation_pressure=0.2, envelope=pc.Sine(100.0), name="spark"
)
SCENE = pc.Scene((SPARK,))


def renderer(**how: Any) -> pc.Renderer:
    device = pc.backend("simulated", rate=2000.0)
    given = {
        "backend": device,
        "adaptive": False,
        "clock": ManualClock(),
        "medium": pc.Air(temperature=25.0),
    }
    return pc.Renderer(ARRAY, SCENE, **(given | how))


def record(path: Path, ticks: Any) -> pc.Recording:
    """Record ticks at these numbers of periods; None resets the renderer."""
    made = renderer(recorder=pc.Recorder(path))
    with made:
        for tick in ticks:
            if tick is None:
                made.reset()
            else:
                made.tick(made.start + tick * made.period)
    return pc.Recording(path)


def test_a_recording_and_its_renderer_agree(tmp_path: Path) -> None:
    recording = record(tmp_path / "run.rec", range(50))
    live = collect_emission(renderer(), duration=0.05)
    for run in (recording, recording.path, str(recording.path)):
        read = collect_emission(run)
        np.testing.assert_array_equal(read.gains, live.gains)
        assert (read.rate, read.start, read.duration) == (2000.0, 0.0, 0.05)
        assert read.medium == live.medium
        assert read.find_scene(99)[1].objects == SCENE.objects
        np.testing.assert_allclose(read.find_scene(99)[0], 0.049)


def test_a_part_is_the_part(tmp_path: Path) -> None:
    recording = record(tmp_path / "run.rec", range(50))
    whole = collect_emission(recording)
    part = collect_emission(recording, 0.0125, 0.02)
    np.testing.assert_array_equal(part.gains, whole.gains[25:65])
    assert part.find_scene(0)[0] == pytest.approx(0.012)
    with pytest.raises(pc.ArgumentError, match=r"ends after 0\.05 s"):
        collect_emission(recording, 1.0)


def test_missed_ticks_repeat_the_last_frame_and_pauses_are_silent(tmp_path: Path) -> None:
    recording = record(tmp_path / "run.rec", [*range(20), *range(24, 30), 300, 301, None, 310])
    found = collect_emission(recording).gains
    assert len(found) == 622
    np.testing.assert_array_equal(found[40:48], np.repeat(found[39:40], 8, axis=0))
    assert not found[60:600].any()  # a pause
    assert found[600:604].any()
    assert not found[604:620].any()  # a reset


def test_a_real_device_is_not_driven() -> None:
    class Loud(type(pc.backend("simulated"))):  # type: ignore[misc]
        name = "loud"

        def open(self, array: Any) -> None:
            raise AssertionError("opened")

    with pytest.raises(pc.ArgumentError, match="would sound"):
        collect_emission(renderer(backend=Loud()), duration=0.1)


def test_a_run_that_stops_is_told() -> None:
    def scene(t: float) -> pc.Scene:
        if t > 0.01:
            raise RuntimeError("no scene")
        return SCENE

    with pytest.raises(pc.ArgumentError, match=r"stopped: .*no scene"):
        collect_emission(pc.Renderer(ARRAY, scene, clock=ManualClock()), duration=0.1)


@pytest.mark.parametrize(
    ("argument", "run", "how"),
    [
        ("run", None, {}),
        ("run", ARRAY, {}),
        ("duration", "renderer", {}),
        ("duration", "renderer", {"duration": 0.0}),
        ("duration", "renderer", {"duration": np.nan}),
        ("duration", "renderer", {"duration": 1.0 + MAX_GAINS / len(ARRAY) / 2000.0}),
        ("start", "renderer", {"start": -1.0, "duration": 1.0}),
    ],
)
def test_bad_arguments_are_named(argument: str, run: Any, how: Any) -> None:
    with pytest.raises(pc.ArgumentError) as told:
        collect_emission(renderer() if run == "renderer" else run, **how)
    assert told.value.argument == argument


def test_what_is_no_recording_is_told(tmp_path: Path) -> None:
    with pytest.raises(pc.RecordingError):
        collect_emission(tmp_path / "none.rec")
    with pytest.raises(pc.RecordingError, match="no tick"):
        collect_emission(record(tmp_path / "empty.rec", []))
