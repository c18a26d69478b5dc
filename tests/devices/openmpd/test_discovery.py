"""Which boards are found and opened, and what the user sees where one cannot be."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pacinian as pc
from pacinian_plugins.backends.openmpd import OpenMpd

from .chips import BITMODE, LATENCY, RESET, UDEV, Setup


def test_only_boards_that_are_named_are_touched() -> None:
    it = Setup("FT1", "OTHER", serials=[])
    it.refused(
        it.open,
        "openmpd: name the boards: `serials`, or those of a `description`; any FT232H looks like one; "
        "there are: FT1, OTHER",
    )
    it = Setup("FT1", "OTHER")
    it.backend.serials = ["FT1"]
    it.array = pc.Array(it.array.positions[:256], it.array.normals[:256])
    it.open()
    it.play()
    it.backend.close()
    other = it.chips[1]
    assert (other.requests, other.writes, other.configured) == ([], [], False)


def test_all_or_none_are_opened() -> None:
    it = Setup("FT1", "FT2")
    it.bus.devices.remove(it.chips[1])
    it.refused(it.open, "openmpd FT2: is not connected; there are: FT1")
    assert (it.bus.open, it.chip.requests) == (0, [])


def test_another_program_has_it_and_is_not_disturbed() -> None:
    it = Setup().open()
    it.play()
    told = len(it.chip.requests)
    other = OpenMpd(library=it.bus, serials=["FT1"], wait=it.clock.advance, clock=it.clock.now)
    it.refused(
        lambda: other.open(it.array),
        "openmpd FT1: opening it: it is in use by another program: end that first",
    )
    assert it.sounding()
    assert len(it.chip.requests) == told
    it.play()
    it.backend.close()
    other.open(it.array)
    other.close()


def test_boards_are_in_the_order_in_which_they_are_named() -> None:
    it = Setup("FT2", "FT1").open()
    levels = np.zeros((1, 512), np.uint16)
    levels[:, :256], levels[:, 256:] = 1, 2
    it.backend.send(pc.Frame(0, 0.0, levels, levels))
    assert [int(chip.model.pulses().sum(axis=1).max()) for chip in it.chips] == [1, 2]
    it.backend.close()


def test_an_array_of_another_size_is_refused() -> None:
    it = Setup("FT1", "FT2", serials=["FT1"])
    it.refused(it.open, "openmpd: the array has 512 transducers, and its 1 boards 256")


def test_boards_of_a_description(tmp_path: Path) -> None:
    order = list(reversed(range(256)))
    board = f'layout = {{ type = "grid" }}\norder = {order}\n'
    file = tmp_path / "device.toml"
    file.write_text(
        f'backend = "openmpd"\n[[boards]]\nserial = "FT2"\n{board}'
        f'[[boards]]\nserial = "FT1"\n{board}dead = [5]\npose = {{ position = [0.2, 0.0, 0.0] }}\n'
    )
    it = Setup("FT1", "FT2", serials=[], description=str(file))
    it.array = pc.DeviceDescription.load(file).array()
    it.open()
    levels = (np.arange(511, dtype=np.uint16) % 65)[None]
    it.backend.send(pc.Frame(0, 0.0, np.zeros_like(levels), levels))
    first, second = (chip.model.pulses().sum(axis=1) for chip in reversed(it.chips))
    np.testing.assert_array_equal(first[::-1], levels[0, :256])
    assert second[5] == 0
    np.testing.assert_array_equal(np.delete(second[::-1], 250), levels[0, 256:])
    it.backend.close()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[[boards]]\nlayout = { type = 'grid' }\n", "name the boards: "),
        ("[[boards]]\nserial = 'FT1'\n", "a board has 256 channels: correct the description"),
    ],
)
def test_descriptions_that_do_not_fit(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "device.toml"
    file.write_text(text)
    it = Setup(serials=[], description=str(file))
    it.array = pc.DeviceDescription.load(file).array()
    with pytest.raises(pc.BackendError, match=message):
        it.open()


def test_the_examples_pins_are_where_the_boards_have_them() -> None:
    file = Path(__file__).parents[3] / "examples" / "devices" / "openmpd-four.toml"
    (order,) = {board.order for board in pc.DeviceDescription.load(file).boards}
    # of the top row the first and the last, then of the bottom row; and the top row's next ones
    assert [order[pin] for pin in (249, 58, 197, 7)] == [240, 255, 0, 15]
    assert [order[pin] for pin in (248, 251, 250, 185)] == [241, 242, 243, 244]
    assert order[253] == 224  # below the first


def test_without_pyftdi_the_extra_is_named_and_the_chip_given_back(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "pyftdi.ftdi", None)
    it = Setup()
    with pytest.raises(pc.MissingExtra, match=r'pip install .*\[devices\]"'):
        it.open()
    assert (it.bus.open, it.chip.holder, it.chip.writes) == (0, None, [])


@pytest.mark.parametrize("request_", [RESET, BITMODE, LATENCY])
def test_a_chip_that_refuses_to_be_set_up_is_given_back(
    monkeypatch: pytest.MonkeyPatch, request_: int
) -> None:
    it = Setup()
    set_up = it.chip.control

    def control(setup: Any, data: bytes) -> bytes | None:
        return None if setup[1] == request_ else set_up(setup, data)

    monkeypatch.setattr(it.chip, "control", control)
    it.refused(it.open, "openmpd FT1: opening it: it refuses (stall)")
    assert (it.bus.open, it.chip.holder, it.chip.writes) == (0, None, [])


def test_what_is_connected_is_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    it = Setup("FT2", "FT1", "FT3", "")
    it.chips[2].denied = True
    find = __import__("usb.core").core.find
    monkeypatch.setattr("usb.core.find", lambda **given: find(**{**given, "backend": it.bus}))
    title = "FT232H, an OpenMPD board or anything else, bus 1, address"
    nameless = "it has no serial number: write one to its EEPROM, with FTDI's FT_PROG or pyftdi's ftconf.py"
    assert list(OpenMpd.find_devices()) == [
        pc.FoundDevice("openmpd", "", f"{title} 4", UDEV),
        pc.FoundDevice("openmpd", "", f"{title} 5", nameless),
        pc.FoundDevice("openmpd", "FT1", f"{title} 3"),
        pc.FoundDevice("openmpd", "FT2", f"{title} 2"),
    ]
    assert it.bus.open == 0
    assert not any(chip.requests for chip in it.chips)


@pytest.mark.parametrize(
    "options",
    [
        {"rate": 50.0},
        {"rate": 20_000.0},
        {"timeout": 0.0},
        {"led": (0, 0)},
        {"led": (0, 0, 256)},
        {"led": (0, 0, 1.5)},
        {"serials": "FT1,,FT2"},
        {"serials": ["A", "A"]},
    ],
)
def test_bad_settings_are_named(options: dict[str, Any]) -> None:
    with pytest.raises(pc.ArgumentError, match=next(iter(options))):
        OpenMpd(**options)
