"""Calibration files are read strictly, and with them an imperfect device makes the pressures of an ideal one."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian.devices import calibration
from pacinian.scene.config_sections import Device
from pacinian.testing import ManualClock

DEVICE = """
calibration = "heard.csv"
[[boards]]
serial = "A"
order = [{order}]
[[boards]]
serial = "B"
pose = {{ position = [0.2, 0.0, 0.0] }}
"""
HEAD = "serial,channel,gain,phase\n"


@pytest.fixture
def device(tmp_path: Path) -> Path:
    order = ", ".join(map(str, np.random.default_rng(5).permutation(249)))
    path = tmp_path / "device.toml"
    path.write_text(DEVICE.format(order=order), encoding="utf-8")
    (tmp_path / "heard.csv").write_text(HEAD, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "line 1: must be serial,channel,gain,phase"),
        ("serial,channel,phase,gain\n", "line 1: must be"),
        (HEAD + "A,1,1.0\n", "line 2: must have 4 values, not 3"),
        (HEAD + "A,0,1.0,0.0\n\nA,one,1.0,0.0\n", "line 4: must be numbers"),
        (HEAD + "A,1.5,1.0,0.0\n", "line 2.*`channel`.*whole"),
        (HEAD + "A,-1,1.0,0.0\n", "line 2.*`channel`"),
        (HEAD.replace("\n", ",gain_error,phase_error\n") + "A,1,1.0,0.0\n", "line 2: must have 6"),
        (
            HEAD.replace("\n", ",gain_error,phase_error\n") + "A,1,1,0,-1,0\n",
            "line 2.*`gain_error`",
        ),
        (HEAD + "A,1,nan,0.0\n", "line 2.*`gain`.*finite"),
        (HEAD + "A,1,-1.0,0.0\n", "line 2.*`gain`"),
        (HEAD + "A,1,1.0,inf\n", "line 2.*`phase`"),
        (HEAD + "A,0,1.0,120\nA,1,1.0,-95.5\n", "line 2.*`phase`.*were degrees given"),
        (HEAD + "A,1,1.0,0.0\nA,1,1.0,0.1\n", "line 3.*channel 1 of it again"),
        (HEAD + "C,1,1.0,0.0\n", "board 'C', which is not described"),
        (HEAD + "A,249,1.0,0.0\n", "channel 249 of 'A', which has 249"),
        (HEAD + "A,1,1e9,0.0\n", "gain"),
        (HEAD + "A,1,1.0,\xff", "line 2|is not CSV"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(device: Path, text: str, told: str) -> None:
    (device.parent / "heard.csv").write_bytes(text.encode("latin-1"))
    with pytest.raises(pc.SceneFileError) as raised:
        pc.DeviceDescription.load(device)
    assert re.search(told, str(raised.value)), raised.value
    assert "heard.csv" in str(raised.value)


def test_what_was_measured_goes_before_what_is_written(device: Path) -> None:
    text = device.read_text() + "gain = 0.7\nphase = 1.0\n"  # in the section of board B
    device.write_text(text)
    rows = "B,3,0.5,-1.0,0.02,0.03\nB,4,0.0,0.0,0,0\nB,5,0.0005,0.0,0.1,0.1\n"
    head = HEAD.replace("\n", ",gain_error,phase_error\n")
    (device.parent / "heard.csv").write_text("\ufeff" + head + rows, encoding="utf-8")
    board = pc.DeviceDescription.load(device).boards[1]
    assert [errors[2:4].tolist() for errors in board.errors] == [[0.1, 0.02], [0.35, 0.03]]
    np.testing.assert_allclose(board.responses[2:4], [0.7 * np.exp(1j), 0.5 * np.exp(-1j)])
    assert board.alive.tolist() == [c for c in range(249) if c not in (4, 5)]


def test_a_copy_of_a_device_needs_neither_of_its_files(device: Path, tmp_path: Path) -> None:
    (device.parent / "heard.csv").write_text(HEAD + "B,3,0.5,-1.0\nB,4,0.0,0.0\n", encoding="utf-8")
    original = Device(str(device), pc.Pose((0.0, 0.0, 1.0)))
    array = original.make()
    copied = original.copy_to(tmp_path / "copy.json")
    device.unlink()
    (device.parent / "heard.csv").unlink()
    for name in ("positions", "normals", "responses"):
        np.testing.assert_array_equal(getattr(copied.make(), name), getattr(array, name))


def test_a_calibrated_device_makes_the_pressures_of_an_ideal_one(device: Path) -> None:
    """A microphone measures one channel after another. The double-precision reference judges the result."""
    rng = np.random.default_rng(9)
    plain = pc.DeviceDescription.load(device)
    ideal = plain.array()
    N = len(ideal)
    truth = rng.uniform(0.4, 1.2, N) * np.exp(1j * rng.uniform(-np.pi, np.pi, N))
    real = pc.Array(ideal.positions, ideal.normals, ideal.transducer, truth)  # the real device

    microphone = [[0.1, 0.0, 0.5]]
    rows = HEAD
    for wiring in plain.wiring:
        for channel, index in zip(wiring.channels, wiring.indices, strict=True):
            drive = np.zeros(N)
            drive[index] = 1.0
            heard = pc.field(real, drive, microphone, precision="double", medium=pc.Air())[0]
            expected = pc.field(ideal, drive, microphone, precision="double", medium=pc.Air())[0]
            s = heard / expected
            rows += f"{wiring.serial},{channel},{abs(s):.6f},{np.angle(s):.6f}\n"
    (device.parent / "heard.csv").write_text(rows, encoding="utf-8")
    calibrated = pc.DeviceDescription.load(device).array()
    np.testing.assert_allclose(calibrated.responses, truth, atol=1e-5)

    q = np.array([[0.05, 0.0, 0.2], [0.12, 0.03, 0.22]])
    B = pc.matrix(ideal, q, pc.Air()) * truth  # independent of `response`
    t = 0.3 * np.abs(B).sum(axis=1) / 2.0
    unaware = B @ pc.solve(ideal, q, t, solver="lagrange").gains
    aware = B @ pc.solve(calibrated, q, t, solver="lagrange").gains
    np.testing.assert_allclose(np.abs(aware), t, rtol=1e-3)
    assert (np.abs(unaware) < 0.5 * t).any()  # without calibration, pressures would be wrong

    # with the device's levels, as a backend gets them
    backend = pc.backend("simulated", phases=256, amplitudes=320)
    scene = pc.Scene(
        tuple(pc.Point(position=tuple(p), radiation_pressure=20.0) for p in q.tolist())
    )
    with pc.Renderer(
        calibrated, scene, backend=backend, solver="lagrange", clock=ManualClock()
    ) as renderer:
        renderer.run(0.2)
    emitted: Any = backend
    asked = pc.sound_pressure(20.0, pc.Air())
    np.testing.assert_allclose(
        np.abs(B @ emitted.frames[-3].gains(backend.capability)[-1]), asked, rtol=5e-3
    )


# ------------------------------------------------------------------ the array's response


def test_the_kernels_know_the_response() -> None:
    """`field`, `matrix` and the propagator against plain NumPy in double precision."""
    array = pc.autd()
    rng = np.random.default_rng(2)
    s = rng.uniform(0.2, 2.0, 249) * np.exp(1j * rng.uniform(-3, 3, 249))
    uneven = replace(array, response=s)
    q = rng.uniform([-0.1, -0.1, 0.1], [0.1, 0.1, 0.3], (20, 3))
    B = pc.matrix(array, q, pc.Air()) * s
    g = rng.normal(size=249) / 30 + 0j
    np.testing.assert_allclose(pc.matrix(uneven, q, pc.Air()), B, rtol=1e-12)
    np.testing.assert_allclose(
        pc.field(uneven, g, q, precision="double", medium=pc.Air()), B @ g, rtol=1e-9
    )
    scale = np.abs(B).sum(axis=1).max()
    np.testing.assert_allclose(pc.field(uneven, g, q, medium=pc.Air()), B @ g, atol=1e-5 * scale)
    propagator = pc.Propagator(uneven, pc.Air())
    propagator.set_points(q)
    np.testing.assert_allclose(propagator.B, B, atol=1e-4 * np.abs(B).max())
    moved = q.copy()
    moved[3] += 0.01
    assert propagator.set_points(moved) == 1  # a single row is weighted, too
    np.testing.assert_allclose(
        propagator.B, pc.matrix(array, moved, pc.Air()) * s, atol=1e-4 * np.abs(B).max()
    )


def test_a_response_stays_with_its_transducers() -> None:
    array = pc.autd()
    s = np.linspace(0.5, 2.0, 249) * 1j
    uneven = replace(array, response=s)
    assert np.array_equal(uneven.remove_transducers([0, 5]).responses, np.delete(s, [0, 5]))
    assert np.array_equal(uneven.transform(pc.Pose((0.0, 0.0, 0.1))).responses, s)
    assert np.array_equal(uneven.fold().responses, s)
    assert np.array_equal(uneven.replace_transducer(pc.IDEAL).responses, s)
    both = array.transform(pc.Pose((1.0, 0.0, 0.0))) + uneven
    assert np.array_equal(both.responses, np.r_[np.ones(249), s])
    assert replace(array, response=np.ones(249)).response is None
    assert not uneven.responses.flags.writeable


@pytest.mark.parametrize(
    "wrong", [np.ones(3), 0.0 * np.ones(249), np.full(249, np.nan), ["x"] * 249]
)
def test_a_response_that_cannot_be_is_refused(wrong: Any) -> None:
    with pytest.raises(pc.ArgumentError, match="response"):
        replace(pc.autd(), response=wrong)


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="a file without an end")
@pytest.mark.parametrize("endless", ["/dev/zero", "large.csv"])
def test_files_without_an_end_are_not_read(device: Path, endless: str) -> None:
    with (device.parent / "large.csv").open("wb") as file:
        file.truncate(calibration.MAX_BYTES + 1)
    device.write_text(device.read_text().replace("heard.csv", endless))
    with pytest.raises(pc.SceneFileError, match=r"not a file|larger than"):
        pc.DeviceDescription.load(device)


def test_errors_tell_nothing_of_what_is_in_other_files(device: Path) -> None:
    for secret in ("hunter2:x:0:0", f"{','.join(calibration.COLUMNS)}\nhunter2,x,0,0"):
        (device.parent / "heard.csv").write_text(secret)
        with pytest.raises(pc.SceneFileError) as raised:
            pc.DeviceDescription.load(device)
        assert "hunter2" not in str(raised.value)
