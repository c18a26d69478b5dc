"""Device descriptions: what is read, what is rejected and why, and the resulting array and wiring."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pacinian as pc
from pacinian.devices.description import schema
from pacinian.devices.layouts import AutdUnit, Grid, Places

ROOT = Path(__file__).parents[3]
EXAMPLES = sorted((ROOT / "examples" / "devices").glob("*.toml"))

FULL = """
backend = "usb-autd"
levels = { phases = 128, amplitudes = 65 }

[transducer]
frequency = 40500.0
pressure = 3.4
pressure_error = 0.2
directivity = { angles = [0, 0.7, 1.5708], values = [1, 0.6, 0.1] }

[[boards]]
serial = "A"
layout = { type = "grid", columns = 2, rows = 2, pitch = 0.01 }
pose = { position = [0.1, 0.0, 0.0], rotation = [0.0, 0.0, 1.0, 0.0] }
order = [3, 2, 1, 0]
dead = [1]
gain = [1.0, 0.5, 2.0, 1.0]
phase = 0.5
gain_error = [0.01, 0.02, 0.03, 0.04]
phase_error = 0.1

[[boards]]
serial = "B"
layout = { type = "places", places = [[0.0, 0.0, 0.0], [0.0, 0.02, 0.0]] }
"""


def write(folder: Path, text: str, name: str = "device.toml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_every_key_is_read(tmp_path: Path) -> None:
    device = pc.DeviceDescription.load(write(tmp_path, FULL))
    assert device.backend == "usb-autd"
    assert (device.levels.phases, device.levels.amplitudes) == (128, 65)  # type: ignore[union-attr]
    array = device.array()
    table = pc.DirectivityTable((0.0, 0.7, 1.5708), (1.0, 0.6, 0.1))
    assert array.transducer == pc.Transducer(frequency=40500.0, pressure=3.4, directivity=table)
    # half a turn about z, then 0.1 m along x; transducer 2 of the grid is dead: channel 1
    places = 0.1 - np.array([-0.005, 0.005, 0.005]), -np.array([-0.005, -0.005, 0.005])
    np.testing.assert_allclose(array.positions[:3, :2].T, places, atol=1e-12)
    np.testing.assert_allclose(array.positions[3:], [[0, 0, 0], [0, 0.02, 0]])
    turned = np.exp(0.5j)
    np.testing.assert_allclose(array.responses, [turned, 2.0 * turned, turned, 1.0, 1.0])
    unsure = pc.Uncertainty(
        pressure=0.2, gain=(0.04, 0.03, 0.01, 0.1, 0.1), phase=(0.1,) * 3 + (0.35,) * 2
    )
    assert device.uncertainty() == unsure
    one, other = device.wiring
    assert (one.serial, one.size, other.serial, other.size) == ("A", 4, "B", 2)
    assert one.channels.tolist() == [0, 2, 3]
    assert one.indices.tolist() == [2, 1, 0]
    assert other.channels.tolist() == [0, 1]
    assert other.indices.tolist() == [3, 4]


def test_nine_plain_units_are_the_paper_s_array() -> None:
    array = pc.autd(3, 3)
    boards = tuple(
        pc.Board(f"{j}{i}", pose=pc.Pose(((i - 1) * 0.192, (j - 1) * 0.1514, 0.0)))
        for j in range(3)
        for i in range(3)
    )
    made = pc.DeviceDescription(boards).array()
    np.testing.assert_allclose(made.positions, array.positions, atol=1e-12)
    assert np.array_equal(made.normals, array.normals)
    assert made.transducer == array.transducer
    assert made.response is None


@given(data=st.data())
def test_each_channel_drives_the_transducer_that_its_order_says(data: Any) -> None:
    """The reference goes position by position, with dictionaries."""
    boards = []
    for k in range(data.draw(st.integers(1, 3))):
        columns, rows = data.draw(st.integers(1, 4)), data.draw(st.integers(1, 3))
        L = columns * rows
        order = tuple(data.draw(st.permutations(range(L))))
        dead = tuple(data.draw(st.sets(st.integers(0, L - 1), max_size=L - 1)))
        gain = tuple(data.draw(st.lists(st.floats(0.1, 3.0), min_size=L, max_size=L)))
        pose = pc.Pose((0.3 * k, 0.0, 0.0))
        layout = Grid(columns, rows, 0.01)
        boards.append(pc.Board(f"{k}", layout, pose, order, dead, gain=gain))
    device = pc.DeviceDescription(tuple(boards))
    array, seen = device.array(), 0
    for board, wiring in zip(device.boards, device.wiring, strict=True):
        local = board.layout.positions()
        driven = dict(zip(wiring.channels.tolist(), wiring.indices.tolist(), strict=True))
        assert set(driven) == set(range(wiring.size)) - set(board.dead)
        for channel, index in driven.items():
            where = local[board.order[channel]] + board.pose.position
            np.testing.assert_allclose(array.positions[index], where, atol=1e-12)
            assert abs(array.responses[index]) == pytest.approx(board.gain[channel])  # type: ignore[index]
        seen += len(driven)
    assert seen == len(array)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", r"boards"),
        ("boards = []", r"at least one board"),
        ("[[boards]]\nserail = 'A'", r"\$\.boards\[0\].*serail.*did you mean `serial`"),
        ("bords = []\n[[boards]]", r"bords.*did you mean `boards`"),
        ("[[boards]]\nlayout = { type = 'gird' }", r"gird.*did you mean `grid`"),
        ("[[boards]]\nlayout = { type = 'grid', pich = 0.01 }", r"boards.*pich.*`pitch`"),
        ("[[boards]]\nlayout = { type = 'grid', pitch = 10.5 }", r"\$\.boards\[0\].*metres"),
        ("[[boards]]\nlayout = { type = 'grid', columns = 0 }", r"`columns` must be"),
        ("[[boards]]\nlayout = { type = 'grid', columns = 999, rows = 999 }", r"at most 4096"),
        ("[[boards]]\nlayout = { type = 'places', places = [] }", r"`places` must be 1 to"),
        ("[[boards]]\norder = [0, 1]", r"\$\.boards\[0\].*`order` must name each.*0 to 248"),
        ("[[boards]]\ndead = [249]", r"`dead` must be.*0 to 248.*249"),
        ("[[boards]]\ndead = [-1]", r"`dead`"),
        ("[[boards]]\ndead = [3, 3]", r"`dead` must be different"),
        ("[[boards]]\ngain = [1.0]", r"`gain` must be one, or 249"),
        ("[[boards]]\ngain = -1.0", r"`gain` must be 0 or more"),
        ("[[boards]]\ngain_error = -0.1", r"`gain_error` must be 0 or more"),
        ("[[boards]]\nphase_error = [0.1]", r"`phase_error` must be one, or 249"),
        ("transducer = { pressure_error = 30 }\n[[boards]]", r"`pressure_error` must be"),
        ("[[boards]]\nphase = nan", r"`phase` must be finite"),
        ("[[boards]]\ngain = 0.0", r"not dead"),
        ("[[boards]]\n[[boards]]\nserial = 'A'", r"boards\[0\]\.serial.*must be given"),
        ("[[boards]]\nserial = 'A'\n[[boards]]\nserial = 'A'", r"'A' is there twice"),
        ("transducer = { directivity = 'omnni' }\n[[boards]]", r"transducer.*`omni`"),
        ("transducer = { directivity = { angles = [0, 90], values = [1, 0] } }\n[[boards]]",
         r"\$\.transducer\.directivity.*degrees"),
        ("transducer = { directivity = { angels = [0, 90], values = [1, 0] } }\n[[boards]]",
         r"directivity.*angels.*`angles`"),
        ("transducer = { frequency = 0 }\n[[boards]]", r"\$\.transducer.*`frequency`"),
        ("levels = { phases = 1 }\n[[boards]]", r"\$\.levels.*`phases`"),
        ("[[boards]]\npose = { position = [100.0, 0, 0] }\nserial = 'A'\n[[boards]]\nserial = 'B'",
         r"\$\.boards.*lengths are in metres"),
        ("[[boards]]\nserial = 7", r"\$\.boards\[0\]\.serial.*str"),
        ("calibration = 'none.csv'\n[[boards]]", r"none\.csv.*cannot be read"),
        ("[[boards]", r"is not TOML"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_with_its_place(tmp_path: Path, text: str, told: str) -> None:
    with pytest.raises(pc.SceneFileError) as raised:
        pc.DeviceDescription.load(write(tmp_path, text))
    assert re.search(told, str(raised.value)), raised.value
    assert "device.toml" in str(raised.value) or "none.csv" in str(raised.value)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_the_examples_are_read_and_fit_the_schema(path: Path) -> None:
    device = pc.DeviceDescription.load(path)
    assert len(device.array()) == sum(len(wiring.channels) for wiring in device.wiring)
    with path.open("rb") as file:
        jsonschema.validate(tomllib.load(file), schema())


def test_the_examples_are_those_of_the_page() -> None:
    sizes = {p.stem: len(pc.DeviceDescription.load(p).array()) for p in EXAMPLES}
    assert sizes == {"autd-nine": 9 * 249 - 1, "openmpd-four": 4 * 256, "sonicsurface": 255}
    page = (ROOT / "docs" / "devices.md").read_text("utf-8")
    assert all(f"examples/devices/{name}.toml" in page for name in sizes)


def test_a_description_goes_through_json(tmp_path: Path) -> None:
    device = pc.DeviceDescription.load(write(tmp_path, FULL))
    path = write(tmp_path, msgspec.json.encode(device).decode(), "device.json")
    assert pc.DeviceDescription.load(path) == device
    jsonschema.validate(json.loads(path.read_text()), schema())


@pytest.mark.parametrize("layout", [AutdUnit(), Grid(3, 5, 0.012), Places(((0.0, 0.0, 0.0),))])
def test_a_layout_has_as_many_places_as_it_says(layout: Any) -> None:
    assert layout.positions().shape == (layout.count, 3)


def test_reading_one_loads_no_compiler() -> None:
    """Descriptions are also read in a guard and in an emulated machine, where that would be slow."""
    import subprocess
    import sys

    code = (
        "import sys, pacinian as pc\n"
        f"d = pc.DeviceDescription.load({str(EXAMPLES[0])!r})\n"
        "d.array(), d.wiring\n"
        "print(sorted({'pacinian.native', 'scipy', 'matplotlib'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
